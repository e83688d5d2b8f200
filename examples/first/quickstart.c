/* quickstart ROBOT.urdf TEXT.cu COUNT

   The inverse dynamics of a KUKA iiwa14 by the C that rneagen wrote for it, iiwa14_rnea.c: the torques of one sample,
   then COUNT random ones, each held against the independent reference of tests/ (long double). Then the same by the
   CUDA C in TEXT.cu, if there is a GPU. The exit status tells whether every error is within its limit. */
#define _POSIX_C_SOURCE 200809L
#include "iiwa14_rnea.h"
#include "quickstart.h"
#include "reference/reference.h"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { N = iiwa14_nv, THREAD_LIMIT = 64 };

/* Of a million samples in f32 a few reach 3e-6: their torques are small differences of large numbers. */
static const double LIMIT_F64 = 5e-14, LIMIT_F32 = 1e-5;

/* Arrays [N][count]: row r of sample k is at [r * count + k]. */
struct batch {
	size_t count;
	double *q, *qd, *qdd, *tau;
};

double seconds_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *allocate(size_t count, size_t size)
{
	void *memory = calloc(count, size);

	if (!memory) {
		fputs("quickstart: out of memory\n", stderr);
		exit(1);
	}
	return memory;
}

static struct reference *open_reference(const char *urdf)
{
	char message[256];
	struct reference *r = reference_open_file(urdf, NULL, message, sizeof message);

	if (!r || r->nq != N || r->nv != N) {
		fprintf(stderr, "%s: %s\n", urdf, r ? "not the robot that this program was built for" : message);
		exit(1);
	}
	return r;
}

/* ---- random samples ---- */

static void get_sample(const double *rows, const struct batch *b, size_t k, double sample[N])
{
	for (size_t i = 0; i < N; i++)
		sample[i] = rows[i * b->count + k];
}

static void set_sample(double *rows, const struct batch *b, size_t k, const double sample[N])
{
	for (size_t i = 0; i < N; i++)
		rows[i * b->count + k] = sample[i];
}

/* Positions within the robot's limits, velocities within 2 rad/s, accelerations within 5 rad/s^2; `f32`: all of them
   numbers that a float holds. */
static void fill_batch(struct batch *b, const struct reference *r, bool f32)
{
	struct rng rng = rng_seed(1);
	double q[N], qd[N], qdd[N];

	for (size_t k = 0; k < b->count; k++) {
		reference_sample(r, &rng, f32, q, qd, qdd);
		set_sample(b->q, b, k, q);
		set_sample(b->qd, b, k, qd);
		set_sample(b->qdd, b, k, qdd);
	}
}

static struct batch open_batch(size_t count)
{
	return (struct batch){.count = count,
		.q = allocate(N * count, sizeof(double)),
		.qd = allocate(N * count, sizeof(double)),
		.qdd = allocate(N * count, sizeof(double)),
		.tau = allocate(N * count, sizeof(double))};
}

static void close_batch(struct batch *b)
{
	free(b->q);
	free(b->qd);
	free(b->qdd);
	free(b->tau);
}

/* ---- the error: ||tau - reference|| / ||reference||, for every sample ---- */

struct check {
	const struct batch *batch;
	const char *urdf;
	size_t begin, end; /* samples of one thread */
	double limit;
	double max, sum_of_squares;
	size_t above; /* samples whose error is above the limit, or not a number */
};

static void *check_samples(void *memory)
{
	struct check *c = memory;
	const struct batch *b = c->batch;
	struct reference *r = open_reference(c->urdf);
	double q[N], qd[N], qdd[N], tau[N], error;
	wide exact[N];

	for (size_t k = c->begin; k < c->end; k++) {
		get_sample(b->q, b, k, q);
		get_sample(b->qd, b, k, qd);
		get_sample(b->qdd, b, k, qdd);
		get_sample(b->tau, b, k, tau);
		reference_rnea(r, q, qd, qdd, exact);
		error = reference_error(tau, exact, N);
		c->max = fmax(c->max, error);
		c->sum_of_squares += error * error;
		c->above += !(error <= c->limit);
	}
	reference_close(r);
	return NULL;
}

/* Checks the whole batch on all cores, prints, and returns whether the limit holds. */
static bool check_batch(const struct batch *b, const char *urdf, double limit)
{
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	size_t threads = cores < 1 ? 1 : cores > THREAD_LIMIT ? THREAD_LIMIT : (size_t)cores;
	pthread_t thread[THREAD_LIMIT];
	struct check part[THREAD_LIMIT], all = {.max = 0};

	for (size_t i = 0; i < threads; i++) {
		part[i] = (struct check){.batch = b,
			.urdf = urdf,
			.limit = limit,
			.begin = b->count * i / threads,
			.end = b->count * (i + 1) / threads};
		if (pthread_create(&thread[i], NULL, check_samples, &part[i])) {
			fputs("quickstart: no thread can be started\n", stderr);
			exit(1);
		}
	}
	for (size_t i = 0; i < threads; i++) {
		pthread_join(thread[i], NULL);
		all.max = fmax(all.max, part[i].max);
		all.sum_of_squares += part[i].sum_of_squares;
		all.above += part[i].above;
	}
	printf("  error: max %.2g, rms %.2g (limit %g; above it: %zu of %zu samples)\n", all.max,
		sqrt(all.sum_of_squares / (double)b->count), limit, all.above, b->count);
	return all.above == 0;
}

/* ---- the three parts ---- */

enum { TRIES = 5, CALLS = 20000 }; /* the best time of a few tries */

static double time_one(const double q[N], const double qd[N], const double qdd[N], double tau[N])
{
	double best = INFINITY;

	for (int try = 0; try < TRIES; try++) {
		double start = seconds_now();

		for (int i = 0; i < CALLS; i++)
			iiwa14_rnea(q, qd, qdd, tau);
		best = fmin(best, (seconds_now() - start) / CALLS);
	}
	return best;
}

static double time_batch(const struct batch *b)
{
	double best = INFINITY;

	for (int try = 0; try < TRIES; try++) {
		double start = seconds_now();

		iiwa14_rnea_batch(b->q, b->qd, b->qdd, b->tau, b->count);
		best = fmin(best, (seconds_now() - start) / (double)b->count);
	}
	return best;
}

static void show_one(const struct batch *b, struct reference *r)
{
	double q[N], qd[N], qdd[N], tau[N], seconds;
	wide exact[N];

	get_sample(b->q, b, 0, q);
	get_sample(b->qd, b, 0, qd);
	get_sample(b->qdd, b, 0, qdd);
	seconds = time_one(q, qd, qdd, tau);
	reference_rnea(r, q, qd, qdd, exact);

	printf("One sample: iiwa14_rnea(q, qd, qdd, tau)\n");
	printf("  %-14s %9s %9s %9s %20s %20s\n", "joint", "q", "qd", "qdd", "tau", "reference");
	for (int i = 0; i < r->nj; i++) {
		const struct reference_joint *j = &r->joints[i];

		if (j->nv)
			printf("  %-14s %9.5f %9.5f %9.5f %20.15f %20.15f\n", j->name, q[j->iq], qd[j->iv], qdd[j->iv],
				tau[j->iv], (double)exact[j->iv]);
	}
	printf("  time: %.0f ns a call, one core\n\n", 1e9 * seconds);
}

static bool run_c(struct batch *b, const char *urdf)
{
	double seconds = time_batch(b);

	printf("%zu samples, C, f64: iiwa14_rnea_batch(q, qd, qdd, tau, count)\n", b->count);
	printf("  time: %.0f ns a sample, one core\n", 1e9 * seconds);
	return check_batch(b, urdf, LIMIT_F64);
}

static float *to_float(const double *from, size_t count)
{
	float *to = allocate(count, sizeof *to);

	for (size_t i = 0; i < count; i++)
		to[i] = (float)from[i];
	return to;
}

static bool run_gpu(struct batch *b, const struct reference *r, const char *urdf, const char *text)
{
	size_t size = N * b->count;
	float *q, *qd, *qdd, *tau = allocate(size, sizeof *tau);
	struct gpu_job job = {.text = text, .count = b->count, .tau = tau};
	enum gpu_outcome outcome;

	fill_batch(b, r, true);
	job.inputs[0] = q = to_float(b->q, size);
	job.inputs[1] = qd = to_float(b->qd, size);
	job.inputs[2] = qdd = to_float(b->qdd, size);
	outcome = gpu_run(&job);
	for (size_t i = 0; i < size; i++)
		b->tau[i] = (double)tau[i];
	free(q);
	free(qd);
	free(qdd);
	free(tau);
	if (outcome != GPU_DONE) {
		printf("GPU: %s, %s\n", outcome == GPU_SKIPPED ? "skipped" : "failed", job.message);
		return outcome == GPU_SKIPPED;
	}
	printf("%zu samples, GPU, f32: rnea_launch(robot, arguments, count, stream, error)\n", b->count);
	printf("  time: %.4f ns a sample, %.1f us a launch\n", 1e9 * job.seconds / (double)b->count, 1e6 * job.seconds);
	return check_batch(b, urdf, LIMIT_F32);
}

int main(int argc, char **argv)
{
	long long count = argc == 4 ? atoll(argv[3]) : 0;
	struct reference *r;
	struct batch b;
	bool good;

	if (count < 1) {
		fputs("usage: quickstart ROBOT.urdf TEXT.cu COUNT\n", stderr);
		return 2;
	}
	r = open_reference(argv[1]);
	b = open_batch((size_t)count);
	fill_batch(&b, r, false);
	show_one(&b, r);
	good = run_c(&b, argv[1]);
	putchar('\n');
	fflush(stdout);
	good &= run_gpu(&b, r, argv[1], argv[2]);
	close_batch(&b);
	reference_close(r);
	return good ? 0 : 1;
}
