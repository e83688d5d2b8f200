#ifndef BENCH_H
#define BENCH_H
/* The generated C functions of one robot beside Pinocchio's: the same states, one thread, one process. */
#include "peer.h"
#include "reference/reference.h"

enum { STATES = 1024 };

/* What is computed. Pinocchio's computeRNEADerivatives makes M as well, so it stands beside both of the last. */
enum function { TAU, MASS, DERIVATIVES, DERIVATIVES_AND_M, FUNCTIONS };

extern const char *const function_names[FUNCTIONS]; /* as --want has them */

/* The arrays of the texts: of one sample, or of STATES samples as [row][sample]. */
struct arrays {
	double *q, *qd, *qdd, *tau, *dq, *dqd, *M;
};

struct bench {
	struct reference *r;
	struct peer *peer;
	int nq, nv;
	double *states;		/* STATES times q, qd, qdd, one after the other */
	struct arrays one;	/* the inputs are not used: they are in states */
	struct arrays batch;
	bool world;		/* crba is faster by its convention WORLD */
};

/* An input of state s. */
const double *bench_q(const struct bench *b, int s);
const double *bench_qd(const struct bench *b, int s);
const double *bench_qdd(const struct bench *b, int s);

/* One call of a generated function, results to b->one; all states in one call, to b->batch; one call of Pinocchio's. */
void call_one(const struct bench *b, enum function f, int s);
void call_batch(const struct bench *b, enum function f);
void call_peer(const struct bench *b, enum function f, int s);

/* Times of Pinocchio's function over those of the generated one, pass by pass over all states. */
struct ratio {
	double low, median, high; /* quartiles */
};

struct speed {
	struct ratio one, batch;
};

/* `repeats` rounds, in each of which every function has its turn, after one that is not counted. */
void speed_measure(struct bench *b, int repeats, struct speed speeds[FUNCTIONS]);

/* The largest error of an element over the largest element of its array, over the first `count` states, against
   differences of the independent reference in quad precision. */
struct error {
	double one, batch, peer;
};

void error_measure(const struct bench *b, int count, struct error errors[FUNCTIONS]);

#endif
