#ifndef TESTS_ROBOT_BOX_H
#define TESTS_ROBOT_BOX_H
/* A robot of tests/robots with a box of states, and states of it with what its outputs are there. */

#include "prove/prove.h"
#include "range/grid.h"
#include "support/rng.h"

struct robot_box {
	char *urdf;
	struct rneagen_options options;
	struct rneagen_error error;
	struct analysis analysis;
	struct arena arena;
	struct box box;
	double *in[DAG_ARGUMENTS], *out[DAG_ARGUMENTS]; /* the state, and outputs that eval_bound and eval_f64 fill */
	__float128 *exact[DAG_ARGUMENTS];               /* its exact outputs */
};

/* The file tests/robots/NAME.urdf, with a floating base where the name begins with "floating:", its elbow following its
   shoulder where it begins with "mimic:", in a scene, lines of it; gravity 0: as always, else along -z. Fails the test on any
   error. */
void robot_box_open(struct robot_box *x, const char *name, const char *scene, double gravity);
void robot_box_close(struct robot_box *x);

/* A state of the box, in `is_float` of floats where a range has one: any, or corners of what is no position, or corners of all.
   `wider` is by how much of their lengths ranges are longer. */
void robot_box_draw(struct robot_box *x, struct rng *r, int is_float, double wider);

/* x->exact there. */
void robot_box_evaluate(struct robot_box *x);

/* The exact value of an output of the DAG's, by its number. */
double robot_box_value(const struct robot_box *x, size_t output);

/* The polynomial of an output of a field, at drives, then rates. */
double robot_box_polynomial(const struct field *f, const double *coefficients, const double *x);

/* |result of eval_f32 or eval_f64 - exact| of an output. */
double robot_box_error(struct robot_box *x, size_t output, int is_float);

/* An effort for functions of range/: two threads, no deadline. */
struct effort robot_box_effort(void);

#endif
