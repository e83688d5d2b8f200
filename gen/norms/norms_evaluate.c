/* Values of norms.h over a box, lane by lane. */
#include "norms/norms_form.h"
#include <float.h>
#include <math.h>
#include <string.h>

#if defined __x86_64__ && defined __GNUC__ && !defined __clang__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define LANES_FAST __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define LANES_FAST
#endif

/* One value: bounds by lane. */
struct lanes {
	const double *lower, *upper;
	int is_wide;
};

/* Outwards by more than rounding to nearest takes. */
#define DOWN(x) ((x) - (0x1p-52 * fabs(x) + DBL_MIN))
#define UP(x) ((x) + (0x1p-52 * fabs(x) + DBL_MIN))

#define LEAST(a, b) ((a) < (b) ? (a) : (b))
#define MOST(a, b) ((a) > (b) ? (a) : (b))

LANES_FAST static void add(
	size_t n, const double *al, const double *au, const double *bl, const double *bu, double *lower, double *upper)
{
	for (size_t i = 0; i < n; i++) {
		double l = al[i] + bl[i], u = au[i] + bu[i];

		lower[i] = DOWN(l);
		upper[i] = UP(u);
	}
}

/* By one interval, p to q; what is 0 stays so. */
LANES_FAST static void scale(size_t n, double p, double q, const double *bl, const double *bu, double *lower, double *upper)
{
	for (size_t i = 0; i < n; i++) {
		double a = p * bl[i], b = p * bu[i], c = q * bl[i], d = q * bu[i];
		double l = LEAST(LEAST(a, b), LEAST(c, d)), u = MOST(MOST(a, b), MOST(c, d));

		lower[i] = l == 0 && u == 0 && bl[i] == 0 && bu[i] == 0 ? 0 : DOWN(l);
		upper[i] = l == 0 && u == 0 && bl[i] == 0 && bu[i] == 0 ? 0 : UP(u);
	}
}

LANES_FAST static double total(size_t n, const double *lower, const double *upper)
{
	double sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += MOST(-lower[i], upper[i]);
	return sum * (1 + 0x1p-40);
}

/* sum of squares of magnitudes */
LANES_FAST static void add_squares(size_t n, const double *lower, const double *upper, double *sum)
{
	for (size_t i = 0; i < n; i++) {
		double size = MOST(-lower[i], upper[i]);

		sum[i] += size * size;
	}
}

LANES_FAST static void take_roots(size_t n, double *sum)
{
	for (size_t i = 0; i < n; i++)
		sum[i] = sqrt(sum[i]) * (1 + 0x1p-48) + SQUARES_LOST;
}

LANES_FAST static void take_least(size_t n, const double *rule, double *norm)
{
	for (size_t i = 0; i < n; i++)
		norm[i] = LEAST(norm[i], rule[i]);
}

LANES_FAST static void cap(size_t n, const double *norm, double *lower, double *upper)
{
	for (size_t i = 0; i < n; i++) {
		lower[i] = MOST(lower[i], -norm[i]);
		upper[i] = LEAST(upper[i], norm[i]);
	}
}

/* ---- operations ---- */

enum { MOST_LANES = 256 };

static const double ZERO[MOST_LANES];

static struct lanes value_at(const struct norms *x, const struct norms_values *v, uint32_t i)
{
	const double *lower = v->bounds + x->at[i];

	return (struct lanes){lower, lower + (x->is_wide[i] ? x->lanes : 1), x->is_wide[i]};
}

/* A narrow value as a wide one, in room for it. */
static struct lanes widen(const struct norms *x, struct lanes a, double room[2][MOST_LANES])
{
	if (a.is_wide)
		return a;
	memset(room[0], 0, x->lanes * sizeof **room);
	memset(room[1], 0, x->lanes * sizeof **room);
	room[0][0] = a.lower[0];
	room[1][0] = a.upper[0];
	return (struct lanes){room[0], room[1], 1};
}

static struct interval first(struct lanes a)
{
	return (struct interval){a.lower[0], a.upper[0]};
}

/* -b */
static struct lanes negated(size_t n, struct lanes b, double room[2][MOST_LANES])
{
	for (size_t i = 0; i < n; i++) {
		room[0][i] = -b.upper[i];
		room[1][i] = -b.lower[i];
	}
	return (struct lanes){room[0], room[1], b.is_wide};
}

static void put_interval(struct interval a, double *lower, double *upper)
{
	*lower = a.lower;
	*upper = a.upper;
}

static void add_to(struct interval a, double *lower, double *upper)
{
	put_interval(interval_add((struct interval){*lower, *upper}, a), lower, upper);
}

static int is_zero(double lower, double upper)
{
	return lower == 0 && upper == 0;
}

/* What two rates make: t_j t_k */
static void add_pairs(const struct norms *x, struct lanes a, struct lanes b, double *lower, double *upper)
{
	size_t from = 1 + (size_t)x->drive_count, n = (size_t)x->rate_count, at = from + n;

	for (size_t j = 0; j < n; j++)
		for (size_t k = j; k < n; k++, at++) {
			struct interval aj = {a.lower[from + j], a.upper[from + j]}, ak = {a.lower[from + k], a.upper[from + k]};
			struct interval bj = {b.lower[from + j], b.upper[from + j]}, bk = {b.lower[from + k], b.upper[from + k]};

			if (!is_zero(aj.lower, aj.upper) && !is_zero(bk.lower, bk.upper))
				add_to(interval_mul(aj, bk), &lower[at], &upper[at]);
			if (j != k && !is_zero(ak.lower, ak.upper) && !is_zero(bj.lower, bj.upper))
				add_to(interval_mul(ak, bj), &lower[at], &upper[at]);
		}
}

/* Of two values with rates: by their constants, and each rate by each. Nothing else has a product (field_split sees to it). */
static void multiply_wide(const struct norms *x, struct lanes a, struct lanes b, double *lower, double *upper)
{
	double room[2][MOST_LANES];
	struct interval a0 = first(a), b0 = first(b);

	scale(x->lanes, a0.lower, a0.upper, b.lower, b.upper, lower, upper);
	if (!is_zero(b0.lower, b0.upper)) {
		struct interval constant = {lower[0], upper[0]};

		scale(x->lanes, b0.lower, b0.upper, a.lower, a.upper, room[0], room[1]);
		add(x->lanes, lower, upper, room[0], room[1], lower, upper);
		put_interval(constant, lower, upper);
	}
	add_pairs(x, a, b, lower, upper);
}

static void multiply(const struct norms *x, struct lanes a, struct lanes b, double *lower, double *upper)
{
	struct interval one = first(a.is_wide ? b : a);

	if (a.is_wide && b.is_wide)
		multiply_wide(x, a, b, lower, upper);
	else if (a.is_wide)
		scale(x->lanes, one.lower, one.upper, a.lower, a.upper, lower, upper);
	else
		scale(b.is_wide ? x->lanes : 1, one.lower, one.upper, b.lower, b.upper, lower, upper);
}

/* x = middle + half t */
static void read_input(const struct norms *x, const struct node *n, struct interval r, double *lower, double *upper)
{
	double middle = 0.5 * r.lower + 0.5 * r.upper, half = fmax(round_up(r.upper - middle), round_up(middle - r.lower));

	memset(lower, 0, x->lanes * sizeof *lower);
	memset(upper, 0, x->lanes * sizeof *upper);
	if (r.lower == r.upper)
		half = 0;
	if (r.lower == -r.upper)
		half = r.upper;
	lower[0] = upper[0] = middle;
	for (int i = 0; i < x->drive_count + x->rate_count; i++)
		if (x->inputs[i].argument == (int)n->arg[0].i && x->inputs[i].row == (int)n->arg[1].i)
			lower[x->inputs[i].lane] = upper[x->inputs[i].lane] = half;
}

static struct interval narrow_value(
	const struct dag *d, const struct node *n, struct interval a, const struct interval *const *rows)
{
	switch (n->op) {
	case OP_CONST:
		return interval_around(n->value, within_error(dag_number(d, n)));
	case OP_INPUT:
		return rows[n->arg[0].i][n->arg[1].i];
	case OP_SIN:
		return interval_sin(a);
	case OP_COS:
		return interval_cos(a);
	default:
		return (struct interval){-(double)INFINITY, (double)INFINITY};
	}
}

/* A value of one lane, made of such. */
static struct interval narrow(
	const struct norms *x, const struct node *n, const struct norms_values *v, const struct interval *const *rows)
{
	struct interval a = first(value_at(x, v, op_arity[n->op] > 0 ? n->arg[0].i : 0));
	struct interval b = first(value_at(x, v, op_arity[n->op] > 1 ? n->arg[1].i : 0));

	switch (n->op) {
	case OP_NEG:
		return interval_neg(a);
	case OP_MUL:
		return interval_mul(a, b);
	case OP_ADD:
		return interval_add(a, b);
	case OP_SUB:
		return interval_sub(a, b);
	default:
		return narrow_value(x->d, n, a, rows);
	}
}

static void evaluate(const struct norms *x, uint32_t i, const struct interval *const *rows, struct norms_values *v)
{
	const struct node *n = &x->d->nodes[i];
	size_t count = x->lanes;
	double *lower = v->bounds + x->at[i], *upper = lower + count, room[2][2][MOST_LANES];
	struct lanes a = value_at(x, v, op_arity[n->op] > 0 ? n->arg[0].i : 0),
		     b = value_at(x, v, op_arity[n->op] > 1 ? n->arg[1].i : 0);

	switch (n->op) {
	case OP_NEG:
		a = negated(count, a, room[0]);
		memcpy(lower, a.lower, count * sizeof *lower);
		memcpy(upper, a.upper, count * sizeof *upper);
		return;
	case OP_MUL:
		multiply(x, a, b, lower, upper);
		return;
	case OP_ADD:
	case OP_SUB:
		a = widen(x, a, room[0]);
		if (n->op == OP_SUB)
			b = negated(b.is_wide ? x->lanes : 1, b, room[1]);
		b = !b.is_wide ? widen(x, (struct lanes){&(double){b.lower[0]}, &(double){b.upper[0]}, 0}, room[1]) : b;
		add(count, a.lower, a.upper, b.lower, b.upper, lower, upper);
		return;
	default:
		read_input(x, n, rows[n->arg[0].i][n->arg[1].i], lower, upper);
	}
}

/* ---- norms ---- */

/* The norms of a set that another needs, in as many lanes. */
static const double *norm_at(const struct norms *x, const struct norms_values *v, uint32_t set, int is_wide, double *room)
{
	const double *norm = v->norm + x->set_at[set - 1];

	if (!is_wide || x->is_wide_set[set - 1])
		return norm;
	memset(room, 0, x->lanes * sizeof *room);
	room[0] = norm[0];
	return room;
}

static double one_norm(const struct norms *x, const struct norms_values *v, uint32_t set)
{
	return set ? v->norm[x->set_at[set - 1]] : 0;
}

/* The same of a set of one lane. */
static double narrow_norm(const struct norms *x, const struct norms_set *s, const struct norms_values *v)
{
	double sum = 0, least;

	for (int i = 0; i < s->count; i++) {
		double size = interval_size(first(value_at(x, v, s->nodes[i])));

		sum += size * size;
	}
	if (s->rest) {
		double rest = v->norm[x->set_at[s->rest - 1]], apart = interval_size(first(value_at(x, v, s->apart)));

		sum = interval_least(sum, rest * rest + apart * apart);
	}
	least = sqrt(sum) * (1 + 0x1p-48) + SQUARES_LOST;
	if (s->form)
		least = interval_least(least, norms_form_bound(s->form, one_norm(x, v, s->form->x), one_norm(x, v, s->form->u),
			one_norm(x, v, s->form->v)));
	if (s->one)
		least = interval_least(least, (1 + 0x1p-48) *
			(v->norm[x->set_at[s->one - 1]] + (s->other ? v->norm[x->set_at[s->other - 1]] : 0)));
	return v->most_norm ? interval_least(least, v->most_norm[s - x->sets]) : least;
}

static void evaluate_set(const struct norms *x, uint32_t k, struct norms_values *v)
{
	const struct norms_set *s = &x->sets[k];
	const int is_wide = 1;
	size_t n = x->lanes;
	double *norm = v->norm + x->set_at[k], room[3][MOST_LANES];

	memset(norm, 0, n * sizeof *norm);
	for (int i = 0; i < s->count; i++) {
		struct lanes a = value_at(x, v, s->nodes[i]);

		add_squares(a.is_wide ? n : 1, a.lower, a.upper, norm);
	}
	take_roots(n, norm);
	if (s->rest) {
		struct lanes apart = value_at(x, v, s->apart);

		memcpy(room[2], norm_at(x, v, s->rest, is_wide, room[0]), n * sizeof *norm);
		for (size_t i = 0; i < n; i++)
			room[2][i] *= room[2][i];
		add_squares(apart.is_wide ? n : 1, apart.lower, apart.upper, room[2]);
		take_roots(n, room[2]);
		take_least(n, room[2], norm);
	}
	if (s->form && !s->form->u) {
		norms_form_lanes(s->form, n, norm_at(x, v, s->form->x, is_wide, room[0]), room[2]);
		take_least(n, room[2], norm);
	}
	if (s->one) {
		const double *one = norm_at(x, v, s->one, is_wide, room[0]),
			     *other = s->other ? norm_at(x, v, s->other, is_wide, room[1]) : ZERO;

		add(n, ZERO, one, ZERO, other, room[2], room[2]);
		take_least(n, room[2], norm);
	}
}

int norms_values_make(struct norms_values *v, const struct norms *x, struct arena *a)
{
	v->bounds = arena_alloc(a, x->value_count, sizeof *v->bounds);
	v->norm = arena_alloc(a, x->norm_count + 1, sizeof *v->norm);
	v->size = arena_alloc(a, x->d->count, sizeof *v->size);
	v->most = v->most_norm = NULL;
	return !a->failed;
}

void norms_evaluate(const struct norms *x, const struct interval *const *rows, struct norms_values *v)
{
	for (uint32_t i = 0; i < x->d->count; i++) {
		double *lower = v->bounds + x->at[i];
		size_t n = x->is_wide[i] ? x->lanes : 1;

		if (x->is_wide[i])
			evaluate(x, i, rows, v);
		else
			put_interval(narrow(x, &x->d->nodes[i], v, rows), lower, lower + 1);
		if (v->most && !x->is_wide[i])
			cap(1, &v->most[i], lower, lower + 1);
		for (uint32_t k = x->first[i]; k < x->first[i + 1]; k++) {
			if (x->is_wide_set[x->order[k]])
				evaluate_set(x, x->order[k], v);
			else
				v->norm[x->set_at[x->order[k]]] = narrow_norm(x, &x->sets[x->order[k]], v);
			if (x->sets[x->order[k]].count == 1)
				cap(n, v->norm + x->set_at[x->order[k]], lower, lower + n);
		}
		v->size[i] = total(n, lower, lower + n);
	}
}

double norms_of_pair(const struct norms *x, const struct norms_values *v, uint32_t pair)
{
	const double *norm = v->norm + x->set_at[pair - 1];

	return x->is_wide_set[pair - 1] ? total(x->lanes, ZERO, norm) : norm[0];
}
