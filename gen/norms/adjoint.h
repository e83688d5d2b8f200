#ifndef RNEAGEN_ADJOINT_H
#define RNEAGEN_ADJOINT_H
/* The values that an output is made of, and its derivatives by each of them, as expressions of one DAG in which both terms of a
   rotation, c x + s y, stand together: so norms.h sees it. */

#include "dag/dag.h"

struct adjoint {
	struct dag d;
	struct ref *value, *slope; /* by node of the DAG that was given; node 0 of d: it is 0, or does not matter */
	uint32_t count;            /* of its nodes */
	struct ref root;           /* the output's value */
};

/* Of one output, with derivatives or without; angles are taken as they are, so nothing is said of derivatives by them.
   It lives in `a`. Returns 0 when memory runs out. */
int adjoint_make(struct adjoint *x, const struct dag *d, size_t output, int has_slopes, struct arena *a);

/* A term c x or s x, c and s the cosine and sine of an angle; is it one? */
struct trig_term {
	uint32_t angle; /* node */
	struct ref other;
	int is_sine, sign;
};
int trig_term(const struct dag *d, struct ref a, struct trig_term *t);

#endif
