#ifndef RNEAGEN_EMIT_ALONE_H
#define RNEAGEN_EMIT_ALONE_H
/* Kernels of large batches, one for each part or for the whole. */

#include "emit/emit.h"

/* Kernels of large batches, where there are any (plan/kernels.h): whether the one there is has the whole, their names, themselves,
   with a guard of all that follows, and their launch. */
#define EMIT_UNLESS_ALONE "#if !defined RNEA_ONLY_PART_KERNELS\n"
int emit_alone_is_whole(const struct emission *e);
const char *emit_alone_name(const struct emission *e, int part);
void emit_alone_kernel(const struct emission *e, int part, struct text *out);
void emit_alone(const struct emission *e, struct text *out);
const char *emit_launch_alone(const struct emission *e);

#endif
