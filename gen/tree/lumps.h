#ifndef RNEAGEN_LUMPS_H
#define RNEAGEN_LUMPS_H
/* Bodies that move by themselves, each with those that are held on it as one: a lump has ten inertial parameters of its own. */

#include "tree/tree.h"

enum { LUMP_PARAMETERS = 10 };

struct lumps {
	int count;
	int *body; /* by lump: the body that moves it */
	int *of;   /* by body: its lump; -1: it is held on the ground */
};

/* Is a body, or the world (-1), held on the ground? */
int lumps_is_held(const struct tree *t, int body);

/* In the order of the bodies. Returns 0 when memory runs out. */
int lumps_make(struct lumps *x, const struct tree *t, struct arena *a);

/* Of all that moves with a lump, about the origin of its body's link, in that link's URDF frame. */
struct inertia lumps_inertia(const struct lumps *x, const struct tree *t, int lump);

#endif
