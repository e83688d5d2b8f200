#ifndef TESTS_TEST_FORWARD_H
#define TESTS_TEST_FORWARD_H
/* Forward dynamics of a drawn scene, and the reference's of the same. */

#include "reference/forward.h"
#include "support/task/task.h"

enum { MOST = 24 };
enum { OUT_QDD, OUT_MINV, OUT_DQ, OUT_DQD, OUT_JVP, OUT_VJP, OUT_TAU_DQ, OUT_TAU_DQD, OUTS };

/* Rows are the scene's; `from` says which of the reference's each is. The reference has all that the scene adds. */
struct forward_case {
	struct task_case *c;
	struct scene_model m;
	const char *what;
	int nv, from[MOST];
	char tau_given[ROWS];
	wide q[ROWS], qd[ROWS], tau[ROWS];      /* all rows of the reference; q with the freed offsets */
	double v[3 * MOST], lambda[MOST];
	real out[OUTS][MOST * 3 * MOST];
	real freed[TASK_WORDS][MOST * MOST];    /* by input of the task: d qdd by it */
	wide *X, *D[4], qdd[ROWS];              /* M^-1; D: d qdd by q, by qd, d tau by q, by qd; [nv][nv] of the reference */
	wide pivot;                             /* the least of the scaled M; 0: singular */
};

/* A random tree and a scene by the seed, with further text for it; NULL where nothing moves. */
struct forward_case *forward_case_random(uint64_t seed, int links, const char *text, const char *what);

/* Open it and evaluate all outputs; returns the generator's code. */
enum rneagen_code forward_case_evaluate(struct forward_case *f);

/* What the reference says: qdd and X always, derivatives where asked. */
void forward_case_refer(struct forward_case *f, int derivatives);

/* Returns how many elements of d qdd/d q and of the inverse are not stored without --dense; all of these are zero. */
int forward_case_left_out(struct forward_case *f);

void forward_case_close(struct forward_case *f);

/* An element of a matrix of the reference, of rows of the scene. */
wide forward_case_at(const struct forward_case *f, const wide *matrix, int i, int j);

#endif
