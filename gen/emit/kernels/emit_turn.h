#ifndef RNEAGEN_EMIT_TURN_H
#define RNEAGEN_EMIT_TURN_H
/* Outputs that are turned at the end, in layout aos (plan/turned.h); "" where a text has none. */

#include "emit/emit.h"
#include "plan/turned.h"

/* Of the last kernel, where outputs are turned; the macro that says how many samples it turns at a time, before the kernels. */
struct turned emit_turned(const struct emission *e);
void emit_turn_samples(const struct emission *e, struct text *out);

/* At the beginning of a kernel: moves each output to the thread's group of samples, and makes `count`, the stride, the number of
   samples in it. */
const char *emit_turn_begin(const struct emission *e);

/* The last kernel; its launch, behind those of the others. */
void emit_turn(const struct emission *e, struct text *out);
const char *emit_launch_turn(const struct emission *e);

/* How the function begins that launches the others; where it is not the last one, NULL. */
const char *emit_launch_unturned(const struct emission *e);

/* Its line of the table for librnea. */
void emit_info_turn(const struct emission *e, struct text *out);

#endif
