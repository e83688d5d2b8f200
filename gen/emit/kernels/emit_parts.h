#ifndef RNEAGEN_EMIT_PARTS_H
#define RNEAGEN_EMIT_PARTS_H
/* The parts of a grid as one body, and the kernels of hands. */

#include "emit/emit.h"

/* What a grid has along y, after a comma; "" where it has no parts. */
const char *emit_along(const struct emission *e, int parts);

/* The body that calls the parts'; one call in it, with its own arguments and `more` after the stride. */
void emit_dispatcher(const struct emission *e, struct text *out);
void emit_put_sample_call(
	const struct emission *e, const struct function *p, const char *function, const char *more, struct text *out);

/* Parameters of the body of a part that come after the stride, each after a comma, and what a call gives for them: the stride of
   inputs, how many rows are left out of its slices, how much further a vjp goes on from one place to the next, and where hands
   have left something, with the stride there. The second of these alone. Launches the kernels of the hands. */
const char *emit_more_params(const struct emission *e, const struct function *p);
const char *emit_more(const struct emission *e, const struct function *p, int is_staged, const char *inner, const char *handed);
const char *emit_gap(const struct emission *e, const struct function *p, int is_staged);
const char *emit_launch_hands(const struct emission *e);

/* Does it read qdd and mu in two arrays (plan/stretch.h)? What it is given for what a kernel before has handed on, `at` being
   where the last array begins. */
int emit_takes_found(const struct function *p);
const char *emit_handed(const struct emission *e, const struct function *p, const char *at, const char *step);

#endif
