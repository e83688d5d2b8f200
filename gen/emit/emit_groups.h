#ifndef RNEAGEN_EMIT_GROUPS_H
#define RNEAGEN_EMIT_GROUPS_H
/* Batches of C functions, in groups of samples that compilers make vectors of. */

#include "emit/emit.h"

/* NAME_PASS_part, which computes samples first to end - 1 of a batch, and what it calls. */
void emit_groups(const struct emission *e, const struct function *p, struct text *out);

/* What moves samples into arrays of a group's own and back: once for all functions; nothing where none does. */
void emit_groups_moves(const struct emission *e, struct text *out);

/* Do groups have arrays [row][sample], in layout soa, or since samples are turned before? Then they take a count, which is the
   stride. And their arguments at sample k, with the stride. */
int emit_groups_have_rows(const struct emission *e, const struct function *p);
const char *emit_groups_at_sample(const struct emission *e, const struct function *p);

#endif
