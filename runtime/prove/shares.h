#ifndef RUNTIME_PROVE_SHARES_H
#define RUNTIME_PROVE_SHARES_H
/* How long the vector (d/dc, d/ds) of an output's derivatives by the cosine and sine of one angle is. What reads them
   adds a vector each: of a product c x with the slope v it is (x v, 0), of s y with w it is (0, y w). Some go together:
   - those of c x and s x: |x| |(v, w)|;
   - those of c x and s y in one sum: |v| |(x, y)|;
   - those of p = c x + s y and r = c y - s x, whose slopes are v and w: (x v + y w, y v - x w), of length |(x, y)| |(v,
   w)|. */

#include "norms/adjoint.h"
#include "norms/norms.h"

/* One such length: a magnitude, or the norm of a set of norms.h, by another. Nodes are the adjoint's; node 0 is 1. */
struct share {
	uint32_t x, slope;       /* nodes */
	uint32_t values, slopes; /* sets, in the place of x and of slope; 0: there is none */
};

struct shares {
	struct share *list;
	size_t count;
};

/* Of all that reads these nodes of the text's DAG, before v->norms is laid. The list lives in `arena`. Returns 0 when
   memory runs out. */
int shares_find(struct shares *t, struct norms *norms, const struct dag *d, const struct adjoint *x, uint32_t cosine,
	uint32_t sine, struct arena *arena);

/* One of their lengths. */
double shares_of(const struct share *t, const struct norms *norms, const struct norms_values *v);

/* The sum of their lengths. */
double shares_length(const struct shares *t, const struct norms *norms, const struct norms_values *v);

#endif
