#ifndef TESTS_REFERENCE_FRAMES_H
#define TESTS_REFERENCE_FRAMES_H

#include "reference/reference.h"

// Where links are and how they move, by homogeneous 4x4 matrices and by Jacobians column by column: the column of a joint is
// its axis in the ground and the arm from it to the frame (Whitney 1972). Rates are central differences of order 8 along the
// curve with the given qd and qdd; no recursion of twists or accelerations is ever run. Linear rows come before angular
// ones. "Held" rows of qd do not move; NULL: none is held.
struct reference_pose {
	wide m[4][4];
};

// A frame that is fixed to the link of an entry, and where it is on it.
struct reference_frame {
	int entry;
	struct reference_pose at;
};

// The axes and the point of a twist: the frame's own (LOCAL of Pinocchio), the ground's at the ground's origin (WORLD),
// the ground's at the frame's origin (LOCAL_WORLD_ALIGNED).
enum reference_axes {
	REFERENCE_LINK,
	REFERENCE_WORLD,
	REFERENCE_ALIGNED,
};

struct reference_pose reference_shift(wide x, wide y, wide z);

// x y z and angles as the origin of a URDF has them.
struct reference_pose reference_origin(const wide xyz[3], const wide rpy[3]);

// The frame of a link, or of the child link of a joint; entry -1 where there is neither.
struct reference_frame reference_frame_named(const struct reference *r, const char *name);

// Of all links in the ground, r->nj of them.
void reference_poses(const struct reference *r, const wide *q, struct reference_pose *out);

// Of one frame in the ground.
struct reference_pose reference_pose(const struct reference *r, const struct reference_frame *f, const wide *q);

// J[6][nv]: twist = J qd.
void reference_jacobian(const struct reference *r, const struct reference_frame *f, enum reference_axes axes, const wide *q,
                        wide *J);

// The derivative of J qd: the spatial acceleration in the link's axes and in the ground, the classical one in the ground's
// axes at the frame's origin. With qdd = 0 it is dJ/dt qd.
void reference_acceleration(const struct reference *r, const struct reference_frame *f, enum reference_axes axes,
                            const wide *q, const wide *qd, const wide *qdd, wide *out);

// J M^-1 J^T, [6][6], in the joints that are not held. Returns the least pivot, as reference_inverse does.
wide reference_opspace_inverse(struct reference *r, const struct reference_frame *f, enum reference_axes axes,
                               const char *held, const wide *q, wide *out);

// The derivative at t = 0 of what f writes to out[n] for the state at time t: order 8, step REFERENCE_STEP.
#ifdef REFERENCE_QUAD
#define REFERENCE_STEP WIDE_C(1e-4)
#else
#define REFERENCE_STEP WIDE_C(1e-3)
#endif
typedef void reference_curve(void *context, const wide *q, const wide *qd, wide *out);
void reference_rate(const struct reference *r, const wide *q, const wide *qd, const wide *qdd, reference_curve *f,
                    void *context, int n, wide *out);

#endif
