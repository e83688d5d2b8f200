#ifndef RNEA_COMPILATION_H
#define RNEA_COMPILATION_H
/* Which of several compilations of one text to keep. */

#include <stddef.h>

/* What the device made of the rnea kernel in one of them. */
struct compilation {
	unsigned block;	     /* samples per block; 0: what the text says */
	unsigned min_blocks; /* the launch bound; 0: none */
	size_t spilled_bytes; /* per thread: local memory beyond the text's own */
	unsigned resident;   /* samples that one multiprocessor holds at once, in such blocks */
};

/* The index of the best of `count` compilations, at least one. Among those of one block size that is the one that
   spills least, the first of equals; among block sizes the one with the most resident samples, then `own`, the text's,
   then the largest. */
size_t compilation_best(const struct compilation *tried, size_t count, unsigned own);

#endif
