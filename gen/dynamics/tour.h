#ifndef RNEAGEN_TOUR_H
#define RNEAGEN_TOUR_H
/* The recursion as a tour of the tree: what rnea.c walks, and where want.c joins in. */

#include "mechanics/joint.h"
#include "mechanics/rigid_body.h"

/* A body while the tour is beyond it. */
struct frame {
	struct joint_pose pose;
	struct motion motion;
	struct svec f, n; /* force, and moment about the origin, through the body's joint */
	struct svec free_a;  /* acceleration of the origin itself: a + g, without the digits lost where these cancel */
	struct smat R0;      /* the body's frame in the world: orientation */
	struct ref mass;     /* at rest: of the subtree */
	struct svec own, beyond; /* at rest: first moments, of the body and of children's masses at their joints; the rest */
};

struct tour {
	struct dag *d;
	const struct tree *t;
	const struct request *request;
	struct frame *frames; /* frames[0] is the world; body k has frames[k + 1] */
	struct ref *tau;      /* so far; NULL: the way out alone */
	struct joint_inputs in;
	int f_in, v_out, a_out, f_out, tau_out; /* arguments; -1: not there */
	int comes_back;                         /* also without tau_out */
	struct ref *eased;                      /* rows of qdd, to be found on the way out: no body's dw has a part along its
	                                           joint's axis; NULL: qdd is what in.qdd says */
	int at_rest;                            /* velocities and accelerations are zero */
	const struct ref *gravity;              /* three; NULL: the tree's */
	struct parameters *const *parameters;   /* by body, of those whose parameters are no numbers; NULL: none */
	struct ref *const *own;                 /* by enum own_term and body, of those that are inputs; NULL: none */
	/* called where they are not NULL: before the tour; when a body has been entered and has its own wrench; before it is
	   left, when it has the wrench of its subtree; after that; and to add to the torques of a body's joint */
	void (*world)(const struct tour *r);
	void (*entered)(const struct tour *r, int body);
	void (*leaving)(const struct tour *r, int body);
	void (*left)(const struct tour *r, int body);
	void (*own_terms)(const struct tour *r, int body, struct ref *tau);
	void *context; /* of these */
};

struct forward;

/* With `eased`, in.qdd finds these rows, which are zero so far. Only joints that turn one body alone are eased. */
void tour_run(struct tour *r);

/* a = E (a_p + U_p p) + dV + 2 w x V once more, from another a_p than less gravity; for a body that has been entered. */
struct svec tour_acceleration(const struct tour *r, int body, struct svec from);

/* How fast a body's origin goes in its parent's frame, p' = w_p x p + R V0; for a body that has been entered. */
struct svec tour_origin_rate(const struct tour *r, int body);

/* C of a body's frame, where nothing moves. */
struct svec at_rest_moment(struct dag *d, const struct frame *x);

/* Adds rotor inertia and friction to the torques of a body's joint, as the request says. */
void own_terms(const struct tour *r, int body, struct ref *tau);
/* A factor times such a term, of a body whose joint has one row. */
struct ref own_term(const struct tour *r, enum own_term term, int body, struct within factor);
/* What these terms of a joint with one row are by qd. */
struct ref own_rate(const struct tour *r, int body);

/* What a scene wants of derivatives, M and the wants in `done` aside: of the torques of a tour that came back, into the
   arguments `outputs` (both by want); where qdd was found, at that qdd, and of it. */
void gradient_outputs(const struct tour *r, const struct forward *forward, const int *outputs, const char *done);

/* The DAG of a request that is not plain. */
void want_build(struct dag *d, const struct tree *t, const struct request *k);

#endif
