#ifndef RNEAGEN_CENTROID_H
#define RNEAGEN_CENTROID_H
/* The centre of mass and the momentum of all that moves: a tour of the tree, along with the one that places bodies. */

#include "kinematics/kinematics.h"
#include "mechanics/composite.h"

/* A body with all that it carries, about its origin, in its frame: see momentum.c. */
struct load {
	struct ref mass;
	struct svec H, beyond;  /* C = H + beyond */
	struct svec P, K, F, N;
	struct motion motion;   /* w, dw and U */
	struct composite whole; /* mass, C and inertia */
};

/* What a unit rate of a row of qd makes, in the world's axes: linear momentum, and angular momentum about the centre of mass. */
struct momentum_column {
	struct svec linear, angular;
};

/* All is summed about the hub's origin. */
struct centroid {
	struct kinematics *x;       /* NULL: nobody asks for it */
	int has_columns, has_matrix;
	struct ref mass, inverse;   /* of all that moves */
	struct within unit;         /* of masses: 1, or all that moves */
	struct load *loads;         /* loads[0] is the world's, of body k loads[k + 1] */
	/* of the columns: those that several bodies add to, by row of qd; where elements are stored; the matrix times qd */
	struct momentum_column *shared;
	char *is_shared;
	struct pattern of_com, of_momentum;
	struct momentum_column times_qd;
};

/* x->bodies[k] is made when a body is entered. Failure is in d->failed. */
void centroid_begin(struct centroid *c, struct kinematics *x);
void centroid_enter(struct centroid *c, int body);
void centroid_leave(struct centroid *c, int body);
void centroid_end(struct centroid *c);

/* The argument of a want; -1: it is not asked for. */
int centroid_output(const struct kinematics *x, enum want_kind kind);

/* A body's own parameters. Returns 1 where these are numbers, *I. */
int centroid_own(const struct centroid *c, int body, struct inertia *I, struct parameters *p);

/* The centre of mass, as struct placed has p of the hub. */
struct svec centroid_from_first(const struct kinematics *x);

/* ---- columns ---- */

/* Before the tour; returns 0 when memory runs out. When a body is left, and when all are. */
int columns_begin(struct centroid *c);
void columns_leave(struct centroid *c, int body);
void columns_end(struct centroid *c);

/* ---- sums over subtrees ---- */

void load_move(const struct kinematics *x, int body, const struct load *parent, struct load *to);
struct svec load_moment(struct dag *d, const struct load *x);

/* Of the body of this number, when all that it carries is in; `numbers`: of parameters that are numbers. */
void load_add_own(struct dag *d, struct load *x, int number, const struct parameters *p, const struct inertia *numbers);
void load_add_child(const struct kinematics *x, int child, const struct load *c, struct load *to);

#endif
