/* Lets a C++ compiler build a whole text of CUDA for the processor, with its NAME_rnea_launch: what that takes of
   CUDA's runtime. Put before the text; FAKE_ENTRY(NAME_rnea_kernel) goes after it, or FAKE_ENTRIES(NAME_rnea_kernel,
   NAME_rnea_limbs, "NAME_across") with FAKE_WAITS 1. What a device refuses is refused, and stays behind as the thread's
   last error. */
#ifndef FAKE_WAITS
#define FAKE_WAITS 0
#endif
#include "fake_device.h"
#undef __CUDACC_RTC__
#define weak visibility("default") /* of NAME_info: a C++ compiler wants to hear of it at the first declaration, nvcc does not */

typedef int cudaError_t;
typedef struct fake_stream *cudaStream_t;
enum { cudaSuccess, cudaErrorInvalidValue };
enum { cudaDevAttrMaxSharedMemoryPerBlockOptin = 97, cudaDevAttrComputeCapabilityMajor = 75,
	cudaFuncAttributeMaxDynamicSharedMemorySize = 8, FAKE_DEVICE = 3, FAKE_MAJOR = 8 };

struct dim3 {
	unsigned x, y;
	dim3(unsigned a, unsigned b = 1) : x(a), y(b) {}
};

/* for the test: bytes that the device can give to a block; those that the last launch gave; calls that failed */
extern "C" {
size_t fake_limit, fake_launched, fake_failures;
unsigned fake_grid, fake_block;
}
static void fake_entry(const void *kernel, void **arguments, unsigned grid, unsigned parts, unsigned block);

/* What a launch of this kernel may give. */
static size_t &fake_most(const void *kernel)
{
	static struct {
		const void *kernel;
		size_t bytes;
	} all[64];

	for (auto &x : all) {
		if (!x.kernel)
			x = {kernel, 48 << 10};
		if (x.kernel == kernel)
			return x.bytes;
	}
	__builtin_trap();
}

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
	const bool is_major = attribute == cudaDevAttrComputeCapabilityMajor;

	*value = is_major ? FAKE_MAJOR : (int)fake_limit;
	return (is_major || attribute == cudaDevAttrMaxSharedMemoryPerBlockOptin) && device == FAKE_DEVICE ? cudaSuccess : fake_refuse();
}

[[maybe_unused]] static cudaError_t cudaFuncSetAttribute(const void *kernel, int attribute, int value)
{
	if (!kernel || attribute != cudaFuncAttributeMaxDynamicSharedMemorySize || value < 0 || (size_t)value > fake_limit)
		return fake_refuse();
	fake_most(kernel) = (size_t)value;
	return cudaSuccess;
}

static cudaError_t cudaLaunchKernel(const void *kernel, dim3 grid, dim3 block, void **arguments, size_t given, cudaStream_t)
{
	if (!kernel || given > fake_most(kernel) || (given > 48 << 10 && given > fake_limit))
		return fake_refuse();
	fake_launched = given;
	fake_give((unsigned)given);
	fake_grid = grid.x;
	fake_block = block.x;
	fake_entry(kernel, arguments, grid.x, grid.y, block.x);
	fake_check_given();
	return cudaSuccess;
}

/* Of any kernels with the parameters of this one; of those whose threads wait for each other. */
#define FAKE_ENTRY(one) FAKE_ENTRY_BY(fake_run_serial, one)
#define FAKE_ENTRY_WAITS(one) FAKE_ENTRY_BY(fake_run_threads, one)
#define FAKE_ENTRY_BY(run, one)                                                                                        \
	static void fake_entry(const void *kernel, void **arguments, unsigned grid, unsigned parts, unsigned block)    \
	{                                                                                                              \
		run((decltype(&one))kernel, arguments, grid, parts, block);                                            \
	}                                                                                                              \
	alignas(1024) unsigned char fake_given_memory[FAKE_MOST_SHARED];

/* Of kernels with the parameters of this one, and of others with those of a part. */
#define FAKE_ENTRY_PARTS(one, part)                                                                                    \
	static void fake_entry(const void *kernel, void **arguments, unsigned grid, unsigned parts, unsigned block)    \
	{                                                                                                              \
		if (kernel == (const void *)one)                                                                       \
			fake_run_serial(one, arguments, grid, parts, block);                                           \
		else                                                                                                   \
			fake_run_serial((decltype(&part))kernel, arguments, grid, parts, block);                       \
	}                                                                                                              \
	alignas(1024) unsigned char fake_given_memory[FAKE_MOST_SHARED];

/* Of two kernels the second one waits; its memory of the launch is `across`. */
#define FAKE_ENTRIES(large, small, across)                                                                             \
	static void fake_entry(const void *kernel, void **arguments, unsigned grid, unsigned parts, unsigned block)    \
	{                                                                                                              \
		if (kernel == (const void *)small)                                                                     \
			fake_run_threads(small, arguments, grid, parts, block);                                        \
		else                                                                                                   \
			fake_run_serial(large, arguments, grid, parts, block);                                         \
	}                                                                                                              \
	alignas(1024) unsigned char fake_given_memory[FAKE_MOST_SHARED];                                               \
	extern "C" __attribute__((alias("slices"))) unsigned char fake_across[FAKE_MOST_SHARED] __asm__(across);
