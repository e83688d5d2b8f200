/* One row of q after the other is given a place, and what the knots have of the others is summed up for it: a tree, whose
   leaves are the points of the grid. */
#define _POSIX_C_SOURCE 200809L
#include "range/knots.h"
#include "core/seconds.h"
#include "range/extreme.h"
#include <math.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Pieces for each thread, so that none waits long for another. */
enum { PIECES = 4 };

/* Of a circle of the highest degree that grids have. */
enum { MOST_KNOTS = 2 * FIELD_DEGREE + 1 };

/* No wider than registers of AVX2: compilers keep wider sums in memory. */
enum { FOUR = 4 };

typedef double four __attribute__((vector_size(FOUR * sizeof(double))));
typedef long long masks __attribute__((vector_size(FOUR * sizeof(double))));

struct walk {
	struct knots_walk *to;
	const struct knots *k;
	const struct effort *effort;
	int depth, order[FIELD_DIMS], places[FIELD_DIMS]; /* by level: dimension, and how many places it has */
	size_t before[FIELD_DIMS], after[FIELD_DIMS];     /* numbers that the knots of the rows left have; `after` in vectors */
	double *weights[FIELD_DIMS];                      /* by level: [place][knot] */
	four *reach;                                      /* what each coefficient is multiplied by at most */
	int chunks;                                       /* of the places of level 1 */
	_Atomic double most[2];
	atomic_int failed;
};

/* A part of it, by one thread. */
struct branch {
	struct walk *w;
	four *rooms[FIELD_DIMS];
	int first, end; /* places of level 1 */
	double most[2];
};

/* ---- sums ---- */

/* A number of knots that is known when it is compiled makes it quick. */
static inline __attribute__((always_inline)) void sum_up(const four *in, size_t before, int n, size_t after, const double *by,
	four *out)
{
	for (size_t p = 0; p < before; p++, in += (size_t)n * after, out += after)
		for (size_t i = 0; i < after; i++) {
			four sum = by[0] * in[i];

			for (int k = 1; k < n; k++)
				sum += by[k] * in[(size_t)k * after + i];
			out[i] = sum;
		}
}

FIELD_CLONES static void contract(const four *in, size_t before, int n, size_t after, const double *by, four *out)
{
	switch (n) {
	case 3:
		sum_up(in, before, 3, after, by, out);
		break;
	case 5:
		sum_up(in, before, 5, after, by, out);
		break;
	default:
		sum_up(in, before, n, after, by, out);
	}
}

/* No value is larger, of either sign. */
FIELD_CLONES static double size_of(const four *c, const four *reach, size_t n)
{
	const masks no_sign = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
	four sum = {0};

	for (size_t i = 0; i < n; i++)
		sum += (four)((masks)(c[i] * reach[i]) & no_sign);
	return (sum[0] + sum[1] + sum[2] + sum[3]) * (1 + 0x1p-40);
}

/* ---- the tree ---- */

/* What is of no interest. Of second derivatives the larger side is asked for. */
static double floor_of(const struct branch *b, int side)
{
	return b->w->to->along < 0 ? b->most[side] : fmax(b->most[0], b->most[1]);
}

static void take(struct branch *b, const four *c)
{
	const struct walk *w = b->w;
	double size = size_of(c, w->reach, w->k->stride / FOUR);

	for (int side = 0; side < 2; side++) {
		double floor = floor_of(b, side);

		if (!(size <= floor))
			b->most[side] = fmax(b->most[side], extreme_above(w->k->f, (const double *)c, side ? 1 : -1, floor));
	}
}

/* No value is larger at a place of the last level, whose knots have these sizes. */
static double most_at(const double *by, const double *sizes, int n)
{
	double sum = 0;

	for (int k = 0; k < n; k++)
		sum += fabs(by[k]) * sizes[k];
	return sum * (1 + 0x1p-40);
}

/* The last level: most of its places need no sum, as what their knots have is too small. */
static void take_places(struct branch *b, int level, const four *in, int first, int end)
{
	const struct walk *w = b->w;
	int n = w->k->counts[w->order[level]];
	size_t count = w->k->stride / FOUR;
	double sizes[MOST_KNOTS];

	for (int k = 0; k < n; k++)
		sizes[k] = size_of(in + (size_t)k * count, w->reach, count);
	for (int i = first; i < end; i++) {
		const double *by = w->weights[level] + i * n;

		if (most_at(by, sizes, n) <= fmin(floor_of(b, 0), floor_of(b, 1)))
			continue;
		contract(in, 1, n, count, by, b->rooms[level]);
		take(b, b->rooms[level]);
	}
}

static void descend(struct branch *b, int level, const four *in)
{
	const struct walk *w = b->w;
	int n = w->k->counts[w->order[level]];
	int first = level == 1 ? b->first : 0, end = level == 1 ? b->end : w->places[level];

	if (level + 1 == w->depth) {
		take_places(b, level, in, first, end);
		return;
	}
	for (int i = first; i < end && !w->failed; i++) {
		contract(in, w->before[level], n, w->after[level], w->weights[level] + i * n, b->rooms[level]);
		descend(b, level + 1, b->rooms[level]);
		if (level < 2 && seconds_now() > w->effort->deadline)
			b->w->failed = 2;
	}
}

static int branch_make(struct branch *b, struct walk *w)
{
	*b = (struct branch){.w = w, .most = {w->most[0], w->most[1]}};
	for (int l = 0; l < w->depth; l++)
		if (!(b->rooms[l] = aligned_alloc(sizeof(four), w->before[l] * w->after[l] * sizeof(four))))
			return 0;
	return 1;
}

/* One place of the first level, with some of the second. */
static void take_branch(void *job, size_t piece)
{
	struct walk *w = job;
	const struct knots *k = w->k;
	const four *from = (const four *)(const void *)(k->values + (size_t)w->to->output * k->points * k->stride);
	int place = (int)(piece / (size_t)w->chunks), chunk = (int)(piece % (size_t)w->chunks), n = k->counts[w->order[0]];
	struct branch b;

	if (!branch_make(&b, w))
		w->failed = 1;
	if (!w->failed) {
		b.first = w->depth > 1 ? w->places[1] * chunk / w->chunks : 0;
		b.end = w->depth > 1 ? w->places[1] * (chunk + 1) / w->chunks : 0;
		contract(from, w->before[0], n, w->after[0], w->weights[0] + place * n, b.rooms[0]);
		if (w->depth > 1)
			descend(&b, 1, b.rooms[0]);
		else
			take(&b, b.rooms[0]);
		grid_raise(&w->most[0], b.most[0]);
		grid_raise(&w->most[1], b.most[1]);
	}
	for (int l = 0; l < w->depth; l++)
		free(b.rooms[l]);
}

/* ---- its levels ---- */

/* A length along which second derivatives are taken has the same everywhere. */
static int places_of(const struct walk *w, int dim)
{
	return dim == w->to->along && !w->k->f->dims[dim].is_angle ? 1 : w->to->grid->counts[dim];
}

static double growth_of(const struct walk *w, int dim)
{
	return (double)places_of(w, dim) / w->k->counts[dim];
}

/* The row with the most places first, so that threads have pieces; then those where the least becomes of the knots. */
static void set_order(struct walk *w)
{
	int n = w->k->f->dim_count, most = 0;

	for (int l = 0; l < n; l++) {
		w->order[l] = l;
		most = places_of(w, l) > places_of(w, most) ? l : most;
	}
	w->order[0] = most;
	w->order[most] = 0;
	for (int i = 2; i < n; i++)
		for (int l = i; l > 1 && growth_of(w, w->order[l]) < growth_of(w, w->order[l - 1]); l--) {
			int t = w->order[l];

			w->order[l] = w->order[l - 1];
			w->order[l - 1] = t;
		}
}

static void set_layout(struct walk *w)
{
	unsigned char is_done[FIELD_DIMS] = {0};

	for (int level = 0; level < w->depth; level++) {
		int dim = w->order[level];

		w->before[level] = 1;
		w->after[level] = w->k->stride / FOUR;
		for (int l = 0; l < w->depth; l++)
			if (l != dim && !is_done[l])
				*(l < dim ? &w->after[level] : &w->before[level]) *= (size_t)w->k->counts[l];
		is_done[dim] = 1;
	}
}

static int set_weights(struct walk *w, double *spread)
{
	for (int level = 0; level < w->depth; level++) {
		int dim = w->order[level], n = w->k->counts[dim];

		w->places[level] = places_of(w, dim);
		w->weights[level] = malloc((size_t)(w->places[level] * n) * sizeof(double));
		spread[dim] = 0;
		for (int i = 0; i < w->places[level] && w->weights[level]; i++)
			spread[dim] = fmax(spread[dim],
				knots_weigh(w->k, dim, w->to->grid->places[dim][i], dim == w->to->along, w->weights[level] + i * n));
		if (!w->weights[level])
			return 0;
	}
	return 1;
}

/* In the order of coefficients. */
static int set_reach(struct walk *w)
{
	const struct field *f = w->k->f;
	double *to;

	w->reach = aligned_alloc(sizeof(four), w->k->stride * sizeof(double));
	if (!(to = (double *)w->reach))
		return 0;
	memset(to, 0, w->k->stride * sizeof(double));
	to[0] = 1;
	for (int i = 0; i < f->drive_count; i++)
		to[1 + i] = f->drives[i].ball ? 1 : interval_size(f->drives[i].range);
	for (int j = 0; j < f->rate_count; j++) {
		to[1 + f->drive_count + j] = interval_size(f->rates[j].range);
		for (int k = j; k < f->rate_count; k++)
			to[field_pair(f, j, k)] = interval_size(f->rates[j].range) * interval_size(f->rates[k].range);
	}
	return 1;
}

static int run(struct walk *w)
{
	struct knots_walk *to = w->to;
	double spread[FIELD_DIMS];
	int wanted = (int)w->effort->threads * PIECES, done = set_weights(w, spread) && set_reach(w);

	if (!done)
		return 0;
	to->off = knots_off(w->k, to->output, spread);
	w->chunks = (wanted + w->places[0] - 1) / w->places[0];
	w->chunks = w->depth < 2 ? 1 : w->chunks < w->places[1] ? w->chunks : w->places[1];
	workers_run(w->effort->workers, w->effort->threads, take_branch, w, (size_t)(w->places[0] * w->chunks));
	for (int side = 0; side < 2; side++)
		to->most[side] = w->most[side];
	return w->failed == 2 ? -1 : !w->failed;
}

int knots_walk(struct knots_walk *to, const struct effort *x)
{
	struct walk w = {.to = to, .k = to->knots, .effort = x, .depth = to->knots->f->dim_count};
	int done;

	for (int side = 0; side < 2; side++)
		w.most[side] = to->most[side];
	set_order(&w);
	set_layout(&w);
	done = run(&w);
	for (int level = 0; level < w.depth; level++)
		free(w.weights[level]);
	free(w.reach);
	return done;
}
