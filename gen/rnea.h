#ifndef RNEAGEN_RNEA_H
#define RNEAGEN_RNEA_H
/* The recursive Newton-Euler algorithm over symbolic 3-vectors. */

#include "dag.h"
#include "tree.h"

/* One generated function: what it is called and how its DAG is made. All return failure through dag->failed. */

/* tau = ID(q, qd, qdd). Arguments: q[nq], qd[nv], qdd[nv] -> tau[nv]. */
void rnea_full(struct dag *d, const struct tree *t);
/* Out from the base. q, qd, qdd -> v[nb*6], a[nb*6], f[nb*6], each linear then angular, at the origin and in the URDF
   frame of the body's link; a is the spatial acceleration with a(world) = -gravity, f = I a + v x* I v. */
void rnea_fpass(struct dag *d, const struct tree *t);
/* Back to the base. q, f[nb*6] -> tau. */
void rnea_bpass(struct dag *d, const struct tree *t);

#endif
