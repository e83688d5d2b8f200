#ifndef RNEAGEN_TREE_H
#define RNEAGEN_TREE_H
/* The kinematic tree that is computed: fixed joints merged, mimic relations resolved, bodies numbered depth-first,
   every constant placed. */

#include "scene/adjust.h"
#include "base/arena.h"
#include "base/error.h"
#include "rneagen.h"
#include "urdf/robot.h"
#include "scene/scene.h"
#include "tree/spatial.h"
#include "request/request.h"

/* One moving body. Its frame is the URDF frame of the joint's child link, turned by `frame` where the joint's axis is
   not a coordinate axis, so that inside the algorithm every axis is x, y or z. */
struct body {
	int number;            /* in names and comments: from 1, or from 0 where 0 is the floating base */
	const char *link;      /* the joint's child link */
	const char *joint;     /* "" for the floating base */
	int parent;            /* body index, smaller than the body's own; -1: the world */
	enum joint_type type;  /* fixed: held, and not merged */
	struct within turn;    /* of a fixed one about its axis, not in X */
	int axis, sign;        /* revolute, continuous, prismatic, planar: coordinate axis, and +1 or -1 along it */
	struct placement X;    /* the joint's frame at q = 0 in the parent body's frame (the world: root link's frame) */
	struct rotation frame; /* x_urdf = frame x_body */
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

/* A joint that the scene holds: fixed at q = value. */
struct tree_held {
	const char *name, *why; /* why: the scene's word, or "mimic" where the joint that it follows is held */
	enum joint_type type;
	const struct within *value; /* joint_nq(type) numbers */
	int joint;         /* of the robot */
	int beyond;        /* its limits */
};

/* What the scene leaves out. */
struct tree_cut {
	const char **links, **joints; /* joints: without the fixed ones */
	int link_count, joint_count;
	real mass;
};

/* An origin in the scene with an angle that is nearly a multiple of pi/2. */
struct tree_angle {
	const char *what, *name; /* what: "joint", "inertial of link" */
	double off;              /* rad; the largest of the three */
};

/* What the URDF says of joints that move, and is not modelled. */
struct tree_ignored {
	const char **damping, **friction, **limits; /* names of joints */
	int damping_count, friction_count, limit_count, transmission_count;
};

struct effect;
struct saving;

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
	struct scene scene;
	struct tree_held *held;
	int held_count;
	struct tree_cut cut;
	struct tree_ignored ignored;
	struct adjust adjust;
	struct tree_angle *angles; /* within ADJUST_NEARLY, or adjust.snap where that is more */
	int angle_count;
	struct effect *effects; /* by effect_measure */
	struct saving *savings; /* by saving_measure: the full model, each line of the scene, the scene */
	int saving_count;
	int effect_count;
	struct request request;
	struct carried *links; /* one for each of the robot's */
	struct inertia fixed; /* what is fixed to the world and so does not matter */
};

/* Rows of q and of qd that a joint type takes. */
int joint_nq(enum joint_type type);
int joint_nv(enum joint_type type);

/* Errors: NO_JOINTS, UNSUPPORTED, USAGE (an order that does not fit), SCENE, MEMORY. */
enum rneagen_code tree_build(struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a,
	struct rneagen_error *e);

/* The same with constants changed in another way than the scene says. */
enum rneagen_code tree_build_adjusted(struct tree *t, const struct robot *r, const struct rneagen_options *o,
	const struct adjust *x, struct arena *a, struct rneagen_error *e);

/* What the URDF says of the joint behind t->joints[i]; NULL for the floating base. */
const struct joint *tree_joint_of(const struct robot *r, const struct tree *t, int i);

/* What the scene chose and may not be meant, as warnings of the robot. */
void tree_warn(const struct tree *t, struct robot *r, const char *file, struct arena *a);

void tree_dump(const struct tree *t, struct text *out);

#endif
