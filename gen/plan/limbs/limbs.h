#ifndef RNEAGEN_LIMBS_H
#define RNEAGEN_LIMBS_H
/* A plan shared out among warps that compute the same samples side by side: limbs first, then what joins them. */

#include "plan/plan.h"
#include "rneagen.h"

/* Each value beyond `values` that a warp has at once waits in memory, at the cost of so many operations. */
struct limbs_spill {
	unsigned values, operations;
};

static inline unsigned limbs_spilled(const struct limbs_spill *x, int alive)
{
	return (unsigned)alive > x->values ? ((unsigned)alive - x->values) * x->operations : 0;
}

struct limbs_limits {
	int warps;         /* that share a sample */
	unsigned across;   /* values in shared memory at most, beside a table of sines */
	unsigned join;     /* what it costs to wait for all warps, in operations */
	struct limbs_spill spill;
	int has_first_sines; /* if all angles are made of one input each */
};

/* Share out the plan so that the longest warp is short, where that takes less than the whole by a tenth; s->warps is 0
   where it does not. Inputs are read, and cheap values made, by each warp that takes them; what one makes in a phase
   and another takes in a later one goes across in a slot of memory. Returns 0 when memory runs out. */
int limbs_make(struct limbs *s, const struct plan *p, const struct limbs_limits *limits, struct arena *a);

/* Of all lines. */
unsigned limbs_operations(const struct plan *p, struct arena *a);

/* A line for each warp and phase of the function. */
void limbs_dump(const struct function *p, struct text *out);

#endif
