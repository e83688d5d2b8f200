#ifndef RNEAGEN_APART_H
#define RNEAGEN_APART_H
/* A long text of torques, of accelerations, or of torques with their vjp, in parts that share nothing: limbs of a robot that
   stands on the ground, each joined to the ground alone. A part holds less in shared memory and in registers, is shorter, and
   nothing is made twice. Or parts of torques for hands (hands.h), which make the motion of their arms again, and for the rest. A
   part with a vjp in f64 makes some of its motion again (again.h), even where it is alone; in layout aos its outputs stand where
   inputs stood (places.h). Where none of that serves, by two kernels, of which the first finds what the second reads (found.h,
   base_first.h). */

#include "plan/grid/hands/hands.h"

/* *count is 0 where that does not serve: there is one limb without hands, or the text is short. Returns 0 when
   memory runs out. */
int apart_make(struct part **parts, int *count, const struct parts_of *x, struct arena *a);

/* Does a product stand in the places of inputs wherever it is staged? */
int apart_has_places(const struct parts_of *x);

typedef void make_stretches(struct stretches *s, const struct dag *d, int nv);

/* One of these parts: the outputs of an owner, in an order of its lines in which what is handed on is read before it is written
   over; `what` is said of it. Then the rows that it reads and
   writes, with nv for those of a vjp in the places of inputs, and its bodies. Return 0 when memory runs out. */
int apart_build(struct part *p, struct share *share, int owner, int number, const char *what, const struct parts_of *x,
	struct arena *a);
int apart_set_rows(struct part *p, make_stretches *make, int nv, const struct parts_of *x, struct arena *a);

/* Parts of hands, whose levels are theirs, numbered from `number` on. Returns 0 when memory runs out. */
int apart_make_hands(struct part *parts, int number, const struct hands *h, const struct parts_of *x, struct arena *spare,
	struct arena *a);

/* Such parts of a DAG, by the owners of its outputs, numbered from `number` on. Returns 0 when memory runs out. */
int apart_make_limbs(struct part *parts, int number, int count, const struct dag *d, const int *owner, const char *what,
	const struct parts_of *x, struct arena *spare, struct arena *a);

#endif
