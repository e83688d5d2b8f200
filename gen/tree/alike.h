#ifndef RNEAGEN_ALIKE_H
#define RNEAGEN_ALIKE_H
/* Limbs of one body that differ in their constants alone, as the legs of a quadruped do: lanes of vectors can compute them
   side by side. */

#include "base/arena.h"
#include "tree/tree.h"

enum { ALIKE_LIMBS = 4 };

/* Limb k, from 0, has the bodies from first + k*bodies on, and as many rows from q + k*bodies and v + k*bodies on. bodies: 0
   where there are none. */
struct alike {
	int first, bodies, q, v;
};

/* Find such limbs; `told` becomes the tree with constants that know their limb where they differ. Returns 0 where there are none,
   or memory runs out. */
int tree_alike(struct alike *x, struct tree *told, const struct tree *t, struct arena *a);

#endif
