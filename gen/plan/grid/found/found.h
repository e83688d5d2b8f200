#ifndef RNEAGEN_FOUND_H
#define RNEAGEN_FOUND_H
/* A vjp of accelerations by two kernels, one after the other. The first finds qdd and, of the weights w, mu = M^-1 w, which is
   the vjp by tau. The second takes both from rows of the vjp and makes the rest, the vjp of the torques at that qdd with -mu for
   its weights (dynamics/product.c). So nothing of M and its factors waits while the motion is gone over backwards, nor motion
   while M is factored. Each is in parts where limbs share nothing (joined.h). */

#include "plan/grid/parts.h"

/* *count is 0 where that does not serve: another request, or one that holds little at once. Returns 0 when memory runs out. */
int found_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a);

#endif
