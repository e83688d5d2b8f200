#ifndef RNEAGEN_WANT_H
#define RNEAGEN_WANT_H
/* A scene's request while its DAG is made. */

#include "dynamics/contacts/contacts.h"
#include "dynamics/forward.h"
#include "dynamics/recursion/recursion.h"
#include "dynamics/registry.h"
#include "dynamics/regressor.h"
#include "dynamics/tour.h"
#include "kinematics/kinematics.h"

/* How it is made. `way`: coordinates go back to the base in loops; NULL: they do not. */
struct ways {
	enum derivatives derivatives;
	enum dynamics dynamics;
	int pivots_alone; /* see forward_pivots */
	const struct loops *loops; /* columns of derivatives of qdd are left as right sides, and solved in loops; NULL: none is */
	struct way_back *way;
	enum handed handed; /* what stands in rows of the output, where all else reads it */
};

struct build {
	struct dag *d;
	const struct tree *t;
	const struct request *k;
	struct ref *offset, *gravity;
	struct parameters **parameters;
	struct ref *own[OWN_TERMS]; /* by body; as the tour's */
	int *pushed, *outputs; /* arguments, by push and by want */
	struct ref *forces;      /* by row of contacts: what they pull at the tour's bodies with */
	struct ref *weights;     /* the same rows: those of a vjp's weights, where they are read (contacts.h) */
	struct ref *demanded;    /* the same rows: how contacts are to accelerate */
	struct ref *accelerated; /* how they do more than that, by the last tour */
	char *done;            /* by want: the recursion writes it */
	struct ref kinetic;
	struct ref *torques;   /* ID(q, qd, qdd) of the main tour, then how contacts accelerate; NULL: it did not come back */
	struct ways ways;
	struct recursion recursion;
	int solved[BY_COUNT]; /* arguments: what is solved with the recursion's matrices; -1: nothing */
	struct regressor regressor;
	struct kinematics places;
	struct forward *forward; /* NULL: qdd is an input */
	struct forward *factored; /* whose tour it is */
};

void want_build_in(struct dag *d, const struct tree *t, const struct request *k, struct ways ways);

/* May the recursion write it, where derivatives are made so? */
int want_is_recursive(const struct tree *t, const struct request *k, enum derivatives derivatives, enum want_kind kind);

/* A tour of the scene's robot, with what it frees and gravity as it has it. */
struct tour want_tour(struct build *b, struct joint_inputs in);

/* Gravity, offsets, parameters of bodies and joints' own terms: the tree's, and what the scene frees as arguments, which are
   declared the first time. Returns 0 when memory runs out. */
int want_constants(struct build *b);

/* The argument of the first want of a kind; -1: there is none. */
int want_output(const struct build *b, enum want_kind kind);

/* "hand" of "payload.hand"; "" of "gravity". */
const char *want_of(const char *word);

/* Where bodies are, in b->places, with what is wanted of that. */
void want_places(struct build *b, struct joint_inputs in);

/* That, and what takes qdd too, which is found by then. */
void want_kinematics(struct build *b, struct joint_inputs in);

/* Does the main tour find what makes the rate of the momentum? And that rate, from it. */
int want_gives_rate(const struct build *b);
void want_rate(const struct build *b, const struct tour *r);

/* The wrenches from outside on a body that has been entered; where they are in axes of the world, the body's orientation. */
void want_pull(const struct tour *r, int body);

/* Out of the axes of X on a body, or of the world, into the body's. */
struct svec want_turn(struct dag *d, const struct frame *x, const struct placement *X, int in_world, struct svec u);

/* All that pulls at it: those, and contacts with b->forces; and how contacts on it accelerate. */
void want_bear(const struct tour *r, int body);

/* The acceleration of its origin with gravity, where contacts are on it or a scene asks for accelerations. */
void want_free(const struct tour *r, int body);

/* What joins a tour: the tour's context is a struct build. */
void want_world(const struct tour *r);
void want_entered(const struct tour *r, int body);
void want_leaving(const struct tour *r, int body);

/* Write a row of the vjp, or where values are handed on, of the only output. What is made of the value: it, or what is read back
   from there, which is called by the quantity of the row's joint. */
struct ref want_hand_on(const struct build *b, int row, struct ref value, const char *quantity);

/* Products of derivatives, want by want: of the torques alone, or of the qdd found alone, when these are made; all others when
   all outputs are. d->failed and d->constant are set where an output does not vary. */
void product_declare(const struct build *b); /* the vectors */
int product_is_of_torques(const struct build *b, int want);
void product_output(struct build *b, struct joint_inputs in, int want);
void product_outputs(struct build *b, struct joint_inputs in);

#endif
