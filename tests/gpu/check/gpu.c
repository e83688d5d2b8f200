#include "gpu.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT_OF(x) #x
#define NAME_OF(x) TEXT_OF(x) /* after cuda.h has renamed it: "cuMemAlloc_v2" */

void gpu_must(const struct gpu *g, CUresult status, const char *call, const char *file, int line)
{
	const char *text = NULL;

	if (status == CUDA_SUCCESS)
		return;
	g->api.f_cuGetErrorString(status, &text);
	fprintf(stderr, "%s:%d: %s: error %d: %s\n", file, line, call, (int)status, text ? text : "no description");
	exit(3);
}

static void load(struct gpu *g, const char *symbol, void *slot)
{
	void *address = dlsym(g->library, symbol);

	if (!address) {
		fprintf(stderr, "the driver has no function %s\n", symbol);
		exit(3);
	}
	memcpy(slot, &address, sizeof address);
}

void gpu_start(struct gpu *g)
{
	const char *chosen = getenv("RNEA_LIBCUDA");
	int l2 = 0, major = 0, minor = 0;

	if (!(g->library = dlopen(chosen ? chosen : "libcuda.so.1", RTLD_NOW))) {
		fprintf(stderr, "skipped: no CUDA driver: %s\n", dlerror());
		exit(77);
	}
#define GPU_LOAD(name) load(g, NAME_OF(name), &g->api.f_##name);
	GPU_FUNCTIONS(GPU_LOAD)
#undef GPU_LOAD
	GPU(g, cuInit, (0));
	GPU(g, cuDriverGetVersion, (&g->driver));
	GPU(g, cuDeviceGet, (&g->device, 0));
	GPU(g, cuDeviceGetName, (g->name, (int)sizeof g->name, g->device));
	GPU(g, cuDeviceGetAttribute, (&l2, CU_DEVICE_ATTRIBUTE_L2_CACHE_SIZE, g->device));
	GPU(g, cuDeviceGetAttribute, (&major, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR, g->device));
	GPU(g, cuDeviceGetAttribute, (&minor, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR, g->device));
	g->l2_bytes = (size_t)l2;
	g->arch = 10 * major + minor;
	GPU(g, cuDevicePrimaryCtxRetain, (&g->context, g->device));
	GPU(g, cuCtxPushCurrent, (g->context));
	GPU(g, cuStreamCreate, (&g->stream, CU_STREAM_NON_BLOCKING));
}

void gpu_stop(struct gpu *g)
{
	CUcontext context;

	GPU(g, cuCtxSynchronize, ());
	GPU(g, cuStreamDestroy, (g->stream));
	GPU(g, cuCtxPopCurrent, (&context));
	GPU(g, cuDevicePrimaryCtxRelease, (g->device));
}

struct gpu_array gpu_array_new(const struct gpu *g, size_t bytes)
{
	struct gpu_array a = {.bytes = bytes};
	CUdeviceptr memory;

	GPU(g, cuMemAlloc, (&memory, bytes + 2 * GPU_GUARD));
	a.data = memory + GPU_GUARD;
	gpu_array_poison(g, &a);
	return a;
}

void gpu_array_free(const struct gpu *g, struct gpu_array *a)
{
	if (a->data)
		GPU(g, cuMemFree, (a->data - GPU_GUARD));
	a->data = 0;
}

void gpu_array_poison(const struct gpu *g, const struct gpu_array *a)
{
	GPU(g, cuMemsetD8, (a->data - GPU_GUARD, 0xff, a->bytes + 2 * GPU_GUARD));
	GPU(g, cuCtxSynchronize, ());
}

int gpu_array_intact(const struct gpu *g, const struct gpu_array *a)
{
	unsigned char guards[2 * GPU_GUARD];

	GPU(g, cuMemcpyDtoH, (guards, a->data - GPU_GUARD, GPU_GUARD));
	GPU(g, cuMemcpyDtoH, (guards + GPU_GUARD, a->data + a->bytes, GPU_GUARD));
	for (int i = 0; i < 2 * GPU_GUARD; i++)
		if (guards[i] != 0xff)
			return 0;
	return 1;
}

int gpu_array_read(const struct gpu *g, const struct gpu_array *a, void *host)
{
	GPU(g, cuMemcpyDtoH, (host, a->data, a->bytes));
	return gpu_array_intact(g, a);
}

void gpu_capture_begin(const struct gpu *g)
{
	GPU(g, cuStreamBeginCapture, (g->stream, CU_STREAM_CAPTURE_MODE_GLOBAL));
}

CUgraphExec gpu_capture_end(const struct gpu *g)
{
	CUgraph graph;
	CUgraphExec executable;

	GPU(g, cuStreamEndCapture, (g->stream, &graph));
	GPU(g, cuGraphInstantiateWithFlags, (&executable, graph, 0));
	GPU(g, cuGraphDestroy, (graph));
	return executable;
}

double gpu_replay(const struct gpu *g, CUgraphExec graph)
{
	CUevent start, stop;
	float milliseconds;

	GPU(g, cuEventCreate, (&start, CU_EVENT_DEFAULT));
	GPU(g, cuEventCreate, (&stop, CU_EVENT_DEFAULT));
	/* the first replay keeps the device busy while the rest is enqueued: what is timed never waits for the host */
	GPU(g, cuGraphLaunch, (graph, g->stream));
	GPU(g, cuEventRecord, (start, g->stream));
	GPU(g, cuGraphLaunch, (graph, g->stream));
	GPU(g, cuEventRecord, (stop, g->stream));
	GPU(g, cuEventSynchronize, (stop));
	GPU(g, cuEventElapsedTime, (&milliseconds, start, stop));
	GPU(g, cuEventDestroy, (start));
	GPU(g, cuEventDestroy, (stop));
	return (double)milliseconds * 1e-3;
}
