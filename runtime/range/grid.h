#ifndef RUNTIME_RANGE_GRID_H
#define RUNTIME_RANGE_GRID_H
/* Points of q in rows and columns, and what is done at each by several threads. */

#include "steps/cuts.h"
#include "core/workers.h"
#include "range/field.h"

/* The angle of place i of n that are spread evenly over a circle. */
real grid_angle(int i, int n);

struct grid {
	const struct field *f;
	int counts[FIELD_DIMS];             /* of places, at least 1 */
	double (*places[FIELD_DIMS])[2];    /* as field_place has them */
	double half[FIELD_DIMS];            /* no point of a range is further from the nearest place */
	int skip;                           /* this dimension has its first place alone; -1: none */
};

/* Places that are spread evenly: over the whole circle of each angle, where `is_whole` says so or the range is; else from one end
   of the range to the other. Returns 0 when memory runs out; grid_free in either case. */
int grid_make(struct grid *g, const struct field *f, const int *counts, int is_whole);
void grid_free(struct grid *g);

/* How many points; INFINITY-like numbers are fine. */
double grid_size(const struct grid *g);

/* The point with this number. */
void grid_point(const struct grid *g, size_t number, struct field_point *q);

/* *most becomes x where that is larger, whichever thread comes first. */
void grid_raise(_Atomic double *most, double x);

/* Whoever works on points does so with the time that there is. */
struct effort {
	struct workers *workers;
	unsigned threads;
	double deadline; /* as seconds_now has it */
	struct record *record; /* what a certificate needs to know; NULL: nothing */
};

#endif
