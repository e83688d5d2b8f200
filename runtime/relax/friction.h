#ifndef RUNTIME_RELAX_FRICTION_H
#define RUNTIME_RELAX_FRICTION_H
/* Smooth friction among expressions: c v / sqrt(v^2 + w). It rises with v, where c > 0, and is never larger than c. */

#include "norms/interval.h"

struct friction {
	uint32_t rate;                     /* node v */
	uint32_t slope, product, sum, root; /* nodes c (0: it is 1), c v, v^2 + w, its root */
	uint32_t square;                   /* node w, a constant above 0 */
	int sign;                          /* of all of it */
};

/* Is node i that? */
int friction_of(const struct dag *d, uint32_t i, struct friction *f);

/* Its range where that of v is given. */
struct interval friction_range(const struct dag *d, const struct friction *f, struct interval rate);

#endif
