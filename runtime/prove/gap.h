#ifndef RUNTIME_PROVE_GAP_H
#define RUNTIME_PROVE_GAP_H
/* Why no error is bounded. */

#include "prove/coarse.h"

/* Of an output whose coarse error is INFINITY: the first of the values that it is made of which leaves the numbers of the arithmetic, or
   whose error is not known. */
struct prove_gap gap_find(const struct coarse *c, const struct dag *d, size_t output, int model, const struct eval_model *m, struct arena *a);

#endif
