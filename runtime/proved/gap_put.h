#ifndef RUNTIME_PROVED_GAP_PUT_H
#define RUNTIME_PROVED_GAP_PUT_H
/* Why no error is bounded, told. */

#include "proved/rows_put.h"

/* What of an output's text may leave the numbers of its precision, which body it is of, and which range to narrow: "the moment of
   link 'hand' may reach 3e+39, ...". Nothing where the error is bounded. */
void gap_put(const struct proved *x, size_t output, int precision, struct text *out);

#endif
