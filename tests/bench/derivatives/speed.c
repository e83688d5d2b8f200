#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench.h"

/* Seconds that this thread has run: on a machine with other work, what it waited for a processor is no part of it. */
static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double time_one(const struct bench *b, enum function f)
{
	double began = now();

	for (int s = 0; s < STATES; s++)
		call_one(b, f, s);
	return now() - began;
}

static double time_peer(const struct bench *b, enum function f)
{
	double began = now();

	for (int s = 0; s < STATES; s++)
		call_peer(b, f, s);
	return now() - began;
}

static double time_batch(const struct bench *b, enum function f)
{
	double began = now();

	call_batch(b, f);
	return now() - began;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static struct ratio quartiles(double *x, int n)
{
	qsort(x, (size_t)n, sizeof *x, ascending);
	return (struct ratio){x[n / 4], x[n / 2], x[n - 1 - n / 4]};
}

/* Pinocchio's crba has two ways; the one that takes less time on this robot is measured. */
static void choose_convention(struct bench *b)
{
	enum { TRIES = 5 };
	double least[2];

	for (int t = 0; t < TRIES; t++)
		for (int world = 0; world < 2; world++) {
			double seconds;

			b->world = world;
			seconds = time_peer(b, MASS);
			if (t == 0 || seconds < least[world])
				least[world] = seconds;
		}
	b->world = least[1] < least[0];
}

void speed_measure(struct bench *b, int repeats, struct speed speeds[FUNCTIONS])
{
	double *one[FUNCTIONS], *batch[FUNCTIONS];

	choose_convention(b);
	for (int f = 0; f < FUNCTIONS; f++) {
		one[f] = calloc((size_t)repeats, sizeof **one);
		batch[f] = calloc((size_t)repeats, sizeof **batch);
		if (!one[f] || !batch[f])
			abort();
	}
	for (int i = -1; i < repeats; i++)
		for (int f = 0; f < FUNCTIONS; f++) {
			double peer = time_peer(b, (enum function)f), single = time_one(b, (enum function)f);
			double all = time_batch(b, (enum function)f);

			if (i < 0)
				continue;
			one[f][i] = peer / single;
			batch[f][i] = peer / all;
		}
	for (int f = 0; f < FUNCTIONS; f++) {
		speeds[f] = (struct speed){quartiles(one[f], repeats), quartiles(batch[f], repeats)};
		free(one[f]);
		free(batch[f]);
	}
}
