#ifndef PLANT_H
#define PLANT_H
/* The arm itself, simulated: what a controller's torques do to it. */

#include "iiwa14_rnea.h"

enum { N = iiwa14_nv };

struct state {
	double q[N], qd[N];
};

/* Let `tau` act on the arm for `dt` seconds; `damping` in N m s/rad. */
void plant_move(struct state *s, const double tau[N], const double damping[N], double dt);

#endif
