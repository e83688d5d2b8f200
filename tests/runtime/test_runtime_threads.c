/* rnea_run by several threads at once. */
#include "test_runtime.h"
#include "test_runtime_batch.h"
#include <pthread.h>
#include <stdlib.h>

static void *run_often(void *argument)
{
	unsigned seed = *(unsigned *)argument;
	struct batch b;
	size_t bad = 0;

	for (unsigned i = 0; i < 12; i++) {
		batch_make(&b, seed % 2 ? 150000 + 1000 * i : 10 + i, (int)(seed / 2 % 2), seed + i);
		if (rnea_run(b.aos ? aos : soa, b.arrays, b.count, NULL) != RNEA_OK || !batch_is_right(&b))
			bad++;
		batch_free(&b);
	}
	return bad ? NULL : argument;
}

START_TEST(several_threads)
{
	pthread_t threads[8];
	unsigned seeds[8];
	void *result;

	for (unsigned i = 0; i < 8; i++) {
		seeds[i] = _i ? i : i & 1; /* all on one robot; on two */
		ck_assert_int_eq(pthread_create(&threads[i], NULL, run_often, &seeds[i]), 0);
	}
	for (unsigned i = 0; i < 8; i++) {
		pthread_join(threads[i], &result);
		ck_assert_ptr_eq(result, &seeds[i]);
	}
}
END_TEST

static void *open_run_close(void *argument)
{
	struct rnea_robot *mine = NULL;
	struct batch b;
	void *ok = NULL;

	batch_make(&b, 70000, 0, *(unsigned *)argument);
	if (rnea_open_file(TEST_DIR "/runtime/mixed.cu", NULL, &mine, NULL) == RNEA_OK &&
		rnea_run(mine, b.arrays, b.count, NULL) == RNEA_OK && batch_is_right(&b))
		ok = argument;
	rnea_close(mine);
	batch_free(&b);
	return ok;
}

/* Threads that open, run and close while others run. */
START_TEST(threads_open_and_close)
{
	pthread_t threads[6];
	unsigned seeds[6];
	void *result;

	for (unsigned i = 0; i < 6; i++) {
		seeds[i] = i;
		pthread_create(&threads[i], NULL, i < 4 ? open_run_close : run_often, &seeds[i]);
	}
	for (unsigned i = 0; i < 6; i++) {
		pthread_join(threads[i], &result);
		ck_assert_ptr_eq(result, &seeds[i]);
	}
}
END_TEST

Suite *suite_threads(void)
{
	Suite *s = suite_create("threads");
	TCase *t = tcase_create("threads");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, batch_setup, batch_teardown);
	tcase_add_loop_test(t, several_threads, 0, 2);
	tcase_add_test(t, threads_open_and_close);
	suite_add_tcase(s, t);
	return s;
}
