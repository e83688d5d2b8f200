#ifndef RNEAGEN_CUT_H
#define RNEAGEN_CUT_H
/* The fewest nodes of a DAG through which all goes that some nodes give to others, such as the six numbers of the force on a
   hand, and up to twelve more for a vjp, or the 27 that a base feels of a limb and six for each further right-hand side:
   paths that have no node in common are as many (Menger 1927), and are found one after the other (Ford and Fulkerson 1956). */

#include "dag/dag.h"

enum { CUT_MOST = 33 };

struct cut {
	uint32_t nodes[CUT_MOST]; /* those nearest to `from`, in the order of the DAG */
	int count;                /* 0: nothing goes, or through more */
};

/* A minimum vertex cut; `from`, `to`: by node, 1 where paths begin, or end. Returns 0 when memory runs out. */
int cut_find(struct cut *c, const struct dag *d, const unsigned char *from, const unsigned char *to, struct arena *a);

#endif
