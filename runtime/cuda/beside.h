#ifndef RNEA_BESIDE_H
#define RNEA_BESIDE_H
/* Kernels of a text in a program of their own, which is compiled beside the others, by a thread, unless it was kept. */

#include "cuda/compile/image.h"
#include "cuda/device.h"
#include <pthread.h>

struct beside {
	struct image_request request; /* its source is NULL where there is none */
	struct image image;
	char *key;
	size_t key_length;
	pthread_t thread;
	int has_thread, cached;
};

/* Begin, where the text has kernels of such a share; *r, and what it points to, must live until beside_end. Their blocks are the
   text's. Returns whether it has. */
int beside_begin(struct beside *b, const struct image_request *r, enum image_share share);

/* Wait for it, and load it: the module, or NULL. The context must be current. */
void *beside_load(struct beside *b, const struct device *d);

/* Wait for it, and free what it took. */
void beside_end(struct beside *b);

#endif
