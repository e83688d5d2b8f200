#include "study/bench_gpu.h"
#include "cuda/device.h"
#include <stdint.h>
#include <stdlib.h>

/* What is used beside device.h's, as cuda.h declares it. */
#define TIMING_FUNCTIONS(X)                                                                                            \
	X(copy, "cuMemcpyHtoD_v2", (unsigned long long to, const void *from, size_t size))                             \
	X(begin, "cuStreamBeginCapture_v2", (void *stream, int mode))                                                  \
	X(end, "cuStreamEndCapture", (void *stream, void **graph))                                                     \
	X(instantiate, "cuGraphInstantiateWithFlags", (void **executable, void *graph, unsigned long long flags))      \
	X(launch, "cuGraphLaunch", (void *executable, void *stream))                                                   \
	X(graph_destroy, "cuGraphDestroy", (void *graph))                                                              \
	X(executable_destroy, "cuGraphExecDestroy", (void *executable))                                                \
	X(event_create, "cuEventCreate", (void **event, unsigned flags))                                               \
	X(event_destroy, "cuEventDestroy_v2", (void *event))                                                           \
	X(event_record, "cuEventRecord", (void *event, void *stream))                                                  \
	X(event_wait, "cuEventSynchronize", (void *event))                                                             \
	X(event_elapsed, "cuEventElapsedTime", (float *milliseconds, void *start, void *stop))

enum { CAPTURE_THREAD_LOCAL = 1 };

struct timing {
#define TIMING_FIELD(field, symbol, parameters) int(*field) parameters;
	TIMING_FUNCTIONS(TIMING_FIELD)
#undef TIMING_FIELD
};

struct bench_gpu {
	struct device device;
	struct timing timing;
	int pushed; /* the context is current while the bench is open */
	void *stream, *start, *stop;
};

static enum rnea_code find_functions(struct bench_gpu *g, struct rnea_error *e)
{
#define TIMING_FIND(field, symbol, parameters)                                                                         \
	if (!library_symbol(&g->device.library, symbol, &g->timing.field))                                             \
		return rnea_error_set(e, RNEA_NO_DRIVER, "the CUDA driver %s has no %s: 12.0 or newer is needed",      \
			g->device.library.path, symbol);
	TIMING_FUNCTIONS(TIMING_FIND)
#undef TIMING_FIND
	return RNEA_OK;
}

static enum rnea_code make_events(struct bench_gpu *g, struct rnea_error *e)
{
	int status = g->timing.event_create(&g->start, 0);

	if (!status)
		status = g->timing.event_create(&g->stop, 0);
	return status ? device_failed(&g->device, status, "cuEventCreate", e) : RNEA_OK;
}

enum rnea_code bench_gpu_open(struct bench_gpu **g, int device, struct rnea_error *e)
{
	struct bench_gpu *new = calloc(1, sizeof *new);

	*g = NULL;
	if (!new)
		return rnea_error_memory(e);
	if (device_open(&new->device, device, e) || find_functions(new, e) ||
		device_enter(&new->device, &new->pushed, e) || device_stream(&new->device, &new->stream, e) ||
		make_events(new, e)) {
		bench_gpu_close(new);
		return e->code;
	}
	*g = new;
	return RNEA_OK;
}

void bench_gpu_close(struct bench_gpu *g)
{
	struct rnea_error ignored = {0};

	if (!g)
		return;
	if (g->stream)
		device_finish(&g->device, g->stream, &ignored);
	if (g->start)
		g->timing.event_destroy(g->start);
	if (g->stop)
		g->timing.event_destroy(g->stop);
	device_leave(&g->device, g->pushed);
	device_close(&g->device);
	free(g);
}

int bench_gpu_driver(const struct bench_gpu *g)
{
	return g->device.version;
}

void *bench_gpu_array(struct bench_gpu *g, const void *from, size_t size, struct rnea_error *e)
{
	unsigned long long address = 0;
	int status = 0;

	if (device_alloc(&g->device, size, &address, e))
		return NULL;
	if (from)
		status = g->timing.copy(address, from, size);
	if (!status)
		return (void *)(uintptr_t)address;
	device_failed(&g->device, status, "cuMemcpyHtoD", e);
	device_free(&g->device, address);
	return NULL;
}

enum rnea_code bench_gpu_back(struct bench_gpu *g, void *to, const void *array, size_t size, struct rnea_error *e)
{
	int status = g->device.api.memcpy_dtoh(to, (unsigned long long)(uintptr_t)array, size);

	return status ? device_failed(&g->device, status, "cuMemcpyDtoH", e) : RNEA_OK;
}

void bench_gpu_free(struct bench_gpu *g, void *array)
{
	device_free(&g->device, (unsigned long long)(uintptr_t)array);
}

void *bench_gpu_graph(struct bench_gpu *g, const struct rnea_robot *robot, void *const *const *sets, size_t set_count,
	size_t count, size_t launches, struct rnea_error *e)
{
	void *graph = NULL, *executable = NULL;
	int status = g->timing.begin(g->stream, CAPTURE_THREAD_LOCAL);

	for (size_t i = 0; !status && i < launches && !e->code; i++)
		rnea_launch(robot, sets[i % set_count], count, g->stream, e);
	if (!status)
		status = g->timing.end(g->stream, &graph);
	if (!status && !e->code)
		status = g->timing.instantiate(&executable, graph, 0);
	if (graph)
		g->timing.graph_destroy(graph);
	if (status && !e->code)
		device_failed(&g->device, status, "a graph of launches", e);
	return executable;
}

void bench_gpu_drop(struct bench_gpu *g, void *graph)
{
	if (graph)
		g->timing.executable_destroy(graph);
}

enum rnea_code bench_gpu_replay(struct bench_gpu *g, void *graph, double *seconds, struct rnea_error *e)
{
	const struct timing *t = &g->timing;
	float milliseconds = 0;
	/* the first replay keeps the device busy while the rest is enqueued: what is timed never waits for the host */
	int status = t->launch(graph, g->stream);

	if (!status)
		status = t->event_record(g->start, g->stream);
	if (!status)
		status = t->launch(graph, g->stream);
	if (!status)
		status = t->event_record(g->stop, g->stream);
	if (!status)
		status = t->event_wait(g->stop);
	if (!status)
		status = t->event_elapsed(&milliseconds, g->start, g->stop);
	*seconds = 1e-3 * (double)milliseconds;
	return status ? device_failed(&g->device, status, "a replay of launches", e) : RNEA_OK;
}
