#ifndef RUNTIME_PROVE_TWINS_H
#define RUNTIME_PROVE_TWINS_H
/* Operations of a rotation that go together. */

#include "norms/adjoint.h"
#include "norms/norms.h"
#include "prove/shares.h"

/* Two operations of a rotation, c and s, c x and s x, or c x + s y and c y - s x, whose roundings are bounded together:
   by Cauchy and Schwarz, |v| |by v| + |w| |by w| is at most the product of two norms. */
struct twins {
	uint32_t one, other;     /* nodes of the text's DAG */
	uint32_t values, slopes; /* sets of norms.h; values 0: their norm is 1 */
	uint32_t x; /* of products: the node x of the adjoint's DAG, whose magnitude stands for the values' norm; else 0 */
	struct shares shares;      /* of angles */
};

/* Values and derivatives, each in one interval or by lanes (norms.h). */
struct view {
	struct norms norms;
	struct norms_values values;
	struct twins *products, *sums, *angles;
	size_t product_count, sum_count, angle_count;
};

/* All of a text's DAG whose derivatives `x` has, before v->norms is laid; a node is one of two at most. They live in
   `arena`. Returns 0 when memory runs out. */
int twins_find(struct view *v, const struct dag *d, const struct adjoint *x, struct arena *arena);

#endif
