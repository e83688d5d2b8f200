#ifndef RNEA_IMAGE_H
#define RNEA_IMAGE_H
/* An image of a CUDA text for one device: compiled, or kept from before. */

#include "cache/cache.h"
#include "cuda/compile/jit.h"
#include "core/source.h"

/* Which kernels of the text: all, or all but those that have programs of their own; the kernels of small batches;
   those of parts. */
enum image_share { IMAGE_ALL, IMAGE_MAIN, IMAGE_LIMBS, IMAGE_ALONE };

struct image_request {
	const struct source *source;
	enum image_share share;
	const char *file;	    /* what messages call it */
	const char *const *options; /* further options for NVRTC, option_count of them */
	size_t option_count;
	unsigned block; /* as in struct rnea_options */
	int arch;	/* of the device: 90 is sm_90 */
	const struct cache *cache;
	struct cache_why *unkept; /* receives why what is compiled is not kept; may be NULL */
	char *log; /* as in struct rnea_options */
	size_t log_size;
};

struct image {
	struct jit_image code;
	unsigned block;	     /* samples per block it was compiled for; 0: what the text says */
	unsigned min_blocks; /* the launch bound of the rnea kernel; 0: none */
};

/* The launch bound that the text, or an option of the caller's, gives to the rnea kernel in blocks of `block` threads, 0: the
   text's own. */
unsigned image_bound(const struct image_request *r, unsigned block);

/* Whether an option of the caller's speaks of that bound, which is then not ours to change. */
int image_is_bound(const struct image_request *r);

/* Whether the text has kernels of such a share that no option of the caller's leaves out. */
int image_has(const struct image_request *r, enum image_share share);

/* Compile for blocks of `block` threads (0: the text's own), without the launch bound if `unbounded`. On failure *i is
   empty. Errors: those of jit_compile. */
enum rnea_code image_compile(
	const struct image_request *r, unsigned block, int unbounded, struct image *i, struct rnea_error *e);

/* The bytes that the image of a request depends on, whatever is tried to come to it (malloc, *length of them), or NULL
   where nothing can be kept. */
char *image_key(const struct image_request *r, size_t *length);

/* The image that was kept under a key, which may be NULL: 1, or 0 and *i empty. */
int image_get(const struct cache *c, const char *key, size_t length, struct image *i);

/* The same, unless another NVRTC than the one that `key` tells of turns out to have made the image. */
void image_keep(const struct image_request *r, const char *key, size_t length, const struct image *i);

void image_free(struct image *i);

#endif
