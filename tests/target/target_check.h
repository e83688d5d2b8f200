#ifndef TESTS_TARGET_CHECK_H
#define TESTS_TARGET_CHECK_H
/* A compiled text against the reference, the evaluated DAG and itself. Every function fails the test with a message. */

#include "target/states.h"
#include "target/target.h"

/* What was measured, over any number of texts of one precision. */
struct worst {
	double norm;   /* of ||tau - ref|| / ||ref|| */
	double terms;  /* of |tau_i - ref_i| / (eps S_i), S_i the magnitudes that were summed */
	double passes; /* of ||x - ref|| / ||ref|| over all bodies, x = v, a, f */
	double back;   /* of ||bpass(fpass) - ref|| / ||ref|| */
	char norm_of[256], passes_of[256], back_of[256];
	int count;
};

struct check {
	struct target *target;
	struct model *model;
	const struct states *states;
	int real;  /* a real robot: its torques do not cancel, so that relative errors mean something */
	int exact; /* compiled as written: gives the bits that rerun gives */
	int fused; /* and has a fused multiply-add */
	struct worst *worst;
};

/* N_rnea on every state: right, as eval computes it, equal in place, nothing written beside tau. */
void check_rnea(const struct check *c);

/* N_rnea_batch on 0, 1, 7 and all states: what N_rnea gives. */
void check_batch(const struct check *c);

/* N_fpass and N_bpass on the first states. */
void check_passes(const struct check *c);

/* NaN, infinity, or an angle beyond the domain of the trigonometry mode in any one input reaches every torque that
   depends on it, and no other sample. */
void check_nonfinite(const struct check *c);

/* Take the worse of each. */
void worst_merge(struct worst *into, const struct worst *from);

void worst_report(const struct worst *w, const char *what);

#endif
