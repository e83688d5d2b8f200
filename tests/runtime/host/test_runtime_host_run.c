/* Results, whatever the batch and the number of threads. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include "support/rng.h"
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SEED = 20, LARGEST = 100003, GUARD = 64 };

static float *random_array(struct rng *r, size_t count, double most)
{
	float *x = malloc((count + 1) * sizeof *x);

	ck_assert_ptr_nonnull(x);
	for (size_t i = 0; i < count; i++)
		x[i] = (float)rng_uniform(r, -most, most);
	return x;
}

/* tau between two guards, which stay as they are. */
static float *run(const struct host *h, float *q, float *qdd, size_t count)
{
	float *room = malloc((count + 2 * GUARD) * sizeof *room), *tau = room + GUARD;
	void *arrays[] = {q, NULL, qdd, tau};

	for (size_t i = 0; i < count + 2 * GUARD; i++)
		room[i] = -77;
	host_run(h, &(struct host_function){host_find(h, "pendulum", "rnea"), 1e9}, arrays, count); /* worth all threads */
	for (size_t i = 0; i < GUARD; i++)
		ck_assert(room[i] == -77.0f && tau[count + i] == -77.0f);
	memmove(room, tau, count * sizeof *tau);
	return room;
}

/* tau = m l^2 qdd + m g l sin q in double precision */
static void assert_closed_form(const float *q, const float *qdd, const float *tau, size_t count)
{
	for (size_t k = 0; k < count; k++) {
		double right = 0.5 * (double)qdd[k] + 9.81 * sin((double)q[k]);

		ck_assert_msg(fabs((double)tau[k] - right) < 4e-6, "sample %zu of %zu, seed %d: %a, not %a", k, count,
			SEED, (double)tau[k], right);
	}
}

START_TEST(batches)
{
	static const size_t counts[] = {0, 1, 255, 256, 257, 511, 512, 513, 1024, 1025, LARGEST};
	static const unsigned threads[] = {1, 2, 4};
	struct rng r = rng_seed(SEED);
	float *q = random_array(&r, LARGEST, 4), *qdd = random_array(&r, LARGEST, 10);
	struct host h[3];
	float *tau[3];

	for (int t = 0; t < 3; t++)
		h[t] = open_pendulum_slow(threads[t]);
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		for (int t = 0; t < 3; t++) {
			tau[t] = run(&h[t], q, qdd, counts[c]);
			ck_assert(memcmp(tau[t], tau[0], counts[c] * sizeof *q) == 0);
		}
		assert_closed_form(q, qdd, tau[0], counts[c]);
		for (int t = 0; t < 3; t++)
			free(tau[t]);
	}
	for (int t = 0; t < 3; t++)
		host_close(&h[t]);
	free(q);
	free(qdd);
}
END_TEST

START_TEST(other_kernels)
{
	struct host h = open_pendulum();
	float q[2] = {0}, f[12], tau[2] = {0};
	void *arrays[] = {q, f, tau};

	for (int i = 0; i < 12; i++)
		f[i] = (float)i;
	ck_assert_ptr_null(host_find(&h, "pendulum", "fpass"));
	ck_assert_ptr_nonnull(host_find(&h, "pendulum", "bpass"));
	host_run(&h, &(struct host_function){host_find(&h, "pendulum", "bpass"), 0}, arrays, 2);
	ck_assert(tau[0] == 8 && tau[1] == 9);
	host_close(&h);
}
END_TEST

START_TEST(info_table)
{
	struct host h = open_pendulum();

	ck_assert_ptr_nonnull(strstr(h.info, "\nname pendulum\n"));
	ck_assert_ptr_nonnull(strstr(h.compiler, "cc ("));
	ck_assert_ptr_nonnull(strstr(h.compiler, "/cc)"));
	host_close(&h);
	ck_assert_ptr_null(h.handle);
	host_close(&h);
}
END_TEST

/* As many as asked for, within reason; one for each processor by default. */
START_TEST(thread_counts)
{
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	struct host h;

	r.threads = 0;
	ck_assert_int_eq(host_open(&h, &r, &e), RNEA_OK);
	ck_assert_uint_ge(h.threads, 1);
	ck_assert_uint_le(h.threads, (unsigned)processors);
	if (h.threads == 1 && processors > 1)
		puts("one thread: held to one processor");
	host_close(&h);
	r.threads = 0xffffffffu;
	ck_assert_int_eq(host_open(&h, &r, &e), RNEA_OK);
	ck_assert_uint_le(h.threads, 4 * (unsigned)processors);
	host_close(&h);
	r.threads = 1;
	ck_assert_int_eq(host_open(&h, &r, &e), RNEA_OK);
	ck_assert_uint_eq(h.threads, 1);
	host_close(&h);
	free(text);
}
END_TEST

/* A process forked from one that has run in several threads can go on using the robot. */
START_TEST(forked)
{
	struct rng r = rng_seed(SEED);
	float *q = random_array(&r, LARGEST, 4), *qdd = random_array(&r, LARGEST, 10);
	struct host h = open_pendulum_slow(2);
	float *tau, *again;
	int status;
	pid_t pid;

	tau = run(&h, q, qdd, LARGEST);
	ck_assert_int_eq(faults.started, 1);
	if ((pid = fork()) == 0) {
		again = run(&h, q, qdd, LARGEST);
		host_close(&h);
		_exit(memcmp(again, tau, LARGEST * sizeof *tau) != 0 || faults.started != 1);
	}
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	ck_assert_int_eq(status, 0);
	host_close(&h);
	free(tau);
	free(q);
	free(qdd);
}
END_TEST

/* Catches threads for batches that are soon done: their waking would take longer. By the table alone, so the same on every
   machine. */
START_TEST(threads_by_work)
{
	static const struct {
		double sample_ns;
		size_t count;
		unsigned threads;
	} cases[] = {{30, 1, 1}, {30, 64, 1}, {30, 1024, 1}, {30, 3333, 1}, {30, 3334, 2}, {30, 16384, 9},
		{30, 26666, 15}, {30, 26667, 16}, {30, 262144, 16}, {30, SIZE_MAX, 16}, {0, SIZE_MAX, 1}, {1e5, 1, 2},
		{49e3, 2, 1}};
	struct host h = {.threads = 16};
	struct host_function f = {NULL, 0};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		f.sample_ns = cases[i].sample_ns;
		ck_assert_msg(host_threads(&h, &f, cases[i].count) == cases[i].threads, "case %zu: %u", i,
			host_threads(&h, &f, cases[i].count));
	}
	h.threads = 1;
	ck_assert_uint_eq(host_threads(&h, &f, SIZE_MAX), 1);
}
END_TEST

/* The table of an iiwa14: 1024 samples are less than 50 us of work in f32, and 16384 are more. */
START_TEST(work_of_a_table)
{
	struct rnea_argument arrays[] = {{.name = "q", .rows = 7}, {.name = "qd", .rows = 7}, {.name = "qdd", .rows = 7},
		{.name = "tau", .rows = 7}, {.name = "gravity", .rows = 1000000, .per_batch = 1}};
	struct rnea_info i = {.arithmetic = "f32"};
	struct rnea_function f = {.arguments = arrays,
		.input_count = 3,
		.output_count = 1,
		.operations = {.mul = 125, .add = 60, .sub = 18, .neg = 36, .fma = 163, .sincos = 6}};
	double f32 = host_sample_ns(&i, &f), before;

	ck_assert_double_gt(1024 * f32, 10e3);
	ck_assert_double_lt(1024 * f32, 50e3);
	ck_assert_double_gt(16384 * f32, 200e3);
	f.output_count = 2; /* for the whole batch: no part of a sample */
	ck_assert_double_eq(host_sample_ns(&i, &f), f32);
	i.arithmetic = "f64";
	ck_assert_double_gt(before = host_sample_ns(&i, &f), f32);
	i.arithmetic = "f32x2";
	ck_assert_double_gt(host_sample_ns(&i, &f), before);
	i.layout = RNEA_AOS;
	ck_assert_double_gt(host_sample_ns(&i, &f), 5e3 / 1024 * 100);
	i = (struct rnea_info){.arithmetic = "a later one"};
	f = (struct rnea_function){.arguments = arrays, .output_count = 1};
	ck_assert_double_gt(host_sample_ns(&i, &f), 0);
}
END_TEST

/* Catches a launch that starts threads it has no work for, and one that never does. */
START_TEST(launches_start_threads)
{
	struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .threads = 4, .cache = ""};
	struct rng r = rng_seed(SEED);
	float *q = random_array(&r, LARGEST, 4), *qdd = random_array(&r, LARGEST, 10), *tau = random_array(&r, LARGEST, 1);
	void *arrays[] = {q, q, qdd, tau};
	struct rnea_robot *robot;
	struct rnea_error e;
	int bad = 0;

	ck_assert_msg(!rnea_open_file(TEST_DIR "/runtime/pendulum.c", &o, &robot, &e), "%s", e.message);
	ck_assert_uint_eq(rnea_build(robot)->threads, 4);
	ck_assert(!rnea_launch(robot, arrays, 2048, NULL, &e));
	ck_assert_int_eq(faults.started, 0);
	ck_assert(!rnea_launch(robot, arrays, LARGEST, NULL, &e));
	assert_closed_form(q, qdd, tau, LARGEST);
	ck_assert_int_eq(faults.started, 3);
	faults.allocations = 0;
	for (int i = 0; i < 20; i++)
		bad += rnea_launch(robot, arrays, LARGEST, NULL, NULL) != RNEA_OK;
	faults.allocations = -1;
	ck_assert_int_eq(faults.allocation_failed, 0);
	ck_assert_int_eq(bad, 0);
	ck_assert_int_eq(faults.started, 3);
	rnea_close(robot);
	ck_assert_int_eq(faults.joined, 3);
	free(q);
	free(qdd);
	free(tau);
}
END_TEST

static void *use(void *argument)
{
	const struct host *shared = argument;
	struct rng r = rng_seed(SEED);
	float *q = random_array(&r, 5000, 4), *qdd = random_array(&r, 5000, 10), *tau;
	struct host own = open_pendulum();

	for (int i = 0; i < 20; i++) {
		tau = run(i % 2 ? shared : &own, q, qdd, 5000);
		assert_closed_form(q, qdd, tau, 5000);
		free(tau);
	}
	host_close(&own);
	free(q);
	free(qdd);
	return NULL;
}

START_TEST(several_threads)
{
	struct host h = open_pendulum_slow(2);
	pthread_t threads[8];

	for (int i = 0; i < 8; i++)
		ck_assert_int_eq(pthread_create(&threads[i], NULL, use, &h), 0);
	for (int i = 0; i < 8; i++)
		pthread_join(threads[i], NULL);
	host_close(&h);
}
END_TEST

Suite *suite_host_run(void)
{
	Suite *s = suite_create("host: run");
	TCase *t = tcase_create("host: run");

	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_set_timeout(t, 60);
	tcase_add_test(t, batches);
	tcase_add_test(t, other_kernels);
	tcase_add_test(t, info_table);
	tcase_add_test(t, thread_counts);
	tcase_add_test(t, threads_by_work);
	tcase_add_test(t, work_of_a_table);
	tcase_add_test(t, launches_start_threads);
	tcase_add_test(t, forked);
	tcase_add_test(t, several_threads);
	suite_add_tcase(s, t);
	return s;
}
