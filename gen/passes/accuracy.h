#ifndef RNEAGEN_ACCURACY_H
#define RNEAGEN_ACCURACY_H
/* How far rounding takes torques off, by samples. */

#include "dag/dag.h"
#include "draw/draw.h"

/* ||tau - ref|| / ||ref||, and the mean over joints of the same of each, root mean squares over samples. */
struct accuracy {
	double whole, each;
};

/* Of a DAG from q, qd and qdd to tau in double, beside the same in extended precision. Returns 0 when memory runs out. */
int accuracy_measure(struct accuracy *x, const struct dag *d, const struct drawn *inputs, struct arena *spare);

#endif
