#ifndef RNEAGEN_FORWARD_H
#define RNEAGEN_FORWARD_H
/* Forward dynamics: qdd = qdd_0 + M^-1 (tau - ID(q, qd, qdd_0)). Any qdd_0 would do; that of the tour (`eased`) leaves the fewest
   operations. */

#include "dynamics/articulated.h"
#include "dynamics/recursion/recursion.h"
#include "mechanics/schur.h"
#include "tree/pattern.h"

struct build;

/* By row of qd, the first of those whose columns one loop solves; -1: none does. On a processor a loop's columns of both
   gradients stand side by side in an array of their own, as a compiler's vectors want them, and are copied from there; `rooms`,
   by that first row, says where. For batches, and in a relay, they make the columns in place, in the matrices, and are of columns
   that d tau leaves zero in the same rows. In a relay each kernel reads what the one before has written, qdd too. */
struct loops {
	int *first;
	int is_in_place;
	int is_relay;
	int reads_all;          /* of a column in place, zeros too */
	int is_in_lanes;        /* coordinates go back to the base side by side (recursion/recursion_lanes.c) */
	struct column_room *rooms; /* NULL in place */
	int rows;               /* of that array */
	struct pattern related; /* of d tau */
};

struct forward {
	struct build *b;
	struct source torques;  /* tau */
	int stands;             /* contacts' forces are found with qdd; else those of b->forces, if there are contacts, pull */
	struct tour tour;       /* ID(q, qd, qdd_0); M, or the articulated bodies, along with it */
	struct recursion mass;
	struct articulated bodies;
	struct factor M;
	/* of contacts (contacts.c): J M^-1 J', and by row of theirs unit forces on their way back */
	struct schur *S;
	struct svec *unit_f, *unit_n;
	struct pattern coupled; /* of the derivatives of qdd */
	struct ref *qdd;        /* [nv], then the contacts' forces */
	unsigned char *looped;  /* [arguments][nv]: columns that are left to a loop; NULL: none */
	int singular;           /* the row of qd that moves no mass, -1 where all do */
};

/* Find qdd of x->torques. `in` says where q and qd are. d->failed is set when memory runs out, or a joint moves no mass:
   d->singular then says which. */
void forward_find(struct forward *x, struct build *b, struct joint_inputs in);

/* Factors of M, or articulated bodies, and no more. */
void forward_factor(struct forward *x, struct build *b, struct joint_inputs in);

/* Six pairs of an opspace. */
void opspace_pivots(struct build *b, int want, struct ref *pairs);

/* What is wanted of the inertia that is felt at links: J M^-1 J^T, and its inverse. `in` says where q is. */
void opspace_outputs(struct build *b, struct joint_inputs in);

/* ---- more of qdd ---- */

/* qdd + M^-1 (tau - ID(q, qd, qdd)) in place of x->qdd; `in` as for forward_find. */
void refine_step(struct forward *x, struct joint_inputs in);

/* Of either way, as an output "pivots": a number of D and the element of M's diagonal that it is left of, for each row of qd;
   then six such pairs of each opspace that is wanted. `in` says where q is. */
void forward_pivots(const struct forward *x, struct joint_inputs in);
int forward_pivot_count(const struct tree *t, const struct request *k);

/* Write qdd and M^-1 where these are wanted; -1: they are not. */
void forward_outputs(const struct forward *x, int qdd_out, int inverse_out);

/* Nothing folds these values with what they are made of: a product by a constant becomes a quotient. */
void forward_part(struct dag *d, struct ref *values, int count);

/* Write how far each qdd may be off; -1: it is not wanted. `in`: as before, with the qdd that was found. */
void forward_bound(const struct forward *x, struct joint_inputs in, int argument);

/* The wrenches from outside; the terms of joints join in by own_terms. */
void forward_enter(const struct tour *r, int body);

/* M^-1, [nv][nv], as far as the elements are not zero for all states. */
void forward_inverse(const struct forward *x, struct ref *X);

/* From column j of d tau at this qdd, [nv], that of d qdd = -M^-1 d tau, and write it; in place. Where columns are looped
   over, write -d tau, and leave M^-1 to the loop. */
void forward_column(const struct forward *x, struct ref *column, int j, int argument);

/* The columns of a body, from those that the recursion has made of d tau, by q and qd; -1: not into this argument. */
void forward_by_body(const struct forward *x, const struct recursion *by, int body, const int *arguments);

/* Declare the array of the loops' columns, after all that the request declares. */
void forward_declare_columns(struct dag *d, const struct loops *x);

/* Column j of d tau, where its loop is to find it; in place of -d tau. */
void forward_leave_column(const struct forward *x, const struct ref *column, int j, int argument);

/* The loops, which come last: M^-1 of each column in its place. */
void forward_loop(const struct forward *x);

/* One loop over all columns, behind those of coordinates on their way back to the base; 0: not all joints feel each other. */
int forward_loops_behind(struct loops *x, const struct tree *t, const struct request *k, int is_in_place, struct arena *a);

/* Where there are such, they put elements of d tau into the columns of that loop, or, without it, into `arguments`, by matrix. */
void forward_tell_matrices(const struct build *b, const int *arguments);

/* Which rows are worth one, where matrices are sparse or dense; in place all of them. Returns how many loops that makes; 0 also
   when memory runs out, or there are more than a DAG may have. */
int forward_loops(struct loops *x, const struct tree *t, int dense, int is_in_place, struct arena *a);

/* Does the loop over column j of nv read row i? */
int loops_read(const struct loops *x, int nv, int i, int j);

/* M y = rhs in place, by rows of qd; with contacts as contacts_solve. */
void forward_solve(const struct forward *x, struct ref *rhs);

#endif
