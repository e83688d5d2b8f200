#ifndef RNEAGEN_SLICE_ROWS_H
#define RNEAGEN_SLICE_ROWS_H
/* What the files of emit_slices.h share: which rows slices have, and how these come and go. `s`: of a part; NULL: all rows. */

#include "emit/emit.h"

/* A stretch of an array's rows; whose place the array takes; rows in that place. */
struct stretch slice_stretch(const struct stretches *s, const struct dag *d, int argument, int k);
int slice_place(const struct stretches *s, const struct dag *d, int argument);
int slice_place_rows(const struct stretches *s, const struct dag *d, int argument);

const struct dag *slice_arguments(const struct emission *e);

/* ` + 3`, ` - 3`, or nothing. */
void slice_put_shift(int by, struct text *out);

/* What a kernel before has found, qdd and mu (plan/stretch.h): is it taken from slices? Whose place each takes, and the row of the vjp
   that it begins with. */
enum { SLICE_FOUND = 2 };
int slice_takes_found(const struct stretches *s);
int slice_found_place(const struct dag *d, int k);
int slice_found_row(const struct stretches *s, int k);

/* Lines that fetch slices, and that write them; that join the rows of a vjp before. */
const char *slice_moves_in(const struct emission *e, const struct stretches *s);
const char *slice_moves_out(const struct emission *e, const struct stretches *s);
const char *slice_join(const struct emission *e, const struct stretches *s);

#endif
