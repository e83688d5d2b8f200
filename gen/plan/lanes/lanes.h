#ifndef RNEAGEN_LANES_H
#define RNEAGEN_LANES_H
/* One sample on a processor, in lanes of vectors: limbs that are alike (tree/alike.h), four or two, or four coordinates on their
   way back to the base (dynamics/recursion/recursion_lanes.c). Such numbers are wide. */

#include "plan/segments.h"
#include "tree/alike.h"

_Static_assert((int)ALIKE_LIMBS == (int)DAG_LANES, "a limb for each lane");

/* What is made of the same operations in each limb becomes one operation on lanes. `d` is of the tree `t` that tells the limbs'
   constants apart, not fused, and has the width of a group (twins.c). */
void lanes_of_twins(struct dag *out, const struct dag *d, const struct tree *t, const struct alike *limbs);

/* Make p->single, p->many and p->beside: what a call of one sample, and batches, run instead (segments.h), and what a call runs
   in lanes, where that saves operations, and nothing promises the call's bits (beside.c). Returns 0 when memory runs out. */
int lanes_single(struct function *p, const struct request *k, const struct rneagen_options *o, int is_header, struct arena *a);

#endif
