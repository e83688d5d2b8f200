#ifndef RNEAGEN_FIELD_H
#define RNEAGEN_FIELD_H
/* What a coordinate makes of the particles beyond its joint, and what joints feel of it: see recursion.c. */

#include "mechanics/composite.h"

/* Accelerations alpha x (p - o) + beta x (p' - o') + gamma. */
struct field {
	struct svec alpha, beta, gamma;
};

struct wrench {
	struct svec f, n;
};

/* What a joint with the unit twist (Z, Y) feels of a field: n2.alpha + n1.beta + f2.gamma. */
struct row_vectors {
	struct svec n2, n1, f2;
};

/* f = alpha x h + beta x P + m gamma, n = I alpha + K beta + h x gamma */
struct wrench field_load(struct dag *d, const struct composite *c, const struct field *x);

struct row_vectors field_row(struct dag *d, const struct composite *c, struct svec Z, struct svec Y);
struct ref field_meet(struct dag *d, const struct row_vectors *s, const struct field *x);

#endif
