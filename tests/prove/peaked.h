#ifndef TESTS_PEAKED_H
#define TESTS_PEAKED_H
/* A robot's box, and peaks of what one of its outputs is made of. */

#include "peaks/peaks.h"
#include "prove/robot_box.h"

struct peaked {
	struct robot_box x;
	struct adjoint adjoint;
	struct norms norms;
	struct norms_values values;
	struct peaks p;
	int dims[PEAKS_DIMS];
	double *v, *in[DAG_ARGUMENTS];
	struct interval *rows[DAG_ARGUMENTS];
};

/* That output's values and derivatives, every third node and all pairs; `seconds` for their peaks. */
void peaked_open(struct peaked *c, const char *name, const char *scene, size_t output, double seconds);

/* A state; is_whole: angles of q anywhere. */
void peaked_draw(struct peaked *c, struct rng *r, int is_whole);

/* All nodes there, into c->v. */
void peaked_evaluate(struct peaked *c);

#endif
