#ifndef RNEAGEN_ROWS_H
#define RNEAGEN_ROWS_H
/* Rows of q, qd, qdd and tau: which joint has which. */

#include "tree/tree.h"

/* Fill t->joints, nq, nv and the rows of all bodies, depth-first or as the options order them. Errors: NO_JOINTS, USAGE
   (an order that does not fit), MEMORY. */
enum rneagen_code rows_number(
	struct tree *t, const struct rneagen_options *o, struct arena *a, struct rneagen_error *e);

#endif
