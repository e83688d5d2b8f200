#ifndef RNEAGEN_SLICE_ROWS_H
#define RNEAGEN_SLICE_ROWS_H
/* What the files of emit_slices.h share: which rows slices have, and how these come and go. `s`: of a part; NULL: all rows. */

#include "emit/emit.h"

/* A stretch of an array's rows; whose place the array takes; rows in that place. */
struct stretch slice_stretch(const struct stretches *s, const struct dag *d, int argument, int k);
int slice_place(const struct stretches *s, const struct dag *d, int argument);
int slice_place_rows(const struct stretches *s, const struct dag *d, int argument);

/* ` + 3`, ` - 3`, or nothing. */
void slice_put_shift(int by, struct text *out);

/* Does it take from slices what a kernel before has found (plan/stretch.h)? */
int slice_takes_found(const struct stretches *s);

/* Lines that fetch slices, and that write them; that join the rows of a vjp before. */
const char *slice_moves_in(const struct emission *e, const struct stretches *s);
const char *slice_moves_out(const struct emission *e, const struct stretches *s);
const char *slice_join(const struct emission *e, const struct stretches *s);

#endif
