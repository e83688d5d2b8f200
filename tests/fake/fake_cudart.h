/* Lets a C++ compiler build a program's CUDA C for the processor, where <<< >>> was replaced by fake_launch: the part of
   CUDA's runtime that examples/trajectories/trajectories_solve.cu needs, over the pretended driver. Put before its text. */
#define FAKE_WAITS 1
#include "fake_device.h"
#undef __CUDACC_RTC__
extern "C" {
#include "driver.h"
}
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <tuple>

enum cudaError_t { cudaSuccess, cudaErrorMemoryAllocation = 2 };
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost };
typedef std::chrono::steady_clock::time_point *cudaEvent_t;

static driver &fake_driver()
{
	static driver d;

	if (!d.library && driver_start(&d)) {
		fprintf(stderr, "fake_cudart: there is no pretended driver: set RNEA_LIBCUDA\n");
		exit(1);
	}
	return d;
}

static cudaError_t cudaMalloc(void **array, size_t bytes)
{
	return driver_array(&fake_driver(), array, NULL, bytes) ? cudaErrorMemoryAllocation : cudaSuccess;
}

static cudaError_t cudaFree(void *array)
{
	driver_free(&fake_driver(), array);
	return cudaSuccess;
}

/* memory of the pretended device is memory */
static cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, cudaMemcpyKind)
{
	memcpy(to, from, bytes);
	return cudaSuccess;
}

static cudaError_t cudaMemset(void *array, int value, size_t bytes)
{
	memset(array, value, bytes);
	return cudaSuccess;
}

static cudaError_t cudaEventCreate(cudaEvent_t *event)
{
	*event = new std::chrono::steady_clock::time_point;
	return cudaSuccess;
}

static cudaError_t cudaEventDestroy(cudaEvent_t event)
{
	delete event;
	return cudaSuccess;
}

static cudaError_t cudaEventRecord(cudaEvent_t event)
{
	*event = std::chrono::steady_clock::now();
	return cudaSuccess;
}

static cudaError_t cudaEventElapsedTime(float *milliseconds, cudaEvent_t begin, cudaEvent_t end)
{
	*milliseconds = std::chrono::duration<float, std::milli>(*end - *begin).count();
	return cudaSuccess;
}

static cudaError_t cudaDeviceSynchronize()
{
	return cudaSuccess;
}

static cudaError_t cudaGetLastError()
{
	return cudaSuccess;
}

static const char *cudaGetErrorString(cudaError_t)
{
	return "out of pretended memory";
}

template <class... A, class... B> static void fake_launch(void (*kernel)(A...), unsigned grid, unsigned block, B... values)
{
	std::tuple<std::remove_const_t<A>...> kept(values...);

	std::apply(
		[&](auto &...each) {
			void *parameters[] = {&each...};

			fake_run_threads(kernel, parameters, grid, 1, block);
		},
		kept);
}
