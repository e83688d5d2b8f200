/* What it costs to open a robot and to launch it, on the host. */
#include "arrays.h"
#include <stdlib.h>

double median_of(double *times, size_t n)
{
	for (size_t i = 1; i < n; i++)
		for (size_t j = i; j > 0 && times[j] < times[j - 1]; j--) {
			double t = times[j];

			times[j] = times[j - 1];
			times[j - 1] = t;
		}
	return times[n / 2];
}

/* ---- launching ---- */

static void empty(const struct gpu *g, CUfunction function, int launches)
{
	for (int i = 0; i < launches; i++)
		GPU(g, cuLaunchKernel, (function, 1, 1, 1, 1, 1, 1, 0, g->stream, NULL, NULL));
}

static void full(const struct gpu *g, struct item *it, const struct arrays *a, int launches)
{
	struct rnea_error e;

	for (int i = 0; i < launches; i++)
		if (rnea_launch(it->robot, a->pointers, a->count, g->stream, &e) != RNEA_OK)
			item_fail(it, "while measuring: %s", e.message);
}

/* A chain of launches is short enough that the stream takes it without making its caller wait. */
double cost_launch(const struct gpu *g, const struct settings *s, CUfunction function, struct item *it,
	const struct reference *r)
{
	double *times = malloc((size_t)s->replays * sizeof *times), median;
	struct arrays a = {0};

	if (it)
		a = arrays_new(g, rnea_info(it->robot), r, 1);
	for (int turn = 0; turn < s->replays; turn++) {
		double start = seconds_now();

		if (it)
			full(g, it, &a, s->chain);
		else
			empty(g, function, s->chain);
		times[turn] = (seconds_now() - start) / s->chain;
		GPU(g, cuStreamSynchronize, (g->stream));
	}
	median = median_of(times, (size_t)s->replays);
	arrays_free(g, &a);
	free(times);
	return median;
}

/* ---- opening, alone, first with nothing in the cache ---- */

static double cost_open(struct item *it, const char *path, const char *cache, int is_full)
{
	static const char *const compile[] = {"--no-cache"}; /* NVRTC has one of its own, of what this process compiled */
	struct rnea_options o = {
		.backend = RNEA_BACKEND_CUDA, .cache = cache, .compile = compile, .compile_count = 1};
	struct rnea_robot *robot;
	struct rnea_error e;
	double start = seconds_now(), seconds;

	if (rnea_open_file(path, &o, &robot, &e) != RNEA_OK) {
		item_fail(it, "opened with a cache: %s", e.message);
		return 0;
	}
	seconds = seconds_now() - start;
	if (rnea_build(robot)->cached != is_full)
		item_fail(it, "opened with %s cache: it was %scompiled", is_full ? "a full" : "an empty", is_full ? "" : "not ");
	rnea_close(robot);
	return seconds;
}

void cost_build(struct item *it, const char *path, const char *cache)
{
	it->cold = cost_open(it, path, cache, 0);
	it->cached = cost_open(it, path, cache, 1);
}
