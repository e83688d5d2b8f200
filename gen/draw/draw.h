#ifndef RNEAGEN_DRAW_H
#define RNEAGEN_DRAW_H
/* Inputs of a scene, drawn over ranges: by the limits of the joints, by defaults, or as the scene's `range` says. What
   measures a text by samples takes them from here: prune.h, effect.h, and rnearun's report and choose. */

#include "dag/dag.h"
#include "request/request.h"

/* NUMBER: uniform from lower to upper. ROTATION: of a unit quaternion, uniform over all orientations. BODY: one of the
   ten numbers of a body whose mass is uniform from lower to upper. */
enum draw_kind { DRAW_NUMBER, DRAW_ROTATION, DRAW_BODY };

struct draw_range {
	enum draw_kind kind;
	double lower, upper;
	int is_known; /* the scene states it, or the URDF has it as a limit, or there is no other: every angle, every rotation */
};

struct drawn_array {
	const char *name; /* as the text has it */
	int rows, per_batch;
	const struct freed *freed;  /* NULL: no constant of the URDF's */
	struct draw_range *ranges;  /* by row */
	double *values;             /* [sample][row], or [row] where it is for the whole batch; NULL: not drawn yet */
};

/* q, qd and what drives the joints, qdd or tau, come first, whether the text reads them or not. */
enum { DRAWN_Q, DRAWN_QD, DRAWN_DRIVE, DRAWN_OTHERS };

struct drawn {
	struct drawn_array arrays[DAG_ARGUMENTS];
	int count;
	size_t samples;
};

struct draw_options {
	unsigned long long seed;
	size_t count;
	int each; /* what is the same for a whole batch is drawn for each sample all the same */
};

/* What the effect of changed constants is measured by. */
extern const struct draw_options DRAW_EFFECTS;

/* A limit of more than this, rad, m or per second, is as good as none. */
enum { DRAW_LIMIT = 1000 };

/* Where the scene says nothing: q within the limits of the joint, or where there are none within pi of 0 for angles, 1 m
   for lengths; qd within the limit, or 3 of 0; qdd within 10 of 0; tau within the effort limit, or 10 of 0. Gravity in each axis
   within its length of 0 (9.81 where it is none), a mass within a tenth of the URDF's, an offset within 0.1 of 0, forces and
   moments within 10 of 0, the vectors that derivatives are multiplied by within 1 of 0. A payload, and the mass or inertia of a
   link that has no mass, is a box of 0 to 1 kg, no side over 0.2 m, its centre no farther than 0.1 m from the link's origin in
   each axis; any other inertia has the URDF's mass within a tenth, of which such a box has up to a tenth, and the rest is spread
   as the URDF says. Arrays live in `a`. Return 0 when memory runs out. The same seed gives the same samples, and those of
   an input do not depend on ranges of others. */
int draw_ranges(struct drawn *x, const struct tree *t, const struct request *k, struct arena *a);
int draw_inputs(struct drawn *x, const struct tree *t, const struct request *k, const struct draw_options *o, struct arena *a);

/* Bounds of every row of an array, over all that is drawn of it. Angles that can have any value have -pi to pi. */
void draw_bounds(const struct drawn_array *x, double (*bounds)[2]);

/* Round every number to single precision. */
void draw_round(struct drawn *x);

/* The array of an input, and its rows in one sample. NULL for an output. */
const struct drawn_array *draw_array(const struct drawn *x, const struct argument *a);
const double *draw_rows(const struct drawn *x, const struct argument *a, size_t sample);

#endif
