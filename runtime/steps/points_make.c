/* Is an output such a polynomial, and the steps that evaluate it. */
#include "steps/points.h"
#include <string.h>

/* What is known of a node. */
struct mark {
	unsigned orders;                 /* bit k: terms of order k, rates of order 1 and drives of order 2 */
	unsigned char degree[POINT_DIMS];
	double size, noise;              /* over all angles and the box; how far a double may be off */
};

struct maker {
	struct points *p;
	const struct dag *d;
	struct span *const *rows;
	int position;
	unsigned char *live;
	struct mark *marks;
	uint32_t *place, *spread;        /* by node: where it is, and where it is once more in all lanes */
	struct arena *a;
	int is_other;
};

static int is_position(const struct maker *m, const struct node *n)
{
	return n->op == OP_INPUT && (int)n->arg[0].i == m->position;
}

static int dim_of(struct maker *m, int row)
{
	struct points *p = m->p;
	int k = 0;

	while (k < p->dim_count && p->dims[k].row != row)
		k++;
	if (k == p->dim_count && k < POINT_DIMS)
		p->dims[p->dim_count++] =
			(struct point_dim){.row = row, .range = m->rows[m->position][row], .value = UINT32_MAX,
				.sine = UINT32_MAX, .cosine = UINT32_MAX};
	m->is_other |= k == POINT_DIMS;
	return k < POINT_DIMS ? k : 0;
}

static struct mark mark_input(struct maker *m, const struct node *n)
{
	struct span r = m->rows[n->arg[0].i][n->arg[1].i];
	int is_rate = m->d->arguments[n->arg[0].i].role == ROLE_JOINT_VELOCITY, *count = is_rate ? &m->p->rate_count
		: &m->p->drive_count;
	struct mark x = {.orders = is_rate ? 2 : 4, .size = span_size(r)};

	m->is_other |= !(r.lo <= r.hi) || !(x.size < 1e100);
	if (is_position(m, n)) {
		x.orders = 1;
		x.degree[dim_of(m, (int)n->arg[1].i)] = 1;
		return x;
	}
	if (*count == POINT_INPUTS) {
		m->is_other = 1;
		return x;
	}
	x.size = x.size > 0 ? x.size : 1;
	(is_rate ? m->p->rates : m->p->drives)[(*count)++] = (struct point_input){(int)n->arg[0].i, (int)n->arg[1].i, x.size,
		{out_down(r.lo / x.size), out_up(r.hi / x.size)}};
	return x;
}

/* Constants as the doubles nearest to them, though the exact model may have another. */
static struct mark mark_constant(const struct maker *m, const struct node *n)
{
	double off = within_error(dag_number(m->d, n)) + 0x1p-50 * (double)fabsl(n->value);

	return (struct mark){.orders = 1, .size = (double)fabsl(n->value) * (1 + 0x1p-50), .noise = off};
}

/* The sine of an angle that is an input; nothing else of it may be read. */
static struct mark mark_wave(struct maker *m, const struct node *n)
{
	const struct node *angle = &m->d->nodes[n->arg[0].i];
	struct mark x = {.orders = 1, .size = 1, .noise = 0x1p-52};
	int k;

	if (!is_position(m, angle)) {
		m->is_other = 1;
		return x;
	}
	k = dim_of(m, (int)angle->arg[1].i);
	m->p->dims[k].is_angle = 1;
	x.degree[k] = 1;
	return x;
}

static struct mark mark_sum(struct mark a, struct mark b)
{
	a.orders |= b.orders;
	for (int k = 0; k < POINT_DIMS; k++)
		a.degree[k] = a.degree[k] > b.degree[k] ? a.degree[k] : b.degree[k];
	a.size += b.size;
	a.noise += b.noise;
	a.noise += 0x1p-52 * (a.size + a.noise) + DBL_MIN;
	return a;
}

static struct mark mark_product(struct mark a, struct mark b)
{
	struct mark x = {.size = a.size * b.size, .noise = a.size * b.noise + b.size * a.noise + a.noise * b.noise};

	for (int i = 0; i < 4; i++)
		x.orders |= a.orders >> i & 1 ? b.orders << i : 0;
	x.orders = x.orders > 15 ? 8 : x.orders; /* 8: beyond what is known */
	for (int k = 0; k < POINT_DIMS; k++)
		x.degree[k] = (unsigned char)(a.degree[k] + b.degree[k] < 100 ? a.degree[k] + b.degree[k] : 100);
	x.noise += 0x1p-52 * (x.size + x.noise) + DBL_MIN;
	return x;
}

static struct mark mark_of(struct maker *m, const struct node *n)
{
	struct mark *of = m->marks;

	switch (n->op) {
	case OP_CONST:
		return mark_constant(m, n);
	case OP_INPUT:
		return mark_input(m, n);
	case OP_SIN:
	case OP_COS:
		return mark_wave(m, n);
	case OP_NEG:
	case OP_ANEW:
		return of[n->arg[0].i];
	case OP_ADD:
	case OP_SUB:
		return mark_sum(of[n->arg[0].i], of[n->arg[1].i]);
	case OP_MUL:
		return mark_product(of[n->arg[0].i], of[n->arg[1].i]);
	case OP_FMA:
		return mark_sum(mark_product(of[n->arg[0].i], of[n->arg[1].i]), of[n->arg[2].i]);
	default:
		m->is_other = 1;
		return (struct mark){.orders = 8};
	}
}

/* An angle is read by sine and cosine alone. */
static int reads_angle(const struct maker *m, const struct node *n)
{
	for (int k = 0; k < op_arity[n->op] && n->op != OP_SIN && n->op != OP_COS; k++) {
		const struct node *of = &m->d->nodes[n->arg[k].i];

		for (int i = 0; i < m->p->dim_count && is_position(m, of); i++)
			if (m->p->dims[i].row == (int)of->arg[1].i && m->p->dims[i].is_angle)
				return 1;
	}
	return 0;
}

static void mark_all(struct maker *m, uint32_t root)
{
	for (uint32_t i = 0; i <= root && !m->is_other; i++)
		if (m->live[i])
			m->marks[i] = mark_of(m, &m->d->nodes[i]);
	for (uint32_t i = 0; i <= root && !m->is_other; i++)
		m->is_other |= m->live[i] && reads_angle(m, &m->d->nodes[i]);
	m->is_other |= m->marks[root].orders > 7 || is_position(m, &m->d->nodes[root]);
	for (int k = 0; k < m->p->dim_count; k++) {
		m->p->dims[k].degree = m->marks[root].degree[k];
		m->is_other |= m->p->dims[k].degree > (m->p->dims[k].is_angle ? POINT_DEGREE : 2);
	}
}

/* ---- steps ---- */

static int is_wide(const struct maker *m, uint32_t i)
{
	return m->marks[i].orders > 1;
}

static uint32_t wide_place(struct maker *m, uint32_t i)
{
	struct points *p = m->p;

	if (is_wide(m, i))
		return m->place[i];
	if (m->spread[i] == UINT32_MAX) {
		m->spread[i] = (uint32_t)p->wide_count++;
		p->steps[p->step_count++] = (struct point_step){OP_ANEW, 1, m->spread[i], {m->place[i], 0, 0}};
	}
	return m->spread[i];
}

static double *lane_of_drive(const struct maker *m, int i)
{
	double *lane = arena_alloc(m->a, m->p->lanes, sizeof *lane);

	if (lane)
		lane[1 + i] = m->p->drives[i].scale;
	return lane;
}

static double *lane_of_rate(const struct maker *m, int j)
{
	const struct points *p = m->p;
	double x = p->rates[j].scale, *lane = arena_alloc(m->a, p->lanes, sizeof *lane);
	int at = 1 + p->drive_count;

	if (!lane)
		return NULL;
	lane[at + j] = x;
	at += p->rate_count;
	if (p->is_odd) {
		lane[at + j] = -x;
		at += p->rate_count;
	}
	for (int a = 0; a < p->rate_count; a++)
		for (int b = a + 1; b < p->rate_count; b++, at++)
			lane[at] = a == j || b == j ? x : 0;
	return lane;
}

static void place_input(struct maker *m, uint32_t i)
{
	const struct node *n = &m->d->nodes[i];
	struct points *p = m->p;

	if (is_position(m, n)) {
		m->place[i] = (uint32_t)p->narrow_count++;
		p->dims[dim_of(m, (int)n->arg[1].i)].value = p->dims[dim_of(m, (int)n->arg[1].i)].is_angle
			? UINT32_MAX : m->place[i];
		return;
	}
	m->place[i] = (uint32_t)p->wide_count++;
	for (int k = 0; k < p->drive_count; k++)
		if (p->drives[k].argument == (int)n->arg[0].i && p->drives[k].row == (int)n->arg[1].i)
			p->wide[m->place[i]] = lane_of_drive(m, k);
	for (int k = 0; k < p->rate_count; k++)
		if (p->rates[k].argument == (int)n->arg[0].i && p->rates[k].row == (int)n->arg[1].i)
			p->wide[m->place[i]] = lane_of_rate(m, k);
}

static void place_operation(struct maker *m, uint32_t i)
{
	const struct node *n = &m->d->nodes[i];
	struct points *p = m->p;
	struct point_step s = {.op = n->op, .is_wide = is_wide(m, i)};

	for (int k = 0; k < op_arity[n->op]; k++)
		s.arg[k] = s.is_wide ? wide_place(m, n->arg[k].i) : m->place[n->arg[k].i];
	if (n->op == OP_ANEW) { /* the same */
		m->place[i] = s.arg[0];
		return;
	}
	m->place[i] = s.to = (uint32_t)(s.is_wide ? p->wide_count++ : p->narrow_count++);
	p->steps[p->step_count++] = s;
}

static void place_wave(struct maker *m, uint32_t i)
{
	const struct node *n = &m->d->nodes[i];
	struct point_dim *k = &m->p->dims[dim_of(m, (int)m->d->nodes[n->arg[0].i].arg[1].i)];
	uint32_t *wave = n->op == OP_SIN ? &k->sine : &k->cosine;

	if (*wave == UINT32_MAX)
		*wave = (uint32_t)m->p->narrow_count++;
	m->place[i] = *wave;
}

static void place(struct maker *m, uint32_t i)
{
	const struct node *n = &m->d->nodes[i];

	switch (n->op) {
	case OP_CONST:
		m->place[i] = (uint32_t)m->p->narrow_count++;
		m->p->narrow[m->place[i]] = (double)n->value;
		return;
	case OP_INPUT:
		place_input(m, i);
		return;
	case OP_SIN:
	case OP_COS:
		place_wave(m, i);
		return;
	default:
		place_operation(m, i);
	}
}

static int make_steps(struct maker *m, uint32_t root)
{
	struct points *p = m->p;
	size_t n = (size_t)p->rate_count, count = (size_t)root + 1;

	p->is_odd = m->marks[root].orders >> 1 & 1;
	p->lanes = 1 + (size_t)p->drive_count + n * (p->is_odd ? 2 : 1) + n * (n - (n > 0)) / 2;
	p->lanes = (p->lanes + POINT_VECTOR - 1) / POINT_VECTOR * POINT_VECTOR;
	p->coefficients = 1 + (size_t)p->drive_count + n + n * (n + 1) / 2;
	/* a coefficient is a sum of four lanes at most */
	p->size = 4 * m->marks[root].size;
	p->noise = 8 * m->marks[root].noise + 0x1p-48 * p->size + DBL_MIN;
	p->steps = arena_alloc(m->a, 2 * count + 1, sizeof *p->steps);
	p->narrow = arena_alloc(m->a, count + 1, sizeof *p->narrow);
	p->wide = arena_alloc(m->a, 2 * count + 1, sizeof *p->wide);
	m->place = arena_alloc(m->a, count, sizeof *m->place);
	m->spread = arena_alloc(m->a, count, sizeof *m->spread);
	if (m->a->failed)
		return 0;
	memset(m->spread, 0xff, count * sizeof *m->spread);
	for (uint32_t i = 0; i <= root; i++)
		if (m->live[i])
			place(m, i);
	p->root = wide_place(m, root);
	return !m->a->failed;
}

int points_make(struct points *p, const struct dag *d, size_t output, struct span *const *rows, int position, struct arena *a)
{
	uint32_t root = d->outputs[output].value.i;
	struct maker m = {.p = p, .d = d, .rows = rows, .position = position, .a = a};

	*p = (struct points){.dim_count = 0};
	m.live = arena_alloc(a, (size_t)root + 1, 1);
	m.marks = arena_alloc(a, (size_t)root + 1, sizeof *m.marks);
	if (a->failed)
		return 0;
	m.live[root] = 1;
	dag_mark_operands(d, (size_t)root + 1, m.live);
	mark_all(&m, root);
	return m.is_other ? -1 : make_steps(&m, root);
}
