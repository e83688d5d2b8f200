#ifndef RNEA_LIMBS_H
#define RNEA_LIMBS_H
/* The kernels of small batches, the first function's and that of its relay: a program of their own, compiled beside the other
   kernels. A robot without it runs all the same: what fails here is no failure of its opening, and the info then tells of no such
   kernels. */

#include "cuda/device.h"
#include "cuda/image.h"
#include <pthread.h>

/* Samples of a group: a warp has one on each lane. */
enum { LIMBS_LANES = 32 };

/* On its way: compiled by a thread, unless it was kept. */
struct limbs_build {
	struct image_request request;
	struct image image;
	char *key;
	size_t key_length;
	pthread_t thread;
	int has_thread, cached;
};

struct limbs_kernel {
	struct device_kernel one, all; /* the same kernel, given shared memory for one group of samples, and for all of a block */
	struct rnea_limbs info;
};

struct limbs {
	void *module; /* NULL: there is none */
	struct limbs_kernel own, start;
};

/* Begin, where the text has such a kernel; *r, and what it points to, must live until limbs_end. Returns whether it has. */
int limbs_begin(struct limbs_build *b, const struct image_request *r);

/* Wait for it, load it, and find what *info says of it; where that fails, *info says no more. The context must be current. */
void limbs_load(struct limbs *l, struct limbs_build *b, const struct device *d, struct rnea_info *info);

/* Launch one of them. Without samples it does nothing. */
enum rnea_code limbs_launch(const struct limbs_kernel *l, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e);

/* Wait for it, and free what it took. */
void limbs_end(struct limbs_build *b);

#endif
