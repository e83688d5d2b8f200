/* rnea_run: arrays of the program's own, through the pretended device in slices. What is enqueued there waits until its
   stream is waited for, so that a buffer that is read or written too early shows. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include "../runtime/robot.h"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ARRAYS = 5, GUARD = 64, POISON = 0x7b };

static const size_t rows[ARRAYS] = {2, 3, 4, 2, 1}, bytes[ARRAYS] = {4, 8, 4, 4, 8};

struct batch {
	size_t count;
	int aos;
	char *memory[ARRAYS]; /* with GUARD bytes of poison before and after */
	void *arrays[ARRAYS];
};

static struct rnea_robot *soa, *aos;

/* ---- batches ---- */

static size_t array_size(const struct batch *b, int i)
{
	return rows[i] * bytes[i] * (i == 2 ? 1 : b->count);
}

static void batch_fill(struct batch *b, unsigned seed)
{
	float *a = b->arrays[0], *g = b->arrays[2];
	double *d = b->arrays[1];

	for (size_t i = 0; i < 2 * b->count; i++)
		a[i] = (float)((i * 7 + seed) % 4001) * 0.5f;
	for (size_t i = 0; i < 3 * b->count; i++)
		d[i] = (double)((i * 13 + seed) % 8009) * 0.25;
	for (size_t i = 0; i < 4; i++)
		g[i] = (float)(seed % 5 + i + 1);
}

static void batch_make(struct batch *b, size_t count, int is_aos, unsigned seed)
{
	b->count = count;
	b->aos = is_aos;
	for (int i = 0; i < ARRAYS; i++) {
		size_t size = array_size(b, i);

		b->memory[i] = malloc(size + 2 * GUARD);
		ck_assert_ptr_nonnull(b->memory[i]);
		memset(b->memory[i], POISON, size + 2 * GUARD);
		b->arrays[i] = b->memory[i] + GUARD;
	}
	batch_fill(b, seed);
}

static void batch_free(struct batch *b)
{
	for (int i = 0; i < ARRAYS; i++)
		free(b->memory[i]);
}

static size_t at(const struct batch *b, size_t k, size_t row, size_t n)
{
	return b->aos ? k * n + row : row * b->count + k;
}

/* Whether every output is right to the bit, and nothing beside the outputs was written. */
static int is_right(const struct batch *b)
{
	const float *a = b->arrays[0], *g = b->arrays[2], *x = b->arrays[3];
	const double *d = b->arrays[1], *y = b->arrays[4];

	for (size_t k = 0; k < b->count; k++) {
		for (size_t r = 0; r < 2; r++)
			if (x[at(b, k, r, 2)] != a[at(b, k, r, 2)] * g[r] + (float)d[at(b, k, 0, 3)])
				return 0;
		if (y[k] != d[at(b, k, 1, 3)] + d[at(b, k, 2, 3)] + (double)g[3])
			return 0;
	}
	for (int i = 0; i < ARRAYS; i++)
		for (size_t j = 0; j < GUARD; j++)
			if (b->memory[i][j] != POISON || b->memory[i][GUARD + array_size(b, i) + j] != POISON)
				return 0;
	return 1;
}

/* ---- the pretended driver ---- */

static int driver_call(const char *name)
{
	int (*call)(void);

	fake_function(FAKE_CUDA, name, &call);
	return call();
}

static void defer(int yes)
{
	void (*call)(int);

	fake_function(FAKE_CUDA, "fake_cuda_defer", &call);
	call(yes);
}

/* Make the robot's context current, as a program that locks memory has it; or no longer. */
static void use_context(int yes)
{
	int (*push)(void *), (*pop)(void **);
	void *context;

	fake_function(FAKE_CUDA, "cuCtxPushCurrent_v2", &push);
	fake_function(FAKE_CUDA, "cuCtxPopCurrent_v2", &pop);
	ck_assert_int_eq(yes ? push(soa->driver.device.context) : pop(&context), 0);
}

/* Page-lock `size` bytes, or give them back. */
static void lock_pages(void *memory, size_t size, int yes)
{
	int (*lock)(void *, size_t, unsigned), (*unlock)(void *);

	fake_function(FAKE_CUDA, "cuMemHostRegister_v2", &lock);
	fake_function(FAKE_CUDA, "cuMemHostUnregister", &unlock);
	use_context(1);
	ck_assert_int_eq(yes ? lock(memory, size, 0) : unlock(memory), 0);
	use_context(0);
}

static void lock_arrays(const struct batch *b, unsigned which, int yes)
{
	for (int i = 0; i < ARRAYS; i++)
		if (which >> i & 1)
			lock_pages(b->arrays[i], array_size(b, i), yes);
}

static struct rnea_robot *open_mixed(int is_aos)
{
	FILE *f = fopen(TEST_DIR "/mixed.cu", "rb");
	char *text = calloc(1, 1 << 16);
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert(f && text && fread(text, 1, (1 << 16) - 1, f) > 0);
	fclose(f);
	if (is_aos) {
		memcpy(strstr(text, "MIXED_AOS 0"), "MIXED_AOS 1", 11);
		memcpy(strstr(text, "layout soa"), "layout aos", 10);
	}
	ck_assert_msg(open_text(text, NULL, &robot, &e) == RNEA_OK, "%s", e.message);
	free(text);
	return robot;
}

static void setup(void)
{
	use_fakes();
	soa = open_mixed(0);
	aos = open_mixed(1);
	defer(1);
}

static void teardown(void)
{
	use_fakes();
	rnea_close(soa);
	rnea_close(aos);
	ck_assert_int_eq(fake_live(), 0);
}

/* Run a batch of `count`, arrays `locked` page-locked, and look at the result. */
static void assert_run(size_t count, int is_aos, unsigned locked)
{
	struct rnea_error e;
	struct batch b;

	batch_make(&b, count, is_aos, (unsigned)count + locked);
	lock_arrays(&b, locked, 1);
	ck_assert_msg(rnea_run(is_aos ? aos : soa, b.arrays, count, &e) == RNEA_OK, "%s", e.message);
	lock_arrays(&b, locked, 0);
	ck_assert_msg(is_right(&b), "%zu samples, %s, locked %x", count, is_aos ? "aos" : "soa", locked);
	batch_free(&b);
}

/* ---- tests ---- */

START_TEST(computes)
{
	size_t slice = pipe_slice(soa->pool);
	const size_t counts[] = {1, 2, 127, 129, slice - 1, slice, slice + 1, 100003, 3 * slice, 7 * slice + 5};
	static const unsigned locked[] = {0, 31, 0x15, 0x0a, 0x08};

	ck_assert_uint_gt(100003, slice);
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		for (size_t l = 0; l < sizeof locked / sizeof *locked; l++)
			assert_run(counts[i], _i, locked[l]);
}
END_TEST

START_TEST(nothing_to_do)
{
	struct rnea_error e;

	ck_assert_int_eq(rnea_run(soa, NULL, 0, &e), RNEA_OK);
	ck_assert_int_eq(rnea_run(soa, NULL, 0, NULL), RNEA_OK);
	assert_run(1, 0, 0);
}
END_TEST

START_TEST(bad_arguments)
{
	int (*take)(unsigned long long *, size_t), (*give)(unsigned long long);
	unsigned long long device;
	struct rnea_error e;
	struct batch b;
	void *wrong[ARRAYS];

	batch_make(&b, 10, 0, 1);
	memcpy(wrong, b.arrays, sizeof wrong);
	rnea_run(soa, NULL, 10, &e);
	assert_error(&e, RNEA_ARGUMENT, "mixed_rnea_kernel: there are no arrays");
	wrong[3] = NULL;
	rnea_run(soa, wrong, 10, &e);
	assert_error(&e, RNEA_POINTER, "array 3, \"x\", is NULL");
	wrong[3] = (char *)b.arrays[3] + 1;
	ck_assert_int_eq(rnea_run(soa, wrong, 10, NULL), RNEA_POINTER);
	wrong[3] = b.arrays[3];
	rnea_run(soa, b.arrays, SIZE_MAX, &e);
	assert_error(&e, RNEA_LIMIT, "18446744073709551615 samples");
	fake_function(FAKE_CUDA, "cuMemAlloc_v2", &take);
	fake_function(FAKE_CUDA, "cuMemFree_v2", &give);
	use_context(1);
	take(&device, 4096);
	wrong[1] = (void *)device;
	rnea_run(soa, wrong, 10, &e);
	assert_error(&e, RNEA_POINTER, "rnea_run: array 1, \"b\", is device memory; rnea_launch takes that");
	give(device);
	use_context(0);
	batch_free(&b);
}
END_TEST

/* One slice: one copy in, the launch, one copy out; where the arrays are page-locked, a copy for each. */
START_TEST(small_batches_are_short)
{
	int before = driver_call("fake_cuda_enqueued");

	assert_run(1000, 0, 0);
	ck_assert_int_eq(driver_call("fake_cuda_enqueued") - before, 3);
	assert_run(1000, 0, 31);
	ck_assert_int_eq(driver_call("fake_cuda_enqueued") - before, 3 + 6);
	assert_run(1000, 1, 0);
	ck_assert_int_eq(driver_call("fake_cuda_enqueued") - before, 3 + 6 + 3);
}
END_TEST

/* An array of which only the beginning is page-locked is none that can be copied directly. */
START_TEST(locked_in_part)
{
	struct batch b;

	batch_make(&b, 5000, 0, 3);
	lock_pages(b.arrays[0], 4096, 1);
	ck_assert_int_eq(rnea_run(soa, b.arrays, 5000, NULL), RNEA_OK);
	ck_assert(is_right(&b));
	lock_pages(b.arrays[0], 4096, 0);
	batch_free(&b);
}
END_TEST

/* Buffers are made by the first call, and kept. */
START_TEST(keeps_its_buffers)
{
	int before = fake_live(), after;

	assert_run(100, 0, 0);
	after = fake_live();
	ck_assert_int_eq(after, before + 3);
	assert_run(200000, 0, 0);
	ck_assert_int_eq(fake_live(), before + 9);
	assert_run(200000, 0, 31);
	ck_assert_int_eq(fake_live(), before + 9);
}
END_TEST

static const struct {
	int status;
	enum rnea_code code;
	const char *message;
} statuses[] = {
	{999, RNEA_DRIVER, "error 999"},
	{2, RNEA_DEVICE_MEMORY, "error 2, CUDA_ERROR_OUT_OF_MEMORY"},
	{700, RNEA_CONTEXT, "start the process anew"},
};

/* Nothing of the run of `b` that failed is still to come, not even with the next run. */
static void assert_settled(const struct rnea_robot *robot, const struct batch *b)
{
	struct batch small;

	batch_make(&small, 10, 0, 4);
	for (int i = 3; i < ARRAYS; i++)
		memset(b->arrays[i], POISON, array_size(b, i));
	ck_assert_int_eq(rnea_run(robot, small.arrays, small.count, NULL), RNEA_OK);
	ck_assert(is_right(&small));
	for (int i = 3; i < ARRAYS; i++)
		for (size_t j = 0; j < array_size(b, i); j++)
			if (((const char *)b->arrays[i])[j] != POISON)
				ck_abort_msg("array %d was written after the run had failed", i);
	batch_free(&small);
}

/* Whichever driver call of a run fails, the first of a robot included, the run says so and the next one works. */
START_TEST(every_call_fails_once)
{
	void (*fail_call)(long, int);
	const char *(*failed)(void), *call;
	struct rnea_error e;
	struct batch b;
	long n = 0; /* calls before the one that fails */

	fake_function(FAKE_CUDA, "fake_cuda_fail", &fail_call);
	fake_function(FAKE_CUDA, "fake_cuda_failed", &failed);
	batch_make(&b, 5 * pipe_slice(soa->pool) - 7, 0, 9);
	lock_arrays(&b, 0x11, 1);
	for (;; n++) {
		struct rnea_robot *robot = n < 60 && n % 4 == 0 ? open_mixed(0) : soa;

		memset(b.arrays[3], POISON, array_size(&b, 3));
		fail_call(n, statuses[_i].status);
		rnea_run(robot, b.arrays, b.count, &e);
		call = failed();
		fail_call(-1, 0);
		if (call && strcmp(call, "cuPointerGetAttributes") != 0)
			assert_error(&e, statuses[_i].code, statuses[_i].message);
		else
			ck_assert(e.code == RNEA_OK && is_right(&b));
		if (e.code)
			assert_settled(robot, &b);
		ck_assert_int_eq(rnea_run(robot, b.arrays, b.count, NULL), RNEA_OK);
		ck_assert_msg(is_right(&b), "after call %ld", n);
		if (robot != soa)
			rnea_close(robot);
		else if (!call)
			break;
	}
	ck_assert_int_gt(n, 30);
	lock_arrays(&b, 0x11, 0);
	batch_free(&b);
}
END_TEST

START_TEST(allocation_failures)
{
	struct rnea_error e;
	struct batch b;
	long n = 0;

	batch_make(&b, 1000, 0, 9);
	for (;; n++) {
		fail_allocation(n);
		rnea_run(soa, b.arrays, b.count, &e);
		fail_allocation(-1);
		if (e.code == RNEA_OK)
			break;
		assert_error(&e, RNEA_MEMORY, "out of memory");
	}
	ck_assert_int_eq(n, 1); /* a pipe is one allocation */
	ck_assert(is_right(&b));
	batch_free(&b);
}
END_TEST

/* ---- threads ---- */

static void *run_often(void *argument)
{
	unsigned seed = *(unsigned *)argument;
	struct batch b;
	size_t bad = 0;

	for (unsigned i = 0; i < 12; i++) {
		batch_make(&b, seed % 2 ? 150000 + 1000 * i : 10 + i, (int)(seed / 2 % 2), seed + i);
		if (rnea_run(b.aos ? aos : soa, b.arrays, b.count, NULL) != RNEA_OK || !is_right(&b))
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
	if (rnea_open_file(TEST_DIR "/mixed.cu", NULL, &mine, NULL) == RNEA_OK &&
		rnea_run(mine, b.arrays, b.count, NULL) == RNEA_OK && is_right(&b))
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

/* ---- a context that has died ---- */

START_TEST(closes_on_a_dead_context)
{
	static const char *const deaths[] = {
		"cuCtxGetCurrent=4", "cuCtxPushCurrent_v2=709", "cuModuleUnload=700", "cuStreamSynchronize=719"};
	struct rnea_robot *robot = open_mixed(0);
	struct rnea_error e;
	struct batch b;

	batch_make(&b, 100, 0, 1);
	ck_assert_int_eq(rnea_run(robot, b.arrays, 100, &e), RNEA_OK);
	setenv("RNEA_FAKE_CUDA_FAIL", deaths[_i], 1);
	rnea_close(robot);
	if (_i != 2) {
		rnea_run(soa, b.arrays, 100, &e);
		assert_error(&e, RNEA_CONTEXT,
			_i == 0	  ? "the driver has shut down"
			: _i == 1 ? "open it again"
				  : "anew");
	}
	batch_free(&b);
	use_fakes();
}
END_TEST

Suite *suite_run(void)
{
	Suite *s = suite_create("run");
	TCase *t = tcase_create("run"), *dead = tcase_create("dead");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, setup, teardown);
	tcase_add_loop_test(t, computes, 0, 2);
	tcase_add_test(t, nothing_to_do);
	tcase_add_test(t, bad_arguments);
	tcase_add_test(t, small_batches_are_short);
	tcase_add_test(t, locked_in_part);
	tcase_add_test(t, keeps_its_buffers);
	tcase_add_loop_test(t, every_call_fails_once, 0, 3);
	tcase_add_test(t, allocation_failures);
	tcase_add_loop_test(t, several_threads, 0, 2);
	tcase_add_test(t, threads_open_and_close);
	suite_add_tcase(s, t);
	tcase_set_timeout(dead, 120);
	tcase_add_checked_fixture(dead, setup, NULL); /* what a dead context held cannot be given back */
	tcase_add_loop_test(dead, closes_on_a_dead_context, 0, 4);
	suite_add_tcase(s, dead);
	return s;
}
