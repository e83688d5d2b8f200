#ifndef RNEAGEN_SHARE_H
#define RNEAGEN_SHARE_H
/* Some outputs of a DAG, and the nodes that they take. What a share costs to copy and to fuse grows with its own size, not
   with the whole's. */

#include "dag/dag.h"

struct share {
	const struct dag *whole;
	const int *owner;    /* by output */
	unsigned char *live; /* by node: the outputs take it; eight more */
	uint32_t *place;     /* by node that is live: where it stands in the copy */
};

/* Room for the shares of a DAG, whose outputs have owners. Returns 0 when memory runs out. */
int share_begin(struct share *x, const struct dag *whole, const int *owner, struct arena *a);

/* A copy of what the outputs of owners first to end - 1 take, in the order of the whole, to be read or fused: nothing can be
   added to it. Failure is in out->failed. */
void share_copy(struct share *x, int first, int end, struct dag *out, struct arena *a);

/* Give back what share_begin took. */
void share_end(struct share *x, struct arena *a);

#endif
