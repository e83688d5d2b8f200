#ifndef RUNTIME_PROVE_SEEK_ERRORS_H
#define RUNTIME_PROVE_SEEK_ERRORS_H
/* The largest bounds of single states, as eval_bound has them, that a search over the box finds. */

#include "dag/eval.h"
#include "prove/prove.h"
#include "prove/states.h"

/* Into rows[output].error_found, one for each of `count` models: from two states that were `found` for each output, and
   from corners, uphill by one input at a time. A state's inputs are rounded to what the text's memory has. Returns 0
   when memory runs out. */
int seek_errors(struct prove_row *rows, const struct analysis *a, const struct box *b, const struct eval_model *models, int count,
	double *const (*found)[2], const struct effort *x, double seconds);

#endif
