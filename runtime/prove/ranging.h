#ifndef RUNTIME_PROVE_RANGING_H
#define RUNTIME_PROVE_RANGING_H
/* What proving the ranges of a field works in. */

#include "range/cover.h"
#include "range/curvature.h"
#include "range/seek.h"

struct ranging {
	double (*found)[2], *largest, *bends;
	struct interval *whole, *ranges;
	struct curvature curvature;
	struct cover cover;
	struct knots knots;
};

/* With what a search has found, [output][2]. Returns 0 when memory runs out; ranging_free in either case. */
int ranging_make(struct ranging *r, const struct field *f, const struct sought (*found)[2]);
void ranging_free(struct ranging *r);

/* The cover of a field without a grid: plain intervals. Returns 0 when memory runs out. */
int ranging_plain(struct cover *c, const struct field *f);

#endif
