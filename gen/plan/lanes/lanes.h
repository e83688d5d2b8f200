#ifndef RNEAGEN_LANES_H
#define RNEAGEN_LANES_H
/* One sample on a processor, in lanes of vectors: limbs that are alike (tree/alike.h), or coordinates on their way back to the
   base (dynamics/recursion/recursion_lanes.c). Such numbers are wide. */

#include "plan/segments.h"
#include "tree/alike.h"

_Static_assert((int)ALIKE_LIMBS == (int)DAG_LANES, "a limb for each lane");

/* What is made of the same operations in each limb becomes one operation on lanes. `d` is of the tree that tells the limbs'
   constants apart, and not fused (twins.c). */
void lanes_of_twins(struct dag *out, const struct dag *d, const struct alike *limbs);

/* Make p->single and p->beside for a pass in segments: what a call of one sample runs instead (segments_single), and that in
   lanes, where that saves operations, and nothing promises the call's bits (beside.c). Returns 0 when memory runs out. */
int lanes_single(struct pass *p, const struct request *k, const struct rneagen_options *o, struct arena *a);

#endif
