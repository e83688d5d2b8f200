#ifndef RNEAGEN_BESIDE_PARTS_H
#define RNEAGEN_BESIDE_PARTS_H
/* Small batches beside kernels in parts. */

#include "plan/grid/parts.h"

/* Up to how many samples limbs of the whole are launched; as they are where nothing is divided, or by columns. */
void limbs_beside(struct limbs *whole, const struct part *parts, int count, const struct rneagen_options *o);

#endif
