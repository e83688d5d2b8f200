/* Lets a C++ compiler build a whole text of CUDA for the processor, with its NAME_rnea_launch: what that takes of CUDA's runtime. Put before
   the text; FAKE_ENTRY(NAME_rnea_kernel) goes after it. What a device refuses is refused, and stays behind as the thread's last error. */
#define FAKE_WAITS 0
#include "fake_device.h"
#undef __CUDACC_RTC__
#define weak visibility("default") /* of NAME_info: a C++ compiler wants to hear of it at the first declaration, nvcc does not */

typedef int cudaError_t;
typedef struct fake_stream *cudaStream_t;
enum { cudaSuccess, cudaErrorInvalidValue };
enum { cudaDevAttrMaxSharedMemoryPerBlockOptin = 97, cudaFuncAttributeMaxDynamicSharedMemorySize = 8, FAKE_DEVICE = 3 };

struct dim3 {
	unsigned x, y;
	dim3(unsigned a, unsigned b = 1) : x(a), y(b) {}
};

/* for the test: bytes that the device can give to a block; those that the last launch gave; calls that failed */
extern "C" {
size_t fake_limit, fake_launched, fake_failures;
}
static size_t fake_most = 48 << 10;
static void fake_entry(void **arguments, unsigned grid, unsigned parts, unsigned block);

static cudaError_t fake_refuse()
{
	fake_failures++;
	return cudaErrorInvalidValue;
}

[[maybe_unused]] static cudaError_t cudaGetDevice(int *device)
{
	*device = FAKE_DEVICE;
	return cudaSuccess;
}

[[maybe_unused]] static cudaError_t cudaDeviceGetAttribute(int *value, int attribute, int device)
{
	*value = (int)fake_limit;
	return attribute == cudaDevAttrMaxSharedMemoryPerBlockOptin && device == FAKE_DEVICE ? cudaSuccess : fake_refuse();
}

[[maybe_unused]] static cudaError_t cudaFuncSetAttribute(const void *kernel, int attribute, int value)
{
	if (!kernel || attribute != cudaFuncAttributeMaxDynamicSharedMemorySize || value < 0 || (size_t)value > fake_limit)
		return fake_refuse();
	fake_most = (size_t)value;
	return cudaSuccess;
}

static cudaError_t cudaLaunchKernel(const void *kernel, dim3 grid, dim3 block, void **arguments, size_t given, cudaStream_t)
{
	if (!kernel || given > fake_most || (given > 48 << 10 && given > fake_limit))
		return fake_refuse();
	fake_launched = given;
	fake_give((unsigned)given);
	fake_entry(arguments, grid.x, grid.y, block.x);
	fake_check_given();
	return cudaSuccess;
}

#define FAKE_ENTRY(kernel)                                                                                             \
	static void fake_entry(void **arguments, unsigned grid, unsigned parts, unsigned block)                        \
	{                                                                                                              \
		fake_run_serial(kernel, arguments, grid, parts, block);                                                \
	}                                                                                                              \
	alignas(1024) unsigned char fake_given_memory[FAKE_MOST_SHARED];
