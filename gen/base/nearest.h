#ifndef RNEAGEN_NEAREST_H
#define RNEAGEN_NEAREST_H
/* What a misspelt name was meant to be. */

#include <stddef.h>

/* The name nearest to `word` among `count` entries of `stride` bytes that each begin with a `const char *` to one, by
   the number of letters to add, remove, change or swap (Damerau 1964; names are compared as far as 255 bytes); the first
   of several. NULL where none is within half of its length. */
const char *nearest_name(const char *word, const void *entries, size_t count, size_t stride);

#endif
