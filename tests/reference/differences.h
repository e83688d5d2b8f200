#ifndef TESTS_REFERENCE_DIFFERENCES_H
#define TESTS_REFERENCE_DIFFERENCES_H

#include "reference/reference.h"

// Half the distance of two states whose torques are subtracted: truncation and rounding are both far below what is
// asked for, 1e-9 in long double and 1e-19 in __float128.
#ifdef REFERENCE_QUAD
#define DIFFERENCE_STEP WIDE_C(1e-10)
#else
#define DIFFERENCE_STEP WIDE_C(1e-6)
#endif

// q moved by h along row j of the tangent space.
void reference_move(const struct reference *r, int j, wide h, wide *q);

// Derivatives of the reference's torques as central differences, and its mass matrix column by column, each
// [torque][by], nv x nv. A floating joint's position varies by a twist in the body's frame. `work` is for
// REFERENCE_WORK(r) numbers.
#define REFERENCE_WORK(r) ((size_t)(r)->nq + 4 * (size_t)(r)->nv)
void reference_differences(struct reference *r, const double *q, const double *qd, const double *qdd, wide *dq,
                           wide *dqd, wide *M, wide *work);

#endif
