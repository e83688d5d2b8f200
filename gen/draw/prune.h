#ifndef RNEAGEN_PRUNE_H
#define RNEAGEN_PRUNE_H
/* Terms of sums that no output feels: what --drop-below leaves out. */

#include "dag/dag.h"
#include "request/request.h"

/* A copy of `d`, not fused yet, with all its arguments, without the operands of sums and differences of which no output feels
   this fraction (felt.h). Many small terms may add up: effect_measure says to what. out->failed is set when memory runs
   out. */
void prune_terms(struct dag *out, const struct dag *d, const struct tree *t, const struct request *k, double fraction);

#endif
