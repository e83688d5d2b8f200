/* Where the elements of a packed matrix stand, as a host is told: put back by that, they are the full matrix to the bit. On
   the host and on the pretended driver; and the arrays of C texts say the same. */
#define _POSIX_C_SOURCE 200809L
#include "urdf.h"
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/rng.h"
#include "support/suite.h"
#include "target/target.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 5, SEED = 20261122 };

/* Joints on several branches, a floating base and a driver with followers, all on one chain; --strict: the same bits from
   two texts. */
static const struct subject {
	const char *name, *wants;
	int floating;
	size_t matrices;
	enum rneagen_layout layout; /* not staged: both kernels store the zeros of the full matrix in a loop */
	int limbs;                  /* warps of the kernel of small batches, which this batch takes; 0: there is none */
} SUBJECTS[] = {
	{"hyq", "free payload.lf_lowerleg\nwant tau,M,dtau_dq,dtau_dqd,dtau_dpayload.lf_lowerleg\n", 0, 4, RNEAGEN_AOS, 0},
	{"hyq", "want M,dtau_dqd\n", 0, 2, RNEAGEN_SOA, 0},
	{"hyq", "want M,dtau_dqd\n", 0, 2, RNEAGEN_SOA, 4},
	{"hyq", "want M,dtau_dqd\n", 0, 2, RNEAGEN_AOS, 4},
	{"mimic_chain", "want dtau_dqd,M,dtau_dq\n", 1, 3, RNEAGEN_AOS, 0},
	{"double_pendulum", "want dtau_dq,jvp,M\n", 0, 2, RNEAGEN_AOS, 0},
	{"hyq", "want qdd,Minv,dqdd_dqd\ndynamics factor\n", 0, 2, RNEAGEN_AOS, 0},
	{"mimic_chain", "want tau,regressor,M\n", 1, 2, RNEAGEN_AOS, 0},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

static const char *path_of(const struct subject *s)
{
	static char path[512];

	snprintf(path, sizeof path, "%s/robots/%s.urdf", TEST_DIR, s->name);
	return path;
}

static struct rneagen_options options_of(const struct subject *s, int dense, char *scene, size_t size)
{
	struct rneagen_options o = rneagen_options_default();

	snprintf(scene, size, "%s%s", s->wants, dense ? "dense\n" : "");
	o.scene = scene;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.precision = RNEAGEN_F64;
	o.layout = s->layout;
	o.strict = 1;
	o.tell = RNEAGEN_TELL_JSON;
	return o;
}

static struct rnea_robot *open_robot(const struct subject *s, int dense, enum rnea_backend backend)
{
	char scene[512];
	struct rneagen_options g = options_of(s, dense, scene, sizeof scene);
	struct rnea_options o = {.backend = backend, .threads = 1};
	struct rnea_robot *robot;
	struct rnea_error e;

	g.limbs = s->limbs ? s->limbs : RNEAGEN_LIMBS_NONE;
	if (s->layout == RNEAGEN_SOA)
		g.parts = 2; /* each stores its share of the zeros */
	ck_assert_msg(!rnea_open_urdf(path_of(s), &g, &o, &robot, &e), "%s", e.message);
	return robot;
}

static size_t array_count(const struct rnea_info *info)
{
	return info->input_count + info->output_count;
}

/* [row][sample] to [sample][row] */
static void transpose(double *x, size_t rows)
{
	double *y = malloc(COUNT * rows * sizeof *y);

	for (size_t k = 0; k < COUNT * rows; k++)
		y[k % COUNT * rows + k / COUNT] = x[k];
	memcpy(x, y, COUNT * rows * sizeof *y);
	free(y);
}

/* All arrays of the robot by sample, the inputs by the seed; what is not written stays nan. */
static double **run(const struct rnea_robot *robot)
{
	const struct rnea_info *info = rnea_info(robot);
	double **x = calloc(array_count(info), sizeof *x);
	struct rng rng = rng_seed(SEED);
	struct rnea_error e;

	for (size_t i = 0; i < array_count(info); i++) {
		x[i] = calloc(COUNT, info->arguments[i].rows * sizeof **x);
		for (size_t k = 0; k < COUNT * info->arguments[i].rows; k++)
			x[i][k] = i < info->input_count ? rng_uniform(&rng, -2, 2) : (double)NAN;
	}
	ck_assert_msg(!rnea_run(robot, (void **)x, COUNT, &e), "%s", e.message);
	for (size_t i = 0; i < array_count(info) && info->layout == RNEA_SOA; i++)
		transpose(x[i], info->arguments[i].rows);
	return x;
}

static void release(double **x, struct rnea_robot *robot)
{
	for (size_t i = 0; i < array_count(rnea_info(robot)); i++)
		free(x[i]);
	free(x);
	rnea_close(robot);
}

/* Every element of one sample, in its place. */
static double *unpack(const struct rnea_info *info, const struct rnea_matrix *m, const double *array, size_t sample)
{
	size_t count = info->arguments[m->argument].rows;
	double *full = calloc(m->rows * m->cols, sizeof *full);

	for (size_t k = 0; k < count; k++) {
		size_t i = (size_t)m->row[k], j = (size_t)m->col[k];

		full[i * m->cols + j] = array[sample * count + k];
		if (m->lower)
			full[j * m->cols + i] = array[sample * count + k];
	}
	return full;
}

/* Returns how many elements the packed matrix leaves out. */
static size_t compare(const struct rnea_info *packed, double *const *x, const struct rnea_info *dense, double *const *y, size_t i)
{
	const struct rnea_matrix *m = &packed->matrices[i], *n = &dense->matrices[i];
	size_t size = m->rows * m->cols;

	ck_assert_str_eq(packed->arguments[m->argument].name, dense->arguments[n->argument].name);
	ck_assert(n->rows == m->rows && n->cols == m->cols && m->rows == packed->nv && !n->lower);
	ck_assert_uint_eq(dense->arguments[n->argument].rows, size);
	ck_assert_int_eq(m->lower, packed->arguments[m->argument].name[0] == 'M');
	for (size_t k = 0; k < COUNT; k++) {
		double *full = unpack(packed, m, x[m->argument], k), *same = unpack(dense, n, y[n->argument], k);

		ck_assert(!memcmp(same, y[n->argument] + k * size, size * sizeof *same)); /* row by row */
		for (size_t j = 0; j < size; j++)
			ck_assert_msg(full[j] == same[j], "%s: %s[%zu][%zu] is %a, of the full matrix %a", packed->name,
				packed->arguments[m->argument].name, j / m->cols, j % m->cols, full[j], same[j]);
		free(full);
		free(same);
	}
	return size - packed->arguments[m->argument].rows;
}

START_TEST(test_unpacked)
{
	const struct subject *s = &SUBJECTS[_i / 2];
	enum rnea_backend backend = _i % 2 ? RNEA_BACKEND_CUDA : RNEA_BACKEND_HOST;

	if (!exhaustive() && backend != (_i / 2 < 4 || _i / 2 % 2 ? RNEA_BACKEND_CUDA : RNEA_BACKEND_HOST))
		return; /* by one of them in turn; the first four have loops of zeros, and kernels of small batches, on the GPU alone */
	struct rnea_robot *packed = open_robot(s, 0, backend), *dense = open_robot(s, 1, backend);
	double **x = run(packed), **y = run(dense);
	const struct rnea_info *info = rnea_info(packed);
	size_t left_out = 0;

	ck_assert_uint_eq(info->matrix_count, s->matrices);
	ck_assert_uint_eq(rnea_info(dense)->matrix_count, info->matrix_count);
	for (size_t i = 0; i < info->matrix_count; i++)
		left_out += compare(info, x, rnea_info(dense), y, i);
	printf("%s on %s: %zu elements left out, seed %d\n", s->name, _i % 2 ? "the pretended GPU" : "the host", left_out, SEED);
	ck_assert_uint_gt(left_out, 0);
	release(x, packed);
	release(y, dense);
}
END_TEST

/* The array that a C text calls NAME_MATRIX_WORD. */
static const int *numbers_of(void *library, const struct rnea_info *info, const struct rnea_matrix *m, const char *word)
{
	char name[600];
	const int *numbers;

	snprintf(name, sizeof name, "%s_%s_%s", info->name, info->arguments[m->argument].name, word);
	numbers = dlsym(library, name);
	ck_assert_msg(numbers != NULL, "no %s", name);
	return numbers;
}

/* The member "row" or "col" of --info=json, without spaces. */
static void put_numbers(const int *numbers, size_t count, const char *word, char *to)
{
	to += sprintf(to, "\"%s\":[", word);
	for (size_t k = 0; k < count; k++)
		to += sprintf(to, k ? ",%d" : "%d", numbers[k]);
	sprintf(to, "]");
}

static void remove_spaces(char *s)
{
	char *to = s;

	for (; *s; s++)
		if (*s != ' ' && *s != '\n')
			*to++ = *s;
	*to = '\0';
}

static void check_json(const char *text, const struct rnea_info *info, const struct rnea_matrix *m)
{
	char *json = strdup(text), *row = malloc(1 << 16), *col = malloc(1 << 16), *want = malloc(1 << 17);
	size_t count = info->arguments[m->argument].rows;

	remove_spaces(json);
	put_numbers(m->row, count, "row", row);
	put_numbers(m->col, count, "col", col);
	sprintf(want, "\"%s\":{\"shape\":[%zu,%zu],\"lower\":%s,%s,%s}", info->arguments[m->argument].name, m->rows, m->cols,
		m->lower ? "true" : "false", row, col);
	ck_assert_msg(strstr(json, want) != NULL, "%s lacks %s", json, want);
	free(json);
	free(row);
	free(col);
	free(want);
}

/* The text for target c, beside its header, or for target cuda compiled as C. */
static void *compile(const struct subject *s, enum rneagen_target target, struct target *t)
{
	char scene[512];
	struct rneagen_options o = options_of(s, 0, scene, sizeof scene);
	struct target_path text = target_path(s->name, target == RNEAGEN_TARGET_C ? "_matrices.c" : "_matrices.cu");
	struct target_path object = target_path(s->name, "_matrices.so");
	size_t length;
	char *urdf = read_file(path_of(s), &length);
	const char *const command[] = {
		"cc", "-std=c11", "-x", "c", WARNING_FLAGS, "-shared", "-fPIC", "-o", object.s, text.s, "-lm", NULL};
	void *library;

	ck_assert_ptr_nonnull(urdf);
	o.target = target;
	target_generate(t, urdf, length, &o, s->name);
	free(urdf);
	target_write(text, t->text.source);
	target_compile(t, command);
	library = dlopen(object.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(library != NULL, "%s", dlerror());
	if (target == RNEAGEN_TARGET_C)
		ck_assert_ptr_nonnull(strstr(t->text.header, strstr(s->wants, "Minv") ? "_Minv_row[" : "_M_row["));
	remove(text.s);
	remove(object.s);
	return library;
}

START_TEST(test_arrays)
{
	const struct subject *s = &SUBJECTS[_i / 2];
	struct target t = {.what = "matrices"};
	struct rnea_robot *robot;
	const struct rnea_info *info;
	void *library;

	if (!exhaustive() && _i % 2 != _i / 2 % 2)
		return; /* of one target in turn */
	library = compile(s, _i % 2 ? RNEAGEN_TARGET_CUDA : RNEAGEN_TARGET_C, &t);
	robot = open_robot(s, 0, RNEA_BACKEND_HOST);
	info = rnea_info(robot);
	for (size_t i = 0; i < info->matrix_count; i++) {
		const struct rnea_matrix *m = &info->matrices[i];
		size_t bytes = info->arguments[m->argument].rows * sizeof(int);

		ck_assert(!memcmp(numbers_of(library, info, m, "row"), m->row, bytes));
		ck_assert(!memcmp(numbers_of(library, info, m, "col"), m->col, bytes));
		check_json(t.text.info_json, info, m);
	}
	rneagen_result_free(&t.text);
	dlclose(library);
	rnea_close(robot);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("matrices");
	TCase *c = tcase_create("matrices");

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	setenv("RNEA_CACHE", "", 1);
	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_loop_test(c, test_unpacked, 0, 2 * SUBJECT_COUNT);
	tcase_add_loop_test(c, test_arrays, 0, 2 * SUBJECT_COUNT);
	suite_add_tcase(s, c);
	return suite_run(s);
}
