#ifndef RNEAGEN_SINGULAR_H
#define RNEAGEN_SINGULAR_H
/* Is the mass matrix singular whatever the state: does a joint move no mass of its own, or next to none? Or is what
   opspace is the inverse of? */

#include "dag/dag.h"
#include "request/request.h"
#include "tree/tree.h"

/* Sets d->singular, and d->failed, where it is; d->failed alone when memory runs out. Returns d->failed. */
int singular_find(struct dag *d, const struct tree *t, const struct request *k);

#endif
