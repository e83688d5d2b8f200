/* The same for a million angles on the GPU. arm_rnea_launch could be called from a C file as well. */
#include "arm_rnea.h"
#include <cmath>
#include <cstdio>
#include <vector>

int main()
{
	const size_t count = 1000000;
	const double pi = 3.14159265358979323846;
	std::vector<float> q(arm_nq * count), tau(arm_nv * count);
	float *device = NULL, *q_device, *zero, *tau_device;
	int devices = 0;
	double worst = 0;

	if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
		puts("skipped: there is no CUDA device");
		return 77;
	}
	/* arrays are [row][sample]: the shoulder's angles, then the elbow's */
	for (size_t k = 0; k < count; k++)
		q[k] = (float)(pi / 2 * (double)k / (double)count);
	cudaMalloc(&device, (arm_nq + 2 * arm_nv) * count * sizeof(float));
	q_device = device, zero = q_device + arm_nq * count, tau_device = zero + arm_nv * count;
	cudaMemcpy(q_device, q.data(), q.size() * sizeof(float), cudaMemcpyHostToDevice);
	cudaMemset(zero, 0, arm_nv * count * sizeof(float));
	cudaError_t error = (cudaError_t)arm_rnea_launch(q_device, zero, zero, tau_device, count, NULL);
	if (error == cudaSuccess)
		error = cudaMemcpy(tau.data(), tau_device, tau.size() * sizeof(float), cudaMemcpyDeviceToHost);
	cudaFree(device);
	if (error != cudaSuccess) {
		fprintf(stderr, "aot_gpu: %s\n", cudaGetErrorString(error));
		return 1;
	}
	for (size_t k = 0; k < count; k++) {
		const double c = 9.81 * std::cos((double)q[k]);

		worst = std::fmax(
			worst, std::fabs((double)tau[k] - 2 * c) + std::fabs((double)tau[count + k] - 0.5 * c));
	}
	printf("%zu poses held on the GPU, worst error %.2g N m\n", count, worst);
	return worst < 2e-5 ? 0 : 1;
}
