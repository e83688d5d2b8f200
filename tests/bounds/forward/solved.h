#ifndef TESTS_BOUNDS_SOLVED_H
#define TESTS_BOUNDS_SOLVED_H
/* A robot's torques and accelerations in quad precision from the decimals of its file: the independent reference, friction and
   rotors beside it, and M qdd = tau - bias solved by elimination. */

#include "hard/quad.h"
#include "reference/reference.h"

struct solved {
	struct quad *quad;
	struct reference *table;
	int nq, nv, ready;
	__float128 *friction, *armature; /* by row of qd */
	__float128 width;
	__float128 *M, *rhs, *unit, *bias, *wide[3]; /* work */
};

/* Aborts where the robot is refused; `what` names it. With the file's friction where width > 0, N m, and a rotor of `armature`
   kg m^2 at each joint of one row. Robots whose joints follow others have neither. */
void solved_open(struct solved *x, const char *urdf, int floating, __float128 width, __float128 armature, const char *what);
void solved_close(struct solved *x);

/* A state: of the file's limits, rounded to floats, with unit quaternions that are floats too. */
void solved_draw(const struct solved *x, struct rng *rng, double *q, double *qd, double *qdd);

/* tau = ID(q, qd, qdd) and qdd = FD(q, qd, tau); [nv]. */
void solved_torques(struct solved *x, const double *q, const double *qd, const double *qdd, __float128 *tau);
void solved_accelerations(struct solved *x, const double *q, const double *qd, const double *tau, __float128 *qdd);

#endif
