#include "norms/adjoint.h"
#include <string.h>

static int is_trig(const struct node *n)
{
	return n->op == OP_SIN || n->op == OP_COS;
}

int trig_term(const struct dag *d, struct ref a, struct trig_term *t)
{
	const struct node *n = &d->nodes[a.i];

	t->sign = 1;
	for (; n->op == OP_NEG; n = &d->nodes[n->arg[0].i])
		t->sign = -t->sign;
	for (int k = 0; k < 2 && n->op == OP_MUL; k++) {
		const struct node *f = &d->nodes[n->arg[k].i];

		if (is_trig(f)) {
			t->angle = f->arg[0].i;
			t->is_sine = f->op == OP_SIN;
			t->other = n->arg[!k];
			return 1;
		}
	}
	return 0;
}

static int are_partners(const struct dag *d, struct ref a, struct ref b)
{
	struct trig_term x, y;

	return trig_term(d, a, &x) && trig_term(d, b, &y) && x.angle == y.angle && x.is_sine != y.is_sine;
}

/* a + b; where a's partner is a term of b, (the rest of b) + (a + partner) */
static struct ref add(struct dag *d, struct ref a, struct ref b)
{
	const struct node n = d->nodes[b.i];

	if (are_partners(d, a, b) || (n.op != OP_ADD && n.op != OP_SUB))
		return dag_add(d, a, b);
	for (int k = 0; k < 2; k++) {
		int is_minus = n.op == OP_SUB;
		struct ref term = is_minus && k == 1 ? dag_neg(d, n.arg[1]) : n.arg[k];
		struct ref rest = is_minus && k == 0 ? dag_neg(d, n.arg[1]) : n.arg[!k];

		if (are_partners(d, a, term))
			return dag_add(d, rest, dag_add(d, a, term));
	}
	return dag_add(d, a, b);
}

static struct ref copy_node(struct adjoint *x, const struct dag *from, uint32_t i)
{
	const struct node *n = &from->nodes[i];
	struct dag *d = &x->d;
	struct ref v[3] = {{0}};

	for (int k = 0; k < op_arity[n->op]; k++)
		v[k] = x->value[n->arg[k].i];
	switch (n->op) {
	case OP_CONST:
		return dag_within(d, dag_number(from, n));
	case OP_INPUT:
		return dag_input(d, (int)n->arg[0].i, (int)n->arg[1].i);
	case OP_ANEW:
		return v[0];
	case OP_FMA:
		return add(d, dag_mul(d, v[0], v[1]), v[2]);
	case OP_ADD:
		return trig_term(d, v[1], &(struct trig_term){0}) ? add(d, v[1], v[0]) : add(d, v[0], v[1]);
	case OP_SUB:
		return add(d, dag_neg(d, v[1]), v[0]);
	default:
		return dag_operation(d, n->op, v[0], v[1], v[2]);
	}
}

/* ---- derivatives ---- */

/* What is added to a node's derivative, one after the other. */
struct shares {
	struct ref *of;
	uint32_t *next, *first; /* 0: no more */
	uint32_t count;
};

static void give(struct shares *s, struct dag *d, uint32_t to, struct ref partial, struct ref slope)
{
	s->count++;
	s->of[s->count] = dag_mul(d, partial, slope);
	s->next[s->count] = s->first[to];
	s->first[to] = s->count;
}

/* Their sum: rotations' pairs first found, and added last. */
static struct ref total(struct shares *s, struct dag *d, uint32_t node)
{
	struct ref rest = {0}, pairs = {0};

	for (uint32_t i = s->first[node]; i; i = s->next[i]) {
		struct ref with = {0};

		for (uint32_t k = s->next[i]; k && s->of[i].i && !with.i; k = s->next[k])
			if (are_partners(d, s->of[i], s->of[k])) {
				with = s->of[k];
				s->of[k] = (struct ref){0};
			}
		if (with.i)
			pairs = dag_add(d, pairs, dag_add(d, s->of[i], with));
		else
			rest = dag_add(d, rest, s->of[i]);
	}
	return dag_add(d, rest, pairs);
}

static void give_all(const struct adjoint *x, struct shares *s, struct dag *d, const struct node *n, struct ref slope)
{
	struct ref one = dag_const(d, 1), minus = dag_const(d, -1);

	switch (n->op) {
	case OP_MUL:
	case OP_FMA:
		give(s, d, n->arg[0].i, x->value[n->arg[1].i], slope);
		give(s, d, n->arg[1].i, x->value[n->arg[0].i], slope);
		if (n->op == OP_FMA)
			give(s, d, n->arg[2].i, one, slope);
		return;
	case OP_NEG:
		give(s, d, n->arg[0].i, minus, slope);
		return;
	case OP_ADD:
	case OP_SUB:
	case OP_ANEW:
		give(s, d, n->arg[0].i, one, slope);
		if (n->op != OP_ANEW)
			give(s, d, n->arg[1].i, n->op == OP_SUB ? minus : one, slope);
		return;
	default: /* inputs, constants; angles are taken as they are */
		return;
	}
}

static int derive(struct adjoint *x, const struct dag *from, uint32_t root, struct arena *a)
{
	struct shares s = {0};

	s.of = arena_alloc(a, 3 * (size_t)root + 5, sizeof *s.of);
	s.next = arena_alloc(a, 3 * (size_t)root + 5, sizeof *s.next);
	s.first = arena_alloc(a, (size_t)root + 1, sizeof *s.first);
	if (a->failed)
		return 0;
	give(&s, &x->d, root, dag_const(&x->d, 1), dag_const(&x->d, 1));
	for (uint32_t i = root + 1; i-- > 0;) {
		x->slope[i] = total(&s, &x->d, i);
		if (x->slope[i].i)
			give_all(x, &s, &x->d, &from->nodes[i], x->slope[i]);
	}
	return !x->d.failed;
}

int adjoint_make(struct adjoint *x, const struct dag *d, size_t output, int has_slopes, struct arena *a)
{
	uint32_t root = d->outputs[output].value.i;
	unsigned char *live = arena_alloc(a, d->count, 1);

	*x = (struct adjoint){.count = root + 1};
	dag_init(&x->d, a);
	x->value = arena_alloc(a, d->count, sizeof *x->value);
	x->slope = arena_alloc(a, d->count, sizeof *x->slope);
	if (a->failed)
		return 0;
	for (int i = 0; i < d->argument_count; i++)
		dag_argument_of(&x->d, d->arguments[i]);
	live[root] = 1;
	dag_mark_operands(d, (size_t)root + 1, live);
	for (uint32_t i = 1; i <= root && !x->d.failed; i++)
		if (live[i])
			x->value[i] = copy_node(x, d, i);
	x->root = x->value[root];
	return !x->d.failed && (!has_slopes || derive(x, d, root, a));
}
