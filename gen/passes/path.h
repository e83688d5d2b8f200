#ifndef RNEAGEN_PATH_H
#define RNEAGEN_PATH_H
/* What the torques of a tree cost, and what the constants of one body do: of it with those that it hangs on and those that hang
   on it, whatever the size of the tree. */

#include "dag/dag.h"
#include "request/request.h"
#include "tree/restate.h"

/* Of the torques alone. */
extern const struct request TORQUES_REQUEST;

/* Their DAG, and its multiplications, additions and subtractions; -1 when memory ran out. */
void torques_build(struct dag *d, const struct tree *t, struct arena *a);
long torques_flops(const struct dag *d, struct arena *a);

/* constants: of the body, its parent and its children, that something is multiplied by, each for 2, those of 1 and -1 for 1.
   flops: of the path from the ground to the body, its children at the end; of a long path what is near the body, on a base that
   floats. */
struct cost {
	int constants;
	long flops;
};

extern const struct cost PATH_COST_UNKNOWN; /* more than any */

/* The path of one body, in a tree of its own. */
struct path {
	struct tree tree;
	struct restatement *by; /* of its bodies */
	int body;		/* in it */
	int floats;		/* it does not begin at the ground */
};

/* In `around`, which tree_restate_around made for this body. Returns 0 when memory runs out. */
int path_make(struct path *p, const struct tree *around, const struct restatement *by, int body, struct arena *a);

/* Of its body restated so. flops is LONG_MAX where there are more constants than *least has, and -1 when memory runs out. */
struct cost path_cost(const struct path *p, const struct restatement *by, const struct cost *least,
	const struct rneagen_allocator *allocator);

#endif
