#ifndef TESTS_SCENE_MODEL_H
#define TESTS_SCENE_MODEL_H
/* A robot cut down by a scene, held against the reference of a whole one. */

#include "support/model.h"
#include "tell/effect.h"
#include "support/torque.h"

struct scene_model {
	struct arena arena;
	struct robot robot;
	struct tree tree;
	struct dag dag;
	struct rneagen_error error;
	struct analysis analysis; /* the same, and what else there is of it */
	struct effects effects;   /* for those who measure them */
};

/* Read and build with options; returns the code. scene_close in either case. */
enum rneagen_code scene_open(struct scene_model *m, const char *urdf, const struct rneagen_options *o);
void scene_close(struct scene_model *m);

/* A reference for the same options but the scene; aborts where it refuses. */
struct reference *scene_reference(const char *urdf, const struct rneagen_options *o);

/* The joints that are held, by entry of reference->joints: `q` has the value, by row. */
struct scene_held {
	char held[ROWS];
	double q[ROWS];
};

/* All of zero (identity for floating joints), none held. */
void scene_held_init(struct scene_held *h, const struct reference *r);

/* Torques of the cut robot are those of the whole one with the held joints at rest where they are held, in extended
   precision, f64 and f32, by the magnitudes that are summed. */
void scene_compare(const struct scene_model *m, struct reference *r, const struct scene_held *h, uint64_t seed, const char *what);

/* The URDF of the part below link `root`, without the joints named in gone[count] and all beyond them; the caller frees
   it. NULL where a joint follows one that is not there. */
char *scene_urdf(const char *urdf, const char *root, const char *const *gone, int count);

size_t operation_total(const struct scene_model *m);

/* The number of the joint of this name; the test fails where there is none. */
int entry_named(const struct reference *r, const char *name);

/* Which row of the whole's qd is each row of what is left. */
void scene_rows(const struct tree *t, const struct reference *r, int *rows);

/* A state of the whole, whose joint `held` (-1: none) stands still at `at` from now on, as q, qd and qdd of what is left. */
void scene_settle(const struct tree *t, const struct reference *r, int held, double at, double *q, double *qd, double *qdd,
	real (*left)[ROWS]);

#endif
