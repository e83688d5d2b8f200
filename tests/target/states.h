#ifndef TESTS_STATES_H
#define TESTS_STATES_H
/* Seeded states of a model, what the reference makes of them, and what the evaluated DAG does. */

#include "support/model.h"

struct states {
	int count, nq, nv, f32;
	double *q, *qd, *qdd; /* [sample][row] */
	wide *tau;	      /* by the reference, [sample][row]; so the rest */
	double *eval;	      /* by gen/eval */
	double *size, *bound; /* magnitudes that were summed; eval's running error bound */
	double *noise;	      /* what the rounding of the URDF's numbers can make; zero unless asked for */
};

/* Is this row of q an angle? */
int state_is_angle(const struct model *m, int row);

/* Of the last hundred states, every tenth has angles up to 3e9 rad, unless joints mimic others: rounding a multiple of
   such an angle would be all there is. with_noise costs a second run of the reference. */
struct states states_new(struct model *m, uint64_t seed, int count, int f32, int with_noise);

/* The same with angles up to pi times `enlarge`. */
struct states states_new_large(struct model *m, uint64_t seed, int count, int f32, int with_noise, double enlarge);
void states_free(struct states *s);

#endif
