// templates/sincos/sincos_f64_*.in against MPFR, with both forms of RNEA_FMA; and for f32 as well the arguments that come
// closest to multiples of pi/2.
#include "sincos_check.h"
#include <mpfr.h>

enum { TERMS = 200, BITS = 200, PI_BITS = 1500 };

static mpfr_t exact_x, exact_s, exact_c;

static void exact(double x)
{
	mpfr_set_d(exact_x, x, MPFR_RNDN);
	mpfr_sin_cos(exact_s, exact_c, exact_x, MPFR_RNDN);
}

static double units64(double got, mpfr_t value)
{
	mpfr_t difference;
	double units;

	mpfr_init2(difference, BITS);
	mpfr_d_sub(difference, got, value, MPFR_RNDN);
	mpfr_mul_2si(difference, difference, 53 - mpfr_get_exp(value), MPFR_RNDN);
	units = fabs(mpfr_get_d(difference, MPFR_RNDN));
	mpfr_clear(difference);
	return units;
}

typedef void array64(const double *x, double *s, double *c, size_t n);

static void compare64(array64 *f, double x, struct worst *w)
{
	double s, c;

	f(&x, &s, &c, 1);
	worst_take(w, units64(s, exact_s), x);
	worst_take(w, units64(c, exact_c), x);
}

/* ---- random arguments ---- */

static double exponential(struct rng *r, double low, double high)
{
	double x = fmin(high, exp2(rng_uniform(r, log2(low), log2(high))));

	return rng_chance(r, 0.5) ? -x : x;
}

static double draw_domain(struct rng *r)
{
	return exponential(r, 0x1p-40, 1e7);
}

static double draw_angle(struct rng *r)
{
	return rng_uniform(r, -10, 10);
}

static double draw_large(struct rng *r)
{
	return exponential(r, 1e7, DBL_MAX / 2);
}

// One of the few numbers beside a multiple of pi/4: a zero, or the border of two quarter turns.
static double draw_multiple(struct rng *r)
{
	double x = fmin(1e7, floor(fabs(exponential(r, 1, 1.27e7))) * 0.78539816339744830962);

	for (int i = rng_below(r, 3); i > 0; i--)
		x = nextafter(x, 0);
	return x;
}

static void sample64(const char *what, double (*draw)(struct rng *), int accurate)
{
	struct rng r = rng_seed(SEED);
	struct worst w[2] = {{what, 0, 0}, {what, 0, 0}};

	for (int i = 0; i < SAMPLES; i++) {
		double x = draw(&r);

		exact(x);
		for (int v = 0; v < 2; v++)
			compare64(accurate ? variants[v]->accurate64 : variants[v]->bounded64, x, &w[v]);
	}
	for (int v = 0; v < 2; v++)
		worst_check(&w[v], variants[v]->name);
}

START_TEST(bounded_domain)
{
	sample64("f64 bounded, log-uniform", draw_domain, 0);
	sample64("f64 bounded, |x| < 10", draw_angle, 0);
	sample64("f64 bounded, beside multiples of pi/4", draw_multiple, 0);
}
END_TEST

START_TEST(accurate_large)
{
	sample64("f64 accurate above 1e7", draw_large, 1);
}
END_TEST

/* ---- arguments closest to multiples of pi/2 ---- */

struct close {
	struct worst bounded[2], accurate[2];
	double smallest;
	int is_f32;
};

static void close_take32(struct close *t, double x, double s, double c)
{
	float x32 = (float)x, s32, c32;

	for (int v = 0; v < 2; v++) {
		variants[v]->accurate32(&x32, &s32, &c32, 1);
		worst_take(&t->accurate[v], units32(s32, s), x);
		worst_take(&t->accurate[v], units32(c32, c), x);
		if (x > 1e4)
			continue;
		variants[v]->bounded32(&x32, &s32, &c32, 1);
		worst_take(&t->bounded[v], units32(s32, s), x);
		worst_take(&t->bounded[v], units32(c32, c), x);
	}
}

static void close_take(struct close *t, double x)
{
	double s, c;

	exact(x);
	s = mpfr_get_d(exact_s, MPFR_RNDN);
	c = mpfr_get_d(exact_c, MPFR_RNDN);
	t->smallest = fmin(t->smallest, fmin(fabs(s), fabs(c)));
	if (t->is_f32) {
		close_take32(t, x, s, c);
		return;
	}
	for (int v = 0; v < 2; v++) {
		compare64(variants[v]->accurate64, x, &t->accurate[v]);
		if (x <= 1e7)
			compare64(variants[v]->bounded64, x, &t->bounded[v]);
	}
}

// m*2^p is close to a multiple of pi/2 where m is the denominator of a convergent of 2^p*2/pi (Kahan).
static void close_at_exponent(struct close *t, int p, int bits)
{
	double m = 1, before = 0;
	mpfr_t rest;

	mpfr_init2(rest, PI_BITS);
	mpfr_const_pi(rest, MPFR_RNDN);
	mpfr_si_div(rest, 2, rest, MPFR_RNDN);
	mpfr_mul_2si(rest, rest, p, MPFR_RNDN);
	mpfr_frac(rest, rest, MPFR_RNDN);
	for (int i = 0; i < TERMS; i++) {
		double next;

		mpfr_si_div(rest, 1, rest, MPFR_RNDN);
		next = floor(mpfr_get_d(rest, MPFR_RNDD)) * m + before;
		mpfr_frac(rest, rest, MPFR_RNDN);
		if (next >= ldexp(1, bits))
			break;
		before = m;
		m = next;
		if (ldexp(m, p) >= 0x1p-20)
			close_take(t, ldexp(m, p));
	}
	mpfr_clear(rest);
}

static void close_check(struct close *t, int first, int last, int bits, double smallest)
{
	for (int p = first; p <= last; p++)
		close_at_exponent(t, p, bits);
	for (int v = 0; v < 2; v++) {
		worst_check(&t->bounded[v], variants[v]->name);
		worst_check(&t->accurate[v], variants[v]->name);
	}
	printf("closest to a multiple of pi/2: %g\n", t->smallest);
	ck_assert_double_lt(t->smallest, smallest);
}

START_TEST(close64)
{
	struct worst b = {"f64 bounded, closest to multiples of pi/2", 0, 0};
	struct worst a = {"f64 accurate, closest to multiples of pi/2", 0, 0};
	struct close t = {{b, b}, {a, a}, 1, 0};

	// 6381956970095103*2^797 is 4.69e-19 from a multiple of pi/2, closer than any other double
	close_check(&t, -60, 970, 53, 4.7e-19);
}
END_TEST

START_TEST(close32)
{
	struct worst b = {"f32 bounded, closest to multiples of pi/2", 0, 0};
	struct worst a = {"f32 accurate, closest to multiples of pi/2", 0, 0};
	struct close t = {{b, b}, {a, a}, 1, 1};

	close_check(&t, -30, 103, 24, 2e-9);
}
END_TEST

/* ---- signs, zeros, NaN, bits ---- */

// Inside the domain the two modes give the same bits, and -x changes the sign of the sine alone, also that of zero.
static int is_symmetric(const struct sincos *v, double x)
{
	double minus = -x, s[4], c[4];

	v->accurate64(&x, &s[0], &c[0], 1);
	v->accurate64(&minus, &s[1], &c[1], 1);
	if (s[1] != -s[0] || !signbit(s[1]) == !signbit(s[0]) || c[1] != c[0])
		return 0;
	if (fabs(x) < 0x1p-27 && !(s[0] == x && !signbit(s[0]) == !signbit(x) && c[0] == 1))
		return 0;
	if (fabs(x) > 1e7)
		return 1;
	v->bounded64(&x, &s[2], &c[2], 1);
	v->bounded64(&minus, &s[3], &c[3], 1);
	return memcmp(s, s + 2, 2 * sizeof *s) == 0 && memcmp(c, c + 2, 2 * sizeof *c) == 0;
}

START_TEST(symmetry)
{
	const double special[] = {0, 1e7, 0x1p-1074, DBL_MIN, DBL_MAX};
	const size_t specials = sizeof special / sizeof *special;
	struct rng r = rng_seed(SEED);
	long mistakes = 0;

	for (size_t i = 0; i < 10 * SAMPLES; i++) {
		double x = i < specials ? special[i] : double_of(rng_next(&r));

		for (int v = 0; v < 2 && isfinite(x); v++)
			mistakes += !is_symmetric(variants[v], x);
	}
	ck_assert_int_eq(mistakes, 0);
}
END_TEST

START_TEST(outside_is_nan)
{
	const double nans[] = {INFINITY, (double)NAN, double_of(0x7ff0000000000001u)};
	const double outside[] = {nextafter(1e7, 1e8), 1e8, DBL_MAX, nans[0], nans[1], nans[2]};

	for (size_t i = 0; i < 2 * sizeof outside / sizeof *outside; i++) {
		double x = i & 1 ? -outside[i / 2] : outside[i / 2], s, c;

		for (int v = 0; v < 2; v++) {
			variants[v]->bounded64(&x, &s, &c, 1);
			ck_assert(isnan(s) && isnan(c));
			variants[v]->accurate64(&x, &s, &c, 1);
			ck_assert(isfinite(x) ? isfinite(s) && isfinite(c) : isnan(s) && isnan(c));
		}
	}
}
END_TEST

// With a true fma every machine gives these bits (hashed on a little-endian one).
START_TEST(same_bits)
{
	struct rng r = rng_seed(SEED);
	uint64_t h = hash_start;

	for (int i = 0; i < SAMPLES; i++) {
		double x = double_of(rng_next(&r)), y[2];

		sincos_fma.accurate64(&x, &y[0], &y[1], 1);
		h = isfinite(x) ? hash(h, y, sizeof y) : h;
	}
	ck_assert_uint_eq(h, 0x3826e35ffc11fb1au);
}
END_TEST

static void open_mpfr(void)
{
	mpfr_init2(exact_x, 53);
	mpfr_inits2(BITS, exact_s, exact_c, (mpfr_ptr)0);
}

static void close_mpfr(void)
{
	mpfr_clears(exact_x, exact_s, exact_c, (mpfr_ptr)0);
	mpfr_free_cache();
}

int main(void)
{
	Suite *s = suite_create("sincos_mpfr");
	TCase *t = tcase_create("f64");

	printf("seed %d, %d samples each\n", SEED, SAMPLES);
	suite_add_tcase(s, t);
	tcase_set_timeout(t, 900);
	tcase_add_checked_fixture(t, open_mpfr, close_mpfr);
	tcase_add_test(t, bounded_domain);
	tcase_add_test(t, accurate_large);
	tcase_add_test(t, close64);
	tcase_add_test(t, close32);
	tcase_add_test(t, symmetry);
	tcase_add_test(t, outside_is_nan);
	tcase_add_test(t, same_bits);
	return sincos_run(s);
}
