/* The text whose time is the floor of rnearun report's: it reads every number once and writes every one once, whatever
   arrays there are. So the outputs of a sample add up to its inputs and what all samples share; and where the arrays are
   q, qd, qdd and tau it is their sum. On this machine's processor and on the pretended GPU. */
#define _POSIX_C_SOURCE 200809L
#include "study/floor.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 1000, SEED = 20261121, ARRAYS = 8 };

static const struct argument CASES[][ARRAYS] = {
	{{.name = "q", .rows = 7}, {.name = "qd", .rows = 7}, {.name = "qdd", .rows = 7},
		{.name = "tau", .rows = 7, .is_output = 1}},
	{{.name = "q", .rows = 13}, {.name = "qd", .rows = 12}, {.name = "qdd", .rows = 12},
		{.name = "tau", .rows = 12, .is_output = 1}},
	{{.name = "q", .rows = 7}, {.name = "tau", .rows = 7, .is_output = 1},
		{.name = "power", .rows = 1, .is_output = 1}, {.name = "twist_hand", .rows = 6, .is_output = 1}},
	{{.name = "q", .rows = 3}, {.name = "payload_hand", .rows = 10}, {.name = "gravity", .rows = 3, .per_batch = 1},
		{.name = "tau", .rows = 3, .is_output = 1}, {.name = "power", .rows = 1, .is_output = 1}},
	{{.name = "inertia_hand", .rows = 10, .per_batch = 1}, {.name = "q", .rows = 2},
		{.name = "fext_foot", .rows = 6}, {.name = "wrench_a", .rows = 6, .is_output = 1},
		{.name = "wrench_b", .rows = 6, .is_output = 1}},
	{{.name = "gravity", .rows = 3, .per_batch = 1}, {.name = "tau", .rows = 2, .is_output = 1}},
	{{.name = "tau", .rows = 5, .is_output = 1}},
};

enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

static int array_count(const struct argument *a)
{
	int n = 0;

	while (n < ARRAYS && a[n].name)
		n++;
	return n;
}

static struct rnea_robot *open_floor(const struct argument *arrays, enum rnea_scalar scalar, enum rnea_backend backend)
{
	struct rnea_options o = {.backend = backend, .threads = 3};
	struct rnea_robot *robot;
	struct rnea_error e;
	struct arena a;
	struct text t;

	arena_init(&a, NULL);
	text_init(&t, &a);
	floor_text(arrays, array_count(arrays), scalar, &t);
	ck_assert(!t.failed);
	ck_assert_msg(!rnea_open(text_string(&t), t.length, &o, &robot, &e), "%s in\n%s", e.message, text_string(&t));
	arena_free(&a);
	return robot;
}

static size_t sample_count(const struct argument *a)
{
	return a->per_batch ? 1 : COUNT;
}

/* Numbers of 2^-8 in soa: sums are exact in either precision. */
static void *make_array(const struct argument *a, enum rnea_scalar scalar, struct rng *rng)
{
	size_t n = (size_t)a->rows * sample_count(a);
	double *x = malloc(n * sizeof *x);
	float *y = (float *)x;

	for (size_t i = 0; i < n; i++) {
		double value = a->is_output ? (double)NAN : floor(rng_uniform(rng, -256, 256)) / 256;

		if (scalar == RNEA_F64)
			x[i] = value;
		else
			y[i] = (float)value;
	}
	return x;
}

static double number(const void *array, enum rnea_scalar scalar, size_t at)
{
	return scalar == RNEA_F64 ? ((const double *)array)[at] : (double)((const float *)array)[at];
}

/* Of all rows of an array in sample k. */
static double sum(const struct argument *a, const void *array, enum rnea_scalar scalar, size_t k)
{
	double s = 0;

	for (size_t r = 0; r < (size_t)a->rows; r++)
		s += number(array, scalar, a->per_batch ? r : r * COUNT + k);
	return s;
}

static void check(const struct argument *arrays, void *const *data, enum rnea_scalar scalar)
{
	for (size_t k = 0; k < COUNT; k++) {
		double in = 0, out = 0;

		for (int i = 0; i < array_count(arrays); i++)
			*(arrays[i].is_output ? &out : &in) += sum(&arrays[i], data[i], scalar, k);
		ck_assert_msg(in == out, "sample %zu: %g in, %g out, seed %d", k, in, out, SEED);
	}
}

static void check_case(const struct argument *arrays, enum rnea_scalar scalar, enum rnea_backend backend)
{
	struct rnea_robot *robot = open_floor(arrays, scalar, backend);
	const struct rnea_info *info = rnea_info(robot);
	struct rng rng = rng_seed(SEED);
	void *data[ARRAYS];
	struct rnea_error e;

	for (int i = 0; i < array_count(arrays); i++) {
		ck_assert_str_eq(info->arguments[i].name, arrays[i].name);
		ck_assert_int_eq(info->arguments[i].per_batch, arrays[i].per_batch);
		data[i] = make_array(&arrays[i], scalar, &rng);
	}
	ck_assert_msg(!rnea_run(robot, data, COUNT, &e), "%s", e.message);
	check(arrays, data, scalar);
	for (int i = 0; i < array_count(arrays); i++)
		free(data[i]);
	rnea_close(robot);
}

START_TEST(test_sums)
{
	check_case(CASES[_i / 4], _i % 2 ? RNEA_F64 : RNEA_F32, _i / 2 % 2 ? RNEA_BACKEND_CUDA : RNEA_BACKEND_HOST);
}
END_TEST

/* q + qd + qdd by element. */
START_TEST(test_plain)
{
	struct rnea_robot *robot = open_floor(CASES[0], RNEA_F64, RNEA_BACKEND_HOST);
	double q[7], tau[7], hundred[7], zero[7] = {0};

	for (int i = 0; i < 7; i++) {
		q[i] = i;
		hundred[i] = 100;
	}
	ck_assert(!rnea_run(robot, (void *[]){q, hundred, zero, tau}, 1, NULL));
	for (int i = 0; i < 7; i++)
		ck_assert(tau[i] == 100 + i);
	rnea_close(robot);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("floor");
	TCase *c = tcase_create("floor");

	setenv("RNEA_CACHE", "", 1);
	tcase_set_timeout(c, 60);
	tcase_add_loop_test(c, test_sums, 0, 4 * CASE_COUNT);
	tcase_add_test(c, test_plain);
	suite_add_tcase(s, c);
	return suite_run(s);
}
