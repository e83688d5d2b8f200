#ifndef RNEAGEN_ORDER_H
#define RNEAGEN_ORDER_H
/* Lines of a plan in another order: what order.c tries. */

#include "plan/readings.h"

/* Inputs that tell the bias from the rest of forward dynamics. */
enum { TAKES_VELOCITIES = 1, TAKES_TORQUES = 2 };

/* The rows of the last joints first, or before each of them the bias that it takes. Or joint after joint, what the inputs up to
   its own are enough for: little but what the trunk needs is left of a limb when the next one begins. */
enum order_way { ORDER_ROWS, ORDER_BIAS, ORDER_INPUTS };

struct orderer {
	const struct plan *p;
	const struct tree *t;
	struct readings r;
	uint32_t *begin, *readers; /* of a node: lines; nodes + 1 of them */
	uint32_t *left;            /* by node: lines that will read it */
	uint32_t *wait;            /* by line: readings that are not made yet */
	uint32_t *need;            /* by line: values that are at hand at once while it is made (Sethi and Ullman 1970) */
	unsigned char *takes;      /* by node: of these inputs */
	int *reach;                /* by node, for ORDER_INPUTS: the last row of qd whose joint's inputs it takes; -1: it takes none */
	uint32_t *cone, cones;     /* by line: the last stored line that was seen to take it; how many were looked at */
	unsigned char *done;       /* by line */
	uint32_t end;              /* lines from here on stay where they are */
	uint32_t *order, count;    /* lines */
	enum order_way way;
	int *row_at;               /* by place in that order: the row of qd for which a line was written, or for whose inputs */
	uint32_t *stack, *ready;
	int row;
};

/* Arrays of an orderer whose p and t are set. Returns 0 when memory runs out. */
int order_begin(struct orderer *x, struct arena *a);

/* How many lines will read each value. */
void order_find_left(struct orderer *x);

/* Writes the lines in this way; by rows, those that a stored row takes. */
void order_write(struct orderer *x, enum order_way way);

/* Writes the lines as they stand, but before `end` a line as soon as no more values wait after it than before. */
void order_write_early(struct orderer *x, uint32_t end);

#endif
