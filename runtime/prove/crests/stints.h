#ifndef RUNTIME_PROVE_STINTS_H
#define RUNTIME_PROVE_STINTS_H
/* How long each output is worked on. */

#include "dag/dag.h"

struct stint {
	size_t output;
	double work, seconds;
};

/* By output, those of which the most depends first; each as long as it has pairs of values and derivatives, and no
   longer than all, so that `threads` of them are done in these seconds. In `arena`; NULL when memory runs out. */
struct stint *stints_make(const struct dag *d, unsigned threads, double seconds, struct arena *arena);

#endif
