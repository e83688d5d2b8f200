/* Which outputs make one field, and the steps that evaluate it. */
#include "range/field.h"
#include "scene/adjust.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Grids of more dimensions, or of functions with more waves, are too large. */
enum { GRID_DIMS = 12 };
#define MOST_TOGETHER 5e5 /* knots (knots.h) of outputs in a field: of 7 angles six outputs, of more one each */

/* What is known of a node. */
struct mark {
	uint64_t dims;       /* rows of q that it depends on */
	unsigned char orders; /* bit k: it has terms of order k, where rates are of order 1 and drives of order 2 */
	double size, noise;  /* over all angles: magnitude, and error of field_evaluate */
	struct interval plain;
};

struct splitter {
	const struct relaxed *r;
	const struct analysis *x;
	const struct dag *d;
	struct arena *a;
	struct rneagen_error *e;
	struct mark *marks;
	unsigned char *live, *bit; /* bit: by row of q, 1 + its place among those that are read */
	int bit_count;
};

static enum role role_of(const struct splitter *s, const struct node *n)
{
	return s->d->arguments[n->arg[0].i].role;
}

static enum rneagen_code refuse(const struct splitter *s, const char *what)
{
	return error_set(s->e, RNEAGEN_UNSUPPORTED, "%s: prove knows torques, gravity, bias and M, %s", s->x->options.file, what);
}

/* ---- what is known of each node ---- */

static unsigned orders_of_product(unsigned a, unsigned b)
{
	unsigned orders = 0;

	for (int i = 0; i < 8; i++)
		orders |= a >> i & 1 ? b << i : 0;
	return orders > 255 ? 255 : orders;
}

static struct mark mark_input(struct splitter *s, const struct node *n)
{
	struct interval r = s->r->rows[n->arg[0].i][n->arg[1].i];
	enum role role = role_of(s, n);
	struct mark m = {.orders = role == ROLE_JOINT_VELOCITY ? 2 : 4, .size = interval_size(r), .plain = r};

	if (role == ROLE_JOINT_POSITION) {
		if (!s->bit[n->arg[1].i] && s->bit_count < FIELD_DIMS)
			s->bit[n->arg[1].i] = (unsigned char)++s->bit_count;
		m.dims = (uint64_t)1 << (s->bit[n->arg[1].i] - (s->bit[n->arg[1].i] > 0));
		m.orders = 1;
	}
	return m;
}

/* A constant may be replaced where the file's numbers cannot tell it from another: 2^-50 of it is more than that. */
static struct mark mark_constant(const struct splitter *s, const struct node *n)
{
	double off = within_error(dag_number(s->d, n)) + 0x1p-50 * (double)fabsl(n->value);
	int is_exact = !n->number && (real)(double)n->value == n->value;

	return (struct mark){.orders = 1, .size = (double)fabsl(n->value) * (1 + 0x1p-50), .noise = is_exact ? 0 : off,
		.plain = interval_around(n->value, is_exact ? 0 : off)};
}

static struct mark mark_angle(const struct mark *a, enum op op)
{
	return (struct mark){.dims = a->dims, .orders = a->orders, .size = 1, .noise = 0x1p-52,
		.plain = op == OP_SIN ? interval_sin(a->plain) : interval_cos(a->plain)};
}

static struct mark mark_sum(struct mark a, struct mark b)
{
	struct mark m = {.dims = a.dims | b.dims, .orders = a.orders | b.orders, .size = a.size + b.size, .noise = a.noise + b.noise,
		.plain = interval_add(a.plain, b.plain)};

	m.noise += 0x1p-52 * m.size + DBL_MIN;
	return m;
}

static struct mark mark_product(struct mark a, struct mark b)
{
	struct mark m = {.dims = a.dims | b.dims, .orders = (unsigned char)orders_of_product(a.orders, b.orders),
		.size = a.size * b.size, .noise = a.size * b.noise + b.size * a.noise + a.noise * b.noise,
		.plain = interval_mul(a.plain, b.plain)};

	m.noise += 0x1p-52 * m.size + DBL_MIN;
	return m;
}

static struct mark mark_of(struct splitter *s, const struct node *n)
{
	const struct mark *m = s->marks;
	struct mark a = m[op_arity[n->op] > 0 ? n->arg[0].i : 0], b = m[op_arity[n->op] > 1 ? n->arg[1].i : 0];

	switch (n->op) {
	case OP_CONST:
		return mark_constant(s, n);
	case OP_INPUT:
		return mark_input(s, n);
	case OP_SIN:
	case OP_COS:
		return mark_angle(&a, n->op);
	case OP_NEG:
		a.plain = interval_neg(a.plain);
		return a;
	case OP_ANEW:
		return a;
	case OP_SUB:
		b.plain = interval_neg(b.plain);
		return mark_sum(a, b);
	case OP_ADD:
		return mark_sum(a, b);
	case OP_MUL:
		return mark_product(a, b);
	default:
		return mark_sum(mark_product(a, b), m[n->arg[2].i]);
	}
}

static enum rneagen_code check_node(const struct splitter *s, const struct node *n)
{
	int is_angle = n->op == OP_SIN || n->op == OP_COS;

	if (n->op == OP_DIV || n->op == OP_SQRT || n->op == OP_ABS || n->op == OP_WIDEN || n->op == OP_NARROW)
		return refuse(s, "without roots and quotients");
	if (is_angle && (s->d->nodes[n->arg[0].i].op != OP_INPUT || role_of(s, &s->d->nodes[n->arg[0].i]) != ROLE_JOINT_POSITION))
		return refuse(s, "where each angle is a joint's or a multiple of it");
	if (n->op == OP_INPUT && role_of(s, n) == ROLE_JOINT_POSITION && s->bit_count == FIELD_DIMS && !s->bit[n->arg[1].i])
		return error_set(s->e, RNEAGEN_LIMIT, "%s: rnearun prove takes at most %d positions", s->x->options.file, FIELD_DIMS);
	return RNEAGEN_OK;
}

static enum rneagen_code check_outputs(const struct splitter *s)
{
	if (adjust_is_asked(&s->x->adjust))
		return refuse(s, "of the robot as its file states it: leave out what changes constants");
	for (size_t i = 0; i < s->d->output_count; i++)
		if (s->marks[s->d->outputs[i].value.i].orders > 7)
			return refuse(s, "where no product is of more than two rates, or of an input and an acceleration");
	return RNEAGEN_OK;
}

static enum rneagen_code mark_all(struct splitter *s)
{
	uint32_t *uses = arena_alloc(s->a, s->d->count, sizeof *uses);

	s->marks = arena_alloc(s->a, s->d->count, sizeof *s->marks);
	if (!uses || !s->marks)
		return error_memory(s->e);
	dag_uses(s->d, uses);
	for (size_t i = 0; i < s->d->count; i++) {
		if (i && uses[i] && check_node(s, &s->d->nodes[i]))
			return s->e->code;
		if (!i || uses[i])
			s->marks[i] = mark_of(s, &s->d->nodes[i]);
	}
	return check_outputs(s);
}

/* ---- a field ---- */

static void mark_live(const struct splitter *s, const struct field *f)
{
	memset(s->live, 0, s->d->count);
	for (int i = 0; i < f->output_count; i++)
		s->live[s->d->outputs[f->outputs[i]].value.i] = 1;
	dag_mark_operands(s->d, s->d->count, s->live);
}

static struct field_dim *dim_of(const struct splitter *s, struct field *f, const struct node *n)
{
	struct interval r = s->r->rows[n->arg[0].i][n->arg[1].i];

	for (int i = 0; i < f->dim_count; i++)
		if (f->dims[i].row == (int)n->arg[1].i)
			return &f->dims[i];
	f->dims[f->dim_count] = (struct field_dim){.row = (int)n->arg[1].i, .lower = r.lower, .upper = r.upper};
	return &f->dims[f->dim_count++];
}

static enum rneagen_code add_input(const struct splitter *s, struct field *f, const struct node *n)
{
	struct interval r = s->r->rows[n->arg[0].i][n->arg[1].i];
	int argument = (int)n->arg[0].i, row = (int)n->arg[1].i;
	const struct relaxed_ball *ball = relaxed_ball_of(s->r, argument, row);
	int is_rate = role_of(s, n) == ROLE_JOINT_VELOCITY, *count = is_rate ? &f->rate_count : &f->drive_count;
	int number = ball ? 1 + (int)(ball - s->r->balls) : 0;
	double scale = interval_size(r) > 0 ? interval_size(r) : 1;

	if (ball) {
		scale = ball->radius;
		r = (struct interval){-scale, scale};
	}
	if (*count == FIELD_DIMS)
		return error_set(s->e, RNEAGEN_LIMIT, "%s: rnearun prove takes at most %d rows of inputs", s->x->options.file, FIELD_DIMS);
	(is_rate ? f->rates : f->drives)[(*count)++] = (struct field_input){argument, row, number, scale,
		{round_down(r.lower / scale), round_up(r.upper / scale)}, (uint32_t)(n - s->d->nodes)};
	return RNEAGEN_OK;
}

/* Rows of q in their order: those near the base first. */
static int by_row(const void *a, const void *b)
{
	const struct field_dim *x = a, *y = b;

	return (x->row > y->row) - (x->row < y->row);
}

static void describe(const struct splitter *s, struct field *f, struct field_dim *k)
{
	const struct relaxed_row *row = &s->r->of_q[k->row];
	int is_gravity = s->d->arguments[s->d->outputs[f->outputs[0]].argument].role == ROLE_GRAVITY_TORQUE;

	k->is_circle = k->is_angle && k->upper - k->lower >= 6.283185307179586;
	k->degree = (is_gravity ? 1 : 2) * (k->is_angle ? row->turns : 1);
	f->has_grid &= row->has_grid && k->degree <= FIELD_DEGREE;
}

static enum rneagen_code collect(const struct splitter *s, struct field *f)
{
	for (uint32_t i = 0; i < s->d->count; i++) {
		const struct node *n = &s->d->nodes[i];
		struct field_dim *k;

		if (!s->live[i])
			continue;
		if (n->op == OP_INPUT && role_of(s, n) == ROLE_JOINT_POSITION)
			dim_of(s, f, n)->value = i;
		else if (n->op == OP_INPUT && add_input(s, f, n))
			return s->e->code;
		if (n->op != OP_SIN && n->op != OP_COS)
			continue;
		k = dim_of(s, f, &s->d->nodes[n->arg[0].i]);
		*(n->op == OP_SIN ? &k->sine : &k->cosine) = i;
		k->is_angle = 1;
	}
	for (int i = 0; i < f->dim_count; i++)
		describe(s, f, &f->dims[i]);
	qsort(f->dims, (size_t)f->dim_count, sizeof *f->dims, by_row);
	return RNEAGEN_OK;
}

static void count_lanes(const struct splitter *s, struct field *f)
{
	size_t n = (size_t)f->rate_count, lane_count;

	for (int i = 0; i < f->output_count; i++)
		f->is_odd |= s->marks[s->d->outputs[f->outputs[i]].value.i].orders >> 1 & 1;
	lane_count = 1 + (size_t)f->drive_count + n * (f->is_odd ? 2 : 1) + n * (n - (n > 0)) / 2;
	f->lane_count = (lane_count + FIELD_VECTOR - 1) / FIELD_VECTOR * FIELD_VECTOR;
	f->coefficient_count = 1 + (size_t)f->drive_count + n + n * (n + 1) / 2;
}

static int is_wide(const struct splitter *s, uint32_t i)
{
	return s->marks[i].orders > 1;
}

/* The slot of a wide operand; a narrow one is spread first. */
static uint32_t spread(struct field *f, const struct splitter *s, const uint32_t *slots, uint32_t *spreads, uint32_t i)
{
	if (is_wide(s, i))
		return slots[i];
	if (spreads[i] == UINT32_MAX) {
		spreads[i] = (uint32_t)f->wide_count++;
		f->steps[f->step_count++] = (struct field_step){OP_ANEW, 1, spreads[i], {slots[i], 0, 0}};
	}
	return spreads[i];
}

static void add_step(struct field *f, const struct splitter *s, uint32_t *slots, uint32_t *spreads, uint32_t i)
{
	const struct node *n = &s->d->nodes[i];
	struct field_step step = {.op = n->op, .is_wide = is_wide(s, i)};

	for (int k = 0; k < op_arity[n->op] && n->op != OP_SIN && n->op != OP_COS; k++)
		step.arg[k] = step.is_wide ? spread(f, s, slots, spreads, n->arg[k].i) : slots[n->arg[k].i];
	if (n->op == OP_ANEW && step.is_wide) { /* the same value */
		slots[i] = step.arg[0];
		return;
	}
	slots[i] = step.to = (uint32_t)(step.is_wide ? f->wide_count++ : f->narrow_count++);
	if (op_arity[n->op] && n->op != OP_SIN && n->op != OP_COS)
		f->steps[f->step_count++] = step;
}

static void measure(const struct splitter *s, struct field *f)
{
	for (int i = 0; i < f->output_count; i++) {
		const struct mark *m = &s->marks[s->d->outputs[f->outputs[i]].value.i];

		/* a coefficient is a sum of at most four lanes */
		f->noise[i] = 8 * m->noise + 0x1p-48 * m->size + DBL_MIN;
		f->plain[i] = interval_size(m->plain);
	}
}

static enum rneagen_code compile(struct splitter *s, struct field *f)
{
	size_t count = s->d->count, outputs = (size_t)f->output_count;
	uint32_t *slots = arena_alloc(s->a, count, sizeof *slots), *spreads = arena_alloc(s->a, count, sizeof *spreads);

	f->steps = arena_alloc(s->a, 2 * count + outputs, sizeof *f->steps);
	f->noise = arena_alloc(s->a, outputs, sizeof *f->noise);
	f->plain = arena_alloc(s->a, outputs, sizeof *f->plain);
	f->result = arena_alloc(s->a, outputs, sizeof *f->result);
	if (s->a->failed)
		return error_memory(s->e);
	memset(slots, 0xff, count * sizeof *slots);
	memset(spreads, 0xff, count * sizeof *spreads);
	for (uint32_t i = 0; i < count; i++)
		if (s->live[i])
			add_step(f, s, slots, spreads, i);
	for (int i = 0; i < f->output_count; i++)
		f->result[i] = spread(f, s, slots, spreads, s->d->outputs[f->outputs[i]].value.i);
	f->slots = slots;
	measure(s, f);
	return RNEAGEN_OK;
}

static enum rneagen_code make(struct splitter *s, struct field *f)
{
	f->d = s->d;
	f->has_grid = 1;
	mark_live(s, f);
	if (collect(s, f))
		return s->e->code;
	f->has_grid &= f->dim_count <= GRID_DIMS;
	count_lanes(s, f);
	return compile(s, f);
}

/* Are there too many knots for another output, each row of q having those of an angle? */
static int is_full(uint64_t dims, int outputs)
{
	double knots = outputs + 1;

	for (; dims; dims &= dims - 1)
		knots *= 5;
	return knots > MOST_TOGETHER;
}

static uint64_t dims_of(const struct splitter *s, size_t output)
{
	return s->marks[s->d->outputs[output].value.i].dims;
}

/* Outputs of the same rows of q and the same kind are together. */
static int is_of(const struct splitter *s, const struct field *f, size_t output)
{
	size_t first = (size_t)f->outputs[0];

	return dims_of(s, first) == dims_of(s, output) && s->d->outputs[first].argument == s->d->outputs[output].argument &&
	       !is_full(dims_of(s, first), f->output_count);
}

int field_split(struct field **fields, const struct relaxed *r, struct arena *a, struct rneagen_error *e)
{
	struct splitter s = {.r = r, .x = &r->view, .d = &r->view.dag, .a = a, .e = e, .live = arena_alloc(a, r->view.dag.count, 1),
		.bit = arena_alloc(a, (size_t)r->row_count + 1, 1)};
	int count = 0;

	*fields = arena_alloc(a, s.d->output_count, sizeof **fields);
	if (a->failed)
		return error_memory(e), -1;
	if (mark_all(&s))
		return -1;
	for (size_t i = 0; i < s.d->output_count; i++) {
		int k = 0;

		while (k < count && !is_of(&s, &(*fields)[k], i))
			k++;
		if (k == count && !((*fields)[count++].outputs = arena_alloc(a, s.d->output_count, sizeof(int))))
			return error_memory(e), -1;
		(*fields)[k].outputs[(*fields)[k].output_count++] = (int)i;
	}
	for (int k = 0; k < count; k++)
		if (make(&s, &(*fields)[k]))
			return -1;
	return count;
}
