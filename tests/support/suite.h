#ifndef TESTS_SUITE_H
#define TESTS_SUITE_H
/* What the Check programs share. */

#include <check.h>

/* Run a suite and free it; returns the program's exit status. That no test ran, as with a wrong name in CK_RUN_CASE, is a
   failure. */
static inline int suite_run(Suite *suite)
{
	SRunner *runner = srunner_create(suite);
	int failed;

	srunner_run_all(runner, CK_NORMAL);
	failed = srunner_ntests_failed(runner) || srunner_ntests_run(runner) == 0;
	srunner_free(runner);
	return failed;
}

/* A case of one test in a loop, which may take so many seconds each time. */
static inline void suite_add(Suite *suite, const char *name, const TTest *test, int count, double seconds)
{
	TCase *c = tcase_create(name);

	tcase_set_timeout(c, seconds);
	tcase_add_loop_test(c, test, 0, count);
	suite_add_tcase(suite, c);
}

#endif
