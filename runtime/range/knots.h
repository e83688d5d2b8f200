#ifndef RUNTIME_RANGE_KNOTS_H
#define RUNTIME_RANGE_KNOTS_H
/* Coefficients of a field at as few points as determine them at all q: products of 2 degree + 1 places of a circle, and of three
   places of a length. At any other q they are sums of these, with weights that are products of one for each row of q. Along a
   grid such sums, of one row after the other, are far quicker than evaluating the DAG. */

#include "range/grid.h"

/* Of the time that there is for curvature and cover, to make them; and so many seconds a point of a walk takes, at first sight.
   */
#define KNOTS_SHARE 0.25
#define KNOTS_PACE 1e-6

struct knots {
	const struct field *f;
	struct grid grid;
	int counts[FIELD_DIMS];
	size_t points, stride; /* of points; of one point's coefficients, rounded up */
	double *values;        /* [output][point][stride]; the first row of q goes fastest */
	double *size;          /* by output: no coefficient at a knot is larger */
};

/* Returns 1; 0: there are none, or too many for `seconds` or for the memory. knots_free in either case. */
int knots_make(struct knots *k, const struct field *f, const struct effort *x, double seconds);
void knots_free(struct knots *k);

/* Where the highest waves of all outputs in an angle cancel but for rounding, its degree is less by one, as often as that is so:
   `f`, the field of the knots, gets that degree, and noise by which the rest is bounded. Returns 0 when memory runs out. */
int knots_lower(struct knots *k, struct field *f);

/* By what knots of dimension `dim` are multiplied for the value at a place x, as field_place has it, or for the second derivative
   there. Returns the sum of their magnitudes. */
double knots_weigh(const struct knots *k, int dim, const double x[2], int is_second, double *weights);

/* No coefficient is further off, where no row's weights have more than spread[dim] as the sum of their magnitudes. */
double knots_off(const struct knots *k, int output, const double *spread);

/* All points of a grid, for one output. */
struct knots_walk {
	const struct knots *knots;
	const struct grid *grid;
	int output;
	int along;      /* second derivatives by this dimension; -1: values */
	double most[2]; /* of -f and of f, over all drives and rates: at first what is of no interest, then the largest or that */
	double off;     /* no coefficient was further from the exact one */
};

/* Returns 1; 0: memory ran out, of which it takes more than a point of a grid does; -1: time did. */
int knots_walk(struct knots_walk *w, const struct effort *x);

#endif
