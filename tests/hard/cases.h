#ifndef TESTS_HARD_CASES_H
#define TESTS_HARD_CASES_H
/* The table of numerically hard cases: a robot, states, and in words what they are and why they are hard. */

#include "support/model.h"

enum hard_states {
	STATES_ORDINARY, /* reference_sample's: |q| up to pi, |qd| up to 2, |qdd| up to 5 */
	STATES_FAST,	 /* 300 rad/s, and every second joint as much the other way */
	STATES_LEVEL,	 /* at rest, the two arms of robot_balance at the same angle */
	STATES_FALL,	 /* a floating base at rest that accelerates with gravity, rounded */
	STATES_TURNS_1E5,
	STATES_TURNS_1E6, /* angles between half of this and this */
	STATES_AWAY,	 /* a floating base up to 1e6 m from the origin along each axis */
	STATES_SCALED,	 /* quaternions of length 0.5 to 2 */
	STATES_SLOW,	 /* rates and accelerations up to 1e-3 */
	STATES_RING,	 /* robot_star: every arm as the first, and the hub turning */
	STATES_HUGE,	 /* rates whose squares no float (no double) can hold */
	STATES_STRETCHED, /* angles up to 1e-4 rad */
	STATES_FIST	 /* within 0.05 rad of the upper limits */
};

struct hard_case {
	const char *name, *what, *why, *mends;
	const char *file;      /* in tests/robots, or */
	char *(*build)(void);
	int floating, weightless;
	enum hard_states states;
	int samples;
	const char *scene;     /* NULL: none */
};

extern const struct hard_case HARD_CASES[];
extern const int HARD_CASE_COUNT;

/* The case's robot through the generator's passes; hard_close releases both. */
struct hard {
	const struct hard_case *of;
	struct rneagen_options options;
	char *urdf;
	size_t length;
	struct model model;
};

/* A robot over which compilers and quad precision take long: the short forms of tests leave it. */
int hard_is_long(const struct hard_case *c);

void hard_open(struct hard *h, const struct hard_case *c);
void hard_close(struct hard *h);

/* The next state, all of it floats where f32 says so. */
void hard_sample(const struct hard *h, struct rng *rng, int f32, double *q, double *qd, double *qdd);

#endif
