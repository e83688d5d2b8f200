#ifndef TESTS_TALLY_H
#define TESTS_TALLY_H
/* What the torques of many models are off at most, beside the reference. */

#include "support/model.h"
#include <check.h>
#include <math.h>

/* Of the magnitudes that are summed, eps times this. */
#define LIMIT_TERMS 4

struct tally {
	double f64, f32, terms, bound;
	int count, real; /* of real robots relative errors have limits too */
};

static inline void tally_check(struct tally *t, const char *what, struct model_error e, double limit)
{
	ck_assert_msg(!t->real || e.max <= limit, "%s: relative error %g", what, e.max);
	ck_assert_msg(e.terms <= LIMIT_TERMS, "%s: %g eps of the magnitudes summed", what, e.terms);
	ck_assert_msg(e.bound <= 1, "%s: error is %g of its bound", what, e.bound);
	t->terms = fmax(t->terms, e.terms);
	t->bound = fmax(t->bound, e.bound);
}

/* A model's errors in both precisions, which are within the limits or the test fails. */
static inline void tally_model(
	struct tally *t, const char *what, struct model_error f64, struct model_error f32, double limit_f64, double limit_f32)
{
	tally_check(t, what, f64, limit_f64);
	tally_check(t, what, f32, limit_f32);
	t->f64 = fmax(t->f64, f64.max);
	t->f32 = fmax(t->f32, f32.max);
	t->count++;
}

#endif
