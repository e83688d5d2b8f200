#ifndef RNEAGEN_EMIT_KERNEL_H
#define RNEAGEN_EMIT_KERNEL_H
/* The main kernel, what it stages and how it stores. */

#include "emit/emit.h"

/* Where a kernel may spill to shared memory, the line that says so. Kernels whose outputs leave through windows, and these. */
const char *emit_spill(const struct emission *e);
void emit_windowed(const struct emission *e, const struct function *p, struct text *out);
void emit_put_windows(const struct emission *e, struct text *out);

/* Blocks that a multiprocessor is to have room for, an expression of RNEA_BLOCK; "0": the compiler chooses. */
const char *emit_min_blocks(const struct emission *e);

/* How kernels are, in the text's head. */
void emit_kernels_head(const struct emission *e, struct text *out);

/* CUDA: all kernels, and the functions by which they stage their slices. */
void emit_kernels(const struct emission *e, struct text *out);
const char *emit_stage(const struct emission *e);

/* The function that tells a launch how many bytes of shared memory to give, and its call, "0" where nothing is staged; the bytes
   in which the kernel stages each thread's sample, 0: it does not. */
const char *emit_stage_launch(const struct emission *e);
const char *emit_given(const struct emission *e, const char *kernel);
int emit_stage_bytes(const struct emission *e);

/* Do the statements store by RNEA_STORE? May it be to shared memory? What that means, or RNEA_HOLD and RNEA_FLUSH where outputs
   leave through windows; else "". The calls of a function's flush. */
int emit_is_streamed(const struct emission *e);
int emit_stores_to_tiles(const struct emission *e);
const char *emit_store(const struct emission *e);
void emit_put_flush(const struct emission *e, const struct function *p, int flush, struct text *out);

#endif
