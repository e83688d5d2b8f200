#ifndef PLANT_H
#define PLANT_H
/* The arm itself, simulated: what a controller's torques do to it. Which arm it is, the build says. */

#ifndef PLANT_HEADER
#define PLANT_HEADER "iiwa14_rnea.h"
#define PLANT_RNEA iiwa14_rnea
#define PLANT_JOINTS iiwa14_nv
#endif
#include PLANT_HEADER

enum { N = PLANT_JOINTS };

struct state {
	double q[N], qd[N];
};

/* Let `tau` act on the arm for `dt` seconds; `damping` in N m s/rad. */
void plant_move(struct state *s, const double tau[N], const double damping[N], double dt);

#endif
