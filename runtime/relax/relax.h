#ifndef RUNTIME_RELAX_RELAX_H
#define RUNTIME_RELAX_RELAX_H
/* The expressions of a text with other inputs: what is no polynomial of angles, lengths, rates and drives is an input of its own,
   with the range that it has. Every value of a text's output over the box is one of the relaxed output's over its box; what holds
   for the latter holds for the text.
   - The angle of a follower, or of a joint with a freed offset, is an angle of its own: a row of q.
   - Freed masses, inertias and payloads are lengths: rows of q.
   - Friction is a drive from -c to c.
   - Of a quaternion expressions read its rotation R. Where they read R^T g alone, with a vector g that is known, these are three
     drives whose norm is |g|. Else its elements are lengths, each from -1 to 1; then no grid serves. */

#include "norms/interval.h"
#include "passes/analysis.h"

/* A row of q. */
struct relaxed_row {
	int turns;      /* how many bodies turn by this angle; 0: it is a length */
	int has_grid;   /* outputs are of the degree in it that grids need */
	int argument, row; /* it is `factor` times this input of the text's */
	double factor;  /* 0: it is none */
};

/* Drives, rows of an argument, whose norm is at most this. */
struct relaxed_ball {
	int first, count;
	double radius;
};

enum { RELAXED_BALLS = 8 };

struct relaxed {
	const struct analysis *text; /* as it was */
	struct analysis view;        /* the same, but for view.dag */
	struct interval *rows[DAG_ARGUMENTS]; /* ranges of its inputs, by argument */
	struct relaxed_row *of_q;    /* by row of q */
	int row_count;
	int drives;                  /* the argument with friction and balls; -1: there is none */
	struct relaxed_ball balls[RELAXED_BALLS];
	int ball_count;
	uint32_t *source;            /* by node of view.dag: 1 + the text's node for which an input stands; 0: it is the text's own */
	uint32_t *origin;            /* by node of view.dag: the text's node with this value */
	int is_same;                 /* view.dag is the text's */
};

/* `given`: ranges of the text's inputs, by argument. Arrays live in `a`. Errors: UNSUPPORTED, LIMIT, MEMORY. */
enum rneagen_code relax(struct relaxed *r, const struct analysis *text, struct interval *const *given, struct arena *a,
	struct rneagen_error *e);

/* The ball that a drive is of, or NULL. */
const struct relaxed_ball *relaxed_ball_of(const struct relaxed *r, int argument, int row);

/* How much longer than 1 the square of a quaternion's norm may be, or shorter. */
#define RELAXED_QUATERNION 1e-6

#endif
