/* Tracks that there is no memory for: an error, told to the other ranks, and nothing is recorded as complete. */
#include "support/suite.h"
#include "eval/crew.h"
#include <stdlib.h>

static int refuses;

/* The linker puts this in the place of calloc. */
void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);

void *__wrap_calloc(size_t count, size_t size)
{
	return refuses ? NULL : __real_calloc(count, size);
}

static void show(void *own, uint64_t done)
{
	(void)own;
	ck_assert_uint_eq(done, 0);
}

static void record(void *own, uint64_t whole)
{
	*(uint64_t *)own = whole;
}

START_TEST(test_no_memory)
{
	static struct signature signature = {.count = 1, .arrays = {{.rows = 1}}};
	struct eval_arrays arrays = {.s = &signature, .scalar = RNEA_F64};
	const int devices[] = {0};
	uint64_t recorded = 0;
	struct ranks ranks;
	struct rneagen_error e = {0};
	struct eval_crew crew = {.arrays = &arrays, .ranks = &ranks, .devices = devices, .count = 1, .first = 7, .samples = 100,
		.show = show, .record = record, .own = &recorded};

	ck_assert(ranks_open(&ranks, NULL, NULL));
	refuses = 1;
	ck_assert_int_eq(eval_crew_run(&crew, &e), 0);
	ck_assert_int_eq(ranks_agree(&ranks, 1), 1);
	refuses = 0;
	ck_assert_int_eq(e.code, RNEAGEN_MEMORY);
	ck_assert_uint_eq(recorded, 7);
	ranks_close(&ranks);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("crew");
	TCase *c = tcase_create("crew");

	tcase_add_test(c, test_no_memory);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
