#ifndef RUNTIME_RELAX_RELAXING_H
#define RUNTIME_RELAX_RELAXING_H
/* What the files of relax.c share. */

#include "relax/quadric.h"
#include "relax/relax.h"

/* What a value of the text is made of: CONSTANT; AFFINE: a row of q, its multiples, and what is added to it; QUATERNION: of one
   joint's quaternion alone; OTHER. */
enum kind { CONSTANT, AFFINE, QUATERNION, OTHER };

struct seen {
	unsigned char kind, has_offset, is_angle; /* is_angle: sine or cosine read it */
	int row;                                  /* AFFINE: of q; QUATERNION: where the quaternion begins */
	double factor;                            /* AFFINE */
	struct quadric *quadric;
};

/* By node, of those that are used. NULL when memory runs out. */
struct seen *relax_see(const struct dag *d, const struct tree *t, const uint32_t *uses, struct arena *a);

/* An input of its own, for node `of`. */
struct fresh {
	uint32_t of;
	struct interval range;
	struct relaxed_row row; /* of q; of drives it says nothing */
	int is_drive, at;       /* the row, when all are known */
	int component, joint;   /* of R^T g: which, and of which quaternion; component -1: no such */
	real g[3];
};

struct relaxing {
	struct relaxed *out;
	const struct dag *d;
	struct interval *const *given;
	struct arena *a;
	struct rneagen_error *e;
	struct interval *plain;
	uint32_t *uses, *by_angle, *by_value; /* 1 + the fresh input that stands for a node where sine and cosine read it, and others */
	struct seen *seen;
	struct fresh *fresh;
	int fresh_count, position, is_boxed; /* is_boxed: balls are rows of q */
};

/* What stands for parts of the text, into s->fresh. Errors: UNSUPPORTED, MEMORY. */
enum rneagen_code relax_fresh(struct relaxing *s);

/* Bodies that turn by so many times a row of q; all that turn with it where none does by just that. */
int relax_turns(const struct tree *t, int row, double factor);

#endif
