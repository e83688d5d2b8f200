#ifndef RNEAGEN_ARTICULATED_H
#define RNEAGEN_ARTICULATED_H
/* M x = b by articulated bodies, without M (Featherstone 2008, sections 7.2 and 7.3, at rest: the velocities are in b). A tree
   whose joints follow others has no such bodies: there several move with one coordinate. */

#include "mechanics/factor.h"
#include "dynamics/tour.h"

/* What a body's own acceleration takes, all beyond it moving freely: n = A dw + B a, f = B^T dw + C a. */
struct articulated_body {
	struct smat A, B, C;
	struct svec Un[6], Uf[6]; /* of each row of the joint: the wrench that its unit acceleration takes */
	struct factor D;          /* of the joint: what it feels of these */
};

struct articulated {
	const struct tour *r;
	struct articulated_body *bodies;
};

/* May the tree be solved so? */
int articulated_serves(const struct tree *t);

/* And does it surely take fewer operations than factors, whose number grows with the cube of a chain's length? From 78 joints in
   a row on; of shorter chains both are made and counted. */
int articulated_is_shorter(const struct tree *t);

/* Before a tour, and when it leaves a body. d->failed is set when memory runs out. */
void articulated_begin(struct articulated *x, const struct tour *r);
void articulated_leave(struct articulated *x, int body, int *singular);

/* M x = b in place, by rows of qd, after the tour. What wrenches on the bodies make joints feel is taken off b: by body, in its
   frame and about its origin; NULL: there are none. */
void articulated_solve(const struct articulated *x, struct ref *b, const struct svec *f, const struct svec *n);

/* The way back of that alone: what joints are left with, halfway through their D, by rows of qd. It goes with the rows of
   articulated_reduce. */
void articulated_halve(const struct articulated *x, const struct ref *b, struct ref *y);

/* Of a wrench on a body, in its frame, about its origin: what the joint feels, halfway through its D, row by row; then the wrench
   is carried to the parent, as what that feels of it. As in factor.h, J M^-1 J^T is made of the products of these rows over D. */
void articulated_reduce(const struct articulated *x, int body, struct svec *f, struct svec *n, struct ref *y);

#endif
