#ifndef RNEAGEN_ROBOT_H
#define RNEAGEN_ROBOT_H
/* The robot as its URDF states it: every link and joint, nothing merged, numbers as written. */

#include "base/arena.h"
#include "base/error.h"
#include "base/text.h"
#include "base/within.h"

/* What urdfdom and we can hold; gen/README.md states them. */
enum {
	LIMIT_FILE_BYTES = 16 << 20,
	LIMIT_XML_DEPTH = 100,
	LIMIT_LINKS = 1024,
	LIMIT_NAME_BYTES = 255,
	LIMIT_CHOICES = 16 * LIMIT_LINKS, /* of a scene */
};

enum joint_type { JOINT_FIXED, JOINT_REVOLUTE, JOINT_CONTINUOUS, JOINT_PRISMATIC, JOINT_PLANAR, JOINT_FLOATING };

struct link {
	const char *name;
	int parent_joint; /* index into joints; -1 at the root */
	int has_inertial;
	struct within mass;       /* kg */
	struct within com[3];     /* centre of mass in the link frame, m */
	struct within com_rpy[3]; /* orientation of the inertia's axes in the link frame, rad */
	struct within inertia[6]; /* ixx ixy ixz iyy iyz izz about the centre of mass, in those axes, kg m^2 */
};

struct joint {
	const char *name;
	enum joint_type type;
	int parent, child; /* links */
	struct within xyz[3];  /* origin in the parent link's frame, m */
	struct within rpy[3];  /* fixed-axis roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll), rad */
	struct within axis[3]; /* in the joint frame, as written (not normalised), finite and not zero; 1 0 0 if absent.
			      Fixed and floating joints: not meaningful */
	int has_limits;        /* revolute and prismatic: lower and upper below are the file's */
	int has_rates;         /* continuous ones too: velocity and effort */
	double lower, upper, velocity, effort;
	int has_dynamics;
	struct within damping, friction;
	int driver; /* the joint named by <mimic>, or -1; not resolved: may itself be a follower */
	struct within multiplier, offset;
};

struct robot {
	const char *name; /* as written; "" if the attribute is empty */
	struct link *links;
	int link_count;
	struct joint *joints; /* in byte order of their names, which is urdfdom's and Pinocchio's order of children */
	int joint_count;
	int root; /* the one link without a parent joint */
	int transmission_count; /* elements that were seen and are not read */
	const char **warnings;
	size_t warning_count, warning_capacity;
};

/* Read a URDF from `length` bytes at `xml` (need not be NUL-terminated). Everything lives in `a`.
   `file` is used in messages only. Errors: LIMIT, XML, XACRO, URDF, NUMBER, TREE, MIMIC, UNSUPPORTED, MEMORY, each with
   the link or joint in the message. Physically odd but usable models load with a warning. */
enum rneagen_code robot_read(
	struct robot *r, const char *xml, size_t length, const char *file, struct arena *a, struct rneagen_error *e);

/* The index of the link or joint of this name; -1 where there is none. */
int robot_link(const struct robot *r, const char *name);
int robot_joint(const struct robot *r, const char *name);

/* Append a warning to robot->warnings; on lack of memory a->failed is set. */
void robot_warn(struct robot *r, struct arena *a, const char *fmt, ...) RNEAGEN_PRINTF(3, 4);

/* "revolute", "fixed", ... */
const char *joint_type_name(enum joint_type type);

/* Rows of q and of qd that a joint type takes. */
int joint_nq(enum joint_type type);
int joint_nv(enum joint_type type);

/* A listing that a person reads (`--dump robot`): every link and joint with its numbers, each with the fewest digits that
   read back as the same. */
void robot_dump(const struct robot *r, struct text *t);

#endif
