#include "steps/form.h"
#include <string.h>

/* a b, of which a sum has several; b may be one. */
struct term {
	struct operand a, b;
};

struct terms {
	struct term *list;
	size_t count, capacity;
};

static const struct operand ZERO = {FORM_ZERO, 0}, ONE = {FORM_ONE, 0};

/* Sums that are used once are opened up so deep. */
enum { DEEP = 3 };

static struct operand signed_operand(struct operand p, int is_minus)
{
	return (struct operand){p.form, p.is_minus != (is_minus != 0)};
}

static uint32_t add_form(struct forms *x, struct form f)
{
	struct form *list = arena_grow(x->arena, x->list, x->count, &x->capacity, sizeof *list);

	if (!list)
		return FORM_ZERO;
	x->list = list;
	list[x->count] = f;
	return (uint32_t)x->count++;
}

static void push(struct forms *x, struct terms *t, struct operand a, struct operand b)
{
	struct term *list;

	if (a.form == FORM_ZERO || b.form == FORM_ZERO)
		return;
	list = arena_grow(x->arena, t->list, t->count, &t->capacity, sizeof *list);
	if (!list)
		return;
	t->list = list;
	if (b.form == FORM_ONE && x->list[a.form].kind == FORM_PRODUCT) { /* its factors can be seen */
		b = x->list[a.form].b;
		a = signed_operand(x->list[a.form].a, a.is_minus);
	}
	list[t->count++] = (struct term){signed_operand(a, b.is_minus), {b.form, 0}};
}

int turn_term(const struct forms *x, struct operand a, struct operand b, struct turn_term *t)
{
	for (int k = 0; k < 2; k++) {
		struct operand wave = k ? b : a;
		const struct form *f = &x->list[wave.form];

		if (f->kind != FORM_SINE && f->kind != FORM_COSINE)
			continue;
		*t = (struct turn_term){f->a.form, wave.form, f->kind == FORM_SINE, signed_operand(k ? a : b, wave.is_minus)};
		return 1;
	}
	return 0;
}

static struct operand of_term(struct forms *x, struct term t)
{
	if (t.b.form == FORM_ONE)
		return t.a;
	if (t.a.form == FORM_ONE)
		return (struct operand){t.b.form, t.a.is_minus};
	return (struct operand){add_form(x, (struct form){.kind = FORM_PRODUCT, .a = {t.a.form, 0}, .b = t.b}), t.a.is_minus};
}

static struct operand sum_two(struct forms *x, struct operand a, struct operand b)
{
	if (a.form == FORM_ZERO || b.form == FORM_ZERO)
		return a.form == FORM_ZERO ? b : a;
	return (struct operand){add_form(x, (struct form){.kind = FORM_SUM, .a = a, .b = b}), 0};
}

/* Cosine and sine of one angle among the terms: taken out, as one form. */
static int take_turn(struct forms *x, struct terms *t, struct operand *turn)
{
	struct turn_term p, q, swap;

	for (size_t i = 0; i < t->count; i++)
		for (size_t k = i + 1; k < t->count && turn_term(x, t->list[i].a, t->list[i].b, &p); k++) {
			if (!turn_term(x, t->list[k].a, t->list[k].b, &q) || q.angle != p.angle || q.is_sine == p.is_sine)
				continue;
			swap = p;
			p = p.is_sine ? q : p;
			q = swap.is_sine ? swap : q;
			*turn = (struct operand){add_form(x,
				(struct form){.kind = FORM_TURN, .a = p.other, .b = q.other, .cosine = p.wave, .sine = q.wave}),
				0};
			memmove(&t->list[k], &t->list[k + 1], (--t->count - k) * sizeof *t->list);
			memmove(&t->list[i], &t->list[i + 1], (--t->count - i) * sizeof *t->list);
			return 1;
		}
	return 0;
}

/* Turns stand outermost, so that sums of vectors have them where each other's are. */
static struct operand sum_of(struct forms *x, struct terms *t)
{
	struct operand turns = ZERO, rest = ZERO, turn;

	while (!x->arena->failed && take_turn(x, t, &turn))
		turns = sum_two(x, turns, turn);
	for (size_t i = 0; i < t->count && !x->arena->failed; i++)
		rest = sum_two(x, rest, of_term(x, t->list[i]));
	return sum_two(x, rest, turns);
}

/* ---- values ---- */

static struct operand value_at(const struct forms *x, struct ref a)
{
	return x->value[a.i];
}

static void collect(struct forms *x, struct terms *t, uint32_t i, int is_minus, int deep);

/* An operand of a sum. */
static void collect_operand(struct forms *x, struct terms *t, struct ref a, int is_minus, int deep)
{
	if (deep > 0 && x->uses[a.i] == 1)
		collect(x, t, a.i, is_minus, deep - 1);
	else
		push(x, t, signed_operand(value_at(x, a), is_minus), ONE);
}

static void collect(struct forms *x, struct terms *t, uint32_t i, int is_minus, int deep)
{
	const struct node *n = &x->d->nodes[i];

	switch (n->op) {
	case OP_NEG:
	case OP_ANEW:
		collect_operand(x, t, n->arg[0], is_minus != (n->op == OP_NEG), deep);
		return;
	case OP_MUL:
	case OP_FMA:
		push(x, t, signed_operand(value_at(x, n->arg[0]), is_minus), value_at(x, n->arg[1]));
		if (n->op == OP_FMA)
			collect_operand(x, t, n->arg[2], is_minus, deep);
		return;
	case OP_ADD:
	case OP_SUB:
		collect_operand(x, t, n->arg[0], is_minus, deep);
		collect_operand(x, t, n->arg[1], is_minus != (n->op == OP_SUB), deep);
		return;
	default:
		push(x, t, signed_operand(value_at(x, (struct ref){i}), is_minus), ONE);
	}
}

static struct operand value_of(struct forms *x, uint32_t i)
{
	const struct node *n = &x->d->nodes[i];
	struct terms t = {NULL, 0, 0};

	switch (n->op) {
	case OP_CONST:
		return (struct operand){add_form(x,
			(struct form){.kind = FORM_CONST, .constant = span_within(dag_number(x->d, n))}), 0};
	case OP_INPUT:
		return (struct operand){add_form(x,
			(struct form){.kind = FORM_INPUT, .argument = (int)n->arg[0].i, .row = (int)n->arg[1].i}), 0};
	case OP_SIN:
	case OP_COS:
		return (struct operand){
			add_form(x, (struct form){.kind = n->op == OP_SIN ? FORM_SINE : FORM_COSINE,
				.a = value_at(x, n->arg[0])}), 0};
	case OP_NEG:
	case OP_ANEW:
		return signed_operand(value_at(x, n->arg[0]), n->op == OP_NEG);
	case OP_ADD:
	case OP_SUB:
	case OP_MUL:
	case OP_FMA:
		collect(x, &t, i, 0, DEEP);
		return sum_of(x, &t);
	default:
		x->is_unknown = 1;
		return ZERO;
	}
}

/* ---- derivatives ---- */

/* An operand's share: the derivative by it, times that of the output by the operation. */
static void give(struct forms *x, struct terms *to, struct ref operand, struct operand partial, struct operand slope)
{
	push(x, &to[operand.i], partial.form == FORM_ONE ? signed_operand(slope, partial.is_minus) : partial,
		partial.form == FORM_ONE ? ONE : slope);
}

static void give_all(struct forms *x, struct terms *to, const struct node *n, struct operand slope)
{
	switch (n->op) {
	case OP_MUL:
	case OP_FMA:
		give(x, to, n->arg[0], value_at(x, n->arg[1]), slope);
		give(x, to, n->arg[1], value_at(x, n->arg[0]), slope);
		if (n->op == OP_FMA)
			give(x, to, n->arg[2], ONE, slope);
		return;
	case OP_ADD:
	case OP_SUB:
		give(x, to, n->arg[1], signed_operand(ONE, n->op == OP_SUB), slope);
		give(x, to, n->arg[0], ONE, slope);
		return;
	case OP_NEG:
	case OP_ANEW:
		give(x, to, n->arg[0], signed_operand(ONE, n->op == OP_NEG), slope);
		return;
	default:
		return;
	}
}

static void derive(struct forms *x, uint32_t root)
{
	struct terms *to = arena_alloc(x->arena, x->dag_count, sizeof *to);

	if (!to)
		return;
	push(x, &to[root], ONE, ONE);
	for (uint32_t i = root + 1; i-- > 0 && !x->arena->failed;) {
		x->slope[i] = sum_of(x, &to[i]);
		if (x->slope[i].form != FORM_ZERO)
			give_all(x, to, &x->d->nodes[i], x->slope[i]);
	}
}

int forms_make(struct forms *x, const struct dag *d, size_t output, int has_slopes, struct arena *a)
{
	uint32_t root = d->outputs[output].value.i;

	*x = (struct forms){.d = d, .arena = a, .dag_count = root + 1};
	x->uses = arena_alloc(a, x->dag_count, sizeof *x->uses);
	x->value = arena_alloc(a, x->dag_count, sizeof *x->value);
	x->slope = arena_alloc(a, x->dag_count, sizeof *x->slope);
	if (a->failed)
		return 0;
	add_form(x, (struct form){.kind = FORM_CONST, .constant = {0, 0}});
	add_form(x, (struct form){.kind = FORM_CONST, .constant = {1, 1}});
	x->uses[root] = 1;
	for (uint32_t i = root + 1; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && x->uses[i]; k++)
			x->uses[d->nodes[i].arg[k].i]++;
	for (uint32_t i = 1; i <= root && !a->failed && !x->is_unknown; i++)
		if (x->uses[i])
			x->value[i] = value_of(x, i);
	x->root = x->value[root];
	if (has_slopes && !x->is_unknown)
		derive(x, root);
	return !a->failed && !x->is_unknown;
}
