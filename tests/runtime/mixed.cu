/* A text whose arrays are as different as the table allows: x[r] = a[r] g[r] + b[0], y = b[1] + b[2] + g[3], with a in
   single and b in double precision, and g for the whole batch. For the tests of rnea_run, which turn it into aos too. */
#if defined __CUDACC_RTC__
#define RNEA_INFO __device__
#else
#define RNEA_INFO
#endif
#ifndef RNEA_BLOCK
#define RNEA_BLOCK 128
#endif
#define MIXED_AOS 0
#define MIXED_AT(row, rows) (MIXED_AOS ? k*(rows) + (row) : (row)*count + k)

extern "C" {
extern RNEA_INFO const char mixed_info[];
RNEA_INFO const char mixed_info[] =
	"rneagen-info 1\n"
	"name mixed\n"
	"precision f32\n"
	"layout soa\n"
	"trig accurate\n"
	"base fixed\n"
	"nq 1\n"
	"nv 1\n"
	"nb 1\n"
	"block 128\n"
	"kernels rnea\n"
	"input a 2 f32 sample\n"
	"input b 3 f64 sample\n"
	"input g 4 f32 batch\n"
	"output x 2 f32 sample\n"
	"output y 1 f64 sample\n"
	"operations 0 0 0 0 0 0\n";
}

extern "C" __global__ void __launch_bounds__(RNEA_BLOCK)
mixed_rnea_kernel(const float *__restrict__ a, const double *__restrict__ b, const float *__restrict__ g,
	float *__restrict__ x, double *__restrict__ y, size_t count)
{
	const size_t k = (size_t)blockIdx.x*blockDim.x + threadIdx.x;

	if (k >= count)
		return;
	for (size_t r = 0; r < 2; r++)
		x[MIXED_AT(r, 2)] = a[MIXED_AT(r, 2)]*g[r] + (float)b[MIXED_AT(0, 3)];
	y[k] = b[MIXED_AT(1, 3)] + b[MIXED_AT(2, 3)] + (double)g[3];
}
