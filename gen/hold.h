#ifndef RNEAGEN_HOLD_H
#define RNEAGEN_HOLD_H
/* Held joints that are dearer merged than as bodies of their own. */

#include "rneagen.h"
#include "tree/tree.h"

/* tree_build, with the joints kept as fixed bodies whose merging would cost more operations than it saves: where many
   bodies hang on a link that is turned by no right angle, each would take the turn for itself. So nothing costs more
   for being held. Errors: as tree_build. */
enum rneagen_code keep_build(struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a,
	struct rneagen_error *e);

#endif
