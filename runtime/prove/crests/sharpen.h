#ifndef RUNTIME_PROVE_SHARPEN_H
#define RUNTIME_PROVE_SHARPEN_H
/* Caps of what an output's error is made of, over the whole box: by points of q first (peaks.h), then a few by knots
 * (crests.h). */

#include "prove/crests/crests.h"
#include "prove/twins.h"
#include <stdatomic.h>

struct sharpening {
	const struct dag *text;
	size_t output;
	const struct adjoint *x;
	struct view *view; /* whose values' `most` and `most_norm` are lowered */
	const struct interval *const *rows;
	int position, dim_count;
	const int *dims; /* rows of q that have room */
	const struct relaxed *relaxed;
	const struct effort *effort;
	/* The error over the box with the caps that there are, and by node of the text what it makes of that: NULL when
	 * memory runs out. */
	double (*error)(void *context);
	double *(*terms)(void *context);
	void *context;
	_Atomic double *known; /* by node of the text: what other outputs have found of its value */
	struct arena *arena;
};

/* Returns 0 when memory runs out. */
int sharpen(const struct sharpening *s, double of_peaks, double of_crests);

#endif
