#ifndef RNEAGEN_FIRST_SINES_H
#define RNEAGEN_FIRST_SINES_H
/* A plan whose sines stand in a table before its first line. */

#include "plan/plan.h"

/* The lines of p, with a LINE_SINE for each sine and cosine, and without what only angles take. The angles in `list`, by their
   rows, go with them: sines[2*i] is the sine of angle i, sines[2*i + 1] its cosine. Returns 0, and leaves both, where there are
   no angles, or one of them is not made of an input alone, or when memory runs out. */
int first_sines_make(struct plan *out, struct angles *list, const struct plan *p, struct arena *a);

/* The row of the input that such an angle is made of. */
int first_sines_row(const struct dag *d, struct ref angle);

#endif
