#ifndef RNEAGEN_AGAIN_H
#define RNEAGEN_AGAIN_H
/* The motion of joints, made again where a vjp comes back to them. What the tour makes on its way out the way back takes in
   the other order, so that of a limb nearly all of it waits. Here each chain of joints is cut into stretches. What the way back
   takes in a stretch is made anew, from inputs that are read once more and from the motion where the chain begins, instead of
   being kept: checkpoints, as in Griewank and Walther, "Algorithm 799: revolve" (ACM Transactions on Mathematical Software 26,
   2000). Sines and cosines are kept. */

#include "plan/grid/parts.h"

/* A copy of a DAG whose outputs are rows of joints, with at most so many joints in a stretch, for lines that are ordered by
   rows, the last ones first (order.h). Rows of a joint stand after those of what carries it. Each value is the same, to the bit.
   In loops over limbs, by row, the row of the first limb that is alike; else NULL. Failure is in out->failed. */
void again_make(struct dag *out, const struct dag *d, const struct tree *t, int joints, const int *first_row, struct arena *a);

/* Do the rows of each joint stand after those of what carries it? */
int again_is_ordered(const struct tree *t);

/* Is it for this text: a vjp of torques? And does it serve parts of it: in f64? In f32 values have room there. */
int again_is_of(const struct parts_of *x);
int again_serves(const struct parts_of *x);

/* A function of its own of the share of an owner, its lines ordered, with stretches of the length that costs least: p->joints, or
   0 where all is kept. Returns 0 when memory runs out. */
int again_build(struct part *p, struct share *share, int owner, const char *name, const char *doc, const struct parts_of *x,
	struct arena *a);

#endif
