#ifndef RNEAGEN_BASE_FIRST_H
#define RNEAGEN_BASE_FIRST_H
/* Accelerations of a robot whose base moves freely, by two kernels, one after the other. The first makes the base's own from
   what each limb is felt as, and keeps nothing else of a limb when the next one begins (plan/order.h). Where it is long it is
   two, of which one makes what the base feels of the limbs on one side (hands/base_sides.h). The last reads it from rows of
   qdd and makes each limb again, with the joints' accelerations; limbs then share nothing (joined.h). One kernel would keep
   all that the way out takes of each limb until the base's acceleration is known. */

#include "plan/grid/parts.h"

/* Does everything hang on a base that moves freely and has the first rows? */
int base_is_free(const struct tree *t);

/* *count is 0 where that does not serve: another request, one that holds little at once, or parts that hold nearly as much.
   Returns 0 when memory runs out. */
int base_first_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a);

/* So many kernels of one part, for the base, and then one with so many parts, for limbs; none where it does not serve. */
struct base_first {
	int before, limbs;
};

/* The same of the accelerations of x->raw, `whole` of whose values are alive at once, where that serves precision and tree;
   `of` is said of them. Parts are numbered from `number` on, and there is room for 2 + nv. */
int base_first_serves(const struct parts_of *x);
int base_first_divide(struct base_first *k, struct part *parts, int number, const char *of, int whole, const struct parts_of *x,
	struct arena *spare, struct arena *a);

/* A DAG whose few outputs take all limbs, as one kernel before, or as two where its limbs are on two sides; *count: of them.
   Returns 0 when memory runs out. */
int base_first_make_before(struct part *parts, int *count, const struct dag *base, int number, const char *what,
	const struct parts_of *x, struct arena *spare, struct arena *a);

#endif
