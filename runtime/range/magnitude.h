#ifndef RUNTIME_RANGE_MAGNITUDE_H
#define RUNTIME_RANGE_MAGNITUDE_H
/* Ranges of outputs by intervals in which rotations keep lengths (norms.h), over boxes of q that are split. They hold for any
   number of rows of q, and are the closer the fewer there are. */

#include "range/grid.h"

/* By output of the field, into ranges: over the box; where is_whole, over all angles; unbounded where the time was over. Returns
   0 when memory runs out. */
int magnitude_find(struct interval *ranges, const struct field *f, const struct box *b, int is_whole, const struct effort *x,
	double seconds);

/* Into most[output][dim]: no second derivative of an output by a row of q is larger, over all angles and the box; by intervals of
   its expression. That is close enough to tell which rows matter little. INFINITY where there are many rows, or the time was
   over. Returns 0 when memory runs out. */
int magnitude_bends(double *most, const struct field *f, const struct box *b, const struct effort *x);

#endif
