#ifndef RNEAGEN_ALIKE_H
#define RNEAGEN_ALIKE_H
/* Limbs of one body that differ in their constants alone, as the legs of a quadruped do, or both arms of a humanoid: lanes of
   vectors can compute them side by side. Joints that turn the other way are made to turn alike by another frame of their body,
   half a turn away: that changes signs of constants, and nothing else. */

#include "base/arena.h"
#include "tree/tree.h"

enum { ALIKE_LIMBS = 4, ALIKE_GROUPS = 16 };

/* Limb k has the bodies from first[k] on. */
struct alike_group {
	int bodies, first[ALIKE_LIMBS];
};

struct alike {
	int limbs; /* of each group: four, or two */
	int group_count;
	struct alike_group groups[ALIKE_GROUPS];
};

/* Find groups of so many limbs; `told` becomes the tree with constants that know their limb where they differ. Frames change
   where `may_turn`, but not what stands in them beside the bodies' own numbers: placements of links, what is free. Returns 0
   where there are none, or memory runs out. */
int tree_alike(struct alike *x, struct tree *told, const struct tree *t, int limbs, int may_turn, struct arena *a);

/* The limb, from 1 over all groups, whose joint has this row of q, or of qd, and which body of its group's first limb has that
   joint's place. 0: it is no limb's. */
int alike_limb(const struct alike *x, const struct tree *t, int is_q, int row, int *place);

#endif
