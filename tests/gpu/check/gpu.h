#ifndef GPU_H
#define GPU_H
/* The driver API for the checks, opened at run time, declared by cuda.h. What fails here ends the program. */

#include <cuda.h>
#include <stddef.h>

#define GPU_FUNCTIONS(X)                                                                                               \
	X(cuInit)                                                                                                      \
	X(cuDriverGetVersion)                                                                                          \
	X(cuGetErrorString)                                                                                            \
	X(cuDeviceGet)                                                                                                 \
	X(cuDeviceGetName)                                                                                             \
	X(cuDeviceGetAttribute)                                                                                        \
	X(cuDevicePrimaryCtxRetain)                                                                                    \
	X(cuDevicePrimaryCtxRelease)                                                                                   \
	X(cuCtxPushCurrent)                                                                                            \
	X(cuCtxPopCurrent)                                                                                             \
	X(cuCtxSynchronize)                                                                                            \
	X(cuModuleLoadDataEx)                                                                                          \
	X(cuModuleUnload)                                                                                              \
	X(cuModuleGetFunction)                                                                                         \
	X(cuMemGetInfo)                                                                                                \
	X(cuMemAlloc)                                                                                                  \
	X(cuMemFree)                                                                                                   \
	X(cuMemAllocHost)                                                                                              \
	X(cuMemFreeHost)                                                                                               \
	X(cuMemcpyHtoD)                                                                                                \
	X(cuMemcpyDtoH)                                                                                                \
	X(cuMemcpyDtoD)                                                                                                \
	X(cuMemsetD8Async)                                                                                             \
	X(cuMemsetD8)                                                                                                  \
	X(cuStreamCreate)                                                                                              \
	X(cuStreamSynchronize)                                                                                         \
	X(cuStreamDestroy)                                                                                             \
	X(cuStreamBeginCapture)                                                                                        \
	X(cuStreamEndCapture)                                                                                          \
	X(cuGraphInstantiateWithFlags)                                                                                 \
	X(cuGraphLaunch)                                                                                               \
	X(cuGraphDestroy)                                                                                              \
	X(cuGraphExecDestroy)                                                                                          \
	X(cuEventCreate)                                                                                               \
	X(cuEventRecord)                                                                                               \
	X(cuEventSynchronize)                                                                                          \
	X(cuEventElapsedTime)                                                                                          \
	X(cuEventDestroy)                                                                                              \
	X(cuLaunchKernel)

struct gpu {
	void *library;
	struct {
#define GPU_FIELD(name) __typeof__(&name) f_##name;
		GPU_FUNCTIONS(GPU_FIELD)
#undef GPU_FIELD
	} api;
	CUdevice device;
	CUcontext context;
	CUstream stream; /* of our own: what runs in it is ordered */
	char name[128];
	int driver, arch;
	size_t l2_bytes;
};

/* GPU(g, cuMemFree, (address)): call, and end the program with the driver's words unless it returns 0. */
#define GPU(g, name, arguments) gpu_must(g, (g)->api.f_##name arguments, #name, __FILE__, __LINE__)

void gpu_must(const struct gpu *g, CUresult status, const char *call, const char *file, int line);

/* Device 0, its primary context made current. */
void gpu_start(struct gpu *g);
void gpu_stop(struct gpu *g);

/* ---- an array between two guards; all of it starts as NaN ---- */

enum { GPU_GUARD = 256 };

struct gpu_array {
	CUdeviceptr data; /* 256-byte aligned */
	size_t bytes;
};

struct gpu_array gpu_array_new(const struct gpu *g, size_t bytes);
void gpu_array_free(const struct gpu *g, struct gpu_array *a);
void gpu_array_poison(const struct gpu *g, const struct gpu_array *a);

/* 0 if a guard was written to. */
int gpu_array_intact(const struct gpu *g, const struct gpu_array *a);

/* Copy data to `host`; returns 0 if a guard was written to. */
int gpu_array_read(const struct gpu *g, const struct gpu_array *a, void *host);

/* ---- captured work ---- */

/* After gpu_capture_begin, what is launched in g->stream becomes a graph. */
void gpu_capture_begin(const struct gpu *g);
CUgraphExec gpu_capture_end(const struct gpu *g);

/* Replay twice; the seconds that the second time takes on the device. */
double gpu_replay(const struct gpu *g, CUgraphExec graph);

#endif
