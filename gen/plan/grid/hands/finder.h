#ifndef RNEAGEN_FINDER_H
#define RNEAGEN_FINDER_H
/* Hands on their way to be found. */

#include "plan/grid/hands/hands.h"

struct finder {
	const struct parts_of *x;
	const struct dag *d;
	struct hands *h;
	struct arena *a;
	int is_base;          /* hands are limbs of a base that moves freely (base_sides.c) */
	int is_felt;          /* of which the base's acceleration alone is made; all rows of joints are free until these are */
	int *children;        /* by body */
	unsigned char *taken; /* by body: 1 + the level of the hand that has it */
	unsigned char *rows;  /* by row of the last array: it belongs to a hand, or is taken by what one hands on */
	unsigned char *beyond, *from, *to, *kind, *meets; /* by node */
};

/* Rows of the array in which what is handed on stands. */
static inline int finder_rows(const struct dag *d)
{
	return d->arguments[parts_handed(d)].rows;
}

/* Is it an output of the hand's joints? What takes all limbs is none of theirs, in whatever rows it stands. */
static inline int finder_owns(const struct finder *f, const unsigned char *own, size_t output)
{
	return !f->is_felt && own[f->d->outputs[output].row % f->x->tree->nv];
}

/* Is it a hand, what `body` carries from body `first` to `end` - 1? A hand that is none has no cut. `own` has room for a row
   of qd each. The second takes it too. Return 0 when memory runs out. */
int finder_look(struct hand *m, struct finder *f, int body, int first, int end, unsigned char *own);
int finder_try(struct finder *f, int body, int first, int end, unsigned char *own);

/* The level's DAG with stores of what its hands, from the hand `begin` on, hand on; and a copy without these hands, in which
   that is read from the last array. Return 0 when memory runs out. */
int finder_share(struct finder *f, struct hand_level *level, int begin);
int finder_rest(struct finder *f, struct hand_level *level, int begin);

#endif
