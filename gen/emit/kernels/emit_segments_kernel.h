#ifndef RNEAGEN_EMIT_SEGMENTS_KERNEL_H
#define RNEAGEN_EMIT_SEGMENTS_KERNEL_H
/* Kernels in segments. */

#include "emit/emit.h"

void emit_segments_kernel(const struct emission *e, const struct function *p, struct text *out);

#endif
