#ifndef RNEAGEN_ACCURACY_H
#define RNEAGEN_ACCURACY_H
/* How far rounding takes torques off, by samples. */

#include "dag/dag.h"
#include "draw/draw.h"

/* ||tau - ref|| / ||ref||, and the mean over joints of the same of each, root mean squares over samples. */
struct accuracy {
	double whole, each;
};

/* The torques of a DAG from q, qd and qdd to tau in extended precision, [sample][row]; NULL when memory runs out. */
real *accuracy_reference(const struct dag *d, const struct drawn *inputs, struct arena *a);

/* Of such a DAG in double, beside that of the same robot. Returns 0 when memory runs out. */
int accuracy_measure(struct accuracy *x, const struct dag *d, const struct drawn *inputs, const real *reference,
	struct arena *spare);

#endif
