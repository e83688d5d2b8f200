#ifndef RNEAGEN_SPATIAL_H
#define RNEAGEN_SPATIAL_H
/* Numeric vectors, rotations and inertias of the model's constants, in extended precision, rounded once at the end; each
   number knows how far it may be from what the file's decimals give. */

#include "base/within.h"

/* x_parent = m x_child: the columns are the child's axes in the parent frame. */
struct rotation {
	struct within m[3][3];
};

/* A frame in another: x_parent = R x_child + p. */
struct placement {
	struct rotation R;
	struct within p[3];
};

/* Mass, first moment h = m c, and inertia about the frame's origin: xx xy xz yy yz zz. */
struct inertia {
	struct within mass, h[3], I[6];
};

/* A sum with the magnitudes of what went into it: |value| at or below rounding of the terms is zero. */
struct sum {
	struct within value;
	real size;
};

void sum_add(struct sum *s, struct within term);
struct sum sum_from(struct within term);

/* The value, or exactly 0 when |value| <= 4 * 2^-53 * (sum of |terms|), the noise that doubles in the URDF leave. */
struct within sum_total(struct sum s);

extern const struct rotation ROTATION_IDENTITY;

/* Rz(yaw) Ry(pitch) Rx(roll), the URDF's rpy. */
struct rotation rotation_rpy(const struct within rpy[3]);

/* An angle, by its sine and cosine. */
struct turn {
	struct within s, c;
};

extern const struct turn TURN_NONE;

/* The angle of the vector (x, y); none where that is rounding. */
struct turn turn_of(struct sum x, struct sum y);
/* a + b, a - b */
struct turn turn_add(struct turn a, struct turn b);
struct turn turn_sub(struct turn a, struct turn b);
int turn_is_none(struct turn a);

/* About a coordinate axis (0, 1, 2) by an angle. */
struct rotation rotation_about(int axis, struct within angle);
struct rotation rotation_by(int axis, struct turn angle);

/* A rotation whose third column is the unit vector n and which has as many zeros as possible. */
struct rotation rotation_to_axis(const struct within n[3]);

/* The shortest rotation that takes z onto the unit vector n; for n = -z the half turn about x. */
struct rotation rotation_shortest(const struct within n[3]);

/* Of the quaternion x y z w, made a unit one. */
struct rotation rotation_quaternion(const struct within q[4]);

struct rotation rotation_mul(const struct rotation *a, const struct rotation *b);
struct rotation rotation_transpose(const struct rotation *a);
void rotation_apply(const struct rotation *r, const struct within v[3], struct within out[3]);

/* a after b: x = a.R (b.R y + b.p) + a.p */
struct placement placement_mul(const struct placement *a, const struct placement *b);
struct placement placement_inverse(const struct placement *a);

/* A sum of inertias in one frame: the ten numbers with the sizes of their terms. */
struct inertia_sum {
	struct sum mass, h[3], I[6];
};

/* Add a link whose frame stands at X: mass, centre of mass, and inertia about it in axes turned by rpy.
   I_o = R Ic R^T + m (c.c 1 - c c^T), h = m c (Featherstone 2008, 2.63). */
void inertia_add(struct inertia_sum *s, const struct placement *X, struct within mass, const struct within com[3],
	const struct within rpy[3], const struct within inertia[6]);

/* Add what stands in a frame at X: h' = R h + m p, I' = R I R^T + 2 (p . R h) 1 - R h p^T - p (R h)^T + m (p . p 1 - p p^T). */
void inertia_add_from(struct inertia_sum *s, const struct placement *X, const struct inertia *I);

struct inertia inertia_total(const struct inertia_sum *s);

/* The index of element (i, j) in xx xy xz yy yz zz. */
int inertia_index(int i, int j);

#endif
