#ifndef RNEAGEN_EMIT_RELAY_H
#define RNEAGEN_EMIT_RELAY_H
/* A relay: gradients of qdd by three kernels, one after the other (plan/grid/relay.h). */

#include "emit/emit.h"

/* A relay's kernels but the second; what they do where the text is compiled as C, before the second and after; how its launch
   function begins, or that of the one kernel, and the launch of all; bytes of shared memory of a block of the third. */
void emit_relay_solve(const struct emission *e, struct text *out);
void emit_relay_before(const struct emission *e, struct text *out);
void emit_relay_after(const struct emission *e, struct text *out);
const char *emit_launch_head(const struct emission *e);
const char *emit_launch_relay(const struct emission *e);
int emit_relay_bytes(const struct emission *e);

/* Is it the first kernel's, or of a part of it? */
int emit_is_start(const struct emission *e, const struct function *p);

#endif
