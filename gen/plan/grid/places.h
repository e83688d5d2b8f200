#ifndef RNEAGEN_PLACES_H
#define RNEAGEN_PLACES_H
/* Outputs of a part that take the places of inputs in shared memory: the torque, and a vjp for q, qd and qdd. */

#include "plan/grid/parts.h"

/* Does a function with such rows write there only after it has read what stood there? Sets *serves. Returns 0 when memory runs
   out. */
int places_serve(int *serves, const struct function *p, const struct stretches *s, struct arena *a);

#endif
