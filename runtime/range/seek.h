#ifndef RUNTIME_RANGE_SEEK_H
#define RUNTIME_RANGE_SEEK_H
/* The largest and smallest values of outputs that a search over the box finds: by ascent from many states. It proves nothing. */

#include "range/grid.h"

/* A state of the box with an output's value there. */
struct sought {
	double value;
	double q[FIELD_DIMS];     /* by dimension */
	double x[2 * FIELD_DIMS]; /* drives, then rates, over their scales */
};

/* Into best, [output][2], smallest and largest, for about so many seconds. Returns 0 when memory runs out. */
int seek_extremes(struct sought (*best)[2], const struct field *f, const struct effort *x, double seconds);

#endif
