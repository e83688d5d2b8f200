/* jit

   The torques of a batch of states on the GPU, by the text iiwa14_rnea.cu of the current folder, which NVRTC compiles
   when this program runs. Arrays are [row][sample], and lie on the GPU before the launch and after it. The result is
   held against the C function of the same robot. Exit status 77: there is no GPU. */
#include "driver.h"
#include "iiwa14_rnea.h"
#include "rnea.h"
#include <math.h>
#include <stdio.h>

enum { N = iiwa14_nv, COUNT = 1000, ARRAYS = 4 };

static int compute(void *q, void *qd, void *qdd, void *tau, size_t count, void *stream, const struct driver *d)
{
	struct rnea_robot *robot;
	struct rnea_error error;
	if (rnea_open_file("iiwa14_rnea.cu", NULL, &robot, &error))
		return fprintf(stderr, "%s\n", error.message), 1;

	void *arguments[] = {q, qd, qdd, tau};		      /* device pointers, in the order of rnea_info() */
	rnea_launch(robot, arguments, count, stream, &error); /* allocates nothing, can be captured in a graph */
	d->synchronize();
	rnea_close(robot); /* when the stream has passed */
	return error.code ? fprintf(stderr, "%s\n", error.message), 1 : 0;
}

/* From the zero state, where the arm stands upright, joint by joint away from it and ever faster. */
static void fill(float host[ARRAYS][N][COUNT])
{
	for (int row = 0; row < N; row++)
		for (int k = 0; k < COUNT; k++) {
			host[0][row][k] = 0.002f * (float)(k * (row + 1) % 1000);
			host[1][row][k] = 0.001f * (float)(k * (7 - row) % 1000);
			host[2][row][k] = -0.005f * (float)(k * (row + 2) % 1000);
		}
}

/* ||tau - right|| / ||right||, right being the C function's in double precision; of all samples the largest. */
static double largest_error(float host[ARRAYS][N][COUNT])
{
	double x[ARRAYS][N], largest = 0;

	for (int k = 0; k < COUNT; k++) {
		double difference = 0, norm = 0;

		for (int row = 0; row < N; row++)
			for (int i = 0; i < 3; i++)
				x[i][row] = (double)host[i][row][k];
		iiwa14_rnea(x[0], x[1], x[2], x[3]);
		for (int row = 0; row < N; row++) {
			difference = hypot(difference, (double)host[3][row][k] - x[3][row]);
			norm = hypot(norm, x[3][row]);
		}
		if (!(difference <= largest * norm)) /* a NaN is an error too */
			largest = difference / norm;
	}
	return largest;
}

static int run(const struct driver *d)
{
	static float host[ARRAYS][N][COUNT];
	void *array[ARRAYS] = {NULL};
	int status = 0;
	double error;

	fill(host);
	for (int i = 0; i < ARRAYS && !status; i++)
		status = driver_array(d, &array[i], host[i], sizeof host[i]);
	if (!status)
		status = compute(array[0], array[1], array[2], array[3], COUNT, NULL, d);
	if (!status)
		status = driver_read(d, host[3], array[3], sizeof host[3]);
	for (int i = 0; i < ARRAYS; i++)
		driver_free(d, array[i]);
	if (status)
		return 1;
	error = largest_error(host);
	printf("joint 2 holds %.4f N m; %d samples, largest error %.2g\n", (double)host[3][1][0], COUNT, error);
	return !(error < 1e-5);
}

int main(void)
{
	struct driver driver;
	int status = driver_start(&driver);

	if (status == DRIVER_ABSENT)
		return puts("skipped: jit: there is no CUDA driver or no GPU"), 77;
	if (status)
		return fprintf(stderr, "jit: the CUDA driver answers with status %d\n", status), 1;
	status = run(&driver);
	driver_stop(&driver);
	return status;
}
