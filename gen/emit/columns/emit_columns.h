#ifndef RNEAGEN_EMIT_COLUMNS_H
#define RNEAGEN_EMIT_COLUMNS_H
/* Segments that are loops: over columns of derivatives, or over coordinates on their way back to the base. */

#include "emit/emit.h"

struct writer;

/* Is this segment a loop? Its functions, and their calls for one sample, and for some of a batch. */
int emit_is_loop(const struct function *p, int segment);
void emit_columns(const struct emission *e, const struct function *p, int segment, struct writer *w, struct text *spare,
	struct text *out);
void emit_columns_calls(const struct emission *e, const struct function *p, int segment, struct text *out);
void emit_columns_many_calls(const struct emission *e, const struct function *p, int segment, struct text *out);

/* Batches that run such loops: what stores the elements that are always zero, and the calls. */
void emit_zeros_many(const struct emission *e, const struct function *p, struct text *out);
void emit_zeros_many_calls(const struct emission *e, const struct function *p, struct text *out);

/* What such loops are written with. Their arrays, for one sample, and, beside what goes across cuts, for a block of samples;
   nothing where there are none. */
void emit_columns_macros(const struct emission *e, struct text *out);
const char *emit_columns_declaration(const struct emission *e, const struct function *p);
const char *emit_columns_many_declarations(const struct emission *e, const struct function *p);

/* A row of an array, as an address; `step`: from a row to the next, "" where it is 1. */
void emit_put_address(const char *array, int row, const char *step, struct text *out);

#endif
