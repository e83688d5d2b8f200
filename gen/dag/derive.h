#ifndef RNEAGEN_DERIVE_H
#define RNEAGEN_DERIVE_H
/* Derivatives of expressions as expressions, forwards and backwards, one rule for each operation (Griewank and Walther,
   Evaluating Derivatives, 2nd ed., SIAM 2008, chapter 3). What is constant, or shared, folds as everywhere. */

#include "dag/dag.h"

/* The values that are differentiated: roots, and all that they are made of, among the DAG's first `count` nodes. */
struct derivable {
	struct dag *d;
	uint32_t count;
	const struct ref *roots;
	int root_count;
	unsigned char *live; /* by node: does a root depend on it? */
};

/* The DAG as it stands. Returns 0 when memory runs out. */
int derive_begin(struct derivable *x, struct dag *d, const struct ref *roots, int root_count);

/* Along one direction: `seed` gives an input's derivative. dot[i] becomes that of node i; dot has x->count elements. */
void derive_forward(
	const struct derivable *x, struct ref (*seed)(void *context, int argument, int row), void *context, struct ref *dot);

/* The derivative of a value by an input, in its place. Returns 0 when memory runs out. */
int derive_by(struct dag *d, struct ref *value, int argument, int row);

/* Of the sum of weights[k] roots[k]: bar[i] becomes its derivative by node i; bar has x->count elements. */
void derive_backward(const struct derivable *x, const struct ref *weights, struct ref *bar);

#endif
