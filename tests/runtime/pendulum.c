/* A text such as rneagen writes for target c, written by hand: the pendulum of pendulum.cu. */
#include <math.h>
#include <stddef.h>

#define RNEA_INFO

extern const char pendulum_info[];
void pendulum_rnea_slice(void *const *arrays, size_t count, size_t first, size_t end);
void pendulum_bpass_slice(void *const *arrays, size_t count, size_t first, size_t end);

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
	"input q 1 f32 sample\n"
	"input qd 1 f32 sample\n"
	"input qdd 1 f32 sample\n"
	"output tau 1 f32 sample\n"
	"operations 1 0 0 0 1 1\n"
	"joint 0 1 0 1 revolute swing of the rod\n";

void pendulum_rnea_slice(void *const *arrays, size_t count, size_t first, size_t end)
{
	const float *q = arrays[0], *qdd = arrays[2];
	float *tau = arrays[3];

	(void)count;
	for (size_t k = first; k < end; k++)
		tau[k] = fmaf(0.5f, qdd[k], 9.81f*sinf(q[k]));
}

void pendulum_bpass_slice(void *const *arrays, size_t count, size_t first, size_t end)
{
	const float *f = arrays[1];
	float *tau = arrays[2];

	for (size_t k = first; k < end; k++)
		tau[k] = f[4*count + k];
}
