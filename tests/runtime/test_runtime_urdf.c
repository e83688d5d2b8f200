/* rnea_open_urdf, on the pretended driver and NVRTC, on the host and by the evaluator: torques of rnea_run and
   rnea_run_aos against the reference, errors, and robots and files with names that mean something to a shell, to C or
   to a comment. */
#define _GNU_SOURCE
#include "urdf.h"
#include "reference/reference.h"
#include <check.h>
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { COUNT = 300, SEED = 20261121 };

static void use_fakes(void)
{
	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	setenv("RNEA_CACHE", "", 1);
}

static struct reference *open_reference(const char *path, int floating)
{
	struct reference_options o = {.floating = floating};
	char message[512];
	struct reference *r = reference_open_file(path, &o, message, sizeof message);

	ck_assert_msg(r != NULL, "%s", message);
	return r;
}

/* Element (k, row) of an array of either scalar and layout. */
static void put(const struct rnea_info *info, int is_aos, void *array, size_t rows, size_t k, size_t row, double value)
{
	size_t at = is_aos ? k * rows + row : row * COUNT + k;

	if (info->precision == RNEA_F64)
		((double *)array)[at] = value;
	else
		((float *)array)[at] = (float)value;
}

static double get(const struct rnea_info *info, int is_aos, const void *array, size_t rows, size_t k, size_t row)
{
	size_t at = is_aos ? k * rows + row : row * COUNT + k;

	return info->precision == RNEA_F64 ? ((const double *)array)[at] : (double)((const float *)array)[at];
}

/* The largest error of `run` over COUNT states, as the reference has it. */
static double run_error(const struct rnea_robot *robot, struct reference *r, int turned)
{
	const struct rnea_info *info = rnea_info(robot);
	int is_aos = turned || info->layout == RNEA_AOS;
	struct rng rng = rng_seed(SEED);
	void *arrays[4];
	double q[64], qd[64], qdd[64], got[64], worst = 0;
	wide tau[64];
	struct rnea_error e;

	ck_assert(info->nq == (size_t)r->nq && info->nv == (size_t)r->nv && info->nq < 64);
	for (int i = 0; i < 4; i++)
		arrays[i] = calloc(COUNT * 64, sizeof(double));
	for (size_t k = 0; k < COUNT; k++) {
		reference_sample(r, &rng, info->precision == RNEA_F32, q, qd, qdd);
		for (size_t row = 0; row < info->nq; row++)
			put(info, is_aos, arrays[0], info->nq, k, row, q[row]);
		for (size_t row = 0; row < info->nv; row++) {
			put(info, is_aos, arrays[1], info->nv, k, row, qd[row]);
			put(info, is_aos, arrays[2], info->nv, k, row, qdd[row]);
		}
	}
	ck_assert_msg(!(turned ? rnea_run_aos : rnea_run)(robot, arrays, COUNT, &e), "%s", e.message);
	rng = rng_seed(SEED);
	for (size_t k = 0; k < COUNT; k++) {
		reference_sample(r, &rng, info->precision == RNEA_F32, q, qd, qdd);
		reference_rnea(r, q, qd, qdd, tau);
		for (size_t row = 0; row < info->nv; row++)
			got[row] = get(info, is_aos, arrays[3], info->nv, k, row);
		worst = fmax(worst, reference_error(got, tau, r->nv));
	}
	for (int i = 0; i < 4; i++)
		free(arrays[i]);
	return worst;
}

static const struct {
	const char *file;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum rneagen_base base;
	double most;
} robots[] = {
	{"panda", RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_FIXED, 2e-5},
	{"panda", RNEAGEN_F64, RNEAGEN_AOS, RNEAGEN_FIXED, 1e-13},
	{"panda", RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_FLOATING, 1e-13},
	{"pendulum", RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_FIXED, 1e-5},
};

/* On the pretended device, on the host and by the evaluator; the host also with arrays that it turns. */
START_TEST(computes)
{
	static const enum rnea_backend backends[] = {RNEA_BACKEND_CUDA, RNEA_BACKEND_HOST, RNEA_BACKEND_EVALUATOR};
	struct rneagen_options g = rneagen_options_default();
	struct rnea_options o = {.backend = backends[_i % 3]};
	char path[512];
	struct rnea_robot *robot;
	struct rnea_error e;
	struct reference *r;
	double error;

	use_fakes();
	snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", robots[_i / 3].file);
	g.precision = robots[_i / 3].precision;
	g.layout = robots[_i / 3].layout;
	g.base = robots[_i / 3].base;
	ck_assert_msg(rnea_open_urdf(path, &g, &o, &robot, &e) == RNEA_OK, "%s", e.message);
	ck_assert_int_eq(rnea_build(robot)->backend, o.backend);
	r = open_reference(path, g.base == RNEAGEN_FLOATING);
	error = run_error(robot, r, 0);
	if (o.backend == RNEA_BACKEND_HOST)
		error = fmax(error, run_error(robot, r, 1));
	printf("%s: error %.2g, seed %d\n", robots[_i / 3].file, error, SEED);
	ck_assert_double_lt(error, robots[_i / 3].most);
	reference_close(r);
	rnea_close(robot);
}
END_TEST

/* tau = I qdd + m g l sin(q) of the pendulum, whose reference is asked. */
static double torque(struct reference *r, double q)
{
	wide tau[1];

	reference_rnea(r, &q, (double[]){0}, (double[]){0}, tau);
	return (double)tau[0];
}

/* The evaluator's torque at rest; in f32 and mixed q and tau are floats. */
static double evaluated(const struct rneagen_options *g, double q)
{
	struct rnea_options o = {.backend = RNEA_BACKEND_EVALUATOR};
	double wide_rows[4] = {q};
	float rows[4] = {(float)q};
	void *arrays[4];
	struct rnea_robot *robot;
	struct rnea_error e;
	double tau;

	ck_assert_msg(!rnea_open_urdf(TEST_DIR "/robots/pendulum.urdf", g, &o, &robot, &e), "%s", e.message);
	for (int i = 0; i < 4; i++)
		arrays[i] = rnea_info(robot)->precision == RNEA_F32 ? (void *)&rows[i] : (void *)&wide_rows[i];
	ck_assert_msg(!rnea_run(robot, arrays, 1, &e), "%s", e.message);
	tau = rnea_info(robot)->precision == RNEA_F32 ? (double)rows[3] : wide_rows[3];
	rnea_close(robot);
	return tau;
}

/* Would catch an evaluator that goes on where the text's sine and cosine are NAN: beyond 1e4 rad, in f64 1e7. */
START_TEST(beyond_the_domain)
{
	static const struct {
		enum rneagen_precision precision;
		double most, off;
	} cases[] = {{RNEAGEN_F32, 1e4, 1e-5}, {RNEAGEN_F32X2, 1e4, 1e-12}, {RNEAGEN_MIXED, 1e7, 1e-6},
		{RNEAGEN_F64, 1e7, 1e-14}};
	static const enum rneagen_trig trigs[] = {RNEAGEN_BOUNDED, RNEAGEN_FAST, RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE};
	struct rneagen_options g = rneagen_options_default();
	enum rneagen_trig trig = trigs[_i % 4];
	struct reference *r = open_reference(TEST_DIR "/robots/pendulum.urdf", 0);
	double most = cases[_i / 4].most, off = cases[_i / 4].off;

	use_fakes();
	g.precision = cases[_i / 4].precision;
	g.trig = trig;
	g.scene = trig == RNEAGEN_TRIG_AUTO ? "range q=-3,3" : NULL; /* bounded, then */
	for (int sign = -1; sign <= 1; sign += 2) {
		ck_assert_double_eq_tol(evaluated(&g, sign * most), torque(r, sign * most), off * fabs(torque(r, M_PI / 2)));
		if (trig == RNEAGEN_ACCURATE)
			ck_assert_double_eq_tol(
				evaluated(&g, 4 * sign * most), torque(r, 4 * sign * most), off * fabs(torque(r, M_PI / 2)));
		else
			ck_assert(isnan(evaluated(&g, sign * (most + 2))) && isnan(evaluated(&g, 30 * sign * most)));
	}
	ck_assert(isnan(evaluated(&g, (double)INFINITY)) && isnan(evaluated(&g, (double)NAN)));
	reference_close(r);
}
END_TEST

/* A processor gains nothing from parts: only who asks for them has them there. */
START_TEST(parts)
{
	static const struct {
		enum rnea_backend backend;
		unsigned asked, has;
	} cases[] = {{RNEA_BACKEND_CUDA, RNEAGEN_PARTS_AUTO, 2}, {RNEA_BACKEND_HOST, RNEAGEN_PARTS_AUTO, 1},
		{RNEA_BACKEND_HOST, 3, 3}};
	static const char *const quickly[] = {"-O0"};
	struct rneagen_options g = rneagen_options_default();
	struct rnea_options o = {.backend = cases[_i].backend};
	struct rnea_robot *robot;
	struct rnea_error e;

	use_fakes();
	if (o.backend == RNEA_BACKEND_HOST) {
		o.compile = quickly;
		o.compile_count = 1;
	}
	g.precision = RNEAGEN_F64;
	g.scene = "want tau,dtau_dq,dtau_dqd";
	g.parts = (int)cases[_i].asked;
	ck_assert_msg(!rnea_open_urdf(TEST_DIR "/robots/panda.urdf", &g, &o, &robot, &e), "%s", e.message);
	ck_assert_uint_eq(rnea_info(robot)->parts, cases[_i].has);
	rnea_close(robot);
}
END_TEST

static void assert_error(const struct rnea_error *e, enum rnea_code code, const char *part)
{
	ck_assert_msg(e->code == code, "code %d where %d is right: %s", (int)e->code, (int)code, e->message);
	ck_assert_msg(strstr(e->message, part) != NULL, "\"%s\" is not in \"%s\"", part, e->message);
	ck_assert_ptr_null(strchr(e->message, '\n'));
}

static int compute_nothing(void *context, void *const *arrays, size_t count, size_t first, size_t end)
{
	(void)context, (void)arrays, (void)count, (void)first, (void)end;
	return 1;
}

/* What goes without a compiler is refused where something is missing; arrays are turned on the host alone. */
START_TEST(evaluator_errors)
{
	static const char cut[] = "RNEA_INFO const char a_info[] = \"ab\\";
	static const struct rnea_evaluator nothing = {0}, some = {.evaluate = compute_nothing};
	struct rnea_options o = {.backend = RNEA_BACKEND_EVALUATOR}, cuda = {.backend = RNEA_BACKEND_CUDA};
	void *arrays[4];
	struct rnea_robot *robot;
	struct rnea_error e;
	double x[64] = {0};

	use_fakes();
	rnea_open_evaluator("text", 4, &nothing, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "no evaluator");
	rnea_open_evaluator(cut, sizeof cut - 1, &some, NULL, &robot, &e); /* under the sanitizers: nothing behind it is read */
	assert_error(&e, RNEA_TABLE, "info table");
	rnea_evaluate_urdf(NULL, 0, NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "urdf is NULL");
	ck_assert_ptr_null(robot);
	rnea_open("text", 4, &o, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "no backend");
	rnea_open_urdf(TEST_DIR "/bad/axis_zero.urdf", NULL, &o, &robot, &e);
	assert_error(&e, RNEA_URDF, "bad/axis_zero.urdf");
	for (int i = 0; i < 4; i++)
		arrays[i] = x;
	ck_assert_msg(!rnea_open_urdf(TEST_DIR "/robots/pendulum.urdf", NULL, &o, &robot, &e), "%s", e.message);
	ck_assert_uint_eq(rnea_info(robot)->function_count, 1);
	rnea_launch_kernel(robot, "fpass", arrays, 1, NULL, &e);
	assert_error(&e, RNEA_KERNEL, "fpass");
	rnea_launch(robot, arrays, 1, arrays, &e);
	assert_error(&e, RNEA_ARGUMENT, "stream");
	rnea_close(robot);
	ck_assert_msg(!rnea_open_urdf(TEST_DIR "/robots/pendulum.urdf", NULL, &cuda, &robot, &e), "%s", e.message);
	rnea_run_aos(robot, arrays, 1, &e);
	assert_error(&e, RNEA_ARGUMENT, "layout");
	rnea_close(robot);
}
END_TEST

START_TEST(errors)
{
	static const char panda[] = TEST_DIR "/robots/panda.urdf";
	struct rneagen_options g = rneagen_options_default();
	struct rnea_robot *robot = (struct rnea_robot *)&g;
	struct rnea_error e;

	use_fakes();
	rnea_open_urdf(panda, NULL, NULL, NULL, &e);
	assert_error(&e, RNEA_ARGUMENT, "robot is NULL");
	rnea_open_urdf(NULL, NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "path is NULL");
	ck_assert_ptr_null(robot);
	g.target = RNEAGEN_TARGET_C;
	rnea_open_urdf(panda, &g, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "panda.urdf: the target must be RNEAGEN_TARGET_CUDA");
	g.target = RNEAGEN_TARGET_CUDA;
	g.dump = RNEAGEN_DUMP_DAG;
	rnea_open_urdf(panda, &g, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "a dump cannot be opened");
	g.dump = RNEAGEN_DUMP_NONE;
	g.order = "nobody";
	rnea_open_urdf(panda, &g, NULL, &robot, &e);
	assert_error(&e, RNEA_URDF, "nobody");
	rnea_open_urdf("/nowhere/a.urdf", NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_READ, "/nowhere/a.urdf: No such file");
	rnea_open_urdf(TEST_DIR, NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_READ, "Is a directory");
	rnea_open_urdf(TEST_DIR "/bad/mass_word.urdf", NULL, NULL, &robot, &e);
	ck_assert_int_eq(rnea_open_urdf(TEST_DIR "/bad/axis_zero.urdf", NULL, NULL, &robot, NULL), RNEA_URDF);
	rnea_open_urdf(TEST_DIR "/bad/axis_zero.urdf", NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_URDF, "bad/axis_zero.urdf");
	setenv("RNEA_FAKE_CUDA_FAIL", "cuInit=999", 1);
	rnea_open_urdf(panda, NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_DRIVER, "cuInit");
	unsetenv("RNEA_FAKE_CUDA_FAIL");
	ck_assert_ptr_null(robot);
}
END_TEST

/* ---- names ---- */

/* As they stand in the XML, and in the file system. */
static const char *const names[][2] = {
	{"a&quot;; system(&quot;touch x&quot;); //", "a\"; touch x; #.urdf"},
	{"*/ int x; /*", "*\\ $(touch x) `touch x`.urdf"},
	{"one&#10;#error two&#13;", "one\n#error two\n.urdf"},
	{"\\&#10;?\?/&#10;", "-o x\\.urdf"},
	{"%s%n`touch x`", "%s%n*?[]{}~|&<>.urdf"},
	{"'; touch x; '", "'; touch x; '.urdf"},
	{"\xc3\xa4\xe2\x80\xae", "\xc3\xa4\xff\xfe.urdf"},
};

static void write_robot(const char *path, const char *name)
{
	FILE *f = fopen(path, "w");

	ck_assert_msg(f != NULL, "%s", path);
	fprintf(f,
		"<robot name=\"%s\"><link name=\"base\"/><link name=\"%s\"><inertial><mass value=\"2\"/>"
		"<origin xyz=\"0 0 -0.5\"/><inertia ixx=\"0\" iyy=\"0\" izz=\"0\" ixy=\"0\" ixz=\"0\" "
		"iyz=\"0\"/></inertial></link>"
		"<joint name=\"%s\" type=\"continuous\"><parent link=\"base\"/><child link=\"%s\"/><axis xyz=\"0 1 "
		"0\"/></joint>"
		"</robot>\n",
		name, name, name, name);
	fclose(f);
}

static int count_files(const char *folder)
{
	DIR *d = opendir(folder);
	int count = 0;

	ck_assert_ptr_nonnull(d);
	while (readdir(d))
		count++;
	closedir(d);
	return count - 2;
}

START_TEST(hostile_names)
{
	char folder[] = "/tmp/test_runtime_urdf_XXXXXX", path[256];
	float q = 0.25f, qd = 0, qdd = 2, tau = 0;
	struct rnea_options o = {.backend = _i % 2 ? RNEA_BACKEND_HOST : RNEA_BACKEND_CUDA};
	struct rnea_robot *robot;
	struct rnea_error e;

	use_fakes();
	ck_assert_ptr_nonnull(mkdtemp(folder));
	ck_assert_int_eq(chdir(folder), 0);
	snprintf(path, sizeof path, "./%s", names[_i / 2][1]);
	write_robot(path, names[_i / 2][0]);
	ck_assert_msg(rnea_open_urdf(path, NULL, &o, &robot, &e) == RNEA_OK, "%s", e.message);
	ck_assert_int_eq(rnea_run(robot, (void *[]){&q, &qd, &qdd, &tau}, 1, &e), RNEA_OK);
	ck_assert_msg(fabsf(tau - (0.5f * 2 + 9.81f * sinf(0.25f))) < 1e-5f, "%g", (double)tau);
	rnea_close(robot);
	ck_assert_int_eq(count_files("."), 1); /* the robot itself */
	unlink(path);
	ck_assert_int_eq(rnea_open_urdf(path, NULL, NULL, &robot, &e), RNEA_READ);
	ck_assert_ptr_null(strchr(e.message, '\n'));
	ck_assert_int_eq(chdir("/"), 0);
	rmdir(folder);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("urdf");
	TCase *t = tcase_create("urdf");
	SRunner *r = srunner_create(s);
	int bad;

	tcase_set_timeout(t, 120);
	tcase_add_test(t, evaluator_errors);
	tcase_add_loop_test(t, computes, 0, 3 * (int)(sizeof robots / sizeof *robots));
	tcase_add_test(t, errors);
	tcase_add_loop_test(t, beyond_the_domain, 0, 16);
	tcase_add_loop_test(t, parts, 0, 3);
	tcase_add_loop_test(t, hostile_names, 0, 2 * (int)(sizeof names / sizeof *names));
	suite_add_tcase(s, t);
	srunner_run_all(r, CK_ENV);
	bad = srunner_ntests_failed(r);
	srunner_free(r);
	return bad != 0;
}
