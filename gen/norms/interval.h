#ifndef RNEAGEN_INTERVAL_H
#define RNEAGEN_INTERVAL_H
/* Intervals of doubles, rounded outwards: each bound is moved by two units in the last place of what rounding to
   nearest gives. */

#include "dag/dag.h"
#include <math.h>

struct interval {
	double lower, upper;
};

/* Above, or below, what rounding to nearest gives, by more than that can be off. */
static inline double round_up(double x)
{
	return x + (0x1p-52 * (x < 0 ? -x : x) + 0x1p-1022);
}

static inline double round_down(double x)
{
	return x - (0x1p-52 * (x < 0 ? -x : x) + 0x1p-1022);
}

/* What the root of a sum of up to four squares lacks, each less than 2^-1021 short where it is no normal number. */
#define SQUARES_LOST 0x1p-508

/* -pi to pi, and a little more: every angle, where turns are not counted. */
static inline struct interval interval_turn(void)
{
	return (struct interval){-0x1.921fb54442d19p+1, 0x1.921fb54442d19p+1};
}

static inline struct interval interval_add(struct interval a, struct interval b)
{
	return (struct interval){round_down(a.lower + b.lower), round_up(a.upper + b.upper)};
}

static inline struct interval interval_neg(struct interval a)
{
	return (struct interval){-a.upper, -a.lower};
}

static inline struct interval interval_sub(struct interval a, struct interval b)
{
	return interval_add(a, interval_neg(b));
}

static inline double interval_least(double a, double b)
{
	return a < b ? a : b;
}

static inline double interval_most(double a, double b)
{
	return a > b ? a : b;
}

/* Of infinite bounds nothing is known. */
static inline struct interval interval_mul(struct interval a, struct interval b)
{
	double p = a.lower * b.lower, q = a.lower * b.upper, r = a.upper * b.lower, s = a.upper * b.upper, sum = p + q + r + s;

	if (sum != sum)
		return (struct interval){-(double)INFINITY, (double)INFINITY};
	return (struct interval){round_down(interval_least(interval_least(p, q), interval_least(r, s))),
		round_up(interval_most(interval_most(p, q), interval_most(r, s)))};
}

/* The largest magnitude in it. */
static inline double interval_size(struct interval a)
{
	return interval_most(-a.lower, a.upper);
}

/* Of all angles in it. */
struct interval interval_sin(struct interval a);
struct interval interval_cos(struct interval a);

/* x and everything within `error` of it. */
struct interval interval_around(real x, double error);

#endif
