/* several_gpus TEXT.cu [COUNT]

   The torques of a million states by all GPUs of the machine at once, each with its part of the arrays, which lie in
   the program's memory as [sample][row] (rneagen --layout aos); then the same by the first one alone, which is to give
   the same bits. Exit status 77: there is no GPU. */
#include "rnea.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 7, COUNT = 1000003, GPUS = 16 };

/* One robot on each GPU, from the same text: the first is compiled, the others are taken from the cache. */
static int open_all(const char *text, struct rnea_robot *robots[GPUS])
{
	struct rnea_error error;
	int gpus = rnea_device_count(&error);

	if (!gpus)
		return printf("skipped: %s\n", error.message), 0;
	for (int g = 0; g < gpus && g < GPUS; g++) {
		struct rnea_options options = {.backend = RNEA_BACKEND_CUDA, .device = g};

		if (rnea_open_file(text, &options, &robots[g], &error))
			return fprintf(stderr, "%s\n", error.message), -1;
	}
	return gpus < GPUS ? gpus : GPUS;
}

/* Samples count*g/gpus to count*(g+1)/gpus - 1 on GPU g; how many GPUs failed. */
static int run_all(struct rnea_robot **robots, int gpus, float *q, float *qd, float *qdd, float *tau, size_t count)
{
	int failed = 0;

	#pragma omp parallel for num_threads(gpus) reduction(+ : failed)
	for (int g = 0; g < gpus; g++) {
		size_t first = count * (size_t)g / (size_t)gpus, end = count * (size_t)(g + 1) / (size_t)gpus;
		void *part[] = {q + first * N, qd + first * N, qdd + first * N, tau + first * N};
		failed += rnea_run(robots[g], part, end - first, NULL) != RNEA_OK;
	}
	return failed;
}

static int compare(struct rnea_robot **robots, int gpus, float *array[5], size_t count)
{
	for (size_t i = 0; i < count * N; i++)
		for (int k = 0; k < 3; k++)
			array[k][i] = 0.001f * (float)(i * (size_t)(k + 3) % 2000);
	if (run_all(robots, gpus, array[0], array[1], array[2], array[3], count) ||
		run_all(robots, 1, array[0], array[1], array[2], array[4], count))
		return fprintf(stderr, "a launch failed\n"), 1;
	printf("%zu samples on %d GPUs, joint 2 of the last holds %.4f N m\n", count, gpus, (double)array[3][count * N - 6]);
	return memcmp(array[3], array[4], count * N * sizeof(float)) ? fprintf(stderr, "one GPU has other bits\n"), 1 : 0;
}

int main(int argc, char **argv)
{
	size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : COUNT;
	struct rnea_robot *robots[GPUS] = {NULL};
	float *array[5];
	int gpus = argc > 1 ? open_all(argv[1], robots) : -1, status = 1;

	for (int k = 0; k < 5; k++)
		array[k] = malloc((count ? count : 1) * N * sizeof(float));
	if (gpus > 0 && count && array[0] && array[1] && array[2] && array[3] && array[4])
		status = compare(robots, gpus, array, count);
	for (int k = 0; k < 5; k++)
		free(array[k]);
	for (int g = 0; g < GPUS; g++)
		rnea_close(robots[g]);
	return gpus ? status : 77;
}
