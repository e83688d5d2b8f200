#ifndef TESTS_REFERENCE_H
#define TESTS_REFERENCE_H

#include <stdbool.h>
#include <stddef.h>

#include "support/rng.h"
#include "reference/wide.h"

// Inverse dynamics of a URDF by the recursive Newton-Euler algorithm over every link of the file, fixed ones too, in
// dense 6x6 spatial algebra (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1) and an extended type.
// It shares nothing with the generator and is what the generator is measured against. SI units throughout.

enum reference_type {
	REFERENCE_FIXED,
	REFERENCE_REVOLUTE,
	REFERENCE_CONTINUOUS,
	REFERENCE_PRISMATIC,
	REFERENCE_FLOATING,	// q = x y z qx qy qz qw; v = twist in the child's frame, linear then angular
	REFERENCE_PLANAR,	// q = x y theta; v = dq/dt
};

// All zero means the defaults.
struct reference_options {
	bool floating;		// the root link floats: its 7 numbers lead q, its 6 lead v
	bool independent;	// joints with <mimic> are ordinary joints
	const double *gravity;	// 3 numbers in the root link's frame (the world, when floating); NULL: 0 0 -9.81
	bool decimals;		// numbers as the file's decimals in the extended type; else as the doubles nearest to them
	const char *order;	// names, with commas, of every joint with an entry in q; NULL: depth first
};

// One link with the joint that carries it. The table is in depth-first order, children by joint name in byte order;
// entry 0 is the root link with a joint without name, fixed or (the base floating) REFERENCE_FLOATING.
struct reference_joint {
	char *name;		// of the joint, as the XML means it (entities resolved, UTF-8)
	char *link;		// of the child link
	enum reference_type type;
	int parent;		// entry of the parent link; -1 for entry 0
	int iq, nq;		// first row in q and rows; nq = 0 for fixed joints and followers
	int iv, nv;		// the same in qd, qdd, tau
	int driver;		// entry whose q moves this joint: itself, or the end of a chain of <mimic>
	wide multiplier, offset;	// q = multiplier * q[driver] + offset, through the whole chain
	double lower, upper;	// <limit>, 0 0 if absent
	int body;		// moving body that the link belongs to, a row of reference_passes; -1: the ground
};

// What a joint with one row bears beside the links: armature a + damping v + friction v/sqrt(v^2 + width^2), of its own
// coordinate's v and a.
struct reference_own {
	wide armature, damping, friction, width;
};

struct reference_link;

struct reference {
	int nq, nv;		// rows of q; rows of qd, qdd and tau
	int nb;			// moving bodies, depth first: links whose joint is not fixed (followers, floating base too)
	int nj;			// entries of `joints`: links of the file
	struct reference_joint *joints;
	struct reference_link *links;	// private: constants, and the working memory of one call
	wide gravity[3];
};

// Reads `length` bytes of URDF. Returns NULL and a text in message[size] where it cannot; `o` may be NULL. The caller
// owns the result and gives it to reference_close (which takes NULL). One thread at a time may use one reference.
struct reference *reference_open(const char *urdf, size_t length, const struct reference_options *o, char *message,
                                 size_t size);

// The same from a file.
struct reference *reference_open_file(const char *path, const struct reference_options *o, char *message, size_t size);
void reference_close(struct reference *r);

// tau[nv] = ID(q[nq], qd[nv], qdd[nv]).
void reference_rnea(struct reference *r, const double *q, const double *qd, const double *qdd, wide *tau);

// The same with extended inputs, for finite differences.
void reference_rnea_wide(struct reference *r, const wide *q, const wide *qd, const wide *qdd, wide *tau);

// Twist v, spatial acceleration a (that of the ground is minus gravity) and own net wrench f = I a + v x* I v (links
// fixed to it included, its children not) of every moving body, linear then angular, at the origin and in the axes of
// the child link of its joint. Any of v, a, f may be NULL.
void reference_passes(struct reference *r, const double *q, const double *qd, const double *qdd, wide (*v)[6],
                      wide (*a)[6], wide (*f)[6]);

// S_i: the magnitudes of all products that make tau_i, summed: |tau_i - rounded| <= K eps S_i. The same recursion with
// every matrix and vector replaced by its magnitudes, so never below the sum for a smaller number of operations.
void reference_magnitude(struct reference *r, const double *q, const double *qd, const double *qdd, wide *s);

// Values of one entry after the last call: twist, spatial acceleration, and the wrench through its joint (its own, and
// all that hangs on it), linear then angular, at the origin and in the axes of its link; their magnitudes after
// reference_magnitude. The ground's acceleration is minus gravity. Any of them may be NULL.
void reference_link(const struct reference *r, int entry, wide *v, wide *a, wide *f);

// The kinetic energy of the last call; after reference_magnitude, with `magnitudes`, what was summed for it.
wide reference_kinetic(const struct reference *r, bool magnitudes);

// Changes of an open reference, which last. The inertial parameters of an entry's link about its origin: mass, first
// moments, xx xy xz yy yz zz; a wrench from outside: force, then moment about the link's origin, in axes of the link or
// of the ground; terms of a joint with one row.
void reference_inertia(const struct reference *r, int entry, wide p[10]);
void reference_set_inertia(struct reference *r, int entry, const wide p[10]);
void reference_set_push(struct reference *r, int entry, const wide w[6], bool in_ground);
void reference_set_own(struct reference *r, int entry, const struct reference_own *terms);

// A random state: q within the limits of the file (at most +-pi and +-1 m; +-pi for continuous; positions +-1, unit
// quaternions), qd within +-2, qdd within +-5. `f32` rounds all to float.
void reference_sample(const struct reference *r, struct rng *rng, bool f32, double *q, double *qd, double *qdd);

// ||tau - ref|| / ||ref||; 0 where both are zero, infinite where ref alone is; NaN in tau gives NaN.
double reference_error(const double *tau, const wide *ref, int n);

#endif
