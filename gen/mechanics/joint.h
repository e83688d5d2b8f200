#ifndef RNEAGEN_JOINT_H
#define RNEAGEN_JOINT_H
/* What the joint types do, in symbols: where a joint puts its body, how it moves it, which part of a wrench it feels. */

#include "dag/svec.h"
#include "request/request.h"

/* Rows of an input: those that the scene gives (NULL: none), else those that were found (NULL: none), else the argument's; -1:
   zero. */
struct source {
	int argument;
	const struct row *given;
	const struct ref *found;
};

/* Where q, qd and qdd come from; what is added to rows of q (NULL: nothing). */
struct joint_inputs {
	struct source q, qd, qdd;
	const struct ref *offset;
	int by_halves; /* sine and cosine of an angle are made of those of its half, which are there */
	int is_again; /* what is made of orientations is made again: see dag_anew */
};

struct ref source_row(struct dag *d, const struct source *s, int row);

/* The joint at q. Its frame is turned by the constant R in the parent's; the body's frame is turned in the joint's by
   the angle (s, c) or, where the joint floats, by Q; p is the body's origin in the parent's frame. */
struct joint_pose {
	struct smat R, Q;
	struct svec p, slide; /* slide: of p what varies */
	struct ref s, c;
};

/* The rates along the joint's own axes: angular W and dW, and linear V and dV in the body's frame; linear V0 and dV0 in
   the joint's frame, before its turn. */
struct joint_rates {
	struct svec W, dW, V, dV, V0, dV0;
};

/* [1-2(yy+zz), 2(xy-zw), 2(xz+yw); ...] of x y z w, as a floating joint has it */
struct smat quaternion_matrix(struct dag *d, const struct ref *q);

struct joint_pose joint_place(struct dag *d, const struct body *k, struct joint_inputs in);
/* Sine and cosine of half the angle by which the joint turns its body; 0 and 1 where it does not turn. */
void joint_half_turn(struct dag *d, const struct body *k, struct joint_inputs in, struct ref *s, struct ref *c);

struct joint_rates joint_move(struct dag *d, const struct body *k, struct joint_inputs in);

/* The velocities that a unit rate of the joint's coordinate `row` makes; a follower's is its driver's coordinate. */
struct joint_rates joint_unit(struct dag *d, const struct body *k, int row);

/* From the joint's frame into the body's, and back: the variable turn. */
struct svec joint_into(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec u);
struct svec joint_out_of(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec u);

/* That unit rate as the twist (V, W) of the body, at its origin and in its frame. */
void joint_unit_twist(struct dag *d, const struct body *k, const struct joint_pose *x, int row, struct svec *V, struct svec *W);

/* R(q) u of the whole joint: from the body's frame into its parent's. */
struct svec joint_to_parent(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec u);

/* A T A^T for that rotation A */
struct smat joint_turn(struct dag *d, const struct body *k, const struct joint_pose *x, const struct smat *T);

/* The same, and R(q) u, of a sum of two whose second is symmetric too. What of the first varies with the joint goes to the
   second. */
void joint_turn_apart(struct dag *d, const struct body *k, const struct joint_pose *x, struct smat *constant,
	struct smat *varied);
void joint_to_parent_apart(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec *constant,
	struct svec *varied);

/* The generalized forces of the joint, joint_nv of them: the wrench (f, n) in the body's frame, and its force f0 in the
   joint's, along the joint's axes. */
void joint_project(struct dag *d, const struct body *k, struct svec f, struct svec n, struct svec f0, struct ref *tau);

#endif
