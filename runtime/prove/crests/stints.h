#ifndef RUNTIME_PROVE_STINTS_H
#define RUNTIME_PROVE_STINTS_H
/* How long each output is worked on. */

#include "dag/dag.h"

struct stint {
	size_t output;
	double work, seconds;
};

/* By output, those of which the most depends first, so that `threads` of them are done in these seconds. Of the time
   this part is the same for all; of the rest each has as much as it has nodes and derivatives, to the third power. In
   `arena`; NULL when memory runs out. */
struct stint *stints_make(const struct dag *d, double equally, unsigned threads, double seconds, struct arena *arena);

#endif
