#ifndef RUNTIME_PEAKS_CAPS_H
#define RUNTIME_PEAKS_CAPS_H
/* The largest magnitudes over a whole box, from its parts: cut by one row of q after the other, each value has the
   largest of its magnitudes in the parts, and what is made of it in other parts, or in boxes within, is closer. */

#include "norms/norms.h"

struct caps {
	struct interval *const *rows; /* of the box, by argument; as they were when caps_find returns */
	struct interval *q;	      /* those of q among them */
	const int *dims;	      /* rows of q by which it is cut */
	int dim_count;
	double deadline; /* as seconds_now has it; after it what has been found counts */
};

/* Into v->most and v->most_norm, of values of one lane: they live in `arena`, unless they are there already. Returns 0
   when memory runs out. */
int caps_find(const struct caps *c, const struct norms *x, struct norms_values *v, struct arena *arena);

#endif
