#ifndef RNEAGEN_REGRESSOR_H
#define RNEAGEN_REGRESSOR_H
/* The torques by the inertial parameters of all bodies. */

#include "dynamics/tour.h"
#include "tree/lumps.h"
#include "tree/pattern.h"

/* What a unit rate of a coordinate makes of a body beyond its joint: its twist at the body's origin, in the body's frame. */
struct carried_twist {
	int row;
	struct svec V, W;
};

struct regressor {
	const struct tour *r; /* NULL: nobody asks for it */
	int argument;
	struct pattern p;
	struct lumps lumps;
	struct body_twists {
		int count;
		struct carried_twist *of; /* by coordinate, from the base on; more than one may be of the same row */
	} *twists;                        /* by body */
	struct ref (*element)[LUMP_PARAMETERS]; /* by row of qd: the columns of one lump */
};

/* d->failed is set when memory runs out. */
void regressor_begin(struct regressor *x, const struct tour *r, int argument);

/* When the tour has entered a body. */
void regressor_enter(struct regressor *x, int body);

#endif
