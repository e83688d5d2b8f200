#ifndef RNEAGEN_WANT_TYPE_H
#define RNEAGEN_WANT_TYPE_H
/* The words of --want, each with what is true of it: others ask this table, never for the order of the words. */

#include "dag/role.h"

enum want_kind { WANT_TAU, WANT_GRAVITY, WANT_BIAS, WANT_WRENCH, WANT_TWIST, WANT_ACCEL, WANT_POWER, WANT_KINETIC,
	WANT_POTENTIAL, WANT_REGRESSOR, WANT_QDD, WANT_QDD_BOUND, WANT_DTAU_DQ, WANT_DTAU_DQD, WANT_MASS,
	WANT_DTAU_DFREED, WANT_JVP, WANT_VJP, WANT_VJP_BY, WANT_MINV, WANT_DQDD_DQ, WANT_DQDD_DQD, WANT_DQDD_DFREED,
	WANT_POSE, WANT_JACOBIAN, WANT_DJACOBIAN, WANT_COM, WANT_VCOM, WANT_COM_JACOBIAN, WANT_MOMENTUM,
	WANT_MOMENTUM_MATRIX, WANT_DMOMENTUM, WANT_CORIOLIS, WANT_OPSPACE_INV, WANT_OPSPACE, WANT_CONTACT, WANT_WELD, WANT_COUNT };

enum want_trait {
	OF_LINK = 1 << 0,       /* a link or a frame follows the word: want.body and want.X */
	OF_JOINT = 1 << 1,      /* a joint does: want.body */
	OF_FREED = 1 << 2,      /* what is free stands in the word: want.body is its number */
	IS_TORQUES = 1 << 3,    /* tau, or a part of it */
	IS_DERIVATIVE = 1 << 4, /* of torques, or of the qdd found, M included */
	IS_GRADIENT = 1 << 5,   /* made by differentiating their expressions, where no recursion makes it */
	IS_BY_Q = 1 << 6,       /* a derivative by q; by qd */
	IS_BY_QD = 1 << 7,
	IS_SYMMETRIC = 1 << 8,  /* a matrix of which the lower triangle is stored */
	IS_SOLVED = 1 << 9,     /* made by solving with the mass matrix, column by column */
	FINDS_QDD = 1 << 10,    /* qdd is found, and tau an input */
	IS_MOTION = 1 << 11,    /* where things are and how they move: no force */
	IS_PLACED = 1 << 12,    /* made by the room kinematics, from the places of bodies */
	IS_PRODUCT = 1 << 16,   /* of derivatives of other outputs with a vector: of whatever kind these are */
	IS_OPSPACE = 1 << 15,   /* the inertia that is felt at a link */
	OF_CONTACT = 1 << 17,   /* what holds a link that stands: found with qdd */
	OF_MASSES = 1 << 14,    /* told by the masses of all that moves: none may be left out that no torque feels */
};

/* What is stored of a matrix. */
enum want_shape {
	SHAPE_NONE,     /* it is none */
	SHAPE_TREE,     /* nv x nv, without joints on different branches */
	SHAPE_COUPLED,  /* nv x nv, without joints that do not hang together */
	SHAPE_LUMPS,    /* nv x 10 links */
	SHAPE_CHAIN,    /* 6 x nv, the columns of a link's chain */
	SHAPE_POINT,    /* 3 x nv */
	SHAPE_SPATIAL,  /* 6 x nv */
	SHAPE_SQUARE,   /* 6 x 6 */
	SHAPE_PLACEMENT /* 3 x 4 */
};

struct want_type {
	const char *word;
	const char *argument; /* NULL: made from the word and its name */
	int rows;             /* 0: nv; of a matrix: as many as are stored */
	enum role role;
	enum want_shape shape;
	unsigned traits;
};

const struct want_type *want_type(enum want_kind kind);

/* Has it any of these traits? */
int want_is(enum want_kind kind, unsigned traits);

#endif
