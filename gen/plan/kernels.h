#ifndef RNEAGEN_KERNELS_H
#define RNEAGEN_KERNELS_H
/* What kernels take of a multiprocessor: threads of a block, room for registers, shared memory; and from how many samples on each
   part of a text has a kernel of its own. */

#include "plan/grid/relay.h"

/* Of the main kernel, if nothing else is said. Bytes and words are of one sample. */
struct kernels {
	int block;          /* threads of a block */
	int blocks;         /* of them, a multiprocessor is to have room for so many; 0: the compiler chooses */
	int is_full;        /* more values wait than registers hold: they spill to shared memory, not to the stack */
	int is_optimistic;  /* angles are taken for small ones, and a sample is computed again if one was not; else a test comes first */
	int is_prefetched;  /* inputs are asked for in advance */
	int is_staged;      /* a block fetches its slice of all arrays to shared memory first */
	int slice_words, slice_bytes; /* of such a slice; of parts that share nothing, the largest one's */
	int start_words;    /* of a slice of a relay's first kernel; 0: it reads the arrays themselves */
	int window_bytes;   /* of a warp, the window through which outputs leave (stage.h); 0: there is none */
	int segment_bytes;  /* what a sample keeps across cuts; 0: the kernel has no segments */
	int alone_least;    /* from so many samples on, each part, or the whole, has a kernel of its own; 0: it never has */
	int alone_block;    /* threads of a block there */
	int has_columns;    /* parts have the elements of matrices, and write as in soa: else, in aos, outputs leave through windows */
	int has_tiles;      /* those move tiles (tiles/tiles.h) */
	int serves_untiled; /* and pay without a copy engine, too */
};

/* A text's kernels: of the whole of `x`, or its parts, `count` of them; or of a relay, whose second kernel has these.
   The options are those that kernels are written by (transposed_options). Where memory runs out, a->failed is set. */
struct kernels kernels_choose(
	const struct parts_of *x, const struct part *parts, int count, const struct relay *relay, struct arena *a);

/* Samples that a thread takes at most in a kernel in segments. */
int kernels_segment_samples(const struct rneagen_options *o);

/* That of a function which is no algorithm, and has nothing in shared memory. */
struct kernels kernels_plain(const struct rneagen_options *o);

/* A line for each that is not 0. */
void kernels_dump(const struct kernels *s, struct text *out);

#endif
