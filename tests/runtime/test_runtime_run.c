/* rnea_run: arrays of the program's own, through the pretended device in slices. What is enqueued there waits until its
   stream is waited for, so that a buffer that is read or written too early shows. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include "test_runtime_batch.h"
#include "cuda/backend.h"
#include "handle.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the pretended driver ---- */

static int driver_call(const char *name)
{
	int (*call)(void);

	fake_function(FAKE_CUDA, name, &call);
	return call();
}

static const struct cuda *state(void)
{
	return soa->state;
}

/* Make the robot's context current, as a program that locks memory has it; or no longer. */
static void use_context(int yes)
{
	int (*push)(void *), (*pop)(void **);
	void *context;

	fake_function(FAKE_CUDA, "cuCtxPushCurrent_v2", &push);
	fake_function(FAKE_CUDA, "cuCtxPopCurrent_v2", &pop);
	ck_assert_int_eq(yes ? push(state()->driver.device.context) : pop(&context), 0);
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
			lock_pages(b->arrays[i], batch_size(b, i), yes);
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
	ck_assert_msg(batch_is_right(&b), "%zu samples, %s, locked %x", count, is_aos ? "aos" : "soa", locked);
	batch_free(&b);
}

/* ---- tests ---- */

START_TEST(computes)
{
	size_t slice = pipe_slice(state()->pool);
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
	ck_assert(batch_is_right(&b));
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
		memset(b->arrays[i], POISON, batch_size(b, i));
	ck_assert_int_eq(rnea_run(robot, small.arrays, small.count, NULL), RNEA_OK);
	ck_assert(batch_is_right(&small));
	for (int i = 3; i < ARRAYS; i++)
		for (size_t j = 0; j < batch_size(b, i); j++)
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
	batch_make(&b, 5 * pipe_slice(state()->pool) - 7, 0, 9);
	lock_arrays(&b, 0x11, 1);
	for (;; n++) {
		struct rnea_robot *robot = n < 60 && n % 4 == 0 ? batch_open(0) : soa;

		memset(b.arrays[3], POISON, batch_size(&b, 3));
		fail_call(n, statuses[_i].status);
		rnea_run(robot, b.arrays, b.count, &e);
		call = failed();
		fail_call(-1, 0);
		if (call && strcmp(call, "cuPointerGetAttributes") != 0)
			assert_error(&e, statuses[_i].code, statuses[_i].message);
		else
			ck_assert(e.code == RNEA_OK && batch_is_right(&b));
		if (e.code)
			assert_settled(robot, &b);
		ck_assert_int_eq(rnea_run(robot, b.arrays, b.count, NULL), RNEA_OK);
		ck_assert_msg(batch_is_right(&b), "after call %ld", n);
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
	ck_assert(batch_is_right(&b));
	batch_free(&b);
}
END_TEST

/* ---- a context that has died ---- */

START_TEST(closes_on_a_dead_context)
{
	static const char *const deaths[] = {
		"cuCtxGetCurrent=4", "cuCtxPushCurrent_v2=709", "cuModuleUnload=700", "cuStreamSynchronize=719"};
	struct rnea_robot *robot = batch_open(0);
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

/* A text that does not write an output, or not all of it, gives nan there, not zeros that could be right. */
START_TEST(unwritten_is_nan)
{
	char *text = pendulum_with("if (k < count)", "if (k + 1 < count)");
	float q[2] = {1, 1}, zero[2] = {0, 0}, tau[2] = {0, 0};
	struct rnea_options o = {.backend = RNEA_BACKEND_CUDA};
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(!open_text(text, &o, &robot, &e), "%s", e.message);
	ck_assert_msg(!rnea_run(robot, (void *[]){q, zero, zero, tau}, 2, &e), "%s", e.message);
	ck_assert(tau[0] > 0);
	ck_assert(isnan(tau[1]));
	rnea_close(robot);
	free(text);
}
END_TEST

Suite *suite_run(void)
{
	Suite *s = suite_create("run");
	TCase *t = tcase_create("run"), *dead = tcase_create("dead");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, batch_setup, batch_teardown);
	tcase_add_loop_test(t, computes, 0, 2);
	tcase_add_test(t, nothing_to_do);
	tcase_add_test(t, bad_arguments);
	tcase_add_test(t, small_batches_are_short);
	tcase_add_test(t, locked_in_part);
	tcase_add_test(t, keeps_its_buffers);
	tcase_add_test(t, unwritten_is_nan);
	tcase_add_loop_test(t, every_call_fails_once, 0, 3);
	tcase_add_test(t, allocation_failures);
	suite_add_tcase(s, t);
	tcase_set_timeout(dead, 120);
	tcase_add_checked_fixture(dead, batch_setup, NULL); /* what a dead context held cannot be given back */
	tcase_add_loop_test(dead, closes_on_a_dead_context, 0, 4);
	suite_add_tcase(s, dead);
	return s;
}
