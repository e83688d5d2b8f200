#ifndef RNEA_MACROS_H
#define RNEA_MACROS_H
/* The macros by which a CUDA text states its launch. */

#include "core/source.h"

/* The number of the line "#define MACRO number", or 0 where the text has no such line; of threads or blocks 0 where it
   is more than a block can have. */
size_t macro_number(const struct source *s, const char *macro);
unsigned macro_value(const struct source *s, const char *macro);

/* What the text gives RNEA_MIN_BLOCKS in blocks of `block` threads, 0: its own: a number, or "(RNEA_BLOCK < 64 ? 0 :
   768/RNEA_BLOCK)". */
unsigned macro_min_blocks(const struct source *s, unsigned block);

#endif
