/* When progress is shown, and what: by times that are made up, for a log file and for a terminal. */
#include "rnearun/progress.h"
#include "support/suite.h"
#include <check.h>
#include <string.h>

/* How often something is shown in so many seconds, asked ten times a second. */
static int shown_in(double seconds, int terminal)
{
	struct progress p = {.terminal = terminal, .total = 1};
	double last = 0;
	int shown = 0;

	for (int i = 1; i <= 10 * seconds; i++)
		if (progress_is_due(&p, i / 10.0, i / 10.0 - last)) {
			last = i / 10.0;
			shown++;
		}
	return shown;
}

/* Would catch silence where there is no terminal, and a log that fills up. */
START_TEST(in_a_log)
{
	ck_assert_int_eq(shown_in(4.9, 0), 0);
	ck_assert_int_eq(shown_in(60, 0), 11);
	ck_assert_int_ge(shown_in(3600, 0), 40);
	ck_assert_int_le(shown_in(3600, 0), 60);
}
END_TEST

START_TEST(on_a_terminal)
{
	ck_assert_int_ge(shown_in(10, 1), 50);
}
END_TEST

static void check_text(uint64_t done, const char *doing, const char *expected)
{
	struct progress p = {.unit = "variants", .total = 12};
	char text[160];

	progress_text(&p, done, doing, 4, text, sizeof text);
	ck_assert_str_eq(text, expected);
	progress_text(&p, done, doing, 4, text, 10);
	ck_assert_uint_lt(strlen(text), 10);
}

START_TEST(texts)
{
	check_text(0, "cpu f64 fast soa", "0 %, 0 of 12 variants: cpu f64 fast soa");
	check_text(3, "cpu f64 fast soa", "25 %, 3 of 12 variants, 0:12 left: cpu f64 fast soa");
	check_text(3, "", "25 %, 3 of 12 variants, 0.75/s, 0:12 left");
	check_text(12, "", "100 %, 12 of 12 variants, 3/s, 0:00 left");
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("progress");
	TCase *c = tcase_create("progress");

	tcase_add_test(c, in_a_log);
	tcase_add_test(c, on_a_terminal);
	tcase_add_test(c, texts);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
