#ifndef RNEAGEN_FACTOR_H
#define RNEAGEN_FACTOR_H
/* M = L^T D L of a symmetric matrix, which keeps the zeros that the tree's branches leave in a mass matrix where rows are taken
   in the order of the tree, bodies before what they carry (Featherstone 2008, section 6.5); and what is solved with it. */

#include "dag/dag.h"

struct factor {
	struct dag *d;
	int n;
	int *row;                /* [n]: by place in the order */
	struct ref *L;           /* [n][n], below the diagonal, which is 1 */
	struct ref *D, *inverse; /* [n]: and 1/D */
};

/* From all elements of M, [n][n]; `order`: its rows, one after the other, NULL: as they come. Returns 0 when memory runs out,
   or where a number of D is zero, whatever the inputs: *singular is then its row, else -1. */
int factor_make(struct factor *f, struct dag *d, int n, const int *order, const struct ref *M, int *singular);

/* M x = b, in place. */
void factor_solve(const struct factor *f, struct ref *x);

/* The first half of it, L^T y = b in place: a^T M^-1 b is the sum of y_a y_b/D. */
void factor_reduce(const struct factor *f, struct ref *x);

/* The second half: D L x = y in place. */
void factor_expand(const struct factor *f, struct ref *x);

/* What row y of a Y with L^T Y = J^T, [n], adds to J M^-1 J^T = Y^T D^-1 Y: below and on the diagonal of X, [n][n]. */
void factor_add_felt(struct dag *d, int n, const struct ref *y, struct ref inverse, struct ref *X);

/* M^-1, [n][n], symmetric. */
void factor_inverse(const struct factor *f, struct ref *X);

#endif
