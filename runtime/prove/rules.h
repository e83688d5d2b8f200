#ifndef RUNTIME_PROVE_RULES_H
#define RUNTIME_PROVE_RULES_H
/* What one operation adds to the error of a text, by the largest magnitudes of its operands: the rules of dag/eval.c,
   for all values of these sizes. */

#include "dag/dag.h"
#include "dag/eval_model.h"

/* All by node. */
struct rules {
	const struct dag *d;
	const double *size;           /* no magnitude is larger */
	const double *leaf;           /* of an input: how far off it is where that is known apart, -1: it is not; NULL: of none */
	double *running;              /* no error is larger: of operands, and of the node when rules_node has gone through it */
	double *of_product, *of_sum;  /* what the rounding of a product and of a sum takes from exact values */
};

/* The largest angle that a sine or cosine of node `a` takes, with what it is off. */
double rules_angle(const struct rules *r, uint32_t a, const struct eval_model *m);

/* The largest number that a text makes on its way to a node, but for the node's error: its value, and the product of a fused
   multiply-add that a compiler may round by itself. */
double rules_size(const struct rules *r, uint32_t i, const struct eval_model *m);

/* Returns what the node's error is beside what is linear in its operands' errors; INFINITY where it is not known, or
   overflows: gap_of (gap.h) says why. */
double rules_node(struct rules *r, uint32_t i, const struct eval_model *m);

#endif
