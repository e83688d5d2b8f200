#ifndef RNEAGEN_CONTACTS_H
#define RNEAGEN_CONTACTS_H
/* Links that stand: what holds them is found with qdd, in one array: rows of qd, then those of contacts. d->failed is set when
   memory runs out. */

#include "dynamics/forward.h"

/* Rows of qd, and of all contacts. */
int contacts_found(const struct build *b);

/* Of a body that has been entered: how contacts on it accelerate, into b->accelerated; and what pulls at it, b->forces. */
void contacts_entered(const struct tour *r, int body);
void contacts_pull(const struct tour *r, int body);

/* The torques of such a tour, and behind them how contacts accelerate; NULL when memory runs out. */
struct ref *contacts_join(const struct build *b, struct ref *torques);

/* Before a tour whose way back finds what forces on contacts make these accelerate by, J M^-1 J', and when it has left a body
   that is articulated. */
void contacts_begin(struct forward *x);
void contacts_left(struct forward *x, int body);

/* What that takes of M, when factors of M are made, or bodies are articulated. Once it is solved with, d->failed is set, with
   d->singular, where contacts hold what is held already. */
void contacts_factor(struct forward *x, struct joint_inputs in);

/* M x - J' f = b, J x = c, in place. */
void contacts_solve(const struct forward *x, struct ref *rhs);

/* M x = b - J' n in place of b, where nothing need stand. */
void contacts_solve_pulled(const struct forward *x, struct joint_inputs in, struct ref *rhs, const struct ref *n);

/* Write the forces that are wanted. */
void contacts_outputs(const struct forward *x);

/* What is left of S for each row when those before it are eliminated, and what that is compared with: how a unit force accelerates
   the contact's point, or turns its link, summed over three axes, so that it does not depend on these. What d->singular says of
   such a row. */
void contacts_pivots(const struct forward *x, struct ref *pairs);
struct singular contacts_singular(const struct request *k, int row);

/* ---- forces on their way from kernel to kernel, in rows of the first output (handed.c) ---- */

/* Write those that were found with qdd, and of a vjp those of the weights. */
void contacts_hand_on(const struct forward *x);

/* What all else takes for them, b->forces and b->weights: these rows, or, where nothing is handed on, inputs that are held until
   all is made. */
void contacts_hold(struct build *b);

#endif
