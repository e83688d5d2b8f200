#ifndef TESTS_REFERENCE_MOMENTUM_H
#define TESTS_REFERENCE_MOMENTUM_H

#include "reference/kinematics/frames.h"

// The centre of mass of all links that move in the ground, and the momentum about it in the ground's axes, linear before
// angular: sums over the links of m v and of I w + m c x v, by the Jacobians of their own centres of mass. "Held" is by row
// of qd; NULL: none.

// Of all that moves. Returns the mass; where it is not positive the others are not set.
wide reference_com(const struct reference *r, const char *held, const wide *q, wide c[3]);

// J[3][nv]: the velocity of the centre of mass is J qd.
void reference_com_jacobian(const struct reference *r, const char *held, const wide *q, wide *J);

// A[6][nv]: the momentum is A qd.
void reference_momentum_matrix(const struct reference *r, const char *held, const wide *q, wide *A);

// The rate of the momentum, along the curve with qd and qdd; gravity is not in it.
void reference_momentum_rate(const struct reference *r, const char *held, const wide *q, const wide *qd, const wide *qdd,
                             wide out[6]);

// dM/dt along the curve with qd, [nv][nv], zero in what is held.
void reference_mass_rate(struct reference *r, const char *held, const wide *q, const wide *qd, wide *out);

#endif
