#ifndef RNEAGEN_FOUND_LIMBS_H
#define RNEAGEN_FOUND_LIMBS_H
/* Small batches of what found.h divides: two kernels whose warps share out each sample (plan/limbs), of what is found and of the
   rest, one after the other. */

#include "plan/grid/parts.h"

enum { FOUND_START, FOUND_REST, FOUND_ROUNDS };

/* FOUND_ROUNDS functions with their limbs, beside parts of found.h; NULL where one of them has none. Returns 0 when memory
   runs out. */
int found_limbs_make(struct part **rounds, const struct part *parts, int count, const struct parts_of *x, struct arena *a);

/* Up to how many samples limbs of the whole are launched, where no round has its own. */
void found_limbs_beside(struct limbs *whole, const struct part *parts, int count, const struct rneagen_options *o);

#endif
