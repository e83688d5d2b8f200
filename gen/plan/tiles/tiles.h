#ifndef RNEAGEN_TILES_H
#define RNEAGEN_TILES_H
/* Rows of a block's samples that come to shared memory, and leave it, as tiles: a copy engine moves some rows of an array at
   once, by a tensor map. Kernels of large batches have them, one for each part of a text, in layout soa. */

#include "plan/grid/parts.h"

/* Operations of a text in parts of matrices beyond which it has kernels of large batches. */
enum { TILES_COLUMNS = 11000 };

/* Tensor maps of a launch at most, of 128 bytes each: a kernel may have 4096 bytes of parameters. */
enum { TILES_LIMIT = 28 };

/* The maps of some functions: one for so many rows of an argument. */
struct tiles {
	struct {
		int argument, rows;
	} list[TILES_LIMIT];
	int count;
};

/* With those of a function. Returns 0 where there is no room for them. */
int tiles_add(struct tiles *t, const struct function *p);

/* Which one it is; t->count: none. */
int tiles_find(const struct tiles *t, int argument, int rows);

/* Compute capability of the first devices with such an engine, ten times. */
enum { TILES_ARCH = 90 };

/* Set `tiles` of the functions that serve: of the first function, or of its parts, `count` of them. Not for a relay. Errors:
   MEMORY. */
enum rneagen_code tiles_choose(struct function *whole, struct part *parts, int count, const struct parts_of *x, struct arena *a,
	struct rneagen_error *e);

/* Words of shared memory of a sample. */
int tiles_words(const struct function *p, const struct rneagen_options *o);

/* Threads of a block where a sample takes so many bytes; 0: there is no room. */
int tiles_block(int bytes);

/* Are the rows of inputs alone there, so that they have a stride of their own? */
int tiles_are_inputs(const struct function *p);

/* Are the rows of q that it has in slices in two stretches, with a gap between them? */
int tiles_divide_q(const struct function *p);

/* The rows that the slices of a function have, those of a part that shares nothing with others, or of tiles of inputs; NULL: of
   all. */
const struct stretches *tiles_rows(const struct function *p);

#endif
