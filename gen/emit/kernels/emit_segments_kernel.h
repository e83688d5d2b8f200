#ifndef RNEAGEN_EMIT_SEGMENTS_KERNEL_H
#define RNEAGEN_EMIT_SEGMENTS_KERNEL_H
/* Kernels in segments. */

#include "emit/emit.h"

/* Bytes that a sample keeps across cuts, at least those of a number; samples that a thread takes at most; threads of a block, so
   that each has room for two. */
int emit_segments_bytes(const struct emission *e, const struct function *p);
int emit_segments_samples(const struct emission *e);
int emit_segments_block(const struct emission *e, const struct function *p);
void emit_segments_kernel(const struct emission *e, const struct function *p, struct text *out);

#endif
