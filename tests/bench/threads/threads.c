/* threads TEXT [--idle] [SECONDS]: what a launch on the host takes with threads by default, over what it takes with one
   thread, while every processor is busy with something else; --idle: while none is. Not a test: it measures time. */
#define _GNU_SOURCE
#include "rnea.h"
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { LAUNCH_LIMIT = 1 << 17 };
enum { ONE, DEFAULT, KINDS };

static const size_t COUNTS[] = {1, 64, 1024, 16384, 262144};

static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- what keeps the processors busy ---- */

static atomic_int burning = 1;

static void *burn(void *unused)
{
	volatile double x = 1;

	while (atomic_load_explicit(&burning, memory_order_relaxed))
		for (int i = 0; i < 1000; i++)
			x = x * 0.999 + 1e-3;
	return unused;
}

static void start_burners(pthread_t *threads, long count)
{
	for (long i = 0; i < count; i++)
		if (pthread_create(&threads[i], NULL, burn, NULL) != 0)
			exit((fprintf(stderr, "threads: cannot start %ld threads\n", count), 1));
}

static void stop_burners(const pthread_t *threads, long count)
{
	atomic_store(&burning, 0);
	for (long i = 0; i < count; i++)
		pthread_join(threads[i], NULL);
}

/* ---- launches ---- */

static struct rnea_robot *open_text(const char *path, unsigned threads)
{
	const struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .threads = threads};
	struct rnea_robot *robot;
	struct rnea_error e;

	if (rnea_open_file(path, &o, &robot, &e))
		exit((fprintf(stderr, "threads: %s\n", e.message), 1));
	return robot;
}

static void make_arrays(const struct rnea_info *info, size_t count, void **arrays)
{
	for (size_t i = 0; i < info->input_count + info->output_count; i++) {
		const struct rnea_argument *a = &info->arguments[i];
		size_t n = a->rows * (a->per_batch ? 1 : count);
		double *x = calloc(n, sizeof *x);

		if (!x)
			exit((fputs("threads: out of memory\n", stderr), 1));
		for (size_t k = 0; k < n; k++)
			if (a->scalar == RNEA_F64)
				x[k] = (double)(k % 1000) / 1000;
			else
				((float *)x)[k] = (float)(k % 1000) / 1000;
		arrays[i] = x;
	}
}

static double launch(const struct rnea_robot *robot, void *const *arrays, size_t count)
{
	double start = now();

	rnea_launch(robot, arrays, count, NULL, NULL);
	return now() - start;
}

/* Times of launches, which take turns; sorted. */
struct times {
	double *t[KINDS], sum[KINDS];
	size_t count;
};

static int ascending(const void *a, const void *b)
{
	const double *x = a, *y = b;

	return (*x > *y) - (*x < *y);
}

static void measure(struct times *times, struct rnea_robot *const *robots, size_t count, double seconds)
{
	void *arrays[RNEA_ARGUMENT_LIMIT];
	const struct rnea_info *info = rnea_info(robots[ONE]);
	double start;

	make_arrays(info, count, arrays);
	for (int k = ONE; k < KINDS; k++) {
		times->sum[k] = 0;
		launch(robots[k], arrays, count);
	}
	start = now();
	for (times->count = 0; times->count < LAUNCH_LIMIT && now() - start < seconds; times->count++)
		/* one first, the other first: what follows a long launch is interrupted sooner */
		for (int i = 0; i < KINDS; i++) {
			int k = times->count % 2 ? KINDS - 1 - i : i;

			times->sum[k] += times->t[k][times->count] = launch(robots[k], arrays, count);
		}
	for (int k = ONE; k < KINDS; k++)
		qsort(times->t[k], times->count, sizeof(double), ascending);
	for (size_t i = 0; i < info->input_count + info->output_count; i++)
		free(arrays[i]);
}

static void report(const struct times *t, size_t count)
{
	size_t n = t->count, high = n * 99 / 100;

	printf("%8zu %8zu  %10.2f %10.2f %10.2f  %10.2f %10.2f %10.2f  %6.2f %6.2f %6.2f\n", count, n, 1e6 * t->t[ONE][n / 2],
		1e6 * t->sum[ONE] / (double)n, 1e6 * t->t[ONE][high], 1e6 * t->t[DEFAULT][n / 2],
		1e6 * t->sum[DEFAULT] / (double)n, 1e6 * t->t[DEFAULT][high], t->t[DEFAULT][n / 2] / t->t[ONE][n / 2],
		t->sum[DEFAULT] / t->sum[ONE], t->t[DEFAULT][high] / t->t[ONE][high]);
	fflush(stdout);
}

static void measure_all(const char *path, double seconds, int idle)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN), burners = idle ? 0 : processors;
	struct rnea_robot *robots[KINDS] = {[ONE] = open_text(path, 1), [DEFAULT] = open_text(path, 0)};
	pthread_t *threads = calloc((size_t)burners + 1, sizeof *threads);
	struct times times;

	for (int k = ONE; k < KINDS; k++)
		times.t[k] = malloc(LAUNCH_LIMIT * sizeof(double));
	if (!threads || !times.t[ONE] || !times.t[DEFAULT])
		exit((fputs("threads: out of memory\n", stderr), 1));
	printf("%s: %ld processors, %s; a launch in us with one thread and with %u at most: median, mean, 99 of 100\n", path,
		processors, idle ? "idle" : "all busy", rnea_build(robots[DEFAULT])->threads);
	printf(" samples launches     one: med       mean        99%%  default: med   mean        99%%   ratio:   mean    99%%\n");
	start_burners(threads, burners);
	for (size_t i = 0; i < sizeof COUNTS / sizeof *COUNTS; i++) {
		measure(&times, robots, COUNTS[i], seconds);
		report(&times, COUNTS[i]);
	}
	stop_burners(threads, burners);
	for (int k = ONE; k < KINDS; k++) {
		free(times.t[k]);
		rnea_close(robots[k]);
	}
	free(threads);
}

int main(int argc, char **argv)
{
	int idle = argc > 2 && strcmp(argv[2], "--idle") == 0;

	if (argc < 2 || argc > 3 + idle)
		return fputs("usage: threads TEXT [--idle] [SECONDS]\n", stderr), 2;
	measure_all(argv[1], argc > 2 + idle ? strtod(argv[2 + idle], NULL) : 2, idle);
	return 0;
}
