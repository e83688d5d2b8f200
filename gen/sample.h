#ifndef RNEAGEN_SAMPLE_H
#define RNEAGEN_SAMPLE_H
/* Seeded states of a robot within the limits of its joints. */

#include "dag.h"
#include "tree.h"

struct sample_options {
	unsigned long long seed;
	size_t count;
	double qd_range, qdd_range; /* largest magnitudes: qd where the URDF is silent, qdd everywhere */
};

/* What the effect of changed constants is measured by. */
extern const struct sample_options SAMPLE_EFFECTS;

/* All arrays are [sample][row]. */
struct states {
	size_t count, nq, nv;
	double *q, *qd, *qdd;
};

/* A limit of more than this, rad, m or per second, is as good as none. */
enum { SAMPLE_LIMIT = 1000 };

/* Uniform within the limits of position and velocity of each joint; where there is none q is within pi of 0 for angles
   and 1 m for lengths, quaternions are uniform over all orientations. The same seed gives the same states. Returns 0
   when memory runs out; the caller gives the states to sample_free. */
int sample_states(struct states *s, const struct robot *r, const struct tree *t, const struct sample_options *o);

/* A row of an argument of the DAG: of q, qd, qdd; of a constant that the scene frees, what the URDF says; 1 of others. */
double sample_input(const struct states *s, const struct tree *t, const struct argument *x, int row, size_t state);

void sample_free(struct states *s);

#endif
