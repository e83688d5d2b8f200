#ifndef TESTS_DRAWING_H
#define TESTS_DRAWING_H
/* A scene while it is drawn, and what its lines are written with. */

#include "dice.h"
#include "rneagen.h"
#include "scene/scene.h"
#include "tree/tree.h"

/* `tree` is what the lines about joints and links leave, for those about the task. */
struct drawing {
	struct dice *d;
	const struct robot *r;
	struct rneagen_options o;
	struct arena *a;
	struct text out;
	struct tree tree;
	struct text used; /* names that were drawn for something that takes each once, one on a line */
	int folds_q, folds_qd;
	int is_forward; /* qdd is wanted, and tau an input */
	enum scene_key product; /* jvp or vjp, where there is one; 0: not yet */
};

/* Values with commas between; for a floating joint the last four are a quaternion of length 1. */
void drawing_numbers(struct drawing *g, struct text *t, int count, int has_quaternion);

/* Has this been drawn before, in a line that must not say it twice? Now it has. */
int drawing_is_new(struct drawing *g, const char *kind, const char *name);

struct text drawing_text(struct drawing *g);

/* A line of the scene as a file has it, or as the command writes its own. */
void drawing_line(struct drawing *g, enum scene_key key, const char *value);

/* The lines about inputs, outputs and terms: what the tree has. */
void drawing_task(struct drawing *g);

#endif
