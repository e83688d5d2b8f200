/* The pretended driver's streams, graphs and events. A stream runs everything at once, unless it is being captured
   or fake_cuda_defer was called: then it runs everything when it is waited for. */
#define _GNU_SOURCE
#include "fake_cuda.h"
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct stream {
	struct graph *graph;	/* where a capture collects; NULL: none */
	struct fake_work *work; /* what waits; malloc */
	size_t count, capacity;
};

struct graph {
	size_t count, capacity;
	struct fake_launch *launches;
};

struct event {
	struct timespec time;
};

static atomic_int deferred, enqueued;
static atomic_uint threads;

/* For the tests: copies and launches so far. */
int fake_cuda_enqueued(void)
{
	return enqueued;
}

/* For the tests: threads of a block of the launch that was the last. */
unsigned fake_cuda_threads(void)
{
	return threads;
}

/* For the tests: what is enqueued waits, from now on. */
void fake_cuda_defer(int yes)
{
	deferred = yes;
}

static int create(void **handle, size_t size)
{
	*handle = calloc(1, size);
	fake_count_live(*handle != NULL);
	return *handle ? FAKE_SUCCESS : FAKE_OUT_OF_MEMORY;
}

static int destroy(void *handle)
{
	free(handle);
	fake_count_live(-(handle != NULL));
	return FAKE_SUCCESS;
}

/* ---- streams ---- */

static void do_work(const struct fake_work *w)
{
	if (!w->is_copy)
		fake_run(&w->launch);
	for (size_t i = 0; i < w->height && w->is_copy; i++)
		memcpy((char *)w->to + i * w->to_pitch, (const char *)w->from + i * w->from_pitch, w->width);
}

int fake_enqueue(void *stream, const struct fake_work *work)
{
	struct stream *s = stream;

	enqueued++;
	if (!s || !deferred) {
		do_work(work);
		return FAKE_SUCCESS;
	}
	if (s->count == s->capacity) {
		struct fake_work *more = realloc(s->work, (2 * s->capacity + 16) * sizeof *more);

		if (!more)
			return FAKE_OUT_OF_MEMORY;
		s->work = more;
		s->capacity = 2 * s->capacity + 16;
	}
	s->work[s->count++] = *work;
	return FAKE_SUCCESS;
}

static void catch_up(struct stream *s)
{
	for (size_t i = 0; s && i < s->count; i++)
		do_work(&s->work[i]);
	if (s)
		s->count = 0;
}

/* What a context that has died takes along stays reachable, and is no leak. */
static void *_Atomic streams[256];

int cuStreamCreate(void **stream, unsigned flags)
{
	static atomic_uint next;
	int status;

	(void)flags;
	ENTER(1);
	status = create(stream, sizeof(struct stream));
	streams[next++ % 256] = *stream;
	return status;
}

int cuStreamDestroy_v2(void *stream)
{
	catch_up(stream);
	free(((struct stream *)stream)->work);
	destroy(stream);
	ENTER(1);
	return FAKE_SUCCESS;
}

int cuStreamSynchronize(void *stream)
{
	int status = fake_entry(__func__, 1);

	catch_up(stream);
	return status;
}

static int record(struct graph *graph, const struct fake_launch *launch)
{
	if (graph->count == graph->capacity) {
		size_t capacity = graph->capacity ? 2 * graph->capacity : 16;
		struct fake_launch *more = realloc(graph->launches, capacity * sizeof *more);

		if (!more)
			return FAKE_OUT_OF_MEMORY;
		graph->launches = more;
		graph->capacity = capacity;
	}
	graph->launches[graph->count++] = *launch;
	return FAKE_SUCCESS;
}

int cuLaunchKernel(void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by, unsigned bz,
	unsigned shared, void *stream, void **parameters, void **extra)
{
	struct fake_launch launch = {.kernel = function, .grid = gx, .parts = gy, .block = bx, .given = shared};
	struct fake_work work = {.is_copy = 0};
	struct graph *graph = stream ? ((struct stream *)stream)->graph : NULL;

	ENTER(1);
	if (!function || extra || shared > *launch.kernel->most_given || !gx || !gy || !bx || gy > 65535 || gz != 1 ||
		by != 1 || bz != 1 || gx > 0x7fffffff)
		return FAKE_INVALID_VALUE;
	for (unsigned i = 0; i + 1 < launch.kernel->count; i++)
		memcpy(&launch.parameters[i], parameters[i], sizeof launch.parameters[i]);
	if (launch.kernel->last_bytes > FAKE_LAST_LIMIT)
		return FAKE_INVALID_VALUE;
	if (launch.kernel->count)
		memcpy(launch.last, parameters[launch.kernel->count - 1], launch.kernel->last_bytes);
	threads = bx;
	fake_note_launch();
	if (graph)
		return record(graph, &launch);
	work.launch = launch;
	return fake_enqueue(stream, &work);
}

/* ---- graphs; one that is instantiated is a copy ---- */

int cuStreamBeginCapture_v2(void *stream, int mode)
{
	struct stream *s = stream;

	(void)mode;
	ENTER(1);
	return s && !s->graph ? create((void **)&s->graph, sizeof(struct graph)) : FAKE_INVALID_VALUE;
}

int cuStreamEndCapture(void *stream, void **graph)
{
	struct stream *s = stream;

	ENTER(1);
	*graph = s->graph;
	s->graph = NULL;
	return FAKE_SUCCESS;
}

int cuGraphInstantiateWithFlags(void **executable, void *graph, unsigned long long flags)
{
	const struct graph *from = graph;
	struct graph *copy;

	(void)flags;
	ENTER(1);
	if (create((void **)&copy, sizeof *copy))
		return FAKE_OUT_OF_MEMORY;
	for (size_t i = 0; i < from->count; i++)
		if (record(copy, &from->launches[i]))
			return FAKE_OUT_OF_MEMORY;
	*executable = copy;
	return FAKE_SUCCESS;
}

int cuGraphLaunch(void *executable, void *stream)
{
	const struct graph *g = executable;

	(void)stream;
	ENTER(1);
	for (size_t i = 0; i < g->count; i++)
		fake_run(&g->launches[i]);
	return FAKE_SUCCESS;
}

int cuGraphDestroy(void *graph)
{
	free(((struct graph *)graph)->launches);
	return destroy(graph);
}

int cuGraphExecDestroy(void *executable)
{
	return cuGraphDestroy(executable);
}

/* ---- events ---- */

int cuEventCreate(void **event, unsigned flags)
{
	(void)flags;
	ENTER(1);
	return create(event, sizeof(struct event));
}

int cuEventDestroy_v2(void *event)
{
	return destroy(event);
}

int cuEventRecord(void *event, void *stream)
{
	(void)stream;
	ENTER(1);
	clock_gettime(CLOCK_MONOTONIC, &((struct event *)event)->time);
	return FAKE_SUCCESS;
}

int cuEventSynchronize(void *event)
{
	(void)event;
	ENTER(1);
	return FAKE_SUCCESS;
}

int cuEventElapsedTime_v2(float *milliseconds, void *start, void *stop)
{
	const struct event *a = start, *b = stop;

	ENTER(1);
	*milliseconds =
		(float)(b->time.tv_sec - a->time.tv_sec) * 1e3f + (float)(b->time.tv_nsec - a->time.tv_nsec) * 1e-6f;
	return FAKE_SUCCESS;
}

int cuEventElapsedTime(float *milliseconds, void *start, void *stop)
{
	return cuEventElapsedTime_v2(milliseconds, start, stop);
}
