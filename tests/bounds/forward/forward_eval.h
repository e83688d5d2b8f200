#ifndef TESTS_BOUNDS_FORWARD_EVAL_H
#define TESTS_BOUNDS_FORWARD_EVAL_H
/* --want qdd,qdd_bound as gen/eval computes it, beside the reference in quad precision. */

#include "passes/analysis.h"
#include "solved.h"

enum { FORWARD_ROWS = 256 };

struct forward_scene {
	enum rneagen_precision precision;
	int floating;
	const char *more;    /* further lines of the scene */
	__float128 width, armature; /* of friction, and of rotors that `more` gives to all joints; 0: none */
	int swept;           /* the bound is eval_bound's, and the text has none */
	int worst;           /* every operation is off by as much as it may be, by chance up or down: in f32 */
};

struct forward_eval {
	struct forward_scene scene;
	struct arena arena;
	struct analysis analysis;
	struct rneagen_error error;
	struct solved solved;
	double in[3][FORWARD_ROWS], qdd[FORWARD_ROWS], bound[FORWARD_ROWS];
	__float128 want[FORWARD_ROWS];
};

/* `reference`: the URDF that the reference reads, NULL: the same. Returns 0 where the robot is refused, and prints why. */
int forward_eval_open(struct forward_eval *x, const char *urdf, const char *reference, const struct forward_scene *s,
	const char *what);
void forward_eval_close(struct forward_eval *x);

/* The next state, with torques of accelerations that the file's states have, rounded to floats; qdd, its bound, and what is
   right. Numbers of other inputs, by name of the argument, come from `more`; NULL: there are none. What is right only where
   it is asked for: it takes the longest. */
void forward_eval_run(struct forward_eval *x, struct rng *rng, const double *(*more)(const char *name), int is_referred);

#endif
