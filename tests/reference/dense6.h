#ifndef TESTS_DENSE6_H
#define TESTS_DENSE6_H

#include "reference/wide.h"

// Dense spatial algebra (Featherstone 2008, chapter 2) with the linear part first: motion (v, w), force (f, n).
struct d3_vec {
	wide x[3];
};

struct d3_mat {
	wide m[3][3];
};

struct d6_vec {
	wide x[6];
};

struct d6_mat {
	wide m[6][6];
};

struct d3_mat d3_identity(void);
struct d3_mat d3_mul(struct d3_mat a, struct d3_mat b);
struct d3_mat d3_transpose(struct d3_mat a);
struct d3_vec d3_apply(struct d3_mat a, struct d3_vec b);

// [v]: the matrix with [v] u = v x u.
struct d3_mat d3_cross(struct d3_vec v);

// Rotation about a unit axis, 1 + s [n] + (1 - c) [n]^2.
struct d3_mat d3_about(struct d3_vec axis, wide s, wide c);

// Rz(yaw) Ry(pitch) Rx(roll); an angle within 5e-15 of a multiple of pi/2 is that multiple.
struct d3_mat d3_rpy(const wide rpy[3]);

// Rotation of a quaternion x y z w, as written, not normalised.
struct d3_mat d3_quaternion(const wide q[4]);

struct d6_mat d6_identity(void);
struct d6_mat d6_mul(struct d6_mat a, struct d6_mat b);
struct d6_vec d6_apply(struct d6_mat a, struct d6_vec b);

// a^T b, without forming a^T.
struct d6_vec d6_apply_transpose(struct d6_mat a, struct d6_vec b);
struct d6_vec d6_add(struct d6_vec a, struct d6_vec b);

// Every entry's magnitude.
struct d6_mat d6_abs(struct d6_mat a);
struct d6_vec d6_abs_vec(struct d6_vec a);

// Motion transform parent -> child, r the child's axes in the parent, p its origin: [r^T, -r^T [p]; 0, r^T].
// Its transpose takes forces child -> parent.
struct d6_mat d6_transform(struct d3_mat r, struct d3_vec p);

// v x as a matrix on motions: [[w], [v]; 0, [w]]. On forces, v x* is minus its transpose.
struct d6_mat d6_cross(struct d6_vec v);

// Inertia about the frame's origin: [m 1, -m [c]; m [c], Ic - m [c][c]].
struct d6_mat d6_inertia(wide mass, struct d3_vec c, struct d3_mat ic);

#endif
