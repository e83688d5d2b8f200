#ifndef RNEAGEN_SEGMENT_ZEROS_H
#define RNEAGEN_SEGMENT_ZEROS_H
/* Elements that are always zero, of a C text's segment: with many of them, they are stored in loops, beside its lines. */

#include "emit/emit.h"

struct segment_zeros {
	const struct dag *dag;
	struct output *outputs; /* NULL when memory runs out */
	size_t count;           /* 0: they stand among the lines */
};

struct segment_zeros segment_zeros_of(const struct emission *e, const struct function *p, const struct plan *lines);

/* The loops over their rows and over lanes, after that of the lines. */
void segment_zeros_put(const struct emission *e, const struct function *p, const struct segment_zeros *z, struct text *out);

/* Within that of the lines: pointers to arrays of which nothing else may be stored are used. */
void segment_zeros_put_unused(const struct function *p, const struct segment_zeros *z, struct text *out);

#endif
