#ifndef RNEA_CHOOSE_H
#define RNEA_CHOOSE_H
/* Which of several compilations of one text to keep. */

#include <stddef.h>

/* What the device made of the rnea kernel in one of them. */
struct choice {
	unsigned block;	     /* threads per block; 0: what the text says */
	unsigned min_blocks; /* the launch bound; 0: none */
	size_t local_bytes;  /* per thread: stack and spilled registers */
	unsigned resident;   /* threads that one multiprocessor holds at once, in such blocks */
};

/* The index of the best of `count` choices, at least one. Among those of one block size that is the one with the least
   local memory, the first of equals; among block sizes the one with the most resident threads, then `own`, the text's,
   then the largest. */
size_t choose_best(const struct choice *choices, size_t count, unsigned own);

#endif
