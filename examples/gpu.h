#ifndef GPU_H
#define GPU_H
/* The GPU, for the one file of a program that has its kernels. Without nvcc there is none. */

#include "common.h"

#if defined __CUDACC__
/* Returns whether a call failed, having said why. */
static int failed(cudaError_t e)
{
	if (e != cudaSuccess)
		fprintf(stderr, "%s: %s\n", PROGRAM, cudaGetErrorString(e));
	return e != cudaSuccess;
}

const char *gpu_lacks()
{
	int devices = 0;

	return cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0 ? "there is no CUDA device" : NULL;
}

const char *gpu_name()
{
	static cudaDeviceProp properties;

	return failed(cudaGetDeviceProperties(&properties, 0)) ? "" : properties.name;
}
#else
const char *gpu_lacks()
{
	return "this program was built without nvcc";
}

const char *gpu_name()
{
	return "";
}
#endif

#endif
