#ifndef RUNTIME_PROVE_ROUNDING_H
#define RUNTIME_PROVE_ROUNDING_H
/* How far rounding takes the outputs of a text off, at most, over the whole box. */

#include "range/grid.h"
#include "prove/prove.h"
#include "relax/relax.h"

/* The box of a relaxed text; it has no arrays of its own. */
struct box relaxed_box(const struct relaxed *r);

/* For states of the text's box `b`, into rows[output].error_bound, one for each of `count` models; INFINITY where none
   is known. Exact is as for eval_bound, and the bound holds for any text that computes the fused DAG in that
   arithmetic, whichever way its compiler joins products to sums. Returns 0 when memory runs out. */
int rounding_find(struct prove_row *rows, const struct relaxed *r, const struct box *b, const struct eval_model *models,
	int count, const struct effort *x, double seconds);

#endif
