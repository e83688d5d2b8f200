#ifndef RNEAGEN_TREE_H
#define RNEAGEN_TREE_H
/* The kinematic tree that is computed: fixed joints merged, mimic relations resolved, bodies numbered depth-first,
   every constant placed. */

#include "base/arena.h"
#include "base/error.h"
#include "rneagen.h"
#include "scene/select.h"
#include "urdf/robot.h"
#include "tree/spatial.h"

/* One moving body. Its frame is the URDF frame of the joint's child link, turned by `frame` where the joint's axis is
   not a coordinate axis, so that inside the algorithm every axis is x, y or z. */
struct body {
	int number;            /* in names and comments: from 1, or from 0 where 0 is the floating base */
	const char *link;      /* the joint's child link */
	const char *joint;     /* "" for the floating base */
	int parent;            /* body index, smaller than the body's own; -1: the world */
	enum joint_type type;  /* fixed: held, and not merged */
	struct within turn;    /* of a fixed one about its axis, not in X */
	struct turn ahead;     /* of one that turns: added to its angle, by sine and cosine; 0, 0 stands for none */
	int axis, sign;        /* revolute, continuous, prismatic, planar: coordinate axis, and +1 or -1 along it */
	struct placement X;    /* the joint's frame at q = 0 in the parent body's frame (the world: root link's frame) */
	struct rotation frame; /* x_urdf = frame x_body + origin */
	struct within origin[3];
	struct inertia inertia; /* in the body frame, of the link and all that is fixed to it */
	int iq, iv;            /* first row in q, and in qd, qdd and tau; a follower has its driver's */
	int follower;          /* q_body = multiplier q_driver (+ an offset, which is part of X) */
	struct within multiplier; /* 1 if not a follower */
};

/* A joint with entries in q, in order of iq. */
struct tree_joint {
	const char *name;
	enum joint_type type;
	int body, iq, nq, iv, nv;
};

struct tree_mimic {
	const char *name, *driver;
	int body;
	struct within multiplier, offset; /* chains resolved: driver has entries in q */
};

/* Where a link of the robot ended up. */
struct carried {
	int body;           /* -1: the world; -2: it is not modelled */
	struct placement X; /* its frame in the body's */
};

struct tree {
	const struct robot *source; /* that it was built from; outlives it */
	const char *robot, *root;
	struct body *bodies;
	int body_count; /* nb */
	struct tree_joint *joints;
	int joint_count;
	struct tree_mimic *mimics;
	int mimic_count;
	int nq, nv, floating;
	struct within gravity[3];
	struct carried *links; /* one for each of the robot's */
	struct inertia fixed; /* what is fixed to the world and so does not matter */
};

/* Of what the scene selects; of the options, the base, gravity and the order count. Errors: NO_JOINTS, USAGE (an order that does
   not fit), MEMORY. */
enum rneagen_code tree_build(struct tree *t, const struct robot *r, const struct selection *c, const struct rneagen_options *o,
	struct arena *a, struct rneagen_error *e);

/* Round the placements and inertias of all bodies to so many significant decimal digits. */
void tree_round(struct tree *t, int digits);

/* What the URDF says of the joint behind t->joints[i]; NULL for the floating base. */
const struct joint *tree_joint_of(const struct robot *r, const struct tree *t, int i);

/* The joint that row `row` of qd belongs to; of a coordinate that several follow, their driver. */
const struct tree_joint *tree_joint_of_row(const struct tree *t, int row);

/* The same of a row of q; NULL: there is no such row. */
const struct tree_joint *tree_joint_of_q(const struct tree *t, int row);

/* Behind the last body that this one carries: they are numbered depth-first. */
int tree_end(const struct tree *t, int body);

/* Has a body's joint a turn that is added to its angle? */
int body_is_ahead(const struct body *k);

/* Is there a joint of this type, the floating base included? */
int tree_has_type(const struct tree *t, enum joint_type type);

/* Is this row of q one of a quaternion's four? */
int tree_is_quaternion(const struct tree *t, int row);

/* A base that floats and may not be meant, as a warning of the robot. */
void tree_warn(const struct tree *t, struct robot *r, const char *file, struct arena *a);

void tree_dump(const struct tree *t, struct text *out);

#endif
