#ifndef TESTS_HARD_WORST_H
#define TESTS_HARD_WORST_H
/* The arithmetic of a model at its worst: every operation is off by as much as the model allows, with signs by chance. */

#include "dag/dag.h"
#include "dag/eval_model.h"
#include "support/rng.h"

/* in[k] are the rows of argument k, out[k] those of an output. */
void worst_evaluate(const struct dag *d, const struct eval_model *m, struct rng *rng, const double *const *in,
	double *const *out);

#endif
