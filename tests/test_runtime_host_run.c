/* Results, whatever the batch and the number of threads. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include "rng.h"
#include <math.h>
#include <pthread.h>
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
	host_run(h, RNEA_KERNEL_RNEA, arrays, count);
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
	static const unsigned threads[] = {1, 2, 7};
	struct rng r = rng_seed(SEED);
	float *q = random_array(&r, LARGEST, 4), *qdd = random_array(&r, LARGEST, 10);
	struct host h = open_pendulum();
	float *tau[3];

	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		for (int t = 0; t < 3; t++) {
			h.threads = threads[t];
			tau[t] = run(&h, q, qdd, counts[c]);
			ck_assert(memcmp(tau[t], tau[0], counts[c] * sizeof *q) == 0);
		}
		assert_closed_form(q, qdd, tau[0], counts[c]);
		for (int t = 0; t < 3; t++)
			free(tau[t]);
	}
	host_close(&h);
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
	ck_assert_ptr_null(h.slices[RNEA_KERNEL_FPASS]);
	ck_assert_ptr_nonnull(h.slices[RNEA_KERNEL_BPASS]);
	host_run(&h, RNEA_KERNEL_BPASS, arrays, 2);
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
		puts("one thread: built without OpenMP, or held to one processor");
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
	struct host h = open_pendulum();
	float *tau, *again;
	int status;
	pid_t pid;

	h.threads = 2;
	tau = run(&h, q, qdd, LARGEST);
	if ((pid = fork()) == 0) {
		alarm(20);
		again = run(&h, q, qdd, LARGEST);
		_exit(memcmp(again, tau, LARGEST * sizeof *tau) != 0);
	}
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	ck_assert_int_eq(status, 0);
	host_close(&h);
	free(tau);
	free(q);
	free(qdd);
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
	struct host h = open_pendulum();
	pthread_t threads[8];

	h.threads = 2;
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
	tcase_add_test(t, forked);
	tcase_add_test(t, several_threads);
	suite_add_tcase(s, t);
	return s;
}
