/* Intervals contain what MPFR computes of numbers in them, and are hardly wider: a bound that is rounded inwards, or a sine that
   misses its top, is seen. */
#include "norms/interval.h"
#include "prove/spans.h"
#include "support/suite.h"

enum { SEED = 20, PAIRS = 20000, BITS = 240 };

static struct span span_of(struct interval a)
{
	return (struct span){a.lower, a.upper};
}

static struct interval draw(struct rng *r)
{
	struct span s = spans_draw(r, spans_magnitude);

	return (struct interval){s.lo, s.hi};
}

static double inside(struct rng *r, struct interval a)
{
	return spans_inside(r, span_of(a));
}

static int contains(struct interval a, mpfr_t x)
{
	return spans_contain(span_of(a), x);
}

START_TEST(test_operations)
{
	struct rng r = rng_seed(SEED);
	mpfr_t x, y, z;

	mpfr_inits2(BITS, x, y, z, (mpfr_ptr)0);
	for (int i = 0; i < PAIRS; i++) {
		struct interval a = draw(&r), b = draw(&r);

		mpfr_set_d(x, inside(&r, a), MPFR_RNDN);
		mpfr_set_d(y, inside(&r, b), MPFR_RNDN);
		mpfr_add(z, x, y, MPFR_RNDN);
		ck_assert(contains(interval_add(a, b), z));
		mpfr_sub(z, x, y, MPFR_RNDN);
		ck_assert(contains(interval_sub(a, b), z));
		mpfr_mul(z, x, y, MPFR_RNDN);
		ck_assert(contains(interval_mul(a, b), z));
		mpfr_neg(z, x, MPFR_RNDN);
		ck_assert(contains(interval_neg(a), z));
		ck_assert(mpfr_cmpabs_ui(x, 0) == 0 || interval_size(a) >= fabs(mpfr_get_d(x, MPFR_RNDZ)));
	}
	mpfr_clears(x, y, z, (mpfr_ptr)0);
}
END_TEST

/* The bounds of a product, a sum and a number known within an error, to 2^-50 of themselves. */
START_TEST(test_are_close)
{
	struct interval a = {0.1, 0.3}, b = {-0.7, 0.9}, m = interval_mul(a, b), s = interval_add(a, b),
		n = interval_around(0.1L, 0);

	ck_assert(m.lower <= -0.21 && m.lower >= -0.21 * (1 + 0x1p-50) && m.upper >= 0.27 && m.upper <= 0.27 * (1 + 0x1p-50));
	ck_assert(s.lower <= -0.6 && s.lower >= -0.6 * (1 + 0x1p-50) && s.upper >= 1.2 && s.upper <= 1.2 * (1 + 0x1p-50));
	ck_assert(n.lower <= 0.1 && n.upper >= 0.1 && n.upper - n.lower < 0x1p-52);
	n = interval_around(2, 0);
	ck_assert(n.lower == 2 && n.upper == 2);
	n = interval_around(2, 1e-3);
	ck_assert(n.lower <= 1.999 && n.upper >= 2.001 && n.upper < 2.0010001);
}
END_TEST

/* Angles up to 1000, short intervals and long ones; every top and bottom inside is seen. */
START_TEST(test_waves)
{
	struct rng r = rng_seed(SEED + 1);
	mpfr_t x, s, c;

	mpfr_inits2(BITS, x, s, c, (mpfr_ptr)0);
	for (int i = 0; i < PAIRS; i++) {
		double a = rng_uniform(&r, -1, 1) * exp2(rng_uniform(&r, -3, 10)), width = exp2(rng_uniform(&r, -30, 3));
		struct interval in = {a, a + width}, sine = interval_sin(in), cosine = interval_cos(in);

		for (int k = 0; k < 20; k++) {
			mpfr_set_d(x, inside(&r, in), MPFR_RNDN);
			mpfr_sin_cos(s, c, x, MPFR_RNDN);
			ck_assert_msg(contains(sine, s) && contains(cosine, c), "%a to %a", in.lower, in.upper);
		}
		ck_assert(sine.upper - sine.lower <= fmin(2, width) + 1e-11 &&
			cosine.upper - cosine.lower <= fmin(2, width) + 1e-11);
	}
	mpfr_clears(x, s, c, (mpfr_ptr)0);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("interval");

	suite_add(suite, "operations", test_operations, 1, 60);
	suite_add(suite, "close", test_are_close, 1, 60);
	suite_add(suite, "waves", test_waves, 1, 60);
	return suite_run(suite);
}
