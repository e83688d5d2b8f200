#ifndef RNEAGEN_FRAMES_H
#define RNEAGEN_FRAMES_H
/* Frames of a body that may make constants of its neighbours zero. */

#include "tree/restate.h"

enum { FRAMES_MOST = 64 };

struct frames {
	struct restatement of[FRAMES_MOST]; /* in place of the body's in `by` */
	int count;
};

/* Turns about the axis: with the x-axis along the common normal to the axis of a child or the parent, along what stands
   across the axis of the first moment, of children's origins and of the inertia. Each as part of the joint's placement,
   and of its angle. */
void frames_turned(struct frames *f, const struct tree *now, const struct restatement *by, int body);

/* The same frame, with more or less of the turn added to the joint's angle. */
void frames_split(struct frames *f, const struct tree *now, const struct restatement *by, int body);

/* Slides along the axis, to where a number of the body's or a child's placement is zero. */
void frames_slid(struct frames *f, const struct tree *now, const struct restatement *by, int body);

#endif
