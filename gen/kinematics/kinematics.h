#ifndef RNEAGEN_KINEMATICS_H
#define RNEAGEN_KINEMATICS_H
/* Where bodies are in the world, and what a scene wants of that: poses, Jacobians, centroidal quantities. The world's frame is
   the root link's; of a floating base that of its q. */

#include "mechanics/joint.h"
#include "mechanics/rigid_body.h"
#include "tree/pattern.h"

/* What stands for a joint in offsets: a point on the axis of one that turns, the origin of its body else. */
struct axis_point {
	struct within along;     /* from the origin, along the axis */
	struct within offset[3]; /* where it is in the parent's frame, before the joint slides */
	int is_used;             /* it is on the way to a link that is asked for */
};

/* A body in the world. */
struct placed {
	struct joint_pose pose; /* in its parent */
	struct smat A;          /* the joint's axes in the world, before it turns */
	struct smat R;          /* the body's */
	int is_unit;            /* no floating joint is on the way: the quaternion has norm one */
	struct svec step;       /* from the parent's point to its own, in the parent's axes */
	struct svec from;       /* the point of the body that the world carries on this chain, in the world */
	struct svec point;      /* from there to its own, in the world's axes: without digits that a far base takes */
	struct ref quaternion[4]; /* x y z w, where poses are written so; the orientation is that, then C */
	struct rotation C;
	struct svec p;          /* from there to the body's origin */
};

struct kinematics {
	struct dag *d;
	const struct tree *t;
	const struct request *k;
	struct joint_inputs in;                /* q is read */
	struct parameters *const *parameters;  /* by body, of those whose parameters are no numbers */
	const int *outputs;                    /* arguments, by want */
	int gives_rate;                        /* kinematics_momentum_rate, or a later run, gives the rate of the momentum */
	int hub;                               /* the only body that the world carries; -1: the world */
	struct ref mass;                       /* of all that moves, where that is asked for; its centre, seen from the hub */
	struct svec com;
	struct axis_point *points;             /* by body */
	struct placed *bodies;
};

/* How a point of a body moves: velocity and classical acceleration of its origin, angular velocity and its rate, all in
   the body's frame. */
struct carried_motion {
	struct svec v, w, a, dw;
};

/* Choose x->points. Returns 0 when memory runs out. */
int kinematics_slide(struct kinematics *x);

/* From a body's point (-1: the world's origin) to v in its frame. */
struct svec kinematics_from_point(const struct kinematics *x, int body, const struct within v[3]);

/* Place all bodies, and write what is wanted of their places. x->bodies is made here. */
void kinematics_run(struct kinematics *x);

/* Write what is wanted of dJ/dt qd of the links that a body carries, from its motion where nothing accelerates. */
void kinematics_rate(const struct kinematics *x, int body, const struct carried_motion *m);

/* Write what is wanted of the rate of the momentum, from what a tour of the torques finds that all that moves takes
   against gravity, g in the world's axes: force, and moment about the hub's origin, in its frame. */
void kinematics_momentum_rate(const struct kinematics *x, struct svec f, struct svec n, struct svec g);

/* A frame at X in a body: its axes in the world, and its origin as struct placed has p. */
void kinematics_frame(const struct kinematics *x, int body, const struct placement *X, struct smat *R, struct svec *p);

/* Columns of want `w` in the frame that the request says: linear, then angular; [6][nv], the rest is zero. */
void jacobian_columns(const struct kinematics *x, const struct want *w, struct ref *J);

/* Axes and origin of a want's frame as kinematics_frame has them, by the way back that its Jacobian in the link's frame takes. */
void jacobian_frame(const struct kinematics *x, const struct want *w, struct smat *R, struct svec *p);

/* A body's quaternion, from its parent's; its axes in the world, from that. */
void quaternion_place(const struct kinematics *x, int body);
struct smat quaternion_turn(const struct kinematics *x, int body);

/* The quaternion x y z w of a frame at X in a body, continuous in q. Where q is zero, and floating bodies along their parents'
   axes, w is positive, or the first of x, y and z that is not zero, if w is. */
void quaternion_of(const struct kinematics *x, int body, const struct placement *X, struct ref *quaternion);

#endif
