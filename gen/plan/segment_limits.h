#ifndef RNEAGEN_SEGMENT_LIMITS_H
#define RNEAGEN_SEGMENT_LIMITS_H
/* Whether a pass is cut into segments, and where cuts may be. */

#include "plan/segments.h"
#include "request/request.h"
#include "rneagen.h"

/* What a pass is to become. */
enum segment_use { SEGMENT_NONE, SEGMENT_LOOPS, SEGMENT_KERNEL };

/* Make p->segments as the options ask for, or where that pays. Without loops or a kernel of its own a pass stays whole.
   Returns 0 when memory runs out. */
int segments_choose(struct pass *p, enum segment_use use, const struct request *k, const struct rneagen_options *o,
	struct arena *a);

#endif
