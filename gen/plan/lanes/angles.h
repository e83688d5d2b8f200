#ifndef RNEAGEN_ANGLES_H
#define RNEAGEN_ANGLES_H
/* Angles whose sines stand in a table, and where. */

#include "plan/plan.h"

/* Those of a plan whose sines are wide numbers, or the others. */
struct angles angles_of(const struct plan *p, int is_wide, struct arena *a);

/* Where an angle of a DAG stands in the list; -1: nowhere. In loops over limbs (NULL: there are none) it is that of the limb,
   from 0. */
int angles_place(const struct angles *list, const struct dag *d, struct ref angle, const struct each *loops, int limb);

#endif
