#ifndef RNEAGEN_SPLITTER_H
#define RNEAGEN_SPLITTER_H
/* Matrices as they are divided over parts (parts.h): what a part of neighbouring owners holds, and what it costs. */

#include "plan/grid/owners.h"
#include "plan/grid/parts.h"

struct size {
	int alive;      /* values at once: plan_alive */
	int operations; /* plan_flops, and 1 */
};

struct splitter {
	const struct parts_of *x;
	struct share share; /* of x->raw */
	struct arena *a;
	struct owners owners;
	int count;          /* of owners */
	struct size *sizes; /* [first][end]: of such a part; 0 operations: not known yet */
	int failed;
};

/* A part of fullness FULL has all that it may take; of more than MOST there is none. */
enum { FULL = 1000, MOST = 1 << 20 };

struct size splitter_plan_size(const struct plan *p, struct arena *a);

/* Of the part of these owners. */
const struct size *splitter_size(struct splitter *s, int first, int end);

/* The larger of its shares of what a part may be, of FULL. */
int splitter_fullness(struct splitter *s, int first, int end);

/* Its operations, each as long as one takes in a part of that size. */
double splitter_cost(struct splitter *s, int first, int end);

/* Can a part lose less than the whole? */
int splitter_can_gain(struct splitter *s);

#endif
