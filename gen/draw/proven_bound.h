#ifndef RNEAGEN_PROVEN_BOUND_H
#define RNEAGEN_PROVEN_BOUND_H
/* How large values of a DAG, and derivatives of its outputs by them, are at most while its inputs are within their ranges. */

#include "draw/draw.h"
#include "norms/interval.h"

struct dropping {
	const struct dag *d;
	const struct tree *t;
	const struct request *k;
	struct arena *a; /* for what goes again */
	struct rneagen_error *e;
	struct drawn inputs;
	struct interval *rows[DAG_ARGUMENTS]; /* of inputs that are read */
	uint32_t *uses;
	char *kept;     /* by node: all its terms stay */
	double *size;   /* by node: no magnitude is larger */
	double **slope; /* by output, then by node up to the output's: of derivatives none is larger; NULL: it is constant */
	double *scale;  /* by output: the largest magnitude in the samples */
};

/* Fill all but a, d, t, k and e. Errors: as proven_find. */
enum rneagen_code proven_bound(struct dropping *p);

#endif
