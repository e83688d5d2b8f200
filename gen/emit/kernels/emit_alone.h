#ifndef RNEAGEN_EMIT_ALONE_H
#define RNEAGEN_EMIT_ALONE_H
/* Kernels of large batches, one for each part or for the whole. */

#include "emit/emit.h"

/* Kernels of large batches, one for each part or for the whole (emit_alone.c): from how many samples on a launch takes them (0:
   there are none), whether they pay without tiles, whether the one there is has the whole, their names and threads, themselves,
   with a guard of all that follows, and their launch. */
#define EMIT_UNLESS_ALONE "#if !defined RNEA_ONLY_PART_KERNELS\n"
int emit_alone_least(const struct emission *e);
int emit_serves_untiled(const struct emission *e);
int emit_alone_is_whole(const struct emission *e);
const char *emit_alone_name(const struct emission *e, int part);
int emit_alone_block(const struct emission *e);
void emit_alone_kernel(const struct emission *e, int part, struct text *out);
void emit_alone(const struct emission *e, struct text *out);
const char *emit_launch_alone(const struct emission *e);

#endif
