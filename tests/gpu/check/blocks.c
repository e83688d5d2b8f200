/* gpu_blocks FOLDER LIST BLOCK...
   Every text of FOLDER that LIST, a file there, names on a line, in blocks of these many threads: its outputs on the
   GPU against those of the same text on the processor. Exit status 0: all is right; 1: something is not. */
#include "rnea.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 20011, NAME_LIMIT = 200 };

struct text {
	char path[1200];
	struct rnea_robot *host;
	void *host_arrays[RNEA_ARGUMENT_LIMIT], *gpu_arrays[RNEA_ARGUMENT_LIMIT];
};

static size_t array_count(const struct rnea_info *info)
{
	return info->input_count + info->output_count;
}

static void set(const struct rnea_argument *a, void *array, size_t i, double x)
{
	if (a->scalar == RNEA_F64)
		((double *)array)[i] = x;
	else
		((float *)array)[i] = (float)x;
}

static double get(const struct rnea_argument *a, const void *array, size_t i)
{
	return a->scalar == RNEA_F64 ? ((const double *)array)[i] : (double)((const float *)array)[i];
}

/* Inputs of multiples of 1/1024, which a float holds; the processor's outputs. */
static int prepare(struct text *t)
{
	static const char *const quickly[] = {"-O1"};
	const struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .cache = "", .compile = quickly, .compile_count = 1};
	const struct rnea_info *info;
	unsigned state = 1;
	struct rnea_error e;

	if (rnea_open_file(t->path, &o, &t->host, &e))
		return printf("FAIL: %s\n", e.message), 0;
	info = rnea_info(t->host);
	for (size_t i = 0; i < array_count(info); i++) {
		const struct rnea_argument *a = &info->arguments[i];

		t->host_arrays[i] = calloc(COUNT * a->rows, sizeof(double));
		t->gpu_arrays[i] = calloc(COUNT * a->rows, sizeof(double));
		for (size_t k = 0; k < COUNT * a->rows && i < info->input_count; k++) {
			state = 1664525 * state + 1013904223;
			set(a, t->host_arrays[i], k, ((int)(state >> 20) - 2048) / 1024.0);
			set(a, t->gpu_arrays[i], k, get(a, t->host_arrays[i], k));
		}
	}
	if (rnea_run(t->host, t->host_arrays, COUNT, &e))
		return printf("FAIL: %s\n", e.message), 0;
	return 1;
}

static void release(struct text *t)
{
	for (size_t i = 0; t->host && i < array_count(rnea_info(t->host)); i++) {
		free(t->host_arrays[i]);
		free(t->gpu_arrays[i]);
	}
	rnea_close(t->host);
}

/* The largest difference of an output's elements over its largest; infinite where one is not finite. */
static double distance(const struct text *t)
{
	const struct rnea_info *info = rnea_info(t->host);
	double worst = 0;

	for (size_t i = info->input_count; i < array_count(info); i++) {
		const struct rnea_argument *a = &info->arguments[i];
		double most = 0, size = 1e-30;

		for (size_t k = 0; k < COUNT * a->rows; k++) {
			double x = get(a, t->gpu_arrays[i], k), y = get(a, t->host_arrays[i], k);

			most = isfinite(x) && isfinite(y) ? fmax(most, fabs(x - y)) : (double)INFINITY;
			size = fmax(size, fabs(y));
		}
		worst = fmax(worst, most / size);
	}
	return worst;
}

static int check(struct text *t, unsigned block)
{
	const struct rnea_options o = {.backend = RNEA_BACKEND_CUDA, .block = block, .cache = ""};
	const struct rnea_info *info = rnea_info(t->host);
	double limit = info->precision == RNEA_F64 ? 1e-12 : 1e-4, worst = (double)INFINITY;
	struct rnea_resources r = {0};
	struct rnea_robot *robot;
	struct rnea_error e;

	for (size_t i = info->input_count; i < array_count(info); i++)
		memset(t->gpu_arrays[i], 0xff, COUNT * info->arguments[i].rows * sizeof(double));
	if (rnea_open_file(t->path, &o, &robot, &e))
		return printf("FAIL: %s in blocks of %u: %s\n", t->path, block, e.message), 0;
	rnea_resources(robot, "rnea", &r, NULL);
	if (rnea_run(robot, t->gpu_arrays, COUNT, &e))
		printf("FAIL: %s\n", e.message);
	else
		worst = distance(t);
	printf("%s %s in blocks of %u: within %.1e, %d registers, %zu bytes of local memory, %zu of shared, stages %zu\n",
		worst < limit ? "ok  " : "FAIL", strrchr(t->path, '/') + 1, block, worst, r.registers, r.local_bytes,
		r.shared_bytes, rnea_info(robot)->stage_bytes * block);
	rnea_close(robot);
	return worst < limit;
}

int main(int argc, char **argv)
{
	char path[1024], line[NAME_LIMIT];
	int failures = 0;
	FILE *f;

	if (argc < 4)
		return fputs("usage: gpu_blocks FOLDER LIST BLOCK...\n", stderr), 2;
	snprintf(path, sizeof path, "%s/%s", argv[1], argv[2]);
	if (!(f = fopen(path, "r")))
		return fprintf(stderr, "%s: cannot be opened\n", path), 2;
	setvbuf(stdout, NULL, _IOLBF, 0);
	while (fgets(line, sizeof line, f)) {
		struct text t = {.host = NULL};
		int good;

		line[strcspn(line, "\n")] = '\0';
		snprintf(t.path, sizeof t.path, "%s/%s", argv[1], line);
		good = prepare(&t);
		failures += !good;
		for (int i = 3; good && i < argc; i++)
			failures += !check(&t, (unsigned)atoi(argv[i]));
		release(&t);
	}
	fclose(f);
	return failures != 0;
}
