#ifndef RNEAGEN_JOINED_H
#define RNEAGEN_JOINED_H
/* Limbs that share nothing: stretches of rows whose outputs take no operation in common that varies from sample to sample. */

#include "dag/dag.h"

/* By output, of which each is a row of `nv` or of several times that: its part. A short limb shares one with its neighbours.
   Returns how many there are; 0 when memory runs out. */
int joined_own(int *owner, const struct dag *d, int nv, struct arena *a);

#endif
