#ifndef RUNTIME_CERTIFY_ASSUMPTIONS_H
#define RUNTIME_CERTIFY_ASSUMPTIONS_H
/* What a proof rests on. */

#include "passes/analysis.h"

enum { ASSUMPTION_COUNT = 11 };

struct assumption {
	int (*needed)(const struct analysis *a); /* NULL: of every robot */
	const char *text;
	const char *of_rows; /* what rnearun prove has to add, whose rows say more; NULL: nothing */
};
extern const struct assumption ASSUMPTIONS[ASSUMPTION_COUNT];

/* Is it one of this robot's? */
int assumption_is_needed(const struct analysis *a, int i);

#endif
