#define _POSIX_C_SOURCE 200809L
#include "study/bench.h"
#include "study/bench_gpu.h"
#include "core/failure.h"
#include "core/seconds.h"
#include <stdlib.h>
#include <string.h>

enum { SETS_LIMIT = 32, LAUNCHES_HOST = 1 << 22, LAUNCHES_GPU = 1000 };
enum { ROBOT, FLOOR, KINDS };

struct bench {
	enum rnea_backend backend;
	struct bench_gpu *gpu; /* NULL: the host */
};

/* What one call of bench_measure works with. */
struct work {
	struct bench *b;
	const struct rnea_robot *robots[KINDS];
	size_t bytes[RNEA_ARGUMENT_LIMIT], array_count, count, set_count, launches;
	size_t next; /* set, on the host: a run goes on where the last one ended */
	void *arrays[SETS_LIMIT][RNEA_ARGUMENT_LIMIT];
	void *const *sets[SETS_LIMIT]; /* the rows of `arrays` */
	void *graphs[KINDS];           /* GPU */
	double times[KINDS][BENCH_REPLAYS_LIMIT];
	struct rnea_error *e;
};

enum rnea_code bench_open(struct bench **b, enum rnea_backend backend, int device, struct rnea_error *e)
{
	*b = calloc(1, sizeof **b);
	if (!*b)
		return rnea_error_memory(e);
	(*b)->backend = backend;
	if (backend == RNEA_BACKEND_CUDA && bench_gpu_open(&(*b)->gpu, device, e)) {
		bench_close(*b);
		*b = NULL;
	}
	return e->code;
}

void bench_close(struct bench *b)
{
	if (b)
		bench_gpu_close(b->gpu);
	free(b);
}

int bench_driver(const struct bench *b)
{
	return b->gpu ? bench_gpu_driver(b->gpu) : 0;
}

/* ---- arrays ---- */

static void *copy_host(const void *array, size_t size, struct rnea_error *e)
{
	void *copy = malloc(size);

	if (!copy)
		rnea_error_set(e, RNEA_MEMORY, "no memory for arrays of %zu bytes; choose a smaller --batch", size);
	else
		memcpy(copy, array, size);
	return copy;
}

/* On the host the first set is the caller's own. A GPU's outputs begin as they are. */
static void add_set(struct work *w, void *const *arrays)
{
	size_t n = w->set_count++, inputs = rnea_info(w->robots[ROBOT])->input_count;

	w->sets[n] = w->arrays[n];
	for (size_t i = 0; i < w->array_count && !w->e->code; i++) {
		if (w->b->gpu)
			w->arrays[n][i] = bench_gpu_array(w->b->gpu, i < inputs ? arrays[i] : NULL, w->bytes[i], w->e);
		else
			w->arrays[n][i] = n ? copy_host(arrays[i], w->bytes[i], w->e) : arrays[i];
	}
}

static void make_sets(struct work *w, void *const *arrays)
{
	const struct rnea_info *info = rnea_info(w->robots[ROBOT]);
	size_t total = 0, numbers = 0, wanted = 1;

	w->array_count = info->input_count + info->output_count;
	for (size_t i = 0; i < w->array_count; i++) {
		const struct rnea_argument *a = &info->arguments[i];

		size_t n = a->rows * (a->per_batch ? 1 : w->count);

		w->bytes[i] = n * (a->scalar == RNEA_F64 ? 8 : 4);
		total += w->bytes[i];
		numbers += n;
	}
	if (numbers >= BENCH_LARGE)
		wanted += BENCH_ARRAYS / total;
	while (w->set_count < wanted && w->set_count < SETS_LIMIT && !w->e->code)
		add_set(w, arrays);
}

static void drop_sets(struct work *w)
{
	for (size_t n = 0; n < w->set_count; n++)
		for (size_t i = 0; i < w->array_count; i++) {
			if (w->b->gpu)
				bench_gpu_free(w->b->gpu, w->arrays[n][i]);
			else if (n)
				free(w->arrays[n][i]);
		}
}

/* ---- time ---- */

/* Seconds of one run: all launches. */
static double run(struct work *w, int kind)
{
	double seconds = 0, start;

	if (w->b->gpu) {
		bench_gpu_replay(w->b->gpu, w->graphs[kind], &seconds, w->e);
		return seconds;
	}
	start = seconds_now();
	for (size_t i = 0; i < w->launches && !w->e->code; i++)
		rnea_launch(w->robots[kind], w->sets[w->next++ % w->set_count], w->count, NULL, w->e);
	return seconds_now() - start;
}

/* One output of the first samples, from a GPU: in layout soa a piece of each row. */
static void take_output(struct work *w, const struct rnea_argument *a, size_t i, void *array, size_t samples)
{
	int is_soa = rnea_info(w->robots[ROBOT])->layout == RNEA_SOA && !a->per_batch;
	size_t pieces = is_soa ? a->rows : 1, pitch = w->bytes[i] / pieces;
	size_t size = a->per_batch ? pitch : pitch / w->count * samples;

	for (size_t r = 0; r < pieces && !w->e->code; r++)
		bench_gpu_back(w->b->gpu, (char *)array + r * pitch, (const char *)w->arrays[0][i] + r * pitch, size, w->e);
}

/* The robot's outputs of the first set, where the floor's stand now. */
static void take_outputs(struct work *w, void *const *arrays, size_t samples)
{
	const struct rnea_info *info = rnea_info(w->robots[ROBOT]);

	if (w->b->gpu)
		run(w, ROBOT);
	else
		rnea_launch(w->robots[ROBOT], w->sets[0], w->count, NULL, w->e);
	for (size_t i = info->input_count; i < w->array_count && w->b->gpu; i++)
		take_output(w, &info->arguments[i], i, arrays[i], samples);
}

static void drop_graphs(struct work *w)
{
	for (int i = 0; i < KINDS && w->b->gpu; i++) {
		bench_gpu_drop(w->b->gpu, w->graphs[i]);
		w->graphs[i] = NULL;
	}
}

static void set_launches(struct work *w, size_t launches)
{
	w->launches = launches;
	drop_graphs(w);
	for (int i = 0; i < KINDS && w->b->gpu && !w->e->code; i++)
		w->graphs[i] = bench_gpu_graph(
			w->b->gpu, w->robots[i], w->sets, w->set_count, w->count, launches, w->e);
}

/* As many launches as last BENCH_RUN, in a graph each set as often as the others; this warms up too. */
static void calibrate(struct work *w)
{
	size_t limit = w->b->gpu ? LAUNCHES_GPU : LAUNCHES_HOST, step = w->b->gpu ? w->set_count : 1, more = step;
	double seconds;

	do {
		set_launches(w, more);
		if (w->e->code)
			return;
		run(w, FLOOR);
		seconds = run(w, ROBOT);
		more = w->launches * (seconds > BENCH_RUN / 10 ? (size_t)(1.2 * BENCH_RUN / seconds) + 1 : 10);
		more -= more % step;
	} while (seconds < BENCH_RUN && w->launches < limit && !w->e->code);
}

static int ascending(const void *a, const void *b)
{
	const double *x = a, *y = b;

	return (*x > *y) - (*x < *y);
}

static void summarise(struct work *w, int replays, struct bench_time *time)
{
	double samples = (double)w->launches * (double)w->count, *t = w->times[ROBOT];

	for (int i = 0; i < KINDS; i++)
		qsort(w->times[i], (size_t)replays, sizeof(double), ascending);
	time->ns = 1e9 * t[replays / 2] / samples;
	time->least = 1e9 * t[0] / samples;
	time->spread = (t[3 * replays / 4] - t[replays / 4]) / t[replays / 2];
	time->floor = 1e9 * w->times[FLOOR][replays / 2] / samples;
}

/* Are there runs that nothing disturbed? More than one that is near the least. */
static int is_settled(const double *times, int replays)
{
	double least = times[0];
	int alike = 0;

	for (int i = 1; i < replays; i++)
		least = times[i] < least ? times[i] : least;
	for (int i = 0; i < replays; i++)
		alike += times[i] <= 1.1 * least;
	return alike >= BENCH_ALIKE;
}

static int is_enough(const struct work *w, int replays, double total)
{
	if (replays < BENCH_REPLAYS || (total < BENCH_TOTAL && replays < BENCH_REPLAYS_LIMIT))
		return 0;
	return replays == BENCH_REPLAYS_LIMIT || total >= BENCH_LIMIT || is_settled(w->times[ROBOT], replays);
}

enum rnea_code bench_measure(struct bench *b, const struct rnea_robot *robot, const struct rnea_robot *floor,
	void *const *arrays, size_t count, size_t back, struct bench_time *time, struct rnea_error *e)
{
	struct work *w = calloc(1, sizeof *w);
	double total = 0;
	int replays = 0;

	if (!w)
		return rnea_error_memory(e);
	*w = (struct work){.b = b, .robots = {robot, floor}, .count = count, .e = e};
	make_sets(w, arrays);
	if (!e->code)
		calibrate(w);
	for (; !e->code && !is_enough(w, replays, total); replays++)
		for (int i = 0; i < KINDS; i++)
			total += w->times[i][replays] = run(w, i);
	if (!e->code)
		summarise(w, replays, time);
	if (!e->code && back)
		take_outputs(w, arrays, back);
	drop_graphs(w);
	drop_sets(w);
	free(w);
	return e->code;
}
