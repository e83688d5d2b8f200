#define _POSIX_C_SOURCE 200809L
#include "launched.h"
#include "support/rng.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void launched_pretend(void)
{
	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	setenv("RNEA_CACHE", "", 1);
	setvbuf(stdout, NULL, _IOLBF, 0);
}

void launched_generate(struct target *t, const char *name, const char *scene, int floating,
	const struct rneagen_options *options)
{
	struct rneagen_options o = *options;
	size_t length;
	char *urdf = target_robot(name, &length);

	o.scene = *scene ? scene : NULL;
	o.base = floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	target_generate(t, urdf, length, &o, name);
	free(urdf);
}

struct rnea_robot *launched_open(const struct target *t, enum rnea_backend backend, unsigned block)
{
	/* products are joined to sums where the kernel joins them, by clang as by gcc: the same bits on each processor */
	static const char *const joins[] = {"-ffp-contract=off", "-DFP_FAST_FMA=1", "-DFP_FAST_FMAF=1"};
	struct rnea_options o = {.backend = backend, .threads = 1, .block = block, .compile = joins,
		.compile_count = backend == RNEA_BACKEND_HOST ? sizeof joins / sizeof *joins : 0};
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(!rnea_open(t->text.source, strlen(t->text.source), &o, &robot, &e), "%s, blocks of %u: %s", t->what, block,
		e.message);
	return robot;
}

static double get(const struct rnea_argument *a, const void *array, size_t i)
{
	return a->scalar == RNEA_F64 ? ((const double *)array)[i] : (double)((const float *)array)[i];
}

static void set(const struct rnea_argument *a, void *array, size_t i, double x)
{
	if (a->scalar == RNEA_F64)
		((double *)array)[i] = x;
	else
		((float *)array)[i] = (float)x;
}

/* Of row r of sample k. */
static size_t place(const struct launch *x, const struct rnea_argument *a, size_t r, size_t k)
{
	return x->info->layout == RNEA_AOS ? k * a->rows + r : r * x->count + k;
}

double launched_get(const struct launch *x, size_t argument, size_t row, size_t sample)
{
	const struct rnea_argument *a = &x->info->arguments[argument];

	return get(a, x->arrays[argument], place(x, a, row, sample));
}

void launched_set(const struct launch *x, size_t argument, size_t row, size_t sample, double value)
{
	const struct rnea_argument *a = &x->info->arguments[argument];

	set(a, x->arrays[argument], place(x, a, row, sample), value);
}

/* A row of q that is an angle, another one in turn: a finger that slides has no room for large numbers. */
static size_t angle_in_turn(const struct launch *x, size_t turn)
{
	size_t count = x->info->joint_count;

	for (size_t i = 0; i < count; i++) {
		const struct rnea_joint *j = &x->info->joints[(turn + i) % count];

		if (strcmp(j->type, "prismatic") && strcmp(j->type, "floating"))
			return j->iq + j->nq - 1;
	}
	return 0;
}

static void set_q(const struct launch *x, const struct rnea_argument *a, void *array, int floating)
{
	for (size_t k = 0; k < x->count && floating; k++)
		for (size_t r = 3; r < 7; r++)
			set(a, array, place(x, a, r, k), r == 3 ? 0.6 : r == 6 ? 0.8 : 0);
	/* beyond what the sine of small angles is right for, as it happens to be far beyond what it is said to be for */
	for (size_t k = 5; k < x->count && !strcmp(x->info->trig, "accurate"); k += 8)
		set(a, array, place(x, a, angle_in_turn(x, k / 8), k), (a->scalar == RNEA_F64 ? 1e18 : 1e8) * (1 + (double)(k % 1000) / 1000));
}

struct launch launched_run(struct rnea_robot *robot, size_t count, unsigned seed, int floating)
{
	struct launch x = {robot, rnea_info(robot), count, NULL};
	struct rng rng = rng_seed(seed);
	struct rnea_error e;

	x.arrays = calloc(x.info->input_count + x.info->output_count, sizeof *x.arrays);
	for (size_t i = 0; i < x.info->input_count + x.info->output_count; i++) {
		const struct rnea_argument *a = &x.info->arguments[i];

		x.arrays[i] = calloc(a->rows * count, sizeof(double));
		for (size_t k = 0; k < a->rows * count; k++)
			set(a, x.arrays[i], k, i < x.info->input_count ? rng_uniform(&rng, -2, 2) : (double)NAN);
		if (!strcmp(a->name, "q"))
			set_q(&x, a, x.arrays[i], floating);
	}
	ck_assert_msg(!rnea_launch(robot, x.arrays, count, NULL, &e), "%s", e.message);
	return x;
}

void launched_drop(struct launch *x)
{
	for (size_t i = 0; i < x->info->input_count + x->info->output_count; i++)
		free(x->arrays[i]);
	free(x->arrays);
}

void launched_free(struct launch *x)
{
	launched_drop(x);
	rnea_close(x->robot);
}

static double distance(const struct launch *x, const struct launch *y, size_t i, size_t k, const char *what)
{
	const struct rnea_argument *a = &x->info->arguments[i];
	double most = 0, size = 0;

	for (size_t r = 0; r < a->rows; r++) {
		double p = launched_get(x, i, r, k), q = launched_get(y, i, r, k);

		ck_assert_msg(isfinite(p) && isfinite(q), "%s: %s[%zu] of sample %zu is %g, and %g", what, a->name, r, k, p, q);
		most = fmax(most, fabs(p - q));
		size = fmax(size, fabs(q));
	}
	return size > 0 ? most / size : most;
}

double launched_distance(const struct launch *x, const struct launch *y, const char *what)
{
	double worst = 0;

	for (size_t i = x->info->input_count; i < x->info->input_count + x->info->output_count; i++)
		for (size_t k = 0; k < x->count; k++)
			worst = fmax(worst, distance(x, y, i, k, what));
	return worst;
}
