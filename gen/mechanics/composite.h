#ifndef RNEAGEN_COMPOSITE_H
#define RNEAGEN_COMPOSITE_H
/* A subtree as one composite body: its inertial parameters about the origin of the body that carries it, in that body's frame,
   and how they move. */

#include "mechanics/joint.h"
#include "mechanics/rigid_body.h"

/* Over the particles m at r, which move with r' (relative to the origin, in the body's axes): */
struct composite {
	struct parameters p; /* m, h = sum m r, I = sum m (r.r 1 - r r^T): the sum of these two */
	struct parameters constant, varied;
	struct svec P;       /* sum m r' */
	struct smat K;       /* sum m (r.r' 1 - r' r^T): K b = sum m r x (b x r') */
};

/* Add a body alone, whose particles move with r' = w x r: P = w x h, K = [w]x (I - tr(I)/2). The last that is added: makes p. */
void composite_add_body(struct dag *d, struct composite *to, const struct parameters *p, struct svec w);

/* Add the composite c of a child to that of its parent; `at` is the child's pose, `rate` the velocity of its origin relative
   to the parent's, in the parent's axes; NULL: P and K are not asked for. */
void composite_add_child(
	struct dag *d, struct composite *parent, const struct composite *c, const struct body *child, const struct joint_pose *at,
	const struct svec *rate);

#endif
