#ifndef RUNTIME_STEPS_GRID_H
#define RUNTIME_STEPS_GRID_H
/* A step of a certificate: an output's range, from its values on a grid and how much it bends between its places.

   Bends: B_k is nowhere below |d2f/dq_k^2|, over all angles, the ranges of lengths, and all drives and rates. They begin with
   their expressions (bends.h), or Bernstein's inequality (Markov's for lengths) and the largest magnitude of f. A pass makes them
   smaller: on a grid over whole circles the second derivative by q_k follows exactly from the values on a line along q_k; for all
   q it is larger by what each dimension l adds, in one of two ways:
   - by a factor 1 / cos(pi d / n), d the degree and n > 2 d places: M. Riesz, 1914; for a length, of its degree + 1 places,
   Lebesgue's constant; - by (pi/n)^2 / 2 times |d2g/dq_l^2|, for which Bernstein's inequality has d_l^2 B_k as well as d_k^2 B_l.
   Range: I_k, which replaces f along q_k by straight lines between its places, is positive, and |f - I_k f| <= h^2/2 B_k where h
   is half their distance. So f is at most its largest value on the grid and the sum of these. */

#include "steps/bends.h"

/* At most: passes, places of an angle in a pass, and in the last grid. */
enum { GRID_PASSES = 3, GRID_PASS_PLACES = 128, GRID_PLACES = 4096 };
#define GRID_POINTS 5e7 /* at most, of one grid */

struct grid_pass {
	int counts[POINT_DIMS];   /* places, by dimension; along which it differentiates there may be more */
	double bends[POINT_DIMS]; /* what holds after it */
};

struct grid_step {
	int dim_count, rows[POINT_DIMS]; /* of q */
	int pass_count;
	struct grid_pass passes[GRID_PASSES];
	int counts[POINT_DIMS];          /* of the grid over the ranges */
	struct span value;
};

/* Where bends begin. */
void grid_begin(const struct points *p, const struct bends_start *start, double *bends);

/* One pass, which lowers bends. Returns 0 when memory runs out. */
int grid_pass(const struct points *p, const int *counts, double *bends);

/* The range, from values on the grid. Returns 0 when memory runs out. */
int grid_cover(const struct points *p, const int *counts, const double *bends, struct span *value);

/* How many points a pass, or the last grid, takes. */
double grid_pass_size(const struct points *p, const int *counts);
double grid_cover_size(const struct points *p, const int *counts);

/* Choose passes and a grid that take about so many seconds, and fill the step; `found` is about as large as the output. Returns 0
   when memory runs out; g->dim_count 0: it is not worth it. */
int grid_find(struct grid_step *g, const struct points *p, const struct bends_start *start, double found, double seconds);

/* NULL: the step is true; or what in it is not. */
const char *grid_check(const struct grid_step *g, const struct points *p, const struct bends_start *start);

#endif
