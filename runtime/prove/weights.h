#ifndef RUNTIME_PROVE_WEIGHTS_H
#define RUNTIME_PROVE_WEIGHTS_H
/* Which values, derivatives and pairs of them make the error of an output, and how much each. */

#include "peaks/peaks.h"
#include "prove/twins.h"

/* Into p->list, which lives in p->arena, by terms[i], what node i of the text makes of the error. Returns 0 when memory
 * runs out. */
int weights_find(struct peaks *p, const struct view *v, const double *terms);

#endif
