#ifndef TESTS_HARD_VARIED_H
#define TESTS_HARD_VARIED_H
/* A robot's torques, their derivatives and the mass matrix as a DAG, all elements, and what they are: by the DAG in quad
   precision, and by central differences of the reference in quad precision. */

#include "hard/quad.h"
#include "support/numbers.h"
#include "support/scene_model.h"

enum { TAU, DQ, DQD, MASS, OUTPUTS };
enum { STATE = 3, MOST_ROWS = 18 };

/* A robot, perhaps with a joint that is held, and one state of it: of all its rows, and of those that are left. */
struct varied {
	const char *what;
	struct scene_model model;
	struct reference *table;
	struct quad *quad;
	struct rng rng;
	int nq, nv, held;            /* entry of the table; -1: none */
	int number[DAG_ARGUMENTS];   /* of the DAG's arguments: of STATES or NAMES; what nothing reads is not there */
	double at;
	int v_row[ROWS];             /* of what is left, in the whole */
	double whole[STATE][ROWS], in[STATE][ROWS];
	float in_f32[STATE][ROWS];
	/* [row] of torques, [row][by] of matrices; what is computed, and its bounds, are for the test to fill */
	__float128 *whole_of[OUTPUTS], *want[OUTPUTS], *exact[OUTPUTS];
	double *got[OUTPUTS], *bound[OUTPUTS], *size, noise[ROWS]; /* size: in the order of the DAG's outputs; noise: 2^-62 of
		the magnitudes of a row */
	float *got_f32[OUTPUTS];
};

/* The DAG's arguments among the rows of a state and the outputs. */
#define POINTERS(T)                                                                                                    \
	struct {                                                                                                       \
		const T *in[DAG_ARGUMENTS];                                                                            \
		T *out[DAG_ARGUMENTS];                                                                                 \
	}
#define POINT(p, x, state, outputs)                                                                                    \
	for (int a_ = 0; a_ < (x)->model.dag.argument_count; a_++) {                                                   \
		(p).out[a_] = (x)->model.dag.arguments[a_].is_output ? (outputs)[(x)->number[a_]] : NULL;              \
		(p).in[a_] = (p).out[a_] ? NULL : (state)[(x)->number[a_]];                                            \
	}

/* `lock` is a line of a scene, or "". Returns 0 where the robot has no joint left, or more rows than MOST_ROWS. */
int varied_open(struct varied *x, const char *urdf, const struct rneagen_options *options, uint64_t seed, const char *lock,
	const char *what);
void varied_close(struct varied *x);

/* Make a state of x->whole, rounded to float and with what is held at rest; or draw it. */
void varied_settle(struct varied *x);
void varied_draw(struct varied *x);

/* Fill want, exact and noise. */
void varied_refer(struct varied *x);

/* What half units of the file's decimals may be in a row of an output: 2^-53 of its magnitudes. Of a constant that is next to
   nothing they are as large as of what cancelled in it. */
double varied_half_units(const struct varied *x, int output, int row);

/* How many rows an output has. */
int varied_rows(const struct varied *x, int output);

#endif
