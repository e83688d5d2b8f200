#ifndef RNEAGEN_EMIT_BLOCKS_H
#define RNEAGEN_EMIT_BLOCKS_H
/* What the main kernel takes of a multiprocessor. */

#include "emit/emit.h"

/* What the main kernel takes of a multiprocessor. Threads of a block; blocks that have room, an expression of RNEA_BLOCK. */
int emit_block_size(const struct emission *e);
const char *emit_min_blocks(const struct emission *e);

/* Is its slice fetched into shared memory first? Words and bytes of a sample there, and words from one sample's rows to the next
   one's. */
int emit_is_staged(const struct emission *e);
int emit_stage_words(const struct emission *e);
/* Words of a sample in the slices of a relay's first kernel; 0: it reads the arrays themselves. */
int emit_start_words(const struct emission *e);
int emit_slice_bytes(const struct emission *e);
int emit_pitch(const struct emission *e, int rows);

/* The windows through which its outputs leave, their slots 0 where there are none; bytes of one. */
const struct windows *emit_windows(const struct emission *e);
int emit_window_bytes(const struct emission *e);

/* Are its inputs asked for in advance? Has it more values at once than registers, so that it spills to shared memory? Does a
   sample's first run stand unless an angle turns out to be large? Not where that run fills the registers. */
int emit_is_prefetched(const struct emission *e);
int emit_is_full(const struct emission *e);
int emit_is_optimistic(const struct emission *e);

#endif
