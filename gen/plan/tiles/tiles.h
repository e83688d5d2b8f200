#ifndef RNEAGEN_TILES_H
#define RNEAGEN_TILES_H
/* Rows of a block's samples that come to shared memory, and leave it, as tiles: a copy engine moves some rows of an array at once, by a
   tensor map. Kernels of large batches have them, one for each part of a text, in layout soa. */

#include "plan/grid/parts.h"

/* Tensor maps of a launch at most, of 128 bytes each: a kernel may have 4096 bytes of parameters. */
enum { TILES_LIMIT = 28 };

/* Compute capability of the first devices with such an engine, ten times. */
enum { TILES_ARCH = 90 };

/* Set `tiles` of the passes that serve: of the first function, or of its parts, `count` of them. Not for a relay. Errors:
   MEMORY. */
enum rneagen_code tiles_choose(struct pass *whole, struct part *parts, int count, const struct parts_of *x, struct arena *a,
	struct rneagen_error *e);

/* Words of shared memory of a sample. */
int tiles_words(const struct pass *p, const struct rneagen_options *o);

/* Threads of a block where a sample takes so many bytes; 0: there is no room. */
int tiles_block(int bytes);

/* Are the rows of inputs alone there, so that they have a stride of their own? */
int tiles_are_inputs(const struct pass *p);

/* The rows that the slices of a pass have, those of a part that shares nothing with others, or of tiles of inputs; NULL: of all. */
const struct stretches *tiles_rows(const struct pass *p);

#endif
