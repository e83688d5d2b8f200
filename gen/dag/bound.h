#ifndef RNEAGEN_BOUND_H
#define RNEAGEN_BOUND_H
/* How far values may be off, as expressions beside them: a running error analysis (Higham, Accuracy and Stability of Numerical
   Algorithms, 2nd ed., SIAM 2002, section 3.3) with a rule for each operation. A text that has them computes its own bounds. */

#include "dag/dag.h"
#include "dag/eval_model.h"

struct bound {
	struct dag *d;
	const struct eval_model *m;
	uint32_t count;    /* of the nodes there were */
	struct ref *error; /* by node: |computed - exact| is at most this, but for its own rounding; node 0: it is exact */
	uint32_t *way;     /* by node: so many roundings make that smaller than it should be, a factor 1 - u each */
};

/* Of `roots` and all that they are made of, in arithmetic `m`, whichever way a compiler joins products to sums. Exact is as for
   eval_bound. The values `given` are taken as they are stored, whatever their own error; they are computed as `made`, which may
   be the same. Returns 0 when memory runs out. */
int bound_make(struct bound *x, struct dag *d, const struct eval_model *m, const struct ref *roots, int root_count,
	const struct ref *given, const struct ref *made, int given_count);

/* Above what underflow takes from all operations together, where each product counts it once. */
real bound_tiny(const struct eval_model *m);

/* What makes good for so many roundings of what is made of bounds by sums and products: 1 + 2 n u, where n u is at most 1/8; 0
   where it is more. */
real bound_factor(const struct eval_model *m, uint32_t way);

#endif
