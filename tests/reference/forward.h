#ifndef TESTS_REFERENCE_FORWARD_H
#define TESTS_REFERENCE_FORWARD_H

#include "reference/reference.h"

// Forward dynamics from the reference's torques alone: M column by column as ID(q, 0, e_j) - ID(q, 0, 0), factored as
// L D L^T, and the solution refined by its residual tau - ID(q, qd, qdd). What is held (by row of qd; NULL: nothing) does
// not accelerate, and its torque is what that takes.

// M, [nv][nv], with ones in the diagonal of what is held and zeros in the rest of its rows and columns.
void reference_mass(struct reference *r, const char *held, const wide *q, wide *M);

// X = M^-1, [nv][nv], zero where held. Returns the least pivot of M scaled to ones on its diagonal; where it is not
// positive X is not set.
wide reference_inverse(struct reference *r, const char *held, const wide *q, wide *X);

// qdd[nv]; X is what reference_inverse made at this q.
void reference_forward(struct reference *r, const wide *X, const wide *q, const wide *qd, const wide *tau, wide *qdd);

// Its derivatives by q and by qd as central differences, [nv][nv], a row for each of qdd. A floating joint's position
// varies by a twist in the body's frame.
void reference_forward_differences(struct reference *r, const char *held, const wide *q, const wide *qd,
                                   const wide *tau, wide *dq, wide *dqd);

// The condition number of a symmetric positive definite matrix: its largest eigenvalue by its least, by Jacobi's
// rotations. M is spoiled.
wide reference_condition(int n, wide *M);

#endif
