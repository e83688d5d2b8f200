#ifndef RNEAGEN_SCHUR_H
#define RNEAGEN_SCHUR_H
/* S = J M^-1 J^T = Y^T D^-1 Y, with M = L^T D L and L^T Y = J^T (factor.h): what constraints J x = c feel of M; and its own
   factors S = l d l^T. */

#include "dag/dag.h"

struct schur {
	struct dag *d;
	int n, nv;               /* rows of J; of M */
	struct ref *Y, *inverse; /* [nv][n]; [nv], 1/D */
	struct ref *S;           /* [n][n], on and below the diagonal: what the rows of Y that have joined make of it */
	unsigned char *joined;   /* [nv] */
	struct ref *left;        /* [n][n], likewise, columns of l d: what is left of S; NULL until there are factors */
	struct ref *over;        /* [n], 1/d */
};

/* Nothing of Y and D is known yet. d->failed is set when memory runs out, here and below. */
void schur_begin(struct schur *x, struct dag *d, int n, int nv);

/* Row i of Y and D joins S at once; one that never does, when S is factored, column by column of S: so a column of such rows is
   done with before the next one is taken. */
void schur_join(struct schur *x, int i);

/* n = Y^T D^-1 y. */
void schur_project(const struct schur *x, const struct ref *y, struct ref *n);

/* y - Y n in place of y. */
void schur_take(const struct schur *x, struct ref *y, const struct ref *n);

/* When all of Y and D is known; once more it does nothing. Rows of J are eliminated from the first on. Returns the first whose d
   is zero, whatever the inputs; -1: none is. */
int schur_factor(struct schur *x);

/* The sum of S's diagonal over these rows, when there are factors. */
struct ref schur_trace(const struct schur *x, int first, int count);

/* S n = b, in place. */
void schur_solve(const struct schur *x, struct ref *b);

#endif
