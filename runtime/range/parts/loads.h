#ifndef RUNTIME_RANGE_PARTS_LOADS_H
#define RUNTIME_RANGE_PARTS_LOADS_H
/* What a limb adds to the force and moment of the body that carries it, in that body's frame: its load. Force and moment are
   affine in the wrenches w of the limbs, so
     F = F0 + sum over limbs of their load,  load = (dF/dw) w
   F0 what they are without limbs. A limb is a child of the carrier with all beyond it. */

#include "dag/dag.h"
#include "tree/tree.h"

enum { LOADS_WRENCH = 6, LOADS_LIMBS = 8 };

struct loads {
	int limb_count, total_count;
	int ends[LOADS_LIMBS];                         /* by limb: where the next one's wrench begins */
	uint32_t totals[LOADS_WRENCH];                 /* nodes: force and moment of the carrier */
	uint32_t wrenches[LOADS_LIMBS * LOADS_WRENCH]; /* nodes: of the limbs, one after the other */
	int wrench_count;
	unsigned char *of; /* by node: 1 + the limb of whose wrench it is made, LOADS_LIMBS + 1: of several; 0: of none */
};

/* Of limbs that are chosen, by body. Returns 0 when memory runs out, where force and moment are no such sums, or where not all
   six numbers of a limb's wrench have a name. */
int loads_find(struct loads *l, const struct dag *d, const struct tree *t, int carrier, const unsigned char *is_limb,
	struct arena *a);

/* Which of the totals a node is; -1: none. Is it a number of a limb's wrench? */
int loads_total(const struct loads *l, uint32_t node);
int loads_is_wrench(const struct loads *l, uint32_t node);

/* Do nodes that are marked in reads[] read wrenches through totals alone? More is marked then: all that they read. */
int loads_are_closed(const struct loads *l, const struct dag *d, unsigned char *reads);

/* The load of a limb, by total, in another DAG; map[] has what stands there for the nodes of this one. Returns 0 when memory runs
   out. */
int loads_put(struct ref load[LOADS_WRENCH], const struct loads *l, int limb, const struct dag *d, struct dag *out,
	const struct ref *map, struct arena *a);

#endif
