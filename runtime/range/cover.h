#ifndef RUNTIME_RANGE_COVER_H
#define RUNTIME_RANGE_COVER_H
/* Ranges of outputs over the box, from their values on a grid and how much they bend between its places. */

#include "range/curvature.h"

struct cover {
	double *upper, *lower;   /* by output: of the exact value over the box */
	double points;           /* of the grid */
};

/* `found` is [output][2], smallest and largest values that a search has found; it saves time and decides what is worth it. Returns 0
   when memory runs out; the caller frees upper and lower. */
int cover_find(struct cover *c, const struct field *f, const struct curvature *bends, const double (*found)[2], const struct effort *x,
	double seconds);

#endif
