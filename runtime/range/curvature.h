#ifndef RUNTIME_RANGE_CURVATURE_H
#define RUNTIME_RANGE_CURVATURE_H
/* How much outputs bend: the largest second derivative by each row of q, over all angles (not their ranges alone), the ranges of
   lengths, and those of drives and rates. */

#include "range/grid.h"

struct curvature {
	double *most; /* [output][dim]: |d2f / dq_k^2| is nowhere above */
	double speed; /* seconds of one point, evaluated or by knots, over all threads */
};

struct knots;

/* Where it begins, by output: all values over all angles; the largest magnitude that was found; [output][dim] bounds of what is
   looked for. And knots, or NULL. */
struct curvature_start {
	const struct interval *whole;
	const double *found, *bends;
	const struct knots *knots;
};

/* Into c->most, by points of a grid that takes about `seconds`; where knots take more memory than there is, points are evaluated.
   Returns 0 when memory runs out; the caller frees c->most. */
int curvature_find(struct curvature *c, const struct field *f, const struct curvature_start *from, const struct effort *x,
	double seconds);

/* ---- pace.c: from the largest second derivatives on a grid to those at all q ---- */

/* Of a circle and of a length, where second derivatives are taken along it. */
enum { LEAST_PLACES = 6, LENGTH_PLACES = 3, PACE_ROUNDS = 6 };

/* What is known of a dimension's places: how much larger than on them a polynomial can be; half their distance squared and
   halved; |d2g/dq^2| <= bend |g|. */
struct pace {
	double factor, gap, bend;
};

/* The fewest places of a circle along which second derivatives are taken. */
int pace_least(const struct field_dim *k);

struct pace pace_of(const struct field *f, int k, int count);

/* Places of dimension k where second derivatives are taken along it. */
int pace_own_count(const struct field *f, int k, const int *counts);

/* The best that both ways together give for dimension k of n: `found` is what was found on the grid, most[] what is known of all.
   */
double pace_best(const struct pace *p, int n, int k, double found, const double *most);

#endif
