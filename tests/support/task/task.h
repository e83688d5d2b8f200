#ifndef TESTS_TASK_H
#define TESTS_TASK_H
/* A scene's task, drawn at random or said line by line, and the same of the reference: what it gives, frees, pushes and
   asks for. Names are the reference's; nothing is taken from what the generator makes of the scene. */

#include "reference/oracle.h"
#include "support/scene_model.h"

enum { TASK_WORDS = 48 };

enum task_kind { TASK_TAU, TASK_GRAVITY, TASK_BIAS, TASK_WRENCH, TASK_TWIST, TASK_ACCEL, TASK_POWER, TASK_KINETIC, TASK_POTENTIAL,
	TASK_KINDS };

/* A joint's own terms. */
enum task_term { TASK_ARMATURE, TASK_DAMPING, TASK_FRICTION, TASK_TERMS };

/* An input that the scene makes, with what it is fed, of all joints by rows of the reference; an output that it asks for. */
struct task_in {
	char word[300];
	int rows, is_push, per_batch, is_of_all;
	double value[ROWS];
};
struct task_out {
	char word[300];
	enum task_kind kind;
	int entry;
};

struct task_case {
	struct rneagen_options options;
	char *urdf, scene[1 << 16];
	struct reference *r; /* with all that the scene changes */
	struct oracle oracle;
	struct rng rng;
	double q[ROWS], qd[ROWS], qdd[ROWS]; /* all rows of the reference, given ones as they are given; floats */
	double offset[ROWS];                 /* added to q */
	char q_given[ROWS], qd_given[ROWS], qdd_given[ROWS], held[ROWS];
	wide push[ROWS][6]; /* by entry */
	struct reference_own own[ROWS];
	char own_free[TASK_TERMS][ROWS];
	int in_world;
	struct task_in in[TASK_WORDS];
	struct task_out out[TASK_WORDS];
	int in_count, out_count;
};

/* The URDF is the case's from then on; the seed draws state and choices. */
struct task_case *case_new(char *urdf, const struct rneagen_options *o, uint64_t seed);
void case_close(struct task_case *c);

/* A random tree of at most `links` links with base, mimic and gravity by the seed, with the flags of torque_robot; NULL
   where it has no rows. */
struct task_case *case_random(uint64_t seed, int links, int flags);

/* Further text of the scene. */
void case_say(struct task_case *c, const char *format, ...) RNEAGEN_PRINTF(2, 3);

/* Does this entry's link move in the scene? Does its joint have rows of its own there? */
int case_moves(const struct task_case *c, int entry);
int case_has_rows(const struct task_case *c, int entry);
int case_has_one_row(const struct task_case *c, int entry);

/* A joint that moves, by rows of its own or its driver's; one with one row. */
int case_has_joint(const struct task_case *c, int entry);
int case_slides(const struct task_case *c, int entry);

/* A random entry that has what is asked; -1 where there is none. */
int case_pick(struct task_case *c, int (*good)(const struct task_case *c, int entry));

/* "base" for the floating base, else the joint's name. */
const char *case_joint(const struct task_case *c, int entry);

/* Choices of one line each. Values: what is there already where `nominal`, else others. */
void case_lock(struct task_case *c, int entry);
void case_give(struct task_case *c, int entry, int which);       /* q, qd or qdd of a joint */
void case_give_all(struct task_case *c, int which, double value); /* NaN: as they are drawn, row by row */
void case_gravity(struct task_case *c);
void case_free_gravity(struct task_case *c, int nominal);
void case_free_mass(struct task_case *c, int entry, int nominal);
void case_free_inertia(struct task_case *c, int entry, int nominal);
void case_add_payload(struct task_case *c, int entry, int nominal);
void case_free_offset(struct task_case *c, int entry, int nominal);
void case_free_own(struct task_case *c, enum task_term term, int entry); /* -1: of all joints */
void case_push(struct task_case *c, int entry);
void case_armature(struct task_case *c, int entry);
void case_damping(struct task_case *c); /* as the URDF says; so friction */
void case_friction(struct task_case *c, double width);
void case_want(struct task_case *c, enum task_kind kind, int entry);

/* Which of the joints' own terms an input is, and where it stands. */
int task_is_own(const struct task_in *in, enum task_term *term);
wide *case_own(struct task_case *c, enum task_term term, int entry);

/* A few of each, at random; names that are free already are left out. */
void case_draw_locks(struct task_case *c);
void case_draw_tips(struct task_case *c);
void case_draw_folds(struct task_case *c);
void case_draw_frees(struct task_case *c, int nominal);
void case_draw_pushes(struct task_case *c);
void case_draw_own(struct task_case *c);
void case_draw_wants(struct task_case *c);

/* What is asked for by the reference, with the magnitudes that were summed. */
struct task_expected {
	wide value[ROWS], size[ROWS];
	int rows;
};
void case_expect(struct task_case *c, const struct task_out *out, struct task_expected *x);

/* Inputs by argument of a DAG (NaN in rows that are given or held), and outputs. */
struct task_arrays {
	double in[DAG_ARGUMENTS][ROWS];
	real out[DAG_ARGUMENTS][ROWS];
};
enum task_precision { TASK_REAL, TASK_F64, TASK_F32 };
void case_evaluate(const struct dag *d, enum task_precision p, struct task_arrays *x);
void case_feed(const struct task_case *c, const struct scene_model *m, struct task_arrays *x);
void case_feed_in(const struct task_case *c, const struct task_in *in, const struct tree *t, double *to); /* ROWS of them */

/* Open the scene, evaluate it in extended precision, f64 and f32, and hold it against the reference; the test fails with
   `what`, the seed and the scene. The model stays open. */
void case_check(struct task_case *c, struct scene_model *m, const char *what);

/* The same for a scene that is looked at no further; returns its operations. */
size_t case_checked(struct task_case *c, const char *what);

#endif
