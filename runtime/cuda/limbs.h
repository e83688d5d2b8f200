#ifndef RNEA_LIMBS_H
#define RNEA_LIMBS_H
/* The kernels of small batches, the first function's and that of its relay: a program of their own, compiled beside the other
   kernels. A robot without it runs all the same: what fails here is no failure of its opening, and the info then tells of no such
   kernels. */

#include "cuda/beside.h"

/* Samples of a group: a warp has one on each lane. */
enum { LIMBS_LANES = 32 };

struct limbs_kernel {
	struct device_kernel one, all; /* the same kernel, given shared memory for one group of samples, and for all of a block */
	struct rnea_limbs info;
};

struct limbs {
	void *module; /* NULL: there is none */
	struct limbs_kernel own, start;
};

/* Wait for the program, load it, and find what *info says of it; where that fails, *info says no more. The context must be
   current. */
void limbs_load(struct limbs *l, struct beside *b, const struct device *d, struct rnea_info *info);

/* Launch one of them. Without samples it does nothing. */
enum rnea_code limbs_launch(const struct limbs_kernel *l, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e);

#endif
