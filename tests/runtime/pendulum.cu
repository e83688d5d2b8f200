/* A text such as rneagen writes, written by hand: a point mass of 2 kg on a rod of 0.5 m that turns about y and hangs
   straight down at q = 0. tau = m l^2 qdd + m g l sin(q). The runtime's tests compile it, run it, and damage it. */
#if defined __CUDACC_RTC__
#define RNEA_INFO __device__
#else
#define RNEA_INFO
#endif
#ifndef RNEA_BLOCK
#define RNEA_BLOCK 128
#endif

extern "C" {
extern RNEA_INFO const char pendulum_info[];
RNEA_INFO const char pendulum_info[] =
	"rneagen-info 1\n"
	"name pendulum\n"
	"precision f32\n"
	"layout soa\n"
	"trig accurate\n"
	"base fixed\n"
	"nq 1\n"
	"nv 1\n"
	"nb 1\n"
	"block 128\n"
	"kernels rnea fpass bpass\n"
	"input q 1 f32 sample\n"
	"input qd 1 f32 sample\n"
	"input qdd 1 f32 sample\n"
	"output tau 1 f32 sample\n"
	"operations 1 0 0 0 1 1\n"
	"joint 0 1 0 1 revolute swing of the rod\n";
}

extern "C" __global__ void __launch_bounds__(RNEA_BLOCK)
pendulum_rnea_kernel(const float *__restrict__ q, const float *__restrict__ qd, const float *__restrict__ qdd,
	float *__restrict__ tau, size_t count)
{
	const size_t k = (size_t)blockIdx.x*blockDim.x + threadIdx.x;

	(void)qd;
	if (k < count)
		tau[k] = fmaf(0.5f, qdd[k], 9.81f*sinf(q[k]));
}

extern "C" __global__ void __launch_bounds__(RNEA_BLOCK)
pendulum_fpass_kernel(const float *__restrict__ q, const float *__restrict__ qd, const float *__restrict__ qdd,
	float *__restrict__ v, float *__restrict__ a, float *__restrict__ f, size_t count)
{
	const size_t k = (size_t)blockIdx.x*blockDim.x + threadIdx.x;

	if (k >= count)
		return;
	const float s = sinf(q[k]), c = cosf(q[k]);
	const float velocity[6] = {0, 0, 0, 0, qd[k], 0};
	const float acceleration[6] = {-9.81f*s, 0, 9.81f*c, 0, qdd[k], 0};
	const float force[6] = {
		-(19.62f*s + qdd[k]), 0, fmaf(qd[k], qd[k], 19.62f*c), 0, fmaf(0.5f, qdd[k], 9.81f*s), 0};
	for (int r = 0; r < 6; r++) {
		v[r*count + k] = velocity[r];
		a[r*count + k] = acceleration[r];
		f[r*count + k] = force[r];
	}
}

extern "C" __global__ void __launch_bounds__(RNEA_BLOCK)
pendulum_bpass_kernel(const float *__restrict__ q, const float *__restrict__ f, float *__restrict__ tau, size_t count)
{
	const size_t k = (size_t)blockIdx.x*blockDim.x + threadIdx.x;

	(void)q;
	if (k < count)
		tau[k] = f[4*count + k];
}
