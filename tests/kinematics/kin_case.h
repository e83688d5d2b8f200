#ifndef KIN_CASE_H
#define KIN_CASE_H
/* A scene that wants to know where things are, and what the independent reference, in quad precision, says of it. Matrices are
   compared dense: what is not stored has to be zero. */

#include "dag/eval.h"
#include "passes/analysis.h"
#include "reference/kinematics/momentum.h"
#include "support/rng.h"
#include "tree/pattern.h"

enum { KIN_ROWS = 256, KIN_FRAMES = 4, KIN_INPUTS = 7 };

struct kin_added {
	char name[32], link[128];
	double at[6];          /* xyz, rpy */
};

struct kin_case {
	char what[300];        /* for messages */
	struct arena arena;
	struct rneagen_error error;
	struct analysis analysis;
	struct reference *reference;
	struct rng rng;
	struct kin_added added[KIN_FRAMES];
	int added_count;
	char held[KIN_ROWS];                                    /* by row of the reference's qd */
	double held_q[KIN_ROWS];
	wide q[KIN_ROWS], qd[KIN_ROWS], qdd[KIN_ROWS];          /* of the whole robot */
	wide in[KIN_INPUTS][KIN_ROWS];                          /* q, qd, qdd, tau of what is modelled, jvp_v, vjp_v, */
	const char *more;                                       /* and this one's; NULL: there is none */
	wide *out[DAG_ARGUMENTS];                               /* by argument of the DAG */
	double *size[DAG_ARGUMENTS];                            /* magnitudes that were summed */
	int is_by_largest;                                      /* magnitudes that were summed are no excuse */
	double worst;                                           /* of all that was compared, off by tolerance */
};

/* Returns 0 where nothing is left that moves, or nothing that has mass for what asks for its centre; the test fails for any other
   refusal. `part`: the text of what the scene's root leaves, for the reference; NULL: all of it. */
int kin_open(struct kin_case *c, const char *urdf, const char *part, const struct rneagen_options *options, uint64_t seed);
void kin_close(struct kin_case *c);

/* The reference's joint of this name; the test fails where there is none. */
const struct reference_joint *kin_joint(const struct kin_case *c, const char *joint);

/* A joint stays at q; before kin_draw. */
void kin_hold(struct kin_case *c, const char *joint, double q);

/* A state within the limits, unit quaternions in quad precision; then kin_settle. */
void kin_draw(struct kin_case *c);

/* The rows of what is modelled from those of the whole, and zero speed of what is held. */
void kin_settle(struct kin_case *c);

/* The DAG in quad precision. */
void kin_evaluate(struct kin_case *c);

/* The state rounded to double or float, and the DAG in that precision; magnitudes are those of kin_evaluate, which
   comes first. */
void kin_round(struct kin_case *c, int is_f32);
void kin_evaluate_rounded(struct kin_case *c, int is_f32);

/* A want as the DAG gives it, dense: what is not stored is zero, the other half of a symmetric one is filled in. */
struct kin_matrix {
	int lines, cols;
	wide *x;
	double *size;
};
struct kin_matrix kin_found(struct kin_case *c, const struct want *w, wide *const *out);
struct kin_matrix kin_matrix_new(int lines, int cols);
void kin_matrix_free(struct kin_matrix *m);

/* What the reference says of a want, in the same shape; lines is 0 for coriolis and opspace, and for what is tested elsewhere. */
struct kin_matrix kin_expected(struct kin_case *c, const struct want *w);

/* The properties of coriolis, opspace_inv and opspace. Returns whether it is one of these, and M not too singular. */
int kin_check(struct kin_case *c, const struct want *w, wide *const *out, double noise);

/* One element, or row i where j is 0, off by at most `limit`; the worst of all is in c->worst. */
void kin_expect(struct kin_case *c, const char *what, int i, int j, wide found, wide want, wide limit);

/* All wants against the reference: off by at most `noise` of the magnitudes summed and of the largest element. Returns how many
   were compared. */
int kin_compare(struct kin_case *c, double noise);

/* The frame of the request; which frame a word names. */
enum reference_axes kin_axes(const struct kin_case *c);
struct reference_frame kin_frame(const struct kin_case *c, const char *word);

#endif
