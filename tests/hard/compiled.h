#ifndef TESTS_HARD_COMPILED_H
#define TESTS_HARD_COMPILED_H
/* A hard case as a compiled text beside the reference in quad precision, and one state of it. */

#include "cases.h"
#include "quad.h"
#include "support/numbers.h"
#include "target/target.h"

struct compiled {
	struct hard hard;
	struct target target;
	struct quad *quad;
	int nq, nv;
	struct array in[3], tau; /* as the text takes them */
	double *state[3];        /* the same as double */
	double *eval, *noise;    /* by torque */
	__float128 *reference;
};

/* By the precision, mode, strictness and bounds of `how`. */
void compiled_open(struct compiled *x, const struct hard_case *c, const struct rneagen_options *how,
	const struct compiler *compiler, const char *stem);
void compiled_close(struct compiled *x);

/* Draw the next state. */
void compiled_sample(struct compiled *x, struct rng *rng);

/* The state goes to the text's arrays. */
void compiled_set(struct compiled *x);

/* The reference's torques of the state, and what is summed for them. */
void compiled_refer(struct compiled *x);

#endif
