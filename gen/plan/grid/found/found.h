#ifndef RNEAGEN_FOUND_H
#define RNEAGEN_FOUND_H
/* A product of accelerations, or accelerations with contacts, by kernels one after the other, each in parts where limbs share
   nothing (joined.h).

   A vjp: the first finds qdd and, of the weights w, mu = M^-1 w, which is the vjp by tau. The second takes both from rows of
   the vjp and makes the rest, the vjp of the torques at that qdd with -mu for its weights (dynamics/product.c). A jvp: the
   first finds qdd, the second what tau changes by while that qdd stands still, dtau - T_q dq - T_qd dqd, and the third M^-1
   of that, each in the rows of the jvp. So nothing of M and its factors waits while the motion is gone over, nor motion while
   M is factored.

   Accelerations with contacts: the first finds the forces on these, in rows of joints between base and contact, the second qdd.

   Where the base moves, in soa, a kernel that finds accelerations may be two or three, the base's own first (base_first.h),
   and one of torques two, one for each side of the base (hands/base_sides.h). */

#include "dynamics/registry.h"
#include "plan/grid/parts.h"

/* *count is 0 where that does not serve: another request, or one that holds little at once. Returns 0 when memory runs out. */
int found_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a);

/* DAGs of the first `count` rounds, each a kernel or two. Returns 0 when memory runs out. */
int found_rounds(struct dag *dags, int count, const struct parts_of *x, enum handed handed, struct arena *a);

#endif
