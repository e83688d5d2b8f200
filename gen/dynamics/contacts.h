#ifndef RNEAGEN_CONTACTS_H
#define RNEAGEN_CONTACTS_H
/* Links that stand: what holds them is found with qdd. Rows of both stand in one array, those of qd, then those of contacts. */

#include "dynamics/forward.h"
#include "dynamics/want.h"

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

/* The factors of that, when those of M are made, or bodies are articulated. d->failed is set when memory runs out, or with d->singular where
   contacts hold what is held already. */
void contacts_factor(struct forward *x, struct joint_inputs in);

/* M x + J' n = b, J x = c, in place; of qdd's own equations n is what pulls the other way. */
void contacts_solve(const struct forward *x, struct ref *rhs);

/* Write the forces that are wanted. */
void contacts_outputs(const struct forward *x);

/* Forces into rows of the first output, where the next kernel reads them: it finds qdd with these. */
void contacts_hand_on(struct forward *x);

/* A number of D of the factors, and the element that it is left of, for each row; what d->singular says of such a row. */
void contacts_pivots(const struct forward *x, struct ref *pairs);
int contacts_singular(const struct request *k, int row);

#endif
