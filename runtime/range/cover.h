#ifndef RUNTIME_RANGE_COVER_H
#define RUNTIME_RANGE_COVER_H
/* Ranges of outputs over the box, from their values on a grid and how much they bend between its places. */

#include "range/curvature.h"
#include "range/knots.h"

struct cover {
	double *upper, *lower;   /* by output: of the exact value over the box */
	double points;           /* of the grid */
};

/* Where it begins: curvature's `most`; [output][2], smallest and largest values that a search has found, which save time and
   decide what is worth it; knots, or NULL. */
struct cover_start {
	const double *bends, (*found)[2];
	const struct knots *knots;
	double pace; /* of a point by knots, about, in seconds; 0: it is not known */
};

/* Where knots take more memory than there is, points are evaluated. Returns 0 when memory runs out; the caller frees upper and
   lower. */
int cover_find(struct cover *c, const struct field *f, const struct cover_start *from, const struct effort *x, double seconds);

#endif
