#ifndef RNEAGEN_JOINED_H
#define RNEAGEN_JOINED_H
/* Limbs that share nothing: stretches of rows whose outputs take no operation in common that varies from sample to sample. */

#include "dag/dag.h"
#include "tree/tree.h"

/* By output, of which each is a row of `nv` or of several times that: its part. A short limb shares one with its neighbours.
   Returns how many there are; 0 when memory runs out. */
int joined_own(int *owner, const struct dag *d, int nv, struct arena *a);

/* The same of limbs on a base that has the first rows: what is made of the base's inputs alone joins nothing, and each part
   makes it again. */
int joined_own_beyond(int *owner, const struct dag *d, const struct tree *t, int base_rows, struct arena *a);

#endif
