/* Texts as rneagen writes them, target c and target cuda, through the public functions and against the reference. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include "reference/reference.h"
#include "support/exhaustive.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 21, MOST = 2049, ROWS_MOST = 256, ARRAYS = 6 };

static const char *const texts[] = {"iiwa14.c", "iiwa14.cu", "ur5.c", "ur5.cu", "hyq.c", "hyq.cu"};

/* One robot on one, two and seven threads, and the arrays of its kernels: q, qd, qdd, v, a, f in `in`, results of each
   number of threads in `out`. */
struct bench {
	struct rnea_robot *robots[3];
	const struct rnea_info *info;
	struct reference *reference;
	char *in[ARRAYS], *out[3][3];
};

static void bench_open(struct bench *b, const char *text)
{
	static const unsigned threads[] = {1, 2, 7};
	struct reference_options options = {0};
	char path[300], message[300];
	struct rnea_error e;

	snprintf(path, sizeof path, TEST_DIR "/../generated/%s", text);
	for (int t = 0; t < 3; t++) {
		struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .threads = threads[t], .cache = inside("cache")};

		ck_assert_msg(rnea_open_file(path, &o, &b->robots[t], &e) == RNEA_OK, "%s", e.message);
		ck_assert_int_eq(rnea_build(b->robots[t])->cached, t > 0);
	}
	b->info = rnea_info(b->robots[0]);
	snprintf(path, sizeof path, TEST_DIR "/robots/%.*s.urdf", (int)strcspn(text, "."), text);
	options.floating = strcmp(b->info->base, "floating") == 0;
	b->reference = reference_open_file(path, &options, message, sizeof message);
	ck_assert_msg(b->reference != NULL, "%s", message);
	for (int i = 0; i < ARRAYS; i++)
		b->in[i] = calloc(MOST * ROWS_MOST, sizeof(double));
	for (int i = 0; i < 9; i++)
		b->out[i / 3][i % 3] = calloc(MOST * ROWS_MOST, sizeof(double));
}

static void bench_close(struct bench *b)
{
	for (int t = 0; t < 3; t++)
		rnea_close(b->robots[t]);
	for (int i = 0; i < ARRAYS; i++)
		free(b->in[i]);
	for (int i = 0; i < 9; i++)
		free(b->out[i / 3][i % 3]);
	reference_close(b->reference);
}

/* Row `row` of sample `k`, in the layout and the type of the text. */
static void *element(const struct bench *b, char *array, size_t rows, size_t row, size_t k, size_t count)
{
	size_t index = b->info->layout == RNEA_SOA ? row * count + k : k * rows + row;

	return array + index * (b->info->precision == RNEA_F64 ? sizeof(double) : sizeof(float));
}

static double get(const struct bench *b, char *array, size_t rows, size_t row, size_t k, size_t count)
{
	void *at = element(b, array, rows, row, k, count);

	return b->info->precision == RNEA_F64 ? *(double *)at : (double)*(float *)at;
}

static void put(const struct bench *b, int array, size_t rows, size_t k, size_t count, const double *values)
{
	for (size_t row = 0; row < rows; row++) {
		void *at = element(b, b->in[array], rows, row, k, count);

		if (b->info->precision == RNEA_F64)
			*(double *)at = values[row];
		else
			*(float *)at = (float)values[row];
	}
}

/* The same states in every batch of one size; the wrenches of bpass are random numbers. Some angles are large, so that
   a slice of 256 holds samples of both kinds. */
static void fill(const struct bench *b, size_t count)
{
	struct rng rng = rng_seed(SEED);
	double x[3][ROWS_MOST], f[ROWS_MOST];

	for (size_t k = 0; k < count; k++) {
		reference_sample(b->reference, &rng, b->info->precision == RNEA_F32, x[0], x[1], x[2]);
		if (k % 400 == 130)
			x[0][0] = 0x1p20;
		for (int i = 0; i < 3; i++)
			put(b, i, i ? b->info->nv : b->info->nq, k, count, x[i]);
		for (size_t row = 0; row < 6 * b->info->nb; row++)
			f[row] = rng_uniform(&rng, -9, 9);
		put(b, 5, 6 * b->info->nb, k, count, f);
	}
}

/* All of a small batch, every tenth sample of a large one. */
static void assert_torques_of(const struct bench *b, size_t count)
{
	double most = b->info->precision == RNEA_F64 ? 3e-15 : 2e-6, x[3][ROWS_MOST], tau[ROWS_MOST], error;
	wide right[ROWS_MOST];

	for (size_t k = 0; k<count; k += count> 300 ? 10 : 1) {
		for (int i = 0; i < 3; i++)
			for (size_t row = 0; row < (i ? b->info->nv : b->info->nq); row++)
				x[i][row] = get(b, b->in[i], i ? b->info->nv : b->info->nq, row, k, count);
		for (size_t row = 0; row < b->info->nv; row++)
			tau[row] = get(b, b->out[0][0], b->info->nv, row, k, count);
		reference_rnea(b->reference, x[0], x[1], x[2], right);
		error = reference_error(tau, right, (int)b->info->nv);
		ck_assert_msg(error <= most, "sample %zu of %zu, seed %d: error %g", k, count, SEED, error);
	}
}

/* One kernel with each number of threads gives the same bits. */
static void run_kernel(struct bench *b, const char *function, size_t count)
{
	size_t size = MOST * ROWS_MOST * sizeof(double);
	struct rnea_error e;

	for (int t = 0; t < 3; t++) {
		char **out = b->out[t];
		void *forward[ARRAYS] = {b->in[0], b->in[1], b->in[2], out[0], out[1], out[2]},
			*backward[] = {b->in[0], b->in[5], out[0]};
		void **list = strcmp(function, "bpass") ? forward : backward; /* those of rnea are the first of fpass */

		for (int i = 0; i < 3; i++)
			memset(out[i], 0x77, size);
		ck_assert_msg(rnea_launch_kernel(b->robots[t], function, list, count, NULL, &e) == RNEA_OK, "%s",
			e.message);
		for (int i = 0; i < 3; i++)
			ck_assert_msg(memcmp(out[i], b->out[0][i], size) == 0,
				"%s, %zu samples, robot %d, array %d", function, count, t, i);
	}
}

START_TEST(generated)
{
	static const size_t counts[] = {0, 1, 255, 256, 257, 512, 513, 1025, MOST};
	struct bench b;

	/* of each robot both texts where all is asked for, else one, the kinds in turn; under the sanitizers one of each kind */
	if ((!exhaustive() && _i % 2 != _i / 2 % 2) || (sanitized() && _i > 3))
		return;
	bench_open(&b, texts[_i]);
	ck_assert_uint_le(6 * b.info->nb, ROWS_MOST);
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		fill(&b, counts[c]);
		run_kernel(&b, "fpass", counts[c]);
		run_kernel(&b, "bpass", counts[c]);
		run_kernel(&b, "rnea", counts[c]);
		assert_torques_of(&b, counts[c]);
	}
	bench_close(&b);
}
END_TEST

Suite *suite_host_texts(void)
{
	Suite *s = suite_create("host: texts");
	TCase *t = tcase_create("host: texts");

	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_set_timeout(t, 120);
	tcase_add_loop_test(t, generated, 0, sizeof texts / sizeof *texts);
	suite_add_tcase(s, t);
	return s;
}
