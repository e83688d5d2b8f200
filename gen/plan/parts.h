#ifndef RNEAGEN_PARTS_H
#define RNEAGEN_PARTS_H
/* Matrices of long chains in parts of the grid: each part makes the elements of some bodies, holds less at once than one
   thread would that makes them all, and is shorter. */

#include "plan/plan.h"
#include "rneagen.h"

/* With the outputs of some bodies: see owners.h. */
struct part {
	int first, last; /* bodies */
	int alive;       /* values at once: plan_alive */
	struct algorithm algorithm;
	struct pass pass;
};

/* In the order of the bodies, as the options ask for; *count is 0 where the text stays whole, as one without kernels
   does. `raw` is the whole as the algorithm made it. Errors: USAGE, MEMORY. */
enum rneagen_code parts_make(struct part **parts, int *count, const struct pass *whole, const struct dag *raw,
	const struct tree *t, const struct request *k, const struct rneagen_options *o, int has_kernels, struct arena *a,
	struct rneagen_error *e);

/* What all parts take together, or the whole where there are none. */
struct operation_count parts_operations(const struct part *parts, int count, const struct plan *whole);

/* A line for each part, or for the whole where there are none. */
void parts_dump(const struct part *parts, int count, const struct pass *whole, const struct tree *t, struct text *out);

#endif
