#ifndef RUNTIME_RANGE_CURVATURE_H
#define RUNTIME_RANGE_CURVATURE_H
/* How much outputs bend: the largest second derivative by each row of q, over all angles (not their ranges alone), the ranges of
   lengths, and those of drives and rates. */

#include "range/grid.h"

struct curvature {
	double *most; /* [output][dim]: |d2f / dq_k^2| is nowhere above */
	double speed; /* seconds of one evaluation, over all threads */
};

/* Where it begins, by output: all values over all angles; the largest magnitude that was found; [output][dim] bounds of what is looked
   for. */
struct curvature_start {
	const struct interval *whole;
	const double *found, *bends;
};

/* Into c->most, by points of a grid that takes about `seconds`. Returns 0 when memory runs out; the caller frees c->most. */
int curvature_find(struct curvature *c, const struct field *f, const struct curvature_start *from, const struct effort *x, double seconds);

#endif
