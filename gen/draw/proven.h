#ifndef RNEAGEN_PROVEN_H
#define RNEAGEN_PROVEN_H
/* Which terms of sums may be left out together, whatever the inputs are within their ranges: proved by bounds over all of
   them. */

#include "dag/dag.h"
#include "request/request.h"

/* Without the terms no output is further off than this, in any state within the ranges; as a part of the largest magnitude that
   the output has in the samples of FELT_SAMPLES. In exact arithmetic. */
struct proven {
	double change, share;
};

/* As felt_find, but for all states within the ranges: all that is left out together changes each output by at most this fraction
   of its largest magnitude in the samples. In memory of `a`. NULL on failure. Errors: SCENE, with the names of all inputs that
   have neither a limit nor a range; LIMIT; MEMORY. */
unsigned char *proven_find(struct proven *told, const struct dag *d, const struct tree *t, const struct request *k,
	double fraction, struct arena *a, struct rneagen_error *e);

#endif
