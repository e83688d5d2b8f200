#ifndef RNEAGEN_NEAREST_H
#define RNEAGEN_NEAREST_H
/* What a misspelt name was meant to be. */

#include <stddef.h>

/* The name that `word` was meant to be, among `count` entries of `stride` bytes that each begin with a `const char *` to one: the
   nearest by the number of letters to add, remove, change or swap (Damerau 1964; names are compared as far as 255 bytes), the
   first of several, if that is within a quarter of its length; or one that the word is a part of, or is part of the word; or the
   nearest within half of its length. NULL where there is none. */
const char *nearest_name(const char *word, const void *entries, size_t count, size_t stride);

#endif
