/* Two-float arithmetic against MPFR: the published bounds, on random operands and on those that are hard, however the
   compiler treats products and sums; sine and cosine of such numbers. */
#include "f32x2.h"
#include "support/rng.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <float.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

#define SAMPLES (exhaustive() ? 200000 : sanitized() ? 10000 : 100000)
#define ANGLES (exhaustive() ? 50000 : sanitized() ? 2500 : 25000)
enum { SEED = 4711, BITS = 400, VARIANTS = 3 };

/* Sine and cosine: relative, and where they vanish. */
static const double SINCOS_BOUND = 0x1p-46, SINCOS_TINY = 0x1p-58;

static const struct f32x2 *variants[VARIANTS];
static mpfr_t exact, other, got;

static void open_mpfr(void)
{
	mpfr_inits2(BITS, exact, other, got, (mpfr_ptr)0);
}

static void close_mpfr(void)
{
	mpfr_clears(exact, other, got, (mpfr_ptr)0);
	mpfr_free_cache();
}

/* ---- operands ---- */

/* Few bits, many bits, all bits, or any. */
static float draw_significand(struct rng *r)
{
	switch (rng_below(r, 4)) {
	case 0:
		return 1 + (float)rng_below(r, 8) * FLT_EPSILON;
	case 1:
		return 2 - (float)(1 + rng_below(r, 8)) * FLT_EPSILON;
	case 2:
		return 1 + (float)rng_below(r, 4096) / 4096;
	default:
		return 1 + (float)rng_below(r, 1 << 23) * FLT_EPSILON;
	}
}

static float draw_float(struct rng *r, int exponent)
{
	float x = ldexpf(draw_significand(r), exponent);

	return rng_chance(r, 0.5) ? -x : x;
}

/* lo is nothing, half a unit in the last place of hi, nearly that, or anything below */
static void draw_pair(struct rng *r, int exponent, float *a)
{
	float hi = draw_float(r, exponent), lo = ldexpf(draw_significand(r), exponent - 26 - rng_below(r, 30));

	switch (rng_below(r, 4)) {
	case 0:
		lo = 0;
		break;
	case 1:
		lo = ldexpf(1, exponent - 24);
		break;
	case 2:
		lo = ldexpf(1 - FLT_EPSILON * (float)rng_below(r, 8) / 2, exponent - 24);
		break;
	default:;
	}
	lo = rng_chance(r, 0.5) ? -lo : lo;
	a[0] = hi + lo;
	a[1] = lo - (a[0] - hi);
}

/* Like b with the other sign, but for some of its last bits. */
static void draw_opposite(struct rng *r, const float *b, float *a)
{
	float hi = -b[0] * (1 + (float)(rng_below(r, 7) - 3) * FLT_EPSILON), lo = -b[1] * (float)rng_uniform(r, -1, 1.5);

	a[0] = hi + lo;
	a[1] = lo - (a[0] - hi);
}

/* Magnitudes from 2^-30 to 2^30, and up to 2^gap apart. */
static void draw_operands(struct rng *r, float *a, float *b, int gap)
{
	draw_pair(r, rng_below(r, 60) - 30, b);
	if (rng_chance(r, 0.3))
		draw_opposite(r, b, a);
	else
		draw_pair(r, (int)floor(log2(fabs((double)b[0]))) + rng_below(r, 2 * gap) - gap, a);
}

/* ---- judging ---- */

static void set(mpfr_t x, const float *a)
{
	mpfr_set_d(x, (double)a[0], MPFR_RNDN);
	mpfr_add_d(x, x, (double)a[1], MPFR_RNDN);
}

/* |out - exact| / |size| in u^2 */
static double units_of(const float *out, mpfr_t size)
{
	set(got, out);
	mpfr_sub(got, got, exact, MPFR_RNDN);
	if (mpfr_zero_p(got))
		return 0;
	mpfr_div(got, got, size, MPFR_RNDN);
	return fabs(mpfr_get_d(got, MPFR_RNDN)) * 0x1p48;
}

static double units(const float *out)
{
	return units_of(out, exact);
}

/* The terms of a sum to be: the sum in exact, that of their magnitudes in other. */
static void set_sum(const float *a, const float *b)
{
	set(exact, a), set(other, b);
	mpfr_add(got, exact, other, MPFR_RNDN);
	mpfr_abs(exact, exact, MPFR_RNDN), mpfr_abs(other, other, MPFR_RNDN);
	mpfr_add(other, exact, other, MPFR_RNDN);
	mpfr_set(exact, got, MPFR_RNDN);
}

/* hi is what hi + lo rounds to, but for what the last rounding of lo may do */
static int is_pair(const float *a)
{
	return fabs((double)a[1]) <= (1 + 0x1p-22) * 0x1p-24 * fabs((double)a[0]);
}

struct worst {
	const char *what;
	double units, bound;
};

static void worst_take(struct worst *w, const struct f32x2 *v, double error, const float *out)
{
	ck_assert_msg(isfinite(out[0]) && is_pair(out), "%s, %s: %a + %a is no pair", w->what, v->name, (double)out[0],
		(double)out[1]);
	ck_assert_msg(error <= w->bound, "%s, %s: %g u^2, bound %g", w->what, v->name, error, w->bound);
	w->units = fmax(w->units, error);
}

static void worst_print(const struct worst *w, const struct f32x2 *v)
{
	printf("%s, %s: at most %.3f u^2, bound %.3f\n", w->what, v->name, w->units, w->bound);
}

/* ---- building blocks ---- */

static void check_blocks(const struct f32x2 *v)
{
	static const double add_bound = 3.001; /* of the terms */
	struct worst add = {"add", 0, add_bound}, mul = {"mul", 0, v->mul_bound}, add_f = {"add_f", 0, 2},
		     mul_f = {"mul_f", 0, v->mul_f_bound}, chain = {"add after mul", 0, add_bound};
	struct rng r = rng_seed(SEED);
	float a[2], b[2], c[2], out[2];

	for (int i = 0; i < SAMPLES; i++) {
		draw_operands(&r, a, b, 60);
		set_sum(a, b);
		v->add(a, b, out);
		worst_take(&add, v, units_of(out, other), out);
		set(exact, a);
		mpfr_add_d(exact, exact, (double)b[0], MPFR_RNDN);
		v->add_f(a, b[0], out);
		worst_take(&add_f, v, units(out), out);
		draw_operands(&r, a, b, 20);
		set(exact, a);
		mpfr_mul_d(exact, exact, (double)b[0], MPFR_RNDN);
		v->mul_f(a, b[0], out);
		worst_take(&mul_f, v, units(out), out);
		set(exact, a), set(other, b);
		mpfr_mul(exact, exact, other, MPFR_RNDN);
		v->mul(a, b, out);
		worst_take(&mul, v, units(out), out);
		draw_opposite(&r, out, c);
		set_sum(out, c);
		v->fma(a, b, c, out);
		worst_take(&chain, v, units_of(out, other), out);
	}
	worst_print(&add, v);
	worst_print(&add_f, v);
	worst_print(&mul, v);
	worst_print(&mul_f, v);
	worst_print(&chain, v);
}

START_TEST(blocks)
{
	if (variants[_i])
		check_blocks(variants[_i]);
}
END_TEST

START_TEST(memory)
{
	const struct f32x2 *v = variants[_i];
	struct rng r = rng_seed(SEED);
	float a[2], b[2];

	for (int i = 0; v && i < SAMPLES; i++) {
		double x = ldexp(rng_uniform(&r, -1, 1), rng_below(&r, 160) - 80);

		v->split(x, a);
		ck_assert_msg(is_pair(a) && fabs(v->join(a) - x) <= 0x1p-48 * fabs(x), "%a", x);
		v->split(v->join(a), b);
		ck_assert(a[0] == b[0] && a[1] == b[1]);
	}
}
END_TEST

/* ---- sine and cosine ---- */

static double exponential(struct rng *r, double low, double high)
{
	double x = exp2(rng_uniform(r, log2(low), log2(high)));

	return rng_chance(r, 0.5) ? -x : x;
}

static double draw_angle(struct rng *r)
{
	return rng_uniform(r, -10, 10);
}

static double draw_domain(struct rng *r)
{
	return exponential(r, 0x1p-40, 1e4);
}

/* A number beside a multiple of pi/4: a zero, or the border of two quarter turns. */
static double draw_multiple(struct rng *r)
{
	double x = floor(exponential(r, 1, 12732)) * 0.78539816339744830962;

	return x * (1 + (rng_below(r, 5) - 2) * 0x1p-52);
}

static double draw_large(struct rng *r)
{
	return exponential(r, 1.0001e4, 1e30);
}

/* |out - value| in units of the bound, which is in other */
static double sincos_units(const float *out)
{
	double size = fabs(mpfr_get_d(exact, MPFR_RNDN));

	set(got, out);
	mpfr_sub(got, got, exact, MPFR_RNDN);
	return fabs(mpfr_get_d(got, MPFR_RNDN)) / (SINCOS_BOUND * size + SINCOS_TINY);
}

static void check_angles(const struct f32x2 *v, const char *what, double (*draw)(struct rng *r), int large)
{
	struct rng r = rng_seed(SEED);
	double worst = 0;

	for (int i = 0; i < ANGLES; i++) {
		double x = draw(&r);
		float s[2], c[2];

		mpfr_set_d(exact, x, MPFR_RNDN);
		mpfr_sin_cos(exact, other, exact, MPFR_RNDN);
		(large ? v->sincos : v->bounded)(x, s, c);
		worst = fmax(worst, sincos_units(s));
		mpfr_swap(exact, other);
		worst = fmax(worst, sincos_units(c));
		ck_assert_msg(worst < 1, "%s, %s: %g times the bound at %a", what, v->name, worst, x);
	}
	printf("%s, %s: at most %.3f of 2^-46\n", what, v->name, worst);
}

START_TEST(angles)
{
	const struct f32x2 *v = variants[_i];

	if (!v)
		return;
	check_angles(v, "sincos, |x| < 10", draw_angle, 0);
	check_angles(v, "sincos, log-uniform up to 1e4", draw_domain, 0);
	check_angles(v, "sincos, beside multiples of pi/4", draw_multiple, 0);
	check_angles(v, "sincos above 1e4", draw_large, 1);
}
END_TEST

START_TEST(outside_is_nan)
{
	const double outside[] = {10000.001, 1e9, 1e39, (double)INFINITY, (double)NAN};
	const struct f32x2 *v = variants[_i];

	for (size_t i = 0; v && i < 2 * sizeof outside / sizeof *outside; i++) {
		float s[2], c[2];
		double x = i & 1 ? -outside[i / 2] : outside[i / 2];

		v->bounded(x, s, c);
		ck_assert(isnan(v->join(s)) && isnan(v->join(c)));
		v->sincos(x, s, c);
		ck_assert(isfinite(x) ? isfinite(v->join(s)) && isfinite(v->join(c))
						 : isnan(v->join(s)) && isnan(v->join(c)));
	}
}
END_TEST

int main(void)
{
	Suite *s = suite_create("f32x2");
	TCase *t = tcase_create("f32x2");

	variants[0] = &f32x2_plain;
	variants[1] = &f32x2_fma;
	variants[2] = f32x2_contracted();
	printf("seed %d, %d operations and %d angles each\n", SEED, SAMPLES, ANGLES);
	if (!variants[2])
		printf("skipped: the machine's own fused multiply-add: it has none\n");
	suite_add_tcase(s, t);
	tcase_set_timeout(t, 600);
	tcase_add_checked_fixture(t, open_mpfr, close_mpfr);
	tcase_add_loop_test(t, blocks, 0, VARIANTS);
	tcase_add_loop_test(t, memory, 0, VARIANTS);
	tcase_add_loop_test(t, angles, 0, VARIANTS);
	tcase_add_loop_test(t, outside_is_nan, 0, VARIANTS);
	return suite_run(s);
}
