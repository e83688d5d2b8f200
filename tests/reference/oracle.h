#ifndef TESTS_REFERENCE_ORACLE_H
#define TESTS_REFERENCE_ORACLE_H

#include "reference/reference.h"
#include "reference/read.h"

// A second opinion on the reference from positions alone (Uicker 1965, Kahn 1969): with T the 4x4 pose of a link, J its
// 4x4 pseudo-inertia and c its centre of mass, tau_k = sum tr(dT/dk J T''^T) - m g . (dT/dk c). Derivatives are central
// differences of the poses along curves with the given qd and qdd; no twist, force or Jacobian is ever formed.
struct link_pose {
	wide m[4][4];
};

struct oracle {
	const struct reference *r;	// for the table of joints, and gravity
	struct raw_robot raw;
	int *source;			// entry -> raw joint
};

struct oracle oracle_open(const struct reference *r, const char *urdf, size_t length);
void oracle_close(struct oracle *o);

// Poses of all links of the table in the ground.
void oracle_poses(const struct oracle *o, const wide *q, struct link_pose *out);

// The state on the curve through q with velocity qd and acceleration qdd, at time t.
void oracle_move(const struct reference *r, const wide *q, const wide *qd, const wide *qdd, wide t, wide *out);

// First (order 1) or second (order 2) time derivative at t = 0 of the poses along that curve.
void oracle_derivative(const struct oracle *o, const wide *q, const wide *qd, const wide *qdd, int order,
                       struct link_pose *out);

// The 4x4 pseudo-inertia of an entry's link, in its frame: sum over the mass of (r, 1)(r, 1)^T.
struct link_pose oracle_inertia(const struct oracle *o, int entry);

// The torques.
void oracle_torque(const struct oracle *o, const wide *q, const wide *qd, const wide *qdd, wide *tau);

#endif
