/* A text computes v + delta where v is exact. For a product of a and b,
     delta = a delta_b + b delta_a + (delta_a delta_b + its own rounding),
   and so for each operation: what is linear in the operands' errors, and a rest. So the output's error is exactly the sum over all
   operations of (the output's derivative by the operation) times (the rest there), as in FPTaylor (Solovyev et al., Rigorous estimation
   of floating-point round-off errors with symbolic Taylor expansions, TOPLAS 41, 2018). Magnitudes of both are bounded over boxes of q
   (norms.h), for all drives and rates at once; the box with the largest bound is split until the time is over. */
#define _POSIX_C_SOURCE 200809L
#include "prove/rounding.h"
#include "core/seconds.h"
#include "dag/eval.h"
#include "dag/eval_rounding.h"
#include "norms/adjoint.h"
#include "norms/norms.h"
#include "range/split.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two operations of a rotation, c and s, c x and s x, or c x + s y and c y - s x, whose roundings are bounded together: by Cauchy and Schwarz,
   |v| |by v| + |w| |by w| is at most the product of two norms. */
struct twins {
	uint32_t one, other;     /* nodes of the text's DAG */
	uint32_t values, slopes; /* sets of norms.h; values 0: their norm is 1 */
	uint32_t x;              /* of products: the node x of the adjoint's DAG, whose magnitude stands for the values' norm; else 0 */
};

/* Values and derivatives, each in one interval or by lanes (norms.h). */
struct view {
	struct norms norms;
	struct norms_values values;
	struct twins *products, *sums, *angles;
	size_t product_count, sum_count, angle_count;
};

enum { VIEWS = 2 };
#define LANES_BELOW 0.2 /* rad or m */

/* One output. */
struct hunt {
	const struct dag *d;
	const struct eval_model *models;
	int count;
	struct adjoint x;
	struct view views[VIEWS];
	const struct view *now;
	struct interval *rows[DAG_ARGUMENTS]; /* of the box, those of q its own */
	double *running, *of_product, *of_sum; /* by node: error; what the rounding of a product and of a sum takes from exact values */
	int position, dims[SPLIT_DIMS];
	struct split split;
	struct arena arena;
};

/* ---- a box ---- */

static double rounded(double unit, double tiny, double size)
{
	return unit * size + tiny;
}

/* What rounding takes from exact values up to this size, where the text's are `off` by so much at most: half a unit in the last place; that
   beside `rounded` of what they are off. */
static double rounded_exact(const struct eval_model *m, double unit, double size, double off)
{
	return unit * (m->terms > 0 ? size : fmin(size, rounding_place(size * (1 + DBL_EPSILON) + off)));
}

static double size_of(const struct hunt *h, uint32_t i)
{
	return h->now->values.size[h->x.value[i].i];
}

/* How far what the text reads is from what was meant. */
static double given(const struct hunt *h, const struct node *n, double size, const struct eval_model *m)
{
	real off;

	if (n->op == OP_INPUT)
		return m->input > 0 ? rounded(m->input, m->tiny, size) : 0; /* of angles it does not count: no derivative is taken by them */
	off = fabsl((m->constant ? m->constant(n->value) : (real)(double)n->value) - n->value) + (real)within_error(dag_number(h->d, n));
	return off > 0 ? (double)off * (1 + 0x1p-40) + 2 * m->tiny : 0;
}

/* The rest at a node, and in *inherited what is linear in the errors of its operands; as spread_of of dag/eval.c, for all values of
   these sizes. What roundings take from exact values is apart. */
static double rest_of(struct hunt *h, uint32_t i, const struct eval_model *m, double *inherited)
{
	const struct node *n = &h->d->nodes[i];
	uint32_t a = op_arity[n->op] > 0 ? n->arg[0].i : 0, b = op_arity[n->op] > 1 ? n->arg[1].i : 0, c = op_arity[n->op] > 2 ? n->arg[2].i : 0;
	double A = size_of(h, a), B = size_of(h, b), ea = h->running[a], eb = h->running[b], value = size_of(h, i), product = A * eb + B * ea;
	double rest;

	*inherited = h->of_product[i] = h->of_sum[i] = 0;
	switch (n->op) {
	case OP_CONST:
	case OP_INPUT:
		return given(h, n, value, m);
	case OP_NEG:
	case OP_ANEW:
		*inherited = ea;
		return 0;
	case OP_ADD:
	case OP_SUB:
		*inherited = ea + eb;
		h->of_sum[i] = rounded_exact(m, m->add, value, ea + eb);
		rest = m->terms * (A + B + ea + eb);
		return rest + rounded(m->add, m->tiny, ea + eb + rest);
	case OP_MUL:
		*inherited = product;
		h->of_product[i] = rounded_exact(m, m->mul, value, product + ea * eb);
		return ea * eb + rounded(m->mul, m->tiny, product + ea * eb);
	case OP_FMA:
		*inherited = product + h->running[c];
		h->of_product[i] = m->fused ? 0 : rounded_exact(m, m->mul, A * B, product + ea * eb);
		rest = ea * eb + (m->fused ? 0 : rounded(m->mul, m->tiny, product + ea * eb));
		rest += m->terms * (A * B + size_of(h, c) + *inherited + h->of_product[i] + rest);
		h->of_sum[i] = rounded_exact(m, m->add, value, *inherited + h->of_product[i] + rest);
		return rest + rounded(m->add, m->tiny, *inherited + h->of_product[i] + rest);
	case OP_SIN:
	case OP_COS:
		if (!(A <= m->angle))
			return (double)INFINITY;
		h->of_sum[i] = rounded_exact(m, m->sincos, value, ea);
		return m->tiny + (n->op == OP_SIN ? m->sine : m->cosine);
	default:
		return (double)INFINITY;
	}
}

static double slope_at(const struct hunt *h, uint32_t i)
{
	return h->x.slope[i].i ? h->now->values.size[h->x.slope[i].i] : 0;
}

/* What twins' roundings make of the error is at most that of each, or what the norms say. */
static double gain_of(const struct hunt *h, const struct twins *t, double unit, const double *of)
{
	const struct view *v = h->now;
	double each = slope_at(h, t->one) * of[t->one] + slope_at(h, t->other) * of[t->other];
	double values = t->x ? v->values.size[t->x] : t->values ? norms_of_pair(&v->norms, &v->values, t->values) : 1;

	return fmax(0, each - unit * values * norms_of_pair(&v->norms, &v->values, t->slopes) * (1 + 0x1p-48)) * (1 - 0x1p-30);
}

static double gains_of(const struct hunt *h, const struct eval_model *m)
{
	double sum = 0;

	for (size_t i = 0; i < h->now->product_count; i++) {
		const struct twins *t = &h->now->products[i];

		if (h->of_product[t->one] > 0 && h->of_product[t->other] > 0)
			sum += gain_of(h, t, m->mul, h->of_product);
	}
	for (size_t i = 0; i < h->now->sum_count; i++)
		sum += gain_of(h, &h->now->sums[i], m->add, h->of_sum);
	for (size_t i = 0; i < h->now->angle_count; i++)
		sum += gain_of(h, &h->now->angles[i], m->sincos, h->of_sum);
	return sum;
}

/* Over the box in h->rows, whose values are known. */
static double error_of(struct hunt *h, const struct eval_model *m)
{
	double sum = 0, most;

	for (uint32_t i = 0; i < h->x.count; i++) {
		double inherited, rest = rest_of(h, i, m, &inherited);

		rest = (rest + h->of_product[i] + h->of_sum[i]) * (1 + 0x1p-47);
		h->running[i] = (inherited + rest) * (1 + 0x1p-48);
		if (!(size_of(h, i) + h->running[i] <= m->largest))
			return (double)INFINITY;
		if (rest > 0)
			sum += slope_at(h, i) * rest;
	}
	/* sums of up to 2^20 terms; derivatives' own constants are rounded by 2^-64 */
	sum = sum * (1 + 0x1p-30) - gains_of(h, m);
	most = h->now->values.size[h->x.root.i] + sum;
	if (!(most <= m->store_largest))
		return (double)INFINITY;
	return m->store > 0 ? (sum + m->store * most + m->store_tiny) * (1 + 0x1p-30) : sum;
}

/* Lanes pay in small boxes alone. */
static int is_small(const struct hunt *h, const struct leaf *leaf)
{
	for (int k = 0; k < h->split.dim_count; k++)
		if (leaf->q[k].upper - leaf->q[k].lower > LANES_BELOW)
			return 0;
	return 1;
}

static void examine(void *context, struct leaf *leaf)
{
	struct hunt *h = context;

	for (int k = 0; k < h->split.dim_count; k++)
		h->rows[h->position][h->dims[k]] = leaf->q[k];
	for (int k = 0; k < (is_small(h, leaf) ? VIEWS : 1); k++) {
		struct interval value;

		h->now = &h->views[k];
		norms_evaluate(&h->views[k].norms, (const struct interval *const *)h->rows, &h->views[k].values);
		value = norms_range(&h->views[k].norms, &h->views[k].values, h->x.root.i);
		leaf->value = k ? (struct interval){fmax(value.lower, leaf->value.lower), fmin(value.upper, leaf->value.upper)} : value;
		for (int i = 0; i < h->count; i++)
			leaf->sizes[i] = k ? fmin(leaf->sizes[i], error_of(h, &h->models[i])) : error_of(h, &h->models[i]);
	}
}

/* ---- outputs ---- */

struct job {
	struct prove_row *rows;
	const struct analysis *a;
	const struct box *b;
	const struct eval_model *models;
	int count, failed;
	double seconds, deadline; /* of one output; of all */
};

/* Rows of q that the output depends on and that have room. */
static void list_dims(struct hunt *h)
{
	for (uint32_t i = 0; i < h->x.count; i++) {
		const struct node *n = &h->x.d.nodes[h->x.value[i].i];
		const struct interval *r;

		if (n->op != OP_INPUT || (int)n->arg[0].i != h->position || h->split.dim_count == SPLIT_DIMS)
			continue;
		r = &h->rows[h->position][n->arg[1].i];
		if (r->lower < r->upper)
			h->dims[h->split.dim_count++] = (int)n->arg[1].i;
	}
}

/* ---- twins ---- */

/* A product of a node with a sine or cosine: c x. */
static int product_of(const struct hunt *h, uint32_t i, struct trig_term *t)
{
	const struct node *n = &h->d->nodes[i];

	if ((n->op != OP_MUL && n->op != OP_FMA) || !h->x.slope[i].i)
		return 0;
	for (int k = 0; k < 2; k++) {
		const struct node *f = &h->d->nodes[n->arg[k].i];
		struct ref other = h->x.value[n->arg[!k].i];

		if (f->op != OP_SIN && f->op != OP_COS)
			continue;
		while (h->x.d.nodes[other.i].op == OP_NEG)
			other = h->x.d.nodes[other.i].arg[0];
		*t = (struct trig_term){.angle = f->arg[0].i, .is_sine = f->op == OP_SIN, .other = other};
		return 1;
	}
	return 0;
}

/* c x + s y, the second product in a node of its own. */
static int sum_of(const struct hunt *h, uint32_t i, struct trig_term *a, struct trig_term *b)
{
	const struct node *n = &h->d->nodes[i];
	uint32_t at;

	if (n->op != OP_FMA || !product_of(h, i, a))
		return 0;
	at = n->arg[2].i;
	while (h->d->nodes[at].op == OP_NEG)
		at = h->d->nodes[at].arg[0].i;
	return h->d->nodes[at].op == OP_MUL && product_of(h, at, b) && a->angle == b->angle && a->is_sine != b->is_sine;
}

static void add_product(const struct hunt *h, struct view *v, uint32_t i, uint32_t k, struct ref x)
{
	struct twins t = {i, k, 0, norms_pair(&v->norms, h->x.slope[i].i, h->x.slope[k].i), x.i};

	if (t.slopes)
		v->products[v->product_count++] = t;
}

static void add_sum(const struct hunt *h, struct view *v, uint32_t i, uint32_t k)
{
	struct twins t = {i, k, norms_pair(&v->norms, h->x.value[i].i, h->x.value[k].i),
		norms_pair(&v->norms, h->x.slope[i].i, h->x.slope[k].i), 0};

	if (t.slopes && t.values)
		v->sums[v->sum_count++] = t;
}

static void add_angle(const struct hunt *h, struct view *v, uint32_t i, uint32_t k)
{
	struct twins t = {i, k, 0, norms_pair(&v->norms, h->x.slope[i].i, h->x.slope[k].i), 0};

	if (t.slopes)
		v->angles[v->angle_count++] = t;
}

static void find_angles(const struct hunt *h, struct view *v)
{
	for (uint32_t i = 0; i < h->x.count; i++)
		for (uint32_t k = 0; k < h->x.count && h->d->nodes[i].op == OP_SIN && h->x.slope[i].i; k++)
			if (h->d->nodes[k].op == OP_COS && h->x.slope[k].i && h->d->nodes[k].arg[0].i == h->d->nodes[i].arg[0].i)
				add_angle(h, v, i, k);
}

/* Each node is one of two at most. */
static int find_twins(struct hunt *h, struct view *v)
{
	unsigned char *taken = arena_alloc(&h->arena, h->x.count, 1);
	struct trig_term a, b, p, q;

	v->products = arena_alloc(&h->arena, h->x.count, sizeof *v->products);
	v->sums = arena_alloc(&h->arena, h->x.count, sizeof *v->sums);
	for (uint32_t i = 0; i < h->x.count && !h->arena.failed; i++)
		for (uint32_t k = i + 1; k < h->x.count && product_of(h, i, &a) && !(taken[i] & 1); k++)
			if (!(taken[k] & 1) && product_of(h, k, &p) && a.angle == p.angle && a.is_sine != p.is_sine && a.other.i == p.other.i) {
				taken[i] |= 1;
				taken[k] |= 1;
				add_product(h, v, i, k, a.other);
			}
	for (uint32_t i = 0; i < h->x.count && !h->arena.failed; i++)
		for (uint32_t k = i + 1; k < h->x.count && sum_of(h, i, &a, &b) && !(taken[i] & 2); k++)
			if (!(taken[k] & 2) && sum_of(h, k, &p, &q) && a.angle == p.angle &&
				((a.other.i == q.other.i && b.other.i == p.other.i) || (a.other.i == p.other.i && b.other.i == q.other.i))) {
				taken[i] |= 2;
				taken[k] |= 2;
				add_sum(h, v, i, k);
			}
	v->angles = arena_alloc(&h->arena, h->x.count, sizeof *v->angles);
	if (!h->arena.failed)
		find_angles(h, v);
	return !h->arena.failed;
}

static int hunt_make(struct hunt *h, const struct job *j, size_t output)
{
	*h = (struct hunt){.d = &j->a->dag, .models = j->models, .count = j->count};
	arena_init(&h->arena, NULL);
	h->position = dag_find_role(h->d, ROLE_JOINT_POSITION, 0);
	if (!adjoint_make(&h->x, h->d, output, 1, &h->arena) || !box_copy(h->rows, j->b, h->d, &h->arena))
		return 0;
	for (int k = 0; k < VIEWS; k++) {
		struct view *v = &h->views[k];

		if (!norms_make(&v->norms, &h->x.d, k, &h->arena) || !find_twins(h, v) || !norms_lay(&v->norms, &h->arena) ||
			!norms_values_make(&v->values, &v->norms, &h->arena))
			return 0;
	}
	h->of_product = arena_alloc(&h->arena, h->x.count, sizeof *h->of_product);
	h->of_sum = arena_alloc(&h->arena, h->x.count, sizeof *h->of_sum);
	h->running = arena_alloc(&h->arena, h->x.count, sizeof *h->running);
	list_dims(h);
	return !h->arena.failed;
}

static void take(const struct hunt *h, struct prove_row *r)
{
	double errors[SPLIT_SIZES];
	struct interval value;

	split_total(&h->split, errors, &value);
	for (int m = 0; m < h->count; m++)
		r->error_bound[m] = errors[m] > 0 ? round_up(errors[m]) : 0;
	r->low = fmax(r->low, value.lower);
	r->high = fmin(r->high, value.upper);
}

static void hunt_output(void *job, size_t output)
{
	struct job *j = job;
	struct leaf root = {.value = {0, 0}};
	struct hunt h;
	int done = hunt_make(&h, j, output);

	for (int m = 0; m < j->count; m++)
		j->rows[output].error_bound[m] = (double)INFINITY;
	for (int k = 0; k < h.split.dim_count && done; k++)
		root.q[k] = h.rows[h.position][h.dims[k]];
	h.split.examine = examine;
	h.split.context = &h;
	if (done && split_run(&h.split, &root, fmin(j->deadline, seconds_now() + j->seconds)))
		take(&h, &j->rows[output]);
	else
		j->failed = 1;
	split_free(&h.split);
	arena_free(&h.arena);
}

int rounding_find(struct prove_row *rows, const struct analysis *a, const struct box *b, const struct eval_model *models, int count,
	const struct effort *x, double seconds)
{
	size_t outputs = a->dag.output_count, rounds = (outputs + x->threads - 1) / x->threads;
	struct job j = {rows, a, b, models, count, 0, seconds / (double)(rounds ? rounds : 1), x->deadline};

	workers_run(x->workers, x->threads, hunt_output, &j, outputs);
	return !j.failed;
}
