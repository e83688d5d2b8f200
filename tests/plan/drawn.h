#ifndef TESTS_DRAWN_H
#define TESTS_DRAWN_H
/* Small DAGs that are drawn, and plans of them; and, found without plan/readings.h, what a line reads and makes. */

#include "plan/plan.h"
#include "support/rng.h"

/* Inputs of the first rows of an argument. */
void drawn_inputs(struct dag *d, int argument, int rows);

/* So many operations more, of any nodes but the constant 0, of late ones most often; a sine before its cosine. */
void drawn_operations(struct dag *d, struct rng *r, int count);

/* Store, row after row, each operation that nothing reads, and some others; a value may be stored twice. */
void drawn_outputs(struct dag *d, struct rng *r, int argument);

/* How a plan is drawn: probabilities. */
struct drawn_knobs {
	double named, named_inputs; /* a value that needs no name has one; an input */
	double late;                /* a store waits though its value is there */
};

/* Lines of what is stored, in any order in which each value is made before it is read. */
void drawn_plan(struct plan *p, const struct dag *d, struct rng *r, const struct drawn_knobs *k, struct arena *a);

/* The named values that a line makes: 0 to 2. Returns how many. */
int drawn_made(const struct plan *p, const struct line *l, uint32_t made[2]);

/* By node: 1 where the line reads a named value, and an input without a name; what it makes is not among them. */
void drawn_reads(const struct plan *p, const struct line *l, unsigned char *reads);

/* Each line reads what lines before it have made. Returns a line that does not; the number of lines: there is none. */
size_t drawn_first_too_early(const struct plan *p);

#endif
