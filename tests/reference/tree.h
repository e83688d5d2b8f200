#ifndef TESTS_REFERENCE_TREE_H
#define TESTS_REFERENCE_TREE_H

#include "reference/dense6.h"
#include "reference/reference.h"

// The constants of one link and its joint, and the values of one call.
struct reference_link {
	struct d6_mat tree;		// parent link's frame -> joint frame at q = 0
	struct d6_mat inertia;		// about the link's origin
	struct d3_vec axis;		// unit, in the joint frame
	struct d3_vec plane[2];		// planar: the axes of x and y
	struct d6_vec push;		// a wrench from outside on the link
	bool push_in_world;		// in the ground's axes
	struct reference_own terms;

	struct d6_mat x;		// parent link's frame -> link's frame
	struct d6_mat s;		// motion subspace, nv columns used
	struct d6_vec drift;		// dS/dt qd, seen from the link
	struct d6_vec v, a, net, f;
	struct d3_mat turn;		// the ground's axes -> the link's
	wide own;			// the torque of armature and damping
};

#endif
