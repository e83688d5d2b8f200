#ifndef RNEAGEN_RECURSION_H
#define RNEAGEN_RECURSION_H
/* d tau/d q, d tau/d qd, the Coriolis matrix and the mass matrix by a recursion over composite bodies, along with a tour. */

#include "mechanics/composite.h"
#include "mechanics/field.h"
#include "tree/pattern.h"
#include "dynamics/tour.h"

/* What a matrix tells of the torques: what they are by q, qd and qdd; BY_CORIOLIS: by qd as a factor, C in C qd. */
enum by { BY_Q, BY_QD, BY_CORIOLIS, BY_QDD, BY_COUNT };

struct by_matrix {
	int argument;        /* -1: not asked for */
	struct pattern p;
	struct ref *element; /* [nv][nv] */
	char *is_done;       /* has been written */
	struct ref *apart;   /* [nv][nv]: of a column with a shift, the element without it */
	struct svec *shift;  /* by column: gamma of a coordinate that changes all accelerations alike; else zero */
};

struct recursion {
	const struct tour *r;
	struct composite *bodies; /* of the subtrees so far */
	char *is_shared;          /* by row of qd: several bodies move with it */
	struct by_matrix by[BY_COUNT];
	int has_gradients, has_coriolis; /* else no more is made than M */
	int has_shifts;                  /* gradients are solved with M, and made without their shifts too */
	int is_row_first;                /* a coordinate's row is carried back to the base before its columns are */
};

/* `arguments` says where the matrices go. d->failed is set when memory runs out. */
void recursion_begin(struct recursion *x, const struct tour *r, const int *arguments);

/* Is there such a shift in a body's fields by q and qd? A base that floats on the ground has one: by its orientation gravity
   turns in its axes, by its linear velocity w x v changes. M has a shift as columns of the base's slides. */
int recursion_is_shifted(const struct recursion *x, int body);

/* When the tour has left a body, with the wrench of its subtree; and when it is back. */
void recursion_leave(struct recursion *x, int body);
void recursion_end(struct recursion *x);

/* For recursion.c: where a body is; the unit twist (Z, Y) of its row, in its frame; and the fields of that coordinate, by what it
   is differentiated. */
const struct joint_pose *recursion_pose(const struct recursion *x, int body);
void recursion_unit_twist(const struct recursion *x, int body, int row, struct svec *Z, struct svec *Y);
void recursion_fields(const struct recursion *x, int body, int row, struct field *by);

#endif
