/* embed [COUNT]: inverse dynamics inside a kernel of one's own. COUNT trajectories of a KUKA iiwa 14 go to the device
   as the coefficients of splines (embed.h); one thread a trajectory walks along it, calls the inlined iiwa14_rnea at
   every time step, holds the torques against the joints' limits, and writes one number: the trajectory's cost, or
   infinity. Neither positions nor torques ever exist in memory.

   The same function runs on the host; both are checked (embed_check.cpp). Without nvcc this is C++, without kernel. */
#include "iiwa14_rnea.h"
#include "embed.h"
#include <cstdio>
#include <cstdlib>
#if !defined __CUDACC__
#define __host__
#define __device__
#endif

static_assert(N == iiwa14_nq && N == iiwa14_nv, "embed.h is written for the iiwa 14");
static const double ERROR_LIMIT = 5e-5; /* a sum of 2800 terms in single precision */

/* The integral of |tau|^2 along trajectory k of `count`, in N^2 m^2 s; infinity if a torque is above its limit. */
static __host__ __device__ float trajectory_cost(const float *coefficients, size_t k, size_t count)
{
	const float effort[N] = {EFFORTS};
	float cost = 0, c[N][4], q[N], qd[N], qdd[N], tau[N];

	for (int s = 0; s < SEGMENTS; s++) {
		for (int j = 0; j < N; j++)
			for (int i = 0; i < 4; i++)
				c[j][i] = coefficients[(size_t)((s * N + j) * 4 + i) * count + k];
		for (int step = 0; step < STEPS; step++) {
			const float t = ((float)step + 0.5f) * DT;

			for (int j = 0; j < N; j++) {
				q[j] = ((c[j][3] * t + c[j][2]) * t + c[j][1]) * t + c[j][0];
				qd[j] = (3 * c[j][3] * t + 2 * c[j][2]) * t + c[j][1];
				qdd[j] = 6 * c[j][3] * t + 2 * c[j][2];
			}
			iiwa14_rnea(q, qd, qdd, tau);
			for (int j = 0; j < N; j++)
				cost += fabsf(tau[j]) <= effort[j] ? tau[j] * tau[j] * DT : INFINITY;
		}
	}
	return cost;
}

#if defined __CUDACC__
static __global__ void __launch_bounds__(128) cost_kernel(const float *coefficients, float *costs, size_t count)
{
	const size_t k = (size_t)blockIdx.x * blockDim.x + threadIdx.x;

	if (k < count)
		costs[k] = trajectory_cost(coefficients, k, count);
}

static int failed(cudaError_t e)
{
	if (e != cudaSuccess)
		fprintf(stderr, "embed: %s\n", cudaGetErrorString(e));
	return e != cudaSuccess;
}

/* The costs by the kernel, and the milliseconds of its second run. Returns 1 if something fails. */
static int run_kernel(const std::vector<float> &coefficients, std::vector<float> &costs, float *milliseconds)
{
	const size_t count = costs.size(), bytes = coefficients.size() * sizeof(float);
	const unsigned blocks = (unsigned)((count + 127) / 128);
	float *in = NULL, *out = NULL;
	cudaEvent_t begin, end;

	if (failed(cudaMalloc(&in, bytes)) || failed(cudaMalloc(&out, count * sizeof(float))) ||
		failed(cudaMemcpy(in, coefficients.data(), bytes, cudaMemcpyHostToDevice)) ||
		failed(cudaEventCreate(&begin)) || failed(cudaEventCreate(&end)))
		return 1;
	cost_kernel<<<blocks, 128>>>(in, out, count);
	cudaEventRecord(begin);
	cost_kernel<<<blocks, 128>>>(in, out, count);
	cudaEventRecord(end);
	if (failed(cudaMemcpy(costs.data(), out, count * sizeof(float), cudaMemcpyDeviceToHost)) ||
		failed(cudaEventElapsedTime(milliseconds, begin, end)))
		return 1;
	cudaEventDestroy(begin);
	cudaEventDestroy(end);
	return failed(cudaFree(in)) || failed(cudaFree(out));
}

static int on_device(const std::vector<float> &coefficients, size_t count)
{
	std::vector<float> costs(count);
	float milliseconds = 0;
	double error;
	int devices = 0;

	if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
		printf("skipped: embed's kernel, for there is no CUDA device\n");
		return 0;
	}
	if (run_kernel(coefficients, costs, &milliseconds))
		return 1;
	error = worst_error(coefficients, costs);
	printf("device: %.3f ms, %.1f ps a time step; error of the costs at most %.2g\n", (double)milliseconds,
		1e9 * (double)milliseconds / ((double)count * SEGMENTS * STEPS), error);
	return !(error < ERROR_LIMIT);
}
#else
static int on_device(const std::vector<float> &, size_t)
{
	return 0;
}
#endif

static int on_host(const std::vector<float> &coefficients, size_t count)
{
	std::vector<float> costs(count);
	size_t feasible = 0, best = 0;
	double error;

	for (size_t k = 0; k < count; k++) {
		costs[k] = trajectory_cost(coefficients.data(), k, count);
		feasible += costs[k] < INFINITY;
		best = costs[k] < costs[best] ? k : best;
	}
	error = worst_error(coefficients, costs);
	printf("%zu trajectories of %d steps, %zu within the torque limits; number %zu costs least\n", count,
		SEGMENTS * STEPS, feasible, best);
	printf("host: error of the costs at most %.2g\n", error);
	return !(error < ERROR_LIMIT) || feasible == 0 || feasible == count;
}

int main(int argc, char **argv)
{
	const size_t count = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000;
	const std::vector<float> coefficients = random_splines(count);

	return on_host(coefficients, count) || on_device(coefficients, count);
}
