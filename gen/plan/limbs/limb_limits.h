#ifndef RNEAGEN_LIMB_LIMITS_H
#define RNEAGEN_LIMB_LIMITS_H
/* Whether small batches have a kernel of their own, with how many warps, and up to which batch it is launched. */

#include "plan/limbs/limbs.h"

/* Make the limbs of functions that one kernel runs side by side, with the same number of warps, as the options ask for, or
   where that pays; what the kernel needs to know of all is in the limbs of each. Returns 0 when memory runs out. */
int limbs_choose(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a);

/* Of the whole, beside so many parts that share nothing; one: all limbs, with motion made again. */
void limbs_beside_limbs(struct limbs *s, int parts, const struct rneagen_options *o);

/* Beside kernels of which one makes hands (plan/grid/hands). */
void limbs_beside_hands(struct limbs *s, const struct rneagen_options *o);

/* Beside the parts of a relay's start (plan/grid/relay.h). */
void limbs_beside_starts(struct limbs *s, const struct rneagen_options *o);

/* Beside the sides of a base that moves (plan/grid/hands/base_sides.c). */
void limbs_beside_sides(struct limbs *s, const struct rneagen_options *o);

/* Beside kernels that make the base's acceleration first (plan/grid/base_first.h): for more samples. */
void limbs_beside_base(struct limbs *s, const struct rneagen_options *o);

#endif
