#ifndef RUNTIME_RANGE_SPLIT_H
#define RUNTIME_RANGE_SPLIT_H
/* Branch and bound: a box of q is cut into smaller ones, always the one with the largest bound. */

#include "steps/cuts.h"
#include "norms/interval.h"
#include <stddef.h>

enum { SPLIT_DIMS = 64, SPLIT_SIZES = 4 };

struct leaf {
	double sizes[SPLIT_SIZES];     /* what is bounded; the first decides */
	struct interval value;         /* and its range */
	struct interval q[SPLIT_DIMS]; /* by dimension */
};

struct split {
	int dim_count;
	void (*examine)(void *context, struct leaf *leaf); /* sizes and value from q */
	void *context;
	double width[SPLIT_DIMS], score[SPLIT_DIMS]; /* private */
	double deadline;
	char *leaves;
	size_t count, capacity, stride;
};

/* From the whole box in root->q, until the deadline (as seconds_now has it), until there is no room or nothing to gain. Returns 0
   when memory runs out. */
int split_run(struct split *s, struct leaf *root, double deadline);

/* What holds for the whole box. */
void split_total(const struct split *s, double sizes[SPLIT_SIZES], struct interval *value);

/* The boxes that are left, as cuts of the whole box in root->q by rows[dimension] of q, those below q_rows alone. Returns 0 when
   memory runs out. */
int split_cuts(const struct split *s, const struct leaf *root, const int *rows, int q_rows, struct cuts *cuts);

void split_free(struct split *s);

#endif
