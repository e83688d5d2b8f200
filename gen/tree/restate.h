#ifndef RNEAGEN_RESTATE_H
#define RNEAGEN_RESTATE_H
/* The same mechanism by other constants: frames of bodies moved along and turned about their joints' axes, and inertial
   parameters that a body's parent takes over without a change of any torque (Gautier and Khalil, Direct calculation of minimum
   set of inertial parameters of serial robots, 1990; Mayeda, Yoshida, Osuka, Base parameters of manipulator dynamic models,
   1990). */

#include "tree/tree.h"

/* What the parent takes: of a joint that turns about z, mass, first moment along z, and xx or yy of xx and yy both. */
enum regroup { REGROUP_NOTHING, REGROUP_FIRST, REGROUP_SECOND, REGROUP_COUNT };

/* Of one body. Its frame, in the frame it has: its origin at `slide`, turned about the axis of its joint by `turn`. Of that turn,
   `ahead` is added to the joint's angle; the rest is part of its placement. */
struct restatement {
	struct within slide[3];
	struct turn turn, ahead;
	enum regroup regroup;
};

/* What a body's frame may do: turn about its axis, slide along it (of a prismatic joint it may slide anywhere). */
int restate_turns(const struct body *k);
int restate_slides(const struct body *k);

/* A tree of its own bodies and links, restated by body from one as it was built. Returns 0 when memory runs out. */
int tree_restate(struct tree *out, const struct tree *t, const struct restatement *by, struct arena *a);

/* The same in two steps, for who tries many frames of one body: all that does not depend on it, and the rest. Both
   leave the links where they are. */
int tree_restate_around(struct tree *out, const struct tree *t, const struct restatement *by, int body, struct arena *a);
int tree_restate_body(struct tree *out, const struct tree *around, const struct restatement *by, int body, struct arena *a);

#endif
