#ifndef RNEAGEN_READINGS_H
#define RNEAGEN_READINGS_H
/* What each line of a plan reads: values that have names. */

#include "plan/plan.h"

/* A line reads a value, which the line `previous` was the last one before it to read or make. */
struct reading {
	uint32_t node, previous;
};

struct readings {
	const struct plan *plan;
	uint32_t *begin;         /* of a line's readings; line_count + 1 of them */
	struct reading *list;
	uint32_t *made, *last;   /* by node: the line that makes a named value, and the last that reads it, or that line */
	uint32_t *weight;        /* by line: operations */
};

/* Returns 0 when memory runs out. */
int readings_make(struct readings *r, const struct plan *p, struct arena *a);
void readings_free(struct readings *r, struct arena *a);

/* plan_alive of the lines, in whatever order they stand. Returns 0 when memory runs out. */
int readings_alive(int *most, const struct plan *p, struct arena *a);

/* The values that a line makes: 0 to 2, the sine before the cosine. Returns how many. */
int readings_made(const struct plan *p, const struct line *l, struct ref made[2]);

/* Whose entry of q, qd, qdd or tau an input is, or of an output that has a row for each of qd; NULL: no joint's. */
const struct tree_joint *readings_joint(const struct dag *d, const struct node *input, const struct tree *t);

/* By node: the last row of qd whose joint's inputs it takes; -1: it takes none. */
void readings_reach(int *reach, const struct dag *d, const struct tree *t);

/* By node: an input that only sines and cosines of these lines read. NULL when memory runs out. */
const unsigned char *readings_only_angles(const struct plan *p, struct arena *a);

#endif
