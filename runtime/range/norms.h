#ifndef RUNTIME_RANGE_NORMS_H
#define RUNTIME_RANGE_NORMS_H
/* Intervals of all values of a DAG over a box, where rotations keep lengths: |(c x + s y, c y - s x)| = |(x, y)|. Beside the interval of
   each value stand norms of sets of a few values:
   - of a set with both values of a rotation, or one, it is at most that of the set with x and y in their place;
   - of a set of sums, at most that of the first terms and that of the second ones together;
   - of any set, at most the root of the sum of its squares. */

#include "range/interval.h"

enum { NORMS_SET = 4 };

struct norms_set {
	uint32_t nodes[NORMS_SET], last; /* ascending; last: the largest */
	int count;
	uint32_t one, other; /* 1 + the sets that it is bounded by; 0: none */
};

struct norms {
	const struct dag *d;
	struct norms_set *sets; /* those that others need come first */
	uint32_t set_count, set_limit;
	uint32_t *table, table_size; /* 1 + set, by what is in it */
	uint32_t *order, *first; /* sets by `last`: those of node i are order[first[i]] to order[first[i + 1] - 1] */
};

/* Returns 0 when memory runs out. */
int norms_make(struct norms *x, const struct dag *d, struct arena *a);

/* Into values, by node, over a box: rows[argument] are those of an input. `norm` has room for x->set_count + 1 numbers. */
void norms_evaluate(const struct norms *x, const struct interval *const *rows, struct interval *values, double *norm);

#endif
