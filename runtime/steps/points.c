/* The polynomial of an output at a point, from its values at a few drives and rates: all of them in one pass of vectors. */
#include "steps/points.h"
#include <stdlib.h>
#include <string.h>

typedef double vector __attribute__((vector_size(POINT_VECTOR * sizeof(double))));

#if defined __x86_64__ && defined __GNUC__ && !defined __clang__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CLONES
#endif

#define OF_EACH(value)                                                                                                 \
	for (size_t i = 0; i < n; i++)                                                                                 \
		to[i] = value;                                                                                         \
	break

/* What numbers and vectors of lanes have in common. */
#define ARITHMETIC                                                                                                     \
	case OP_NEG:                                                                                                   \
		OF_EACH(-a[i]);                                                                                        \
	case OP_ADD:                                                                                                   \
		OF_EACH(a[i] + b[i]);                                                                                  \
	case OP_SUB:                                                                                                   \
		OF_EACH(a[i] - b[i]);                                                                                  \
	case OP_MUL:                                                                                                   \
		OF_EACH(a[i] * b[i]);                                                                                  \
	case OP_FMA:                                                                                                   \
		OF_EACH(a[i] * b[i] + c[i])

/* Narrow values have one lane, in `narrow`. */
static inline void run_narrow(const struct point_step *s, double *narrow)
{
	const size_t n = 1;
	double *to = narrow + s->to;
	const double *a = narrow + s->arg[0], *b = narrow + s->arg[1], *c = narrow + s->arg[2];

	switch (s->op) {
	ARITHMETIC;
	default:
		break;
	}
}

CLONES static void run(const struct points *p, double *narrow, vector *wide)
{
	const size_t n = p->lanes / POINT_VECTOR;

	for (const struct point_step *s = p->steps; s < p->steps + p->step_count; s++) {
		vector *to = wide + s->to * n;
		const vector *a = wide + s->arg[0] * n, *b = wide + s->arg[1] * n, *c = wide + s->arg[2] * n;

		if (!s->is_wide) {
			run_narrow(s, narrow);
			continue;
		}
		switch (s->op) {
		ARITHMETIC;
		default:
			OF_EACH(narrow[s->arg[0]] + (vector){0});
		}
	}
}

double *points_work(const struct points *p)
{
	size_t unit = POINT_VECTOR * sizeof(double), count = p->wide_count * p->lanes + p->narrow_count;
	double *work = aligned_alloc(unit, (count * sizeof(double) / unit + 1) * unit);

	for (size_t i = 0; i < p->wide_count && work; i++)
		if (p->wide[i])
			memcpy(work + i * p->lanes, p->wide[i], p->lanes * sizeof *work);
	if (work)
		memcpy(work + p->wide_count * p->lanes, p->narrow, p->narrow_count * sizeof *work);
	return work;
}

static void put(double *narrow, uint32_t place, double x)
{
	if (place != UINT32_MAX)
		narrow[place] = x;
}

/* Lanes: x = 0; each drive alone; each rate alone; each of them backwards, where that differs; each pair of rates. */
void points_at(const struct points *p, const double (*q)[2], double *work, double *coefficients)
{
	double *narrow = work + p->wide_count * p->lanes, *c = coefficients;
	const double *v = work + p->root * p->lanes, *forth = v + 1 + p->drive_count,
		*back = p->is_odd ? forth + p->rate_count : forth;
	const double *pair = back + p->rate_count;

	for (int k = 0; k < p->dim_count; k++) {
		put(narrow, p->dims[k].value, q[k][0]);
		put(narrow, p->dims[k].sine, q[k][0]);
		put(narrow, p->dims[k].cosine, q[k][1]);
	}
	run(p, narrow, (vector *)(void *)work);
	c[0] = v[0];
	for (int i = 0; i < p->drive_count; i++)
		c[1 + i] = v[1 + i] - v[0];
	for (int j = 0; j < p->rate_count; j++) {
		c[1 + p->drive_count + j] = 0.5 * (forth[j] - back[j]);
		c[points_pair(p, j, j)] = 0.5 * (forth[j] + back[j]) - v[0];
		for (int k = j + 1; k < p->rate_count; k++)
			c[points_pair(p, j, k)] = *pair++ - forth[j] - forth[k] + v[0];
	}
}

/* ---- over drives and rates ---- */

static double reach(struct span r)
{
	return fmax(fabs(r.lo), fabs(r.hi));
}

/* Over all corners of rates, of which a square with a negative coefficient is replaced by its tangent at the least rate there is:
   c v^2 <= c (2 t v - t^2). What is left is convex in each rate, so it is largest at a corner. */
struct corners {
	double linear[POINT_INPUTS], pair[POINT_INPUTS][POINT_INPUTS], constant;
	double lo[POINT_INPUTS], hi[POINT_INPUTS], most;
	int n;
};

static void set_corners(struct corners *s, const struct points *p, const double *c, int sign)
{
	int is_even = 1;

	s->constant = 0;
	s->n = p->rate_count;
	for (int j = 0; j < s->n; j++) {
		struct span r = p->rates[j].range;
		double least = r.lo > 0 ? r.lo : r.hi < 0 ? r.hi : 0, square = sign * c[points_pair(p, j, j)];

		s->lo[j] = r.lo;
		s->hi[j] = r.hi;
		s->linear[j] = sign * c[1 + p->drive_count + j] + (square < 0 ? 2 * square * least : 0);
		s->constant -= square < 0 ? square * least * least : 0;
		s->pair[j][j] = square < 0 ? 0 : square;
		for (int k = j + 1; k < s->n; k++)
			s->pair[j][k] = sign * c[points_pair(p, j, k)];
		is_even &= s->linear[j] == 0 && r.lo == -r.hi;
	}
	if (is_even && s->n) /* v and -v are as good */
		s->lo[0] = s->hi[0];
}

/* With the rates from j on at all their ends: slope is what the ones before add to their coefficients. */
static void walk(struct corners *s, int j, double value, const double *slope)
{
	double next[POINT_INPUTS];

	if (j == s->n) {
		s->most = value > s->most ? value : s->most;
		return;
	}
	for (int end = s->lo[j] < s->hi[j] ? 0 : 1; end < 2; end++) {
		double v = end ? s->hi[j] : s->lo[j];

		for (int k = j + 1; k < s->n; k++)
			next[k] = slope[k] + s->pair[j][k] * v;
		walk(s, j + 1, value + v * (slope[j] + s->pair[j][j] * v), next);
	}
}

static double most_of(struct corners *s)
{
	s->most = -(double)INFINITY;
	walk(s, 0, s->constant, s->linear);
	return s->most;
}

double points_above(const struct points *p, const double *c, int sign, double floor)
{
	double drives = sign * c[0], size = fabs(c[0]), rates = 0;
	struct corners s;

	for (int i = 0; i < p->drive_count; i++) {
		double m = sign * c[1 + i];

		drives += m * (m > 0 ? p->drives[i].range.hi : p->drives[i].range.lo);
		size += fabs(m) * reach(p->drives[i].range);
	}
	for (int j = 0; j < p->rate_count; j++) {
		double of = fabs(c[1 + p->drive_count + j]);

		for (int k = j; k < p->rate_count; k++)
			of += fabs(c[points_pair(p, j, k)]) * reach(p->rates[k].range);
		rates += of * reach(p->rates[j].range);
	}
	/* less than 2^10 roundings of what is at most twice all magnitudes */
	size = 0x1p-40 * (size + rates);
	if (drives + rates + size <= floor)
		return drives + rates + size;
	set_corners(&s, p, c, sign);
	return fmin(drives + rates, drives + most_of(&s)) + size;
}
