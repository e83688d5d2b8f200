#ifndef RUNTIME_PROVE_COARSE_H
#define RUNTIME_PROVE_COARSE_H
/* A first bound of every error of a text, by plain intervals: far off, but there at once. */

#include "prove/prove.h"
#include "dag/eval_model.h"

struct coarse {
	double *size;                        /* by node of the DAG: no magnitude is larger */
	double *running[PROVE_PRECISIONS];   /* by model and node: no error is; INFINITY: none is known */
	struct prove_gap *gaps[PROVE_PRECISIONS]; /* by model and node: why none is known */
};

/* Over the box. Arrays live in `a`. Returns 0 when memory runs out. */
int coarse_find(struct coarse *c, const struct dag *d, const struct box *b, const struct eval_model *models, int count,
	struct arena *a);

/* The error of an output as it is stored; into *gap why none is known. */
double coarse_output(const struct coarse *c, const struct dag *d, size_t output, int model, const struct eval_model *m,
	struct prove_gap *gap);

/* What memory makes of a result of at most this magnitude with this error. */
double coarse_stored(const struct eval_model *m, double size, double error);

#endif
