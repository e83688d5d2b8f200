#ifndef RNEAGEN_EMIT_GROUPS_H
#define RNEAGEN_EMIT_GROUPS_H
/* Batches of C functions, in groups of samples that compilers make vectors of. */

#include "emit/emit.h"

/* NAME_FUNCTION_part, which computes samples first to end - 1 of a batch, and what it calls. */
void emit_groups(const struct emission *e, const struct function *p, struct text *out);

/* What moves samples into arrays of a group's own and back: once for all functions; nothing where none does. */
void emit_groups_moves(const struct emission *e, struct text *out);

/* The layout of the arrays that a group gets: the text's, or soa where samples are turned before. */
enum rneagen_layout emit_groups_layout(const struct emission *e, const struct function *p);

#endif
