#ifndef RNEAGEN_DRAW_H
#define RNEAGEN_DRAW_H
/* Seeded values for every array that the text of a scene reads. */

#include "dag.h"
#include "sample.h"

/* The inputs of a DAG, and q, qd and qdd whether it has them or not. */
enum { DRAWN_ARRAYS = DAG_ARGUMENTS + 3 };

struct drawn_array {
	const char *name;
	size_t rows;
	int per_batch;
	double *values; /* [sample][row], or [row] where it is for the whole batch */
};

struct drawn {
	struct states states; /* what q, qd and qdd, the first three arrays, point at; drawn whether the text reads them or not */
	struct drawn_array arrays[DRAWN_ARRAYS];
	int count;
};

/* The states are those of sample_states, whatever else there is. What the scene frees is drawn around what the URDF says:
   a mass, and all of an inertia, times one factor within 0.1 of 1; gravity by 0.1 of its length in each axis; an offset
   within 0.1 of 0. A payload, like the mass or inertia of a link that has none, is a box of 0 to 1 kg, no side over
   0.2 m, no farther than 0.1 m from the link in each axis. External forces and moments are within 10 of 0, and within 1 all
   other inputs of the DAG. Returns 0 when memory runs out; the caller gives *x to draw_free. */
int draw_inputs(struct drawn *x, const struct robot *r, const struct tree *t, const struct dag *d,
	const struct sample_options *o);

/* Round every number to single precision. */
void draw_round(struct drawn *x);
void draw_free(struct drawn *x);

/* The rows of an input in one sample. NULL for an output. */
const double *draw_rows(const struct drawn *x, const struct argument *a, size_t sample);

#endif
