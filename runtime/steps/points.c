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

static double narrow_step(const struct point_step *s, const double *v)
{
	double a = v[s->arg[0]], b = v[s->arg[1]];

	switch (s->op) {
	case OP_NEG:
		return -a;
	case OP_ADD:
		return a + b;
	case OP_SUB:
		return a - b;
	case OP_MUL:
		return a * b;
	case OP_FMA:
		return a * b + v[s->arg[2]];
	default:
		return a;
	}
}

CLONES static void run(const struct points *p, double *narrow, vector *wide)
{
	size_t n = p->lanes / POINT_VECTOR;

	for (const struct point_step *s = p->steps; s < p->steps + p->step_count; s++) {
		vector *to = wide + s->to * n;
		const vector *a = wide + s->arg[0] * n, *b = wide + s->arg[1] * n, *c = wide + s->arg[2] * n;

		if (!s->is_wide)
			narrow[s->to] = narrow_step(s, narrow);
		for (size_t i = 0; i < n && s->is_wide; i++)
			to[i] = s->op == OP_NEG ? -a[i] : s->op == OP_ADD ? a[i] + b[i] : s->op == OP_SUB ? a[i] - b[i] : s->op == OP_MUL ? a[i] * b[i] :
				s->op == OP_FMA ? a[i] * b[i] + c[i] : narrow[s->arg[0]] + (vector){0};
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
	const double *v = work + p->root * p->lanes, *forth = v + 1 + p->drive_count, *back = p->is_odd ? forth + p->rate_count : forth;
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
};

static void set_corners(struct corners *s, const struct points *p, const double *c, int sign)
{
	s->constant = 0;
	for (int j = 0; j < p->rate_count; j++) {
		struct span r = p->rates[j].range;
		double least = r.lo > 0 ? r.lo : r.hi < 0 ? r.hi : 0, square = sign * c[points_pair(p, j, j)];

		s->linear[j] = sign * c[1 + p->drive_count + j] + (square < 0 ? 2 * square * least : 0);
		s->constant -= square < 0 ? square * least * least : 0;
		s->pair[j][j] = square < 0 ? 0 : square;
		for (int k = j + 1; k < p->rate_count; k++)
			s->pair[j][k] = sign * c[points_pair(p, j, k)];
	}
}

/* With the rates from j on at all their ends; v has those before. */
static double most_of(const struct corners *s, const struct points *p, double *v, int j, double value)
{
	double most = -(double)INFINITY;

	if (j == p->rate_count)
		return value;
	for (int end = 0; end < 2; end++) {
		double slope = s->linear[j];

		v[j] = end ? p->rates[j].range.hi : p->rates[j].range.lo;
		for (int k = 0; k < j; k++)
			slope += s->pair[k][j] * v[k];
		most = fmax(most, most_of(s, p, v, j + 1, value + v[j] * (slope + s->pair[j][j] * v[j])));
		if (p->rates[j].range.lo == p->rates[j].range.hi)
			break;
	}
	return most;
}

double points_above(const struct points *p, const double *c, int sign, double floor)
{
	double drives = sign * c[0], size = fabs(c[0]), rates = 0, v[POINT_INPUTS];
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
	return fmin(drives + rates, drives + s.constant + most_of(&s, p, v, 0, 0)) + size;
}
