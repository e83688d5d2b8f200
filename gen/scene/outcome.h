#ifndef RNEAGEN_OUTCOME_H
#define RNEAGEN_OUTCOME_H
/* What a scene made of a robot, for those who tell of it: the joints that it holds, what it cuts away, what of the URDF is
   not modelled, angles that are nearly right. */

#include "scene/adjust.h"
#include "scene/select.h"

/* A joint that the scene holds: fixed at q = value. */
struct outcome_held {
	const char *name, *why; /* why: the scene's word, or "mimic" where the joint that it follows is held */
	enum joint_type type;
	const struct within *value; /* joint_nq(type) numbers */
	int joint;         /* of the robot */
	int beyond;        /* its limits */
};

/* What the scene cuts away. */
struct outcome_cut {
	const char **links, **joints; /* joints: without the fixed ones */
	int link_count, joint_count;
	real mass;
};

/* An origin in the scene with an angle that is nearly a multiple of pi/2. */
struct outcome_angle {
	const char *what, *name; /* what: "joint", "inertial of link" */
	double off;              /* rad; the largest of the three */
};

/* What the URDF says of joints that move, and is not modelled. */
struct outcome_ignored {
	const char **damping, **friction, **limits; /* names of joints */
	int damping_count, friction_count, limit_count, transmission_count;
};

struct outcome {
	struct outcome_held *held; /* in the order of the walk */
	int held_count;
	struct outcome_cut cut;
	struct outcome_ignored ignored;
	struct outcome_angle *angles; /* within ADJUST_NEARLY, or adjust.snap where that is more */
	int angle_count;
};

/* Of the robot as the URDF states it. Names and values are the robot's and the selection's. Errors: MEMORY. */
enum rneagen_code outcome_list(struct outcome *x, const struct scene *s, const struct adjust *adjust, const struct selection *c,
	const struct robot *r, struct arena *a, struct rneagen_error *e);

/* Joints that are held outside of their limits, as warnings of the robot. */
void outcome_warn(const struct outcome *x, struct robot *r, const char *file, struct arena *a);

#endif
