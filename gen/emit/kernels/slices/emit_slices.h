#ifndef RNEAGEN_EMIT_SLICES_H
#define RNEAGEN_EMIT_SLICES_H
/* Slices in shared memory. */

#include "emit/emit.h"

/* Where the slices of a staged kernel, or of its part's rows (NULL: all), `block` samples wide, begin, what the body is called
   with, and how rows come and go, and what comes between; their declaration. Does a vjp that stands in three slices leave as one?
   Does anything come or go as some rows of each sample, and does anything as whole samples? */
struct slices {
	const char *slices, *here, *pointers, *move_in, *move_out, *join;
};
int emit_is_joined(const struct emission *e);
int emit_moves_some(const struct emission *e);
int emit_moves_whole(const struct emission *e);
struct slices emit_slices(const struct emission *e, const struct stretches *s, const char *block);

/* Rows on from where the place of an argument begins, where its k-th stretch does, or a vjp's first row. */
int emit_slot(const struct stretches *s, const struct dag *d, int argument, int k);
int emit_divided_slot(const struct stretches *s);

/* Of so many words for each sample. */
const char *emit_slices_declaration(const struct emission *e, int words);

#endif
