#ifndef RUNTIME_STEPS_BENDS_H
#define RUNTIME_STEPS_BENDS_H
/* How much an output bends by each row of q, from the expressions of its second derivatives, in which turns keep lengths. */

#include "steps/points.h"

/* What is known over all angles and the ranges of lengths, before there is any grid. */
struct bends_start {
	double whole;              /* |f| is nowhere above */
	double bends[POINT_DIMS];  /* |d2f/dq_k^2| is nowhere above, by dimension of p */
};

/* Over the box rows[argument], in which angles become whole circles. Returns 0 when memory runs out. */
int bends_find(struct bends_start *b, const struct points *p, const struct dag *d, size_t output,
	struct span *const *rows, int position);

#endif
