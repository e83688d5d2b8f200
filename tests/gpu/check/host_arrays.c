/* rnea_run: torques of arrays in the program's own memory, pageable and page-locked, and what that takes beside the
   copies alone. */
#include "arrays.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GUARD = 64 };

/* The arrays of one batch in host memory, a guard before and behind each; all of it starts as NaN. */
struct host_arrays {
	unsigned char *memory[ARRAYS_LIMIT];
	void *pointers[ARRAYS_LIMIT];
	size_t bytes[ARRAYS_LIMIT], n, count;
	int is_locked;
};

static struct host_arrays host_new(
	const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count, int is_locked)
{
	struct host_arrays a = {.n = info->input_count + info->output_count, .count = count, .is_locked = is_locked};

	for (size_t i = 0; i < a.n; i++) {
		const struct rnea_argument *argument = &info->arguments[i];
		void *memory;

		a.bytes[i] = arrays_bytes(argument, count);
		if (is_locked)
			GPU(g, cuMemAllocHost, (&memory, a.bytes[i] + 2 * GUARD));
		else
			memory = malloc(a.bytes[i] + 2 * GUARD);
		a.memory[i] = memory;
		memset(memory, 0xff, a.bytes[i] + 2 * GUARD);
		a.pointers[i] = a.memory[i] + GUARD;
		if (i < info->input_count)
			samples_tile(reference_find(r, argument->name), a.pointers[i], count, argument->scalar, info->layout);
	}
	return a;
}

static void host_free(const struct gpu *g, struct host_arrays *a)
{
	for (size_t i = 0; i < a->n; i++) {
		if (a->is_locked)
			GPU(g, cuMemFreeHost, (a->memory[i]));
		else
			free(a->memory[i]);
	}
}

static int is_intact(const struct host_arrays *a, size_t i)
{
	for (size_t k = 0; k < GUARD; k++)
		if (a->memory[i][k] != 0xff || a->memory[i][GUARD + a->bytes[i] + k] != 0xff)
			return 0;
	return 1;
}

static void run_once(const struct gpu *g, struct item *it, const struct reference *r, size_t count, int is_locked)
{
	const struct rnea_info *info = rnea_info(it->robot);
	struct host_arrays a = host_new(g, info, r, count, is_locked);
	const char *memory = is_locked ? "page-locked" : "pageable";
	struct difference d;
	struct rnea_error e;

	if (rnea_run(it->robot, a.pointers, count, &e) != RNEA_OK)
		item_fail(it, "rnea_run, %zu samples, %s: %s", count, memory, e.message);
	d = samples_compare(&r->tau, a.pointers[a.n - 1], count, info->precision, info->layout);
	if (!(d.scaled <= item_limit(it)))
		item_fail(it, "rnea_run, %zu samples, %s: sample %zu is off by %.3g, the limit is %.3g", count, memory,
			d.worst, d.scaled, item_limit(it));
	for (size_t i = 0; i < a.n; i++)
		if (!is_intact(&a, i))
			item_fail(it, "rnea_run, %zu samples, %s: written outside of %s", count, memory, info->arguments[i].name);
	host_free(g, &a);
}

void verify_host(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);

	if (info->output_count != 1)
		return;
	for (size_t i = 0; i < s->size_count; i++)
		for (int is_locked = 0; is_locked < 2; is_locked++)
			run_once(g, it, r, s->counts[i], is_locked);
}

/* ---- what it takes ---- */

static double time_run(struct item *it, const struct host_arrays *a, int replays)
{
	double *times = malloc((size_t)replays * sizeof *times), median;
	struct rnea_error e;

	for (int turn = -1; turn < replays; turn++) {
		double start = seconds_now();

		if (rnea_run(it->robot, a->pointers, a->count, &e) != RNEA_OK)
			item_fail(it, "rnea_run: %s", e.message);
		if (turn >= 0)
			times[turn] = seconds_now() - start;
	}
	median = median_of(times, (size_t)replays);
	free(times);
	return median;
}

/* The inputs in and the output out, one after the other, between page-locked memory and the device. */
static double time_copies(const struct gpu *g, const struct host_arrays *a, int replays)
{
	double *times = malloc((size_t)replays * sizeof *times), median;
	CUdeviceptr data[ARRAYS_LIMIT];

	for (size_t i = 0; i < a->n; i++) {
		GPU(g, cuMemAlloc, (&data[i], a->bytes[i]));
		GPU(g, cuMemsetD8, (data[i], 0, a->bytes[i]));
	}
	for (int turn = 0; turn < replays; turn++) {
		double start = seconds_now();

		for (size_t i = 0; i + 1 < a->n; i++)
			GPU(g, cuMemcpyHtoD, (data[i], a->pointers[i], a->bytes[i]));
		GPU(g, cuMemcpyDtoH, (a->pointers[a->n - 1], data[a->n - 1], a->bytes[a->n - 1]));
		times[turn] = seconds_now() - start;
	}
	for (size_t i = 0; i < a->n; i++)
		GPU(g, cuMemFree, (data[i]));
	median = median_of(times, (size_t)replays);
	free(times);
	return median;
}

void cost_host(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);

	for (int is_locked = 0; is_locked < 2; is_locked++) {
		struct host_arrays one = host_new(g, info, r, 1, is_locked);
		struct host_arrays many = host_new(g, info, r, s->large, is_locked);

		it->run_one[is_locked] = time_run(it, &one, s->replays);
		it->run_many[is_locked] = time_run(it, &many, s->replays);
		if (is_locked)
			it->copies = time_copies(g, &many, s->replays);
		host_free(g, &one);
		host_free(g, &many);
	}
}
