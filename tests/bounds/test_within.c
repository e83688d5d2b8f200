/* gen/within and gen/number against quad precision: no number is further from what the decimals give than it says, and none
   that is exact says that it is not. */
#include "base/number.h"
#include "support/rng.h"
#include "support/suite.h"
#include "base/within.h"
#include <float.h>
#include <math.h>
#include <quadmath.h>
#include <stdio.h>

enum { SEED = 1, TREES = 20000, DEPTH = 4 };

/* A number and what it stands for. */
struct pair {
	struct within near;
	__float128 exact;
};

static struct pair read(const char *decimal)
{
	struct pair p = {.exact = strtoflt128(decimal, NULL)};

	ck_assert_msg(number_read(decimal, &p.near, 1) == NUMBER_FINE, "%s is refused", decimal);
	return p;
}

static __float128 off(const struct pair *p)
{
	return fabsq((__float128)p->near.near - p->exact);
}

/* Quad precision has 49 bits more, of which deep trees take some. */
static void check(const struct pair *p, const char *what)
{
	__float128 noise = 0x1p-105Q * fabsq(p->exact);

	ck_assert_msg(off(p) <= (__float128)p->near.e + noise, "%s: %.21Lg is off by %g, not by %Lg", what, p->near.near,
		(double)off(p), p->near.e);
	ck_assert_msg(fabsq((__float128)p->near.x - p->exact) <= (__float128)within_error(p->near) + noise, "%s: %.17Lg", what,
		p->near.x);
}

/* ---- decimals ---- */

static const struct decimal {
	const char *text;
	int exact;
} decimals[] = {
	{"0", 1}, {"-0.0", 1}, {"1", 1}, {"1.0", 1}, {"-1.000000", 1}, {"+2", 1}, {"0.5", 1}, {".25", 1}, {"10", 1}, {"1e3", 1},
	{"100e-2", 1}, {"0.0625", 1}, {"12345678.75", 1}, {"0.1", 0}, {"1.1", 0}, {"9.81", 0}, {"0.3", 0}, {"1e-5", 0},
	{"3.141592653589793", 0}, {"0.50000000000000000000000001", 0}, {"1.0000000000000000000000000000000000001", 0},
	{"0.99999999999999999999999999", 0}, {"1e-320", 0}, {"1e308", 0}, {"123456789012345678901234567890", 0}, {"-0.7e-12", 0},
	{"0.1000000000000000055511151231257827", 0}, {"4.9e-324", 0},
};

START_TEST(of_decimals)
{
	struct pair p = read(decimals[_i].text);

	check(&p, decimals[_i].text);
	ck_assert_msg((p.near.e == 0) == decimals[_i].exact, "%s: %Lg", decimals[_i].text, p.near.e);
	ck_assert_msg(p.near.e <= LDBL_EPSILON * fabsl(p.near.near) + LDBL_MIN, "%s: %Lg", decimals[_i].text, p.near.e);
	ck_assert(p.near.x == (real)strtod(decimals[_i].text, NULL));
}
END_TEST

/* Any decimal that is read as the same double. */
START_TEST(of_doubles)
{
	static const char *const texts[] = {"-9.81", "-9.8100000000000001", "-9.81000000000000138",
		"-9.8099999999999996", "1.62"};

	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		struct pair p = {within_double(strtod(texts[i], NULL)), strtoflt128(texts[i], NULL)};

		check(&p, texts[i]);
	}
	ck_assert(within_double(0).e == 0 && within_double(-10).e == 0 && within_double(0.5).e > 0);
}
END_TEST

/* ---- arithmetic ---- */

static struct pair leaf(struct rng *rng)
{
	static const char *const formats[] = {"%.1f", "%.3f", "%.17g", "%.6e", "%.0f"};
	char text[64];

	snprintf(text, sizeof text, formats[rng_below(rng, 5)], rng_uniform(rng, -3, 3));
	return read(text);
}

static struct pair combine(int operation, const struct pair *a, const struct pair *b)
{
	switch (operation) {
	case 0:
		return (struct pair){within_add(a->near, b->near), a->exact + b->exact};
	case 1:
		return (struct pair){within_sub(a->near, b->near), a->exact - b->exact};
	case 2:
		return (struct pair){within_div(a->near, b->near), a->exact / b->exact};
	case 3:
		return (struct pair){within_sqrt(a->near), sqrtq(a->exact)};
	case 4:
		return (struct pair){within_sin(a->near), sinq(a->exact)};
	case 5:
		return (struct pair){within_cos(a->near), cosq(a->exact)};
	case 6:
		return (struct pair){within_neg(a->near), -a->exact};
	default:
		return (struct pair){within_mul(a->near, b->near), a->exact * b->exact};
	}
}

static struct pair tree(struct rng *rng, int depth)
{
	struct pair a, b;
	int operation = rng_below(rng, 12);

	if (!depth || rng_chance(rng, 0.1))
		return leaf(rng);
	a = tree(rng, depth - 1);
	b = tree(rng, depth - 1);
	if (operation == 2 && fabsl(b.near.near) < 0.01L)
		operation = 0;
	if (operation == 3 && a.near.near < 0.01L)
		operation = 1;
	/* what is left of a difference of equal sums is their rounding */
	if (operation == 1 && rng_chance(rng, 0.5))
		b = combine(0, &a, &b);
	return combine(operation, &a, &b);
}

START_TEST(of_arithmetic)
{
	struct rng rng = rng_seed(SEED);
	double share = 0;
	int exact = 0;

	for (int i = 0; i < TREES; i++) {
		struct pair p = tree(&rng, DEPTH);

		check(&p, "tree");
		exact += p.near.e == 0;
		if (p.near.e > 0)
			share = fmax(share, (double)(off(&p) / (__float128)p.near.e));
	}
	printf("%d trees, seed %d: %d exact, errors up to %.2f of what is said\n", TREES, SEED, exact, share);
	ck_assert_int_gt(exact, TREES / 100);
	ck_assert(share > 0.5);
}
END_TEST

/* What comes out even has no error. */
START_TEST(stays_exact)
{
	const struct within a = within_exact(0.75L), b = within_exact(-3), tiny = within_exact(LDBL_MIN), c = read("0.3").near;

	ck_assert(within_add(a, b).e == 0 && within_sub(a, b).e == 0 && within_mul(a, b).e == 0 && within_div(b, a).e == 0);
	ck_assert(within_sqrt(within_exact(2.25L)).e == 0 && within_sin(within_exact(0)).e == 0 &&
		within_cos(within_exact(0)).e == 0);
	ck_assert(within_div(a, b).e == 0 && within_div(within_exact(1), b).e > 0 && within_sqrt(within_exact(2)).e > 0);
	ck_assert(within_mul(tiny, within_exact(0.3L)).e > 0 && isinf(within_error(within_div(a, within_sub(c, c)))));
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("within");
	TCase *c = tcase_create("within");

	tcase_add_loop_test(c, of_decimals, 0, sizeof decimals / sizeof *decimals);
	tcase_add_test(c, of_doubles);
	tcase_add_test(c, of_arithmetic);
	tcase_add_test(c, stays_exact);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
