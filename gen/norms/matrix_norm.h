#ifndef RNEAGEN_MATRIX_NORM_H
#define RNEAGEN_MATRIX_NORM_H
/* How much longer a matrix makes a vector at most. */

#include "norms/norms.h"

struct matrix {
	double m[NORMS_SET * NORMS_SET][NORMS_SET]; /* rows, columns */
	int rows, columns;
	double off; /* the root of the sum of squares of what elements are off */
};

/* ||A||, 2-norm, from above. */
double matrix_norm(const struct matrix *a);

#endif
