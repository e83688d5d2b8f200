#ifndef RUNTIME_RANGE_INTERVAL_H
#define RUNTIME_RANGE_INTERVAL_H
/* Intervals of doubles, rounded outwards: each bound is the next double beyond the one that rounding to nearest gives. */

#include "dag/dag.h"

struct interval {
	double lower, upper;
};

struct interval interval_add(struct interval a, struct interval b);
struct interval interval_sub(struct interval a, struct interval b);
struct interval interval_mul(struct interval a, struct interval b);
struct interval interval_neg(struct interval a);
/* Of all angles in it. */
struct interval interval_sin(struct interval a);
struct interval interval_cos(struct interval a);

/* The largest magnitude in it. */
double interval_size(struct interval a);

/* x and everything within `error` of it. */
struct interval interval_around(real x, double error);

/* The next double above, or below, what rounding to nearest gives. */
double round_up(double x);
double round_down(double x);

#endif
