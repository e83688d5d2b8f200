#ifndef RNEAGEN_EARLY_H
#define RNEAGEN_EARLY_H
/* Lines of a plan once more: a value or a store as soon as all that it reads is made, where then no more values
   wait than before. */

#include "plan/plan.h"

/* `early`: the plan with lines of its own. Loops stay as they are. Returns 0 when memory runs out. */
int plan_early(struct plan *early, const struct plan *p, struct arena *a);

#endif
