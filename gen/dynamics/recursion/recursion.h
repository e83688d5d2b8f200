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

/* A coordinate on its way back to the base, or several side by side: their rows of qd, the body where they are,
   what they carry. */
struct traveller {
	int count, rows[DAG_LANES], at;
	struct row_vectors s;
	struct wrench w[BY_QDD];
};

/* Vectors that a coordinate carries: row_vectors, and a wrench by q and by qd. */
enum { WAY_VECTORS = 7 };

/* Coordinates on their way back to the base in loops. A row of qd has a place in an array. */
struct way_back {
	int argument;          /* the array */
	int rows, places;      /* of each place; with as many more as a vector may reach over */
	int carried, elements; /* of the rows: what a coordinate carries; what the joint and it make the other feel */
	int is_wanted[2];      /* d tau/d q, d tau/d qd */
	struct pattern to;     /* where elements are to stand */
	struct {
		int argument, first;
	} matrix[2];           /* in what, by q and by qd, and from which element on */
	int is_negated;        /* -d tau is to stand there */
	int is_batch;          /* samples are side by side, not coordinates */
	int loop, here;        /* while one is made: its number, -1 for none; the body to which it comes, -1: none is made */
};

struct recursion {
	const struct tour *r;
	struct composite *bodies; /* of the subtrees so far */
	char *is_shared;          /* by row of qd: several bodies move with it */
	struct by_matrix by[BY_COUNT];
	int has_gradients, has_coriolis; /* else no more is made than M */
	int has_shifts;                  /* gradients are solved with M, and made without their shifts too */
	int is_in_lanes;                 /* coordinates go back to the base side by side, and columns grow to the end */
	struct traveller *travellers;
	int traveller_count;
	const struct traveller *now;     /* whose elements are made; NULL: of one coordinate */
	struct way_back *way;            /* coordinates go back to the base in loops; NULL: they do not */
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

/* Is a column complete only at the end, and not when its body is left: where bodies follow others, or coordinates go back side by
   side? */
int recursion_grows(const struct recursion *x);

/* For each other. Elements as they grow (recursion_elements.c): add to one; row i of the gradients, by the coordinates of body
   `here`; M_ij, the unit acceleration of row i of body `from` felt by the joint of body `here`; column j, what that joint feels
   of a wrench; and write what is complete between row i and a body. */
int recursion_is_made(const struct recursion *x, enum by by);
void recursion_write(struct recursion *x, enum by by, int i, int j);
void recursion_add(struct recursion *x, enum by by, int i, int j, struct ref e);
void recursion_fill_row(struct recursion *x, int i, int here, const struct row_vectors *s);
void recursion_fill_mass(struct recursion *x, int i, int from, int here, const struct row_vectors *s);
void recursion_fill_column(struct recursion *x, enum by by, int j, int here, struct wrench w);
void recursion_write_between(struct recursion *x, int i, int here);

/* What is carried, at a body's parent. */
struct wrench recursion_wrench_to_parent(const struct recursion *x, int body, struct wrench w);
struct row_vectors recursion_row_to_parent(const struct recursion *x, int body, struct row_vectors s);

/* Coordinate i sets out from its body, with wrenches or without; all that are at a body go on to
   its parent (recursion_lanes.c). */
void recursion_send(struct recursion *x, int body, int i, const struct row_vectors *s, const struct wrench *w);
void recursion_go_on(struct recursion *x, int body);

/* The same in loops (recursion_loops.c). Returns 0 where that does not serve the request. Its array; what
   coordinate i carries when it sets out; what all coordinates share on their way from a body; an element, while a loop is made;
   and the loops, behind all else. */
int way_back_begin(struct way_back *w, const struct tree *t, const struct request *k, const struct pattern *to, int is_batch);
int way_back_makes(const struct tree *t, int i, int j); /* do loops make element (i, j)? */
void way_back_declare(struct way_back *w, struct dag *d); /* NULL: nothing */
void recursion_set_out(struct recursion *x, int body, int i, const struct row_vectors *s, const struct wrench *w);
void recursion_prepare(struct recursion *x, int body);
void recursion_put_element(struct recursion *x, enum by by, int i, int j, struct ref e);
void recursion_loop(struct recursion *x);

/* Where a body is; the unit twist (Z, Y) of its row, in its frame; and the fields of that coordinate, by what it
   is differentiated. */
const struct joint_pose *recursion_pose(const struct recursion *x, int body);
void recursion_unit_twist(const struct recursion *x, int body, int row, struct svec *Z, struct svec *Y);
void recursion_fields(const struct recursion *x, int body, int row, struct field *by);

#endif
