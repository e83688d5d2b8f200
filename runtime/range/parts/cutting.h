#ifndef RUNTIME_RANGE_PARTS_CUTTING_H
#define RUNTIME_RANGE_PARTS_CUTTING_H
/* What the files of cut.h share: where outputs are cut off, and how the body moves there. */

#include "range/grid.h"

/* Nodes that say how a body moves: w and dw, a. */
enum { MOST_LEAVES = 16 };

struct cutting {
	const struct relaxed *r;
	const struct dag *d;
	const struct field *fields;
	int field_count, from, dims; /* of fields with so many rows of q, limbs of so many at most */
	const struct effort *x;
	double seconds;
	struct arena *a;
	int *body;               /* by output, where it is cut off; -1: nowhere */
	unsigned char *carries;  /* by body: its limbs are cut off for the sake of outputs that it carries them for */
	uint64_t *reads;         /* by node: rows of q that it depends on, where a body is cut off */
	unsigned char *live;     /* by node */
};

struct cutting cutting_of(const struct relaxed *r, const struct field *fields, int field_count, struct arena *a);

/* Where each output is cut off, and which bodies' limbs are. */
void cutting_choose(struct cutting *s);

/* Has this body, with all beyond it, few enough rows of q? Is none of their outputs cut off? */
int cutting_is_small(const struct cutting *s, int body);
int cutting_is_whole(const struct cutting *s, int body);

/* The body of the joint that a torque is of; -1: it is none. */
int cutting_body(const struct cutting *s, int output);

/* The leaves of a body, at most MOST_LEAVES. Returns how many; -1: more. */
int cutting_leaves(const struct cutting *s, int body, uint32_t *leaves);

/* Their ranges. Returns 0 when memory runs out, or nothing is known. */
int cutting_ranges(const struct cutting *s, const uint32_t *leaves, int count, struct interval *ranges);

#endif
