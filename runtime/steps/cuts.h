#ifndef RUNTIME_STEPS_CUTS_H
#define RUNTIME_STEPS_CUTS_H
/* A box of q that is cut in halves, and these again: a list of cuts, each before those of its lower half, and these before those
   of its upper half. So whatever the list says, its boxes cover the whole. */

#include "steps/outward.h"
#include <stddef.h>

enum { CUTS_NONE = -1, CUTS_DEEP = 200 };

struct cuts {
	int *rows; /* of q, halved at the middle; CUTS_NONE: a box of the cover */
	size_t count, capacity;
	int failed; /* memory ran out */
};

void cuts_put(struct cuts *c, int row);
void cuts_free(struct cuts *c);

/* Where a span is cut. */
static inline double cuts_middle(double lower, double upper)
{
	return 0.5 * (lower + upper);
}

/* Do the first cuts, all of them, make one whole cover by rows below `row_count`? Into second[i] (`count` of them) the place of
   the upper half of cut i. */
int cuts_check(const struct cuts *c, int row_count, size_t *second);

/* What a proof leaves for its certificate, by output. A NULL record is none. */
struct record {
	struct record_output {
		struct cuts errors, values;
	} *outputs;
	size_t count;
	int q_rows; /* of the text; a proof may cut others, which it has for parts of the text */
};

int record_make(struct record *r, size_t outputs, int q_rows);
void record_free(struct record *r);

#endif
