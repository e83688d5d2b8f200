/* test_six SIX_TEXTS: the operations' texts, compiled through librnea on the host and on the pretended GPU, against dense
   6x6 algebra over the reference's own reading of the URDF. */
#define _POSIX_C_SOURCE 200809L
#include "support/process.h"
#include "reference/tree.h"
#include "support/urdf_text.h"
#include <check.h>
#include <rnea.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEED = 20261121, COUNT = 130, INPUTS = 7, OUTPUTS = 36 };

#define LIMIT 8 /* eps of the magnitudes that were summed */

static const char *six_texts;
static char folder[64];

static const char *const names[] = {"cross_operator", "mxS", "vxIv"};
static const char *const arrays[][3] = {{"v", "crm"}, {"v", "qd", "a"}, {"v", "f"}};
static const size_t rows[][3] = {{6, 36}, {6, 1, 6}, {6, 6}};

/* What the reference knows of the last body whose joint has an axis. */
struct subject {
	struct d6_vec axis;    /* S */
	struct d6_mat inertia; /* with all that is fixed to the link */
};

static void setup(void)
{
	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	setenv("RNEA_CACHE", "", 1);
	strcpy(folder, "/tmp/test_six_XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(folder));
	printf("seed %d\n", SEED);
}

static void path_of(int operation, const char *suffix, char path[128])
{
	snprintf(path, 128, "%s/%s_%s", folder, names[operation], suffix);
}

static void teardown(void)
{
	static const char *const suffixes[] = {"f32.cu", "f64.cu", "f32.c", "f64.c"};
	char path[128];

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++) {
			path_of(i, suffixes[k], path);
			unlink(path);
		}
	ck_assert_int_eq(rmdir(folder), 0);
}

/* ---- what is to come out ---- */

static int last_with_axis(const struct reference *r)
{
	for (int i = r->nj - 1; i >= 0; i--)
		if (r->joints[i].type == REFERENCE_REVOLUTE || r->joints[i].type == REFERENCE_CONTINUOUS ||
			r->joints[i].type == REFERENCE_PRISMATIC)
			return i;
	ck_abort_msg("the robot has no axis");
	return -1;
}

/* X^T I X of a fixed link, from its frame into that of the moving one */
static struct d6_mat carried(struct d6_mat inertia, struct d6_mat x)
{
	struct d6_mat ix = d6_mul(inertia, x), out = {0};

	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			for (int k = 0; k < 6; k++)
				out.m[i][j] += x.m[k][i] * ix.m[k][j];
	return out;
}

static struct subject subject_of(const struct reference *r)
{
	int top = last_with_axis(r);
	struct subject s = {.inertia = r->links[top].inertia};

	for (int i = 0; i < 3; i++)
		s.axis.x[(r->joints[top].type == REFERENCE_PRISMATIC ? 0 : 3) + i] = r->links[top].axis.x[i];
	for (int i = top + 1; i < r->nj; i++) {
		struct d6_mat x = r->links[i].tree, part;

		if (r->joints[i].body != r->joints[top].body)
			continue;
		for (int k = r->joints[i].parent; k != top; k = r->joints[k].parent)
			x = d6_mul(x, r->links[k].tree);
		part = carried(r->links[i].inertia, x);
		for (int k = 0; k < 36; k++)
			s.inertia.m[k / 6][k % 6] += part.m[k / 6][k % 6];
	}
	return s;
}

/* crm(v); crm(v) S qd; -crm(v)^T I v. With magnitudes in place of all numbers: the size of what is summed. */
static void compute(int operation, const struct subject *s, const double *in, int magnitudes, wide out[OUTPUTS])
{
	struct d6_vec v, axis = s->axis, result;
	struct d6_mat cross, inertia = s->inertia;

	for (int i = 0; i < 6; i++)
		v.x[i] = (wide)in[i];
	for (int i = 0; i < 6; i++)
		axis.x[i] *= (wide)in[6];
	cross = d6_cross(v);
	if (magnitudes) {
		v = d6_abs_vec(v);
		axis = d6_abs_vec(axis);
		cross = d6_abs(cross);
		inertia = d6_abs(inertia);
	}
	result = operation == 1 ? d6_apply(cross, axis) : d6_apply_transpose(cross, d6_apply(inertia, v));
	for (int i = 0; i < OUTPUTS; i++) {
		wide six = i < 6 ? result.x[i] : 0;

		out[i] = operation == 0 ? cross.m[i / 6][i % 6] : operation == 2 && !magnitudes ? -six : six;
	}
}

/* ---- a text against it ---- */

static void check_info(const struct rnea_robot *robot, int operation)
{
	const struct rnea_info *info = rnea_info(robot);
	size_t inputs = operation == 1 ? 2 : 1;

	ck_assert_uint_eq(info->input_count, inputs);
	ck_assert_uint_eq(info->output_count, 1);
	for (size_t i = 0; i <= inputs; i++) {
		ck_assert_str_eq(info->arguments[i].name, arrays[operation][i]);
		ck_assert_uint_eq(info->arguments[i].rows, rows[operation][i]);
	}
	ck_assert_uint_eq(rnea_argument_count(robot, "fpass"), 0);
	ck_assert_uint_eq(rnea_argument_count(robot, "bpass"), 0);
}

static double element(int f32, const void *array, size_t i)
{
	return f32 ? (double)((const float *)array)[i] : ((const double *)array)[i];
}

/* COUNT samples of random twists and rates, as a float holds them, through rnea_run; the largest error in eps. */
static double run_error(const struct rnea_robot *robot, int operation, const struct subject *s)
{
	static union { float f32[OUTPUTS * COUNT]; double f64[OUTPUTS * COUNT]; } in, out;
	int f32 = rnea_info(robot)->precision == RNEA_F32;
	size_t output_rows = rows[operation][operation == 1 ? 2 : 1];
	void *qd = f32 ? (void *)(in.f32 + 6 * COUNT) : (void *)(in.f64 + 6 * COUNT);
	void *two[] = {&in, &out}, *three[] = {&in, qd, &out};
	struct rng rng = rng_seed(SEED);
	struct rnea_error e;
	double worst = 0;

	for (size_t i = 0; i < INPUTS * COUNT; i++) {
		float x = (float)rng_uniform(&rng, -2, 2);

		if (f32)
			in.f32[i] = x;
		else
			in.f64[i] = (double)x;
	}
	memset(&out, 0xff, sizeof out); /* not a number */
	ck_assert_msg(!rnea_run(robot, operation == 1 ? three : two, COUNT, &e), "%s", e.message);
	for (size_t k = 0; k < COUNT; k++) {
		wide want[OUTPUTS], size[OUTPUTS];
		double sample[INPUTS];

		for (size_t i = 0; i < INPUTS; i++)
			sample[i] = element(f32, &in, i * COUNT + k);
		compute(operation, s, sample, 0, want);
		compute(operation, s, sample, 1, size);
		for (size_t i = 0; i < output_rows; i++) {
			double off = (double)wide_abs((wide)element(f32, &out, i * COUNT + k) - want[i]);
			double unit = (f32 ? 0x1p-23 : 0x1p-52) * (double)size[i];

			if (!(off <= worst * unit))
				worst = unit > 0 ? off / unit : (double)INFINITY;
		}
	}
	return worst;
}

static void check_text(
	int operation, const char *suffix, enum rnea_backend backend, const struct subject *s, const char *robot_name)
{
	struct rnea_options o = {.backend = backend};
	struct rnea_robot *robot;
	struct rnea_error e;
	char path[128];
	double worst;

	path_of(operation, suffix, path);
	ck_assert_msg(!rnea_open_file(path, &o, &robot, &e), "%s", e.message);
	check_info(robot, operation);
	worst = run_error(robot, operation, s);
	ck_assert_msg(worst <= LIMIT, "%s: %s_%s: %g eps of what is summed", robot_name, names[operation], suffix, worst);
	rnea_close(robot);
}

static struct subject write_texts(const char *name)
{
	char urdf[512], message[512];
	struct reference *r;
	struct subject s;
	struct process p;

	snprintf(urdf, sizeof urdf, TEST_DIR "/robots/%s.urdf", name);
	p = process_run((const char *const[]){six_texts, urdf, folder, NULL});
	ck_assert_msg(p.status == 0 && !*p.output, "%s: status %d: %s", name, p.status, p.output);
	process_free(&p);
	r = reference_open_file(urdf, NULL, message, sizeof message);
	ck_assert_msg(r != NULL, "%s", message);
	s = subject_of(r);
	reference_close(r);
	return s;
}

START_TEST(host)
{
	static const char *const robots[] = {"iiwa14", "hyq", "panda", "skew_axis", "prismatic_skew", "negative_axes",
		"rotated_inertial", "mimic_chain", "double_pendulum"};
	const char *name = robots[_i];
	struct subject s = write_texts(name);

	for (int i = 0; i < 3; i++) {
		check_text(i, "f32.c", RNEA_BACKEND_HOST, &s, name);
		check_text(i, "f64.c", RNEA_BACKEND_HOST, &s, name);
	}
}
END_TEST

START_TEST(cuda)
{
	struct subject s = write_texts("iiwa14");

	for (int i = 0; i < 3; i++) {
		check_text(i, "f32.cu", RNEA_BACKEND_CUDA, &s, "iiwa14");
		check_text(i, "f64.cu", RNEA_BACKEND_CUDA, &s, "iiwa14");
		check_text(i, "f64.cu", RNEA_BACKEND_HOST, &s, "iiwa14");
	}
}
END_TEST

static void assert_refused(const char *urdf, const char *says)
{
	struct process p = process_run((const char *const[]){six_texts, urdf, folder, NULL});

	ck_assert_int_eq(p.status, 1);
	ck_assert_msg(strstr(p.output, says) != NULL, "%s", p.output);
	process_free(&p);
}

START_TEST(refused)
{
	static const char urdf[] = ROBOT("puck",
		BARE("ground") BALL("puck") JOINT("slide", "planar", "ground", "puck", AXIS("0 0 1")));
	char path[128];
	FILE *f;

	path_of(0, "f32.c", path);
	assert_refused(path, "six_texts: /tmp/test_six_");
	f = fopen(path, "w");
	ck_assert(f && fputs(urdf, f) >= 0 && !fclose(f));
	assert_refused(path, "no joint has an axis: take a robot with one that turns or slides");
}
END_TEST

int main(int argc, char **argv)
{
	Suite *suite = suite_create("six");
	TCase *c = tcase_create("operations");
	SRunner *runner;
	int failed;

	if (argc != 2)
		return 2;
	six_texts = argv[1];
	tcase_set_timeout(c, 300);
	tcase_add_checked_fixture(c, setup, teardown);
	tcase_add_loop_test(c, host, 0, 9);
	tcase_add_test(c, cuda);
	tcase_add_test(c, refused);
	suite_add_tcase(suite, c);
	runner = srunner_create(suite);
	srunner_run_all(runner, CK_ENV);
	failed = srunner_ntests_failed(runner);
	srunner_free(runner);
	return failed != 0;
}
