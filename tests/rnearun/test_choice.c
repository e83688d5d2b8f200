/* What rnearun choose takes, of times that are made up: no clock has a say. */
#include "study/choice.h"
#include "support/suite.h"
#include <check.h>
#include <math.h>

/* Close enough, of least and slowest time. */
static struct candidate candidate(enum rneagen_precision precision, enum rneagen_trig trig, enum rneagen_layout layout,
	double least, double slowest)
{
	struct candidate c = {.slowest = slowest};

	c.row.backend = RNEA_BACKEND_HOST;
	c.row.precision = precision;
	c.row.trig = trig;
	c.row.layout = layout;
	c.row.least = least;
	return c;
}

#define F32(trig, least, slowest) candidate(RNEAGEN_F32, RNEAGEN_##trig, RNEAGEN_SOA, least, slowest)

static void check_best(const struct candidate *c, int count, int best)
{
	const struct candidate *taken = choice_best(c, count);

	ck_assert_msg(taken == (best < 0 ? NULL : &c[best]), "number %d, not %d", taken ? (int)(taken - c) : -1, best);
}

/* Would catch a choice by noise: which of two that are as fast is a little faster. */
START_TEST(accurate_before_bounded_before_fast)
{
	const struct candidate even[] = {F32(FAST, 1.0, 1.1), F32(BOUNDED, 1.05, 1.2), F32(ACCURATE, 1.09, 1.3)};
	const struct candidate two[] = {F32(BOUNDED, 1.05, 1.2), F32(FAST, 1.0, 1.1), F32(ACCURATE, 1.11, 1.3)};
	const struct candidate first[] = {F32(ACCURATE, 1.0, 1.1), F32(BOUNDED, 1.0, 1.1)};

	check_best(even, 3, 2);
	check_best(two, 3, 0);
	check_best(first, 2, 0);
}
END_TEST

/* Would catch a tie that costs time: what is slower than the spread allows. */
START_TEST(faster_beyond_the_spread)
{
	const struct candidate c[] = {F32(ACCURATE, 1.2, 1.3), F32(BOUNDED, 1.0, 1.1)};
	const struct candidate narrow[] = {F32(ACCURATE, 1.019, 1.02), F32(BOUNDED, 1.0, 1.001)};
	const struct candidate wide[] = {F32(ACCURATE, 1.03, 9), F32(BOUNDED, 1.0, 1.001)};

	check_best(c, 2, 1);
	check_best(narrow, 2, 0); /* less than CHOICE_ALIKE */
	check_best(wide, 2, 1);   /* the spread of the fastest counts */
}
END_TEST

/* Would catch, on a busy machine with wide spreads, another precision or layout in the fastest one's place. */
START_TEST(ties_are_of_the_trigonometry_alone)
{
	struct candidate c[] = {candidate(RNEAGEN_F64, RNEAGEN_ACCURATE, RNEAGEN_SOA, 1.1, 20),
		candidate(RNEAGEN_F32, RNEAGEN_ACCURATE, RNEAGEN_AOS, 1.1, 20), F32(BOUNDED, 1.0, 20), F32(ACCURATE, 9, 20)};

	check_best(c, 3, 2);
	check_best(c, 4, 3);
	c[3].row.backend = RNEA_BACKEND_CUDA;
	check_best(c, 4, 2);
}
END_TEST

START_TEST(only_what_is_close_enough)
{
	struct candidate c[] = {F32(ACCURATE, 1.0, 1.1), F32(BOUNDED, 2.0, 2.1)};

	c[0].verdict = VERDICT_OVER_BOUND;
	check_best(c, 2, 1);
	c[1].verdict = VERDICT_OVER_ERROR;
	check_best(c, 2, -1);
	check_best(c, 0, -1);
}
END_TEST

/* Would catch a bound or an error that is not known and counts as small. */
START_TEST(verdicts)
{
	struct study_row row = {.bound_max = 1e-6, .errors = {.max = 1e-7}};

	ck_assert_int_eq(choice_by_bound(&row, 1e-6), VERDICT_CLOSE);
	ck_assert_int_eq(choice_by_bound(&row, 0.99e-6), VERDICT_OVER_BOUND);
	ck_assert_int_eq(choice_by_error(&row, 1e-7), VERDICT_CLOSE);
	ck_assert_int_eq(choice_by_error(&row, 0.99e-7), VERDICT_OVER_ERROR);
	row.bound_max = row.errors.max = (double)NAN;
	ck_assert_int_eq(choice_by_bound(&row, 1), VERDICT_NO_BOUND);
	ck_assert_int_eq(choice_by_error(&row, 1), VERDICT_NO_ERROR);
	row.bound_max = row.errors.max = (double)INFINITY;
	ck_assert_int_eq(choice_by_bound(&row, 1), VERDICT_OVER_BOUND);
	ck_assert_int_eq(choice_by_error(&row, 1), VERDICT_OVER_ERROR);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("choice");
	TCase *c = tcase_create("choice");

	tcase_add_test(c, accurate_before_bounded_before_fast);
	tcase_add_test(c, faster_beyond_the_spread);
	tcase_add_test(c, ties_are_of_the_trigonometry_alone);
	tcase_add_test(c, only_what_is_close_enough);
	tcase_add_test(c, verdicts);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
