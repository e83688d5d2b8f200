#ifndef TESTS_TEST_REFERENCE_H
#define TESTS_TEST_REFERENCE_H

#include <check.h>

#include "reference/reference.h"

enum { ROWS = 256 };

// One state and its torque, twice: as sampled, and widened.
struct state {
	double q[ROWS], qd[ROWS], qdd[ROWS];
	wide wq[ROWS], wqd[ROWS], wqdd[ROWS], tau[ROWS];
};

// A reference that must open; the failing test says why it did not.
struct reference *open_text(const char *urdf, const struct reference_options *o);

// A random state of r and its torque.
void sample_state(struct reference *r, struct rng *rng, struct state *s);

// |a - b| <= tolerance * (1 + size), size the larger magnitude in either of the arrays.
void expect_near(const wide *a, const wide *b, int n, double tolerance, const char *what);

// Runs `test` on the URDF text of each robot in the folder RNEAGEN_ROBOTS; one line says "skipped" without it.
void each_real_robot(void (*test)(const char *name, const char *urdf));

TCase *closed_forms(void);
TCase *oracle_agreement(void);
TCase *properties(void);
TCase *kinematics(void);
TCase *equivalences(void);
TCase *input_reading(void);

#endif
