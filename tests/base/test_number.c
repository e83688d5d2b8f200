/* Numbers as text: the fewest digits that read back as the same, which no shorter decimal does; and what is read as a
   number, by a table of what urdfdom takes. */
#include "base/number.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t digits_in(const char *s)
{
	size_t n = 0, zeros = 0;

	for (; *s && *s != 'e'; s++) {
		zeros = *s == '0' ? zeros + 1 : *s == '.' ? zeros : 0;
		n += *s >= '0' && *s <= '9' && (n || *s != '0');
	}
	return n - (n > zeros ? zeros : n); /* zeros at the end may only fill the places before the point */
}

static void check(double x)
{
	struct number_text plain = number_plain(x), shortest = number_shortest(x), single = number_shortest_float((float)x);
	size_t n = digits_in(plain.s);
	char shorter[32];

	ck_assert_msg(strtod(plain.s, NULL) == x && strtod(shortest.s, NULL) == x, "%a as %s, %s", x, plain.s, shortest.s);
	ck_assert_msg(strtof(single.s, NULL) == (float)x, "%a as float %s", x, single.s);
	ck_assert_msg(digits_in(shortest.s) == n, "%s, %s", plain.s, shortest.s);
	snprintf(shorter, sizeof shorter, "%.*e", n > 1 ? (int)n - 2 : 0, x);
	ck_assert_msg(n < 2 || strtod(shorter, NULL) != x, "%s is as good as %s", shorter, plain.s);
}

START_TEST(known)
{
	static const struct {
		double x;
		const char *plain, *shortest;
	} cases[] = {{0.573, "0.573", "0.573"}, {-9.81, "-9.81", "-9.81"}, {0, "0", "0"}, {300, "300", "3e+02"},
		{-10, "-10", "-1e+01"},
		{123456, "123456", "123456"}, {1e14, "100000000000000", "1e+14"}, {1e15, "1e+15", "1e+15"},
		{1e-5, "1e-05", "1e-05"}, {0.1, "0.1", "0.1"}, {0.1 + 0.2, "0.30000000000000004", "0.30000000000000004"},
		{0x1p-1074, "5e-324", "5e-324"}};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		ck_assert_str_eq(number_plain(cases[i].x).s, cases[i].plain);
		ck_assert_str_eq(number_shortest(cases[i].x).s, cases[i].shortest);
	}
	ck_assert_str_eq(number_shortest_float(0.1f).s, "0.1");
}
END_TEST

START_TEST(drawn)
{
	enum { SEED = 20261121, COUNT = 20000 };
	struct rng rng = rng_seed(SEED);

	printf("seed %d\n", SEED);
	for (int i = 0; i < COUNT; i++) {
		double x = ldexp(rng_uniform(&rng, -1, 1), rng_below(&rng, 120) - 60);

		check(x);
		check(round(x));
		check(rng_below(&rng, 100000) / 1000.0);
	}
}
END_TEST

static const struct {
	const char *s;
	int count;
	enum number_fault fault;
} READ[] = {{"0.5", 1, NUMBER_FINE}, {" -.5e1", 1, NUMBER_FINE}, {"0.5 ", 1, NUMBER_BLANK}, {"0.5  ", 1, NUMBER_BLANK},
	{"1e999", 1, NUMBER_LARGE}, {"-1e999", 1, NUMBER_LARGE}, {"1e999 ", 1, NUMBER_LARGE}, {"1e999x", 1, NUMBER_WORD},
	{"inf", 1, NUMBER_WORD}, {"-nan", 1, NUMBER_WORD}, {"0x10", 1, NUMBER_WORD}, {"", 1, NUMBER_WORD}, {" ", 1, NUMBER_WORD},
	{".", 1, NUMBER_WORD}, {"1 2", 1, NUMBER_WORD}, {"1 2 3 ", 3, NUMBER_FINE}, {"1 2 1e400", 3, NUMBER_LARGE},
	{"1e400 2 x", 3, NUMBER_WORD}, {"1 2", 3, NUMBER_WORD}, {"1 2 3 4", 3, NUMBER_WORD}, {"1e-999", 1, NUMBER_FINE}};

START_TEST(read_as_urdfdom_does)
{
	struct within v[3];

	for (size_t i = 0; i < sizeof READ / sizeof *READ; i++)
		ck_assert_msg(number_read(READ[i].s, v, READ[i].count) == READ[i].fault, "'%s'", READ[i].s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("number");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "known", known, 1, 60);
	suite_add(suite, "drawn", drawn, 1, 60);
	suite_add(suite, "read", read_as_urdfdom_does, 1, 60);
	return suite_run(suite);
}
