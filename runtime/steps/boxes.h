#ifndef RUNTIME_STEPS_BOXES_H
#define RUNTIME_STEPS_BOXES_H
/* A step of a certificate: boxes that cover all q, and what holds in each. */

#include "steps/cuts.h"
#include "steps/errors.h"

struct boxes {
	struct cuts cuts;
	size_t count;
	double *low, *high;                  /* of the output's value, by box in the order of the cuts */
	double *errors[STEPS_PRECISIONS];  /* NULL: nothing is said */
};

/* Where boxes are. */
struct boxes_of {
	struct errors *x;
	struct span *const *rows; /* of the whole; those of q are changed on the way */
	int position, q_rows;     /* the argument q; -1: none is read */
};

/* Follow the cuts of a proof, always those of the box with the largest bound of model 0 (without models, of the largest
   magnitude), until none is above `target`, until there are `most` boxes, the deadline, or no more cuts. Returns 0 when memory
   runs out; boxes_free in any case. */
struct boxes_goal {
	double target, deadline;
	size_t most;
};
int boxes_find(struct boxes *b, const struct boxes_of *of, const struct cuts *proof, const struct boxes_goal *goal);

/* Does everything follow as it is stated? -1: it is; the number of the box where it is not, and in *what which number. b->count:
   the cuts are no cover of that many boxes, or memory ran out. */
long boxes_check(const struct boxes *b, const struct boxes_of *of, const char **what);

/* What holds in all of them. */
struct box_bound boxes_total(const struct boxes *b, int count);

void boxes_free(struct boxes *b);

#endif
