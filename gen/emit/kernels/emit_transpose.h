#ifndef RNEAGEN_EMIT_TRANSPOSE_H
#define RNEAGEN_EMIT_TRANSPOSE_H
/* Outputs that are transposed at the end, in layout aos (plan/transposed.h); "" where a text has none. */

#include "emit/emit.h"
#include "plan/transposed.h"

/* Of the last kernel, where outputs are transposed; the macro that says how many samples it transposes at a time, before the
   kernels. */
struct transposed emit_transposed(const struct emission *e);
void emit_transpose_samples(const struct emission *e, struct text *out);

/* At the beginning of a kernel: moves each output to the thread's group of samples, and makes `count`, the stride, the number of
   samples in it. */
const char *emit_transpose_begin(const struct emission *e);

/* The last kernel; its launch, behind those of the others. */
void emit_transpose(const struct emission *e, struct text *out);
const char *emit_launch_transpose(const struct emission *e);

/* How the function begins that launches the others; where it is not the last one, NULL. */
const char *emit_launch_others(const struct emission *e);

/* Its line of the table for librnea. */
void emit_info_transpose(const struct emission *e, struct text *out);

#endif
