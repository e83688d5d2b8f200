#ifndef RNEAGEN_EMIT_FIRST_SINES_H
#define RNEAGEN_EMIT_FIRST_SINES_H
/* Sines of small batches that all threads of a block make before its warps part. */

#include "emit/emit.h"

/* A function by which the threads of a block make the sines that its warps read; a warp's parameter for them, and what the kernel
   hands the function. Nothing where each warp makes its own. */
void emit_put_table(const struct emission *e, const struct function *p, struct text *out);
const char *emit_table_param(const struct emission *e, const struct function *p);
const char *emit_table_arguments(const struct emission *e);

#endif
