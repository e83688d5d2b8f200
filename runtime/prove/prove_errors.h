#ifndef RUNTIME_PROVE_ERRORS_H
#define RUNTIME_PROVE_ERRORS_H
/* How far rounding takes texts off, at most, for every state within the limits: bounds alone, for several kinds of arithmetic. */

#include "dag/eval_model.h"
#include "passes/analysis.h"

/* Into bounds[output of the DAG * count + model]: |text - exact|; INFINITY: none is known. The box is that of box_make,
   and what is refused is what prove refuses. Errors: USAGE, with the names of inputs that have no limit; UNSUPPORTED,
   LIMIT, MEMORY. */
enum rneagen_code prove_errors(double *bounds, const struct analysis *a, const struct eval_model *models, int count,
	unsigned threads, double seconds, struct rneagen_error *e);

#endif
