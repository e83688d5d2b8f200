#ifndef RNEAGEN_REGISTRY_H
#define RNEAGEN_REGISTRY_H
/* The recursive Newton-Euler algorithm over symbolic 3-vectors, whole and in its two halves. */

#include "dag/dag.h"
#include "tree/tree.h"

/* A generated function: its name, the comment above it, and what fills its DAG (failure is in dag->failed). */
struct algorithm {
	const char *name, *doc;
	void (*build)(struct dag *d, const struct tree *t);
};

/* rnea: q[nq], qd[nv], qdd[nv] -> tau[nv].
   fpass: q, qd, qdd -> v[nb*6], a[nb*6], f[nb*6], each linear then angular, at the origin and in the URDF frame of the
   body's link; a is the spatial acceleration with a(world) = -gravity, f = I a + v x* I v the body's own wrench.
   bpass: q, f -> tau. */
enum { PASS_RNEA, PASS_FPASS, PASS_BPASS, PASS_COUNT };
extern const struct algorithm ALGORITHMS[PASS_COUNT];

#endif
