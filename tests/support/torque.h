#ifndef TESTS_TORQUE_H
#define TESTS_TORQUE_H
/* The evaluated DAG as a function tau(q, qd, qdd), in extended precision, for properties of it. */

#include "dag/dag.h"
#include "support/model.h"
#include "support/rng.h"

enum { ROWS = 512 };

struct pose {
	int nq, nv;
	real q[ROWS], qd[ROWS], qdd[ROWS];
};

struct torque {
	real tau[ROWS];
	double size[ROWS]; /* magnitudes that were summed, by row */
};

/* A random state within the limits of the file. */
void pose_random(struct pose *p, const struct reference *r, struct rng *rng);

/* By the DAG of rnea. */
void torque_of(const struct dag *d, const struct pose *p, struct torque *t);

/* A random robot's text, at most `links` links; which knobs are turned off is in the flags. The caller frees it. */
enum { NO_FLOATING = 1, NO_ODD_NAMES = 2, ALWAYS_MIMIC = 4 };
char *torque_robot(uint64_t seed, int links, int flags);

/* The DAG of rnea, fused, of a robot that may have been changed; false where the tree is refused. */
int torque_dag(struct dag *d, struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a);

#endif
