#ifndef RNEAGEN_PRUNE_H
#define RNEAGEN_PRUNE_H
/* Terms of sums that no output feels: what --drop-below leaves out. */

#include "draw/proven.h"

/* A copy of `d`, not fused yet, with all its arguments, without the operands of sums and differences of which no output feels
   this fraction: `is_sampled`, of each alone in drawn samples (felt.h); many small terms may add up: effect_measure says to what.
   Else of all together, in every state within the ranges (proven.h); *told says to what they add up. Errors: as proven_find. */
enum rneagen_code prune_terms(struct dag *out, struct proven *told, const struct dag *d, const struct tree *t,
	const struct request *k, double fraction, int is_sampled, struct rneagen_error *e);

#endif
