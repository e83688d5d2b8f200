#ifndef RNEAGEN_APART_H
#define RNEAGEN_APART_H
/* A long text of torques, of accelerations, or of torques with their vjp, in parts that share nothing: limbs of a robot that
   stands on the ground, each joined to the ground alone. A part holds less in shared memory and in registers, is shorter, and
   nothing is made twice. Or parts of torques for hands (hands.h), which make the motion of their arms again, and for the rest. A
   part with a vjp in f64 makes some of its motion again (again.h), even where it is alone; in layout aos its outputs stand where
   inputs stood (places.h). */

#include "plan/grid/parts.h"

/* *count is 0 where that does not serve: there is one limb without hands, or the text is short. Returns 0 when
   memory runs out. */
int apart_make(struct part **parts, int *count, const struct parts_of *x, struct arena *a);

#endif
