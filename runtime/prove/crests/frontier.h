#ifndef RUNTIME_PROVE_FRONTIER_H
#define RUNTIME_PROVE_FRONTIER_H
/* A value or derivative apart from what depends on a few rows of q alone: the nodes where that ends, its frontier, are
   inputs of their own, with the ranges that they have. So an arm's force depends on the arm's rows of q and on how the
   body that carries it moves, and the output's derivative by it on these and on where the output's axis is. What is lost
   is that not all of the frontier can be largest at once. */

#include "peaks/peaks.h"
#include "relax/relax.h"

/* More nodes are no frontier. */
enum { FRONTIER_NODES = 16 };

/* What peak k reads beside q where rows k->cut end at the frontier: into k->rates and k->drives; and k->steps. Returns 0
   where it cannot be cut so, or memory runs out. */
int frontier_count(const struct peaks *p, struct peak *k);

/* The text's relaxed DAG with these nodes of the adjoint as outputs, all cut as k is, into *to. Returns 0 where they cannot
   be cut so, or memory runs out. */
int frontier_cut(struct relaxed *to, const struct relaxed *of, const struct peaks *p, const struct peak *k, const uint32_t *nodes,
	size_t count, struct arena *arena);

#endif
