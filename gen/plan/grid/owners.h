#ifndef RNEAGEN_OWNERS_H
#define RNEAGEN_OWNERS_H
/* To which body each output belongs: an element of a matrix to the deeper one of the bodies of its row and its column, all
   other outputs to body 0. */

#include "dag/dag.h"
#include "request/request.h"

struct owners {
	int *owner;  /* by output: an index into bodies */
	int *bodies; /* that own outputs, in order */
	int count;
};

/* Of the outputs of the request's DAG; `is_solved`: columns of gradients of qdd are solved in it, each as a whole. Returns
   0 when memory runs out. */
int owners_make(struct owners *x, const struct dag *d, const struct tree *t, const struct request *k, int is_solved,
	struct arena *a);

/* Does the request want a matrix by joints? */
int owners_matrix(const struct request *k);

#endif
