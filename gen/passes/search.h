#ifndef RNEAGEN_SEARCH_H
#define RNEAGEN_SEARCH_H
/* Base parameters and frames of their own for all bodies of a tree, by counted operations of its torques. */

#include "base/error.h"
#include "tree/restate.h"

/* By body, in `by`; keeps[body]: nothing goes to its parent. Only joints that turn or slide have frames of their own, and only
   such as leave the error of the torques within 1.15 times that of the tree as it is. The same tree gives the same choices.
   Errors: MEMORY. */
enum rneagen_code search_params(struct restatement *by, const struct tree *t, const char *keeps,
	const struct rneagen_allocator *allocator, struct rneagen_error *e);

#endif
