#ifndef RNEAGEN_EMIT_WAY_BACK_H
#define RNEAGEN_EMIT_WAY_BACK_H
/* Loops over coordinates on their way back to the base (dynamics/recursion/recursion_loops.c). */

#include "emit/emit.h"

/* Is it their array? All samples of a block have it side by side. */
static inline int emit_is_carried(const struct dag *d, int argument)
{
	return dag_loops_go_back(d) && argument == d->rooms[0].argument;
}

/* The array, of one sample or of a block. */
void emit_way_declaration(const struct emission *e, const struct function *p, struct text *out);
void emit_way_many_declaration(const struct emission *e, const struct function *p, struct text *out);

/* What the loops' calls need, behind the last loop; and the calls, for one sample, and for a block of them. */
void emit_way_functions(const struct emission *e, const struct function *p, struct text *out);
void emit_way_calls(const struct emission *e, const struct function *p, int loop, struct text *out);
void emit_way_many_calls(const struct emission *e, const struct function *p, int loop, struct text *out);

#endif
