/* Kernels of small batches, in which warps share out each sample: values as those of the whole text compiled as C, on
   the pretended driver, whose threads wait for each other; which kernel a launch takes, by the runtime and by
   NAME_rnea_launch; what is said of it. This would catch a value that another warp reads too early, lanes to spare that
   write elsewhere, a batch beyond the threshold that took this kernel, and a block given less memory than it writes.
   The schedules themselves: test_limbs. */
#define _POSIX_C_SOURCE 200809L
#include "launched.h"
#include "support/random_robot.h"
#include "support/suite.h"
#include "target/launch_library.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 32, SEED = 20261122 };

static const struct subject {
	const char *name, *scene;
	int floating, warps, parts;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
	int has_most;  /* also the largest batch that takes it, and one more */
	int is_strict; /* the same bits */
	int has_first; /* all threads make the sines before the warps part */
} SUBJECTS[] = {
	{"iiwa14", "", 0, 4, 1, RNEAGEN_F32, RNEAGEN_ACCURATE, 0, 0, 0},
	{"hyq", "", 1, 4, 1, RNEAGEN_F32, RNEAGEN_BOUNDED, 1, 0, 0},
	{"atlas", "", 0, 4, 1, RNEAGEN_F64, RNEAGEN_ACCURATE, 0, 1, 0},
	{"panda", "want tau,dtau_dq,dtau_dqd\n", 0, 2, 2, RNEAGEN_F64, RNEAGEN_ACCURATE, 1, 0, 0},
	{"hyq", "want qdd\n", 0, 4, 1, RNEAGEN_MIXED, RNEAGEN_ACCURATE, 0, 0, 0},
	{"chain_75", "", 0, 8, 1, RNEAGEN_F32, RNEAGEN_ACCURATE, 0, 0, 1}, /* more shared memory than is a kernel's own */
	{"atlas", "want M,tau,dtau_dq\n", 0, 4, 3, RNEAGEN_F64, RNEAGEN_ACCURATE, 0, 0, 1},
	{"random", "", 1, 4, 1, RNEAGEN_F64, RNEAGEN_ACCURATE, 0, 0, 1},
	{"random", "want tau,dtau_dq\n", 0, 4, 1, RNEAGEN_MIXED, RNEAGEN_ACCURATE, 0, 0, 1},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS, CHAIN = 5, WITHOUT_COUNT = 3 };

/* Joints that follow others turn by multiples of their angles. */
static void generate_random(const struct subject *s, struct rneagen_options *o, struct target *t)
{
	static const struct random_robot_knobs knobs = {.links = 44, .branching = 0.3, .prismatic = 0.1, .planar = 0.05, .mimic = 0.2,
		.odd_axis = 0.3, .general_rpy = 0.3};
	char *urdf = random_robot(SEED, &knobs);

	ck_assert_ptr_nonnull(strstr(urdf, "mimic"));
	o->scene = *s->scene ? s->scene : NULL;
	o->base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	target_generate(t, urdf, strlen(urdf), o, s->name);
	free(urdf);
}

static void generate(const struct subject *s, int limbs, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();

	o.precision = s->precision;
	o.trig = s->trig;
	o.strict = s->is_strict;
	o.limbs = limbs;
	o.parts = limbs == RNEAGEN_LIMBS_NONE ? 1 : s->parts;
	if (!strcmp(s->name, "random"))
		generate_random(s, &o, t);
	else
		launched_generate(t, s->name, s->scene, s->floating, &o);
}

static unsigned threads_of_last_launch(void)
{
	void *handle = dlopen(FAKE_CUDA, RTLD_NOW | RTLD_NODELETE), *found = dlsym(handle, "fake_cuda_threads");
	unsigned (*threads)(void);

	ck_assert_ptr_nonnull(found);
	memcpy(&threads, &found, sizeof threads);
	dlclose(handle);
	return threads();
}

/* Of the kernel that a batch should take. */
static unsigned expected_threads(const struct rnea_info *info, size_t count)
{
	const struct rnea_function *f = info->functions;

	return count > f->limbs.most ? info->block : LANES * f->limbs.warps * (count <= LANES ? 1 : f->limbs.groups);
}

static double compare(const struct subject *s, const struct target *limbs, const struct target *whole, size_t count)
{
	struct launch x = launched_run(launched_open(limbs, RNEA_BACKEND_CUDA, 0), count, SEED, s->floating);
	unsigned threads = threads_of_last_launch();
	struct launch y = launched_run(launched_open(whole, RNEA_BACKEND_HOST, 0), count, SEED, s->floating);
	double worst;

	ck_assert_uint_eq(x.info->functions->limbs.warps, (unsigned)s->warps);
	ck_assert_uint_eq(threads, expected_threads(x.info, count));
	ck_assert_uint_eq(y.info->functions->limbs.warps, 0);
	worst = launched_distance(&x, &y, s->name);
	launched_free(&x);
	launched_free(&y);
	return worst;
}

static size_t most_of(const struct target *t)
{
	const char *at = strstr(t->text.source, "#define RNEA_LIMBS_MOST ");

	ck_assert_ptr_nonnull(at);
	return strtoul(at + strlen("#define RNEA_LIMBS_MOST "), NULL, 10);
}

START_TEST(test_values)
{
	const struct subject *s = &SUBJECTS[_i];
	size_t counts[] = {1, 31, 33, 1000, 0, 0};
	struct target limbs, whole;
	double worst = 0;

	generate(s, s->warps, &limbs);
	generate(s, RNEAGEN_LIMBS_NONE, &whole);
	ck_assert_ptr_null(strstr(whole.text.source, "RNEA_LIMBS"));
	ck_assert_int_eq(strstr(limbs.text.source, "_table(") != NULL, s->has_first);
	counts[4] = s->has_most ? most_of(&limbs) : 0;
	counts[5] = s->has_most ? most_of(&limbs) + 1 : 0;
	for (int i = 0; i < 6; i++)
		worst = counts[i] ? fmax(worst, compare(s, &limbs, &whole, counts[i])) : worst;
	printf("%s, %d warps, %d parts: within %.1e, seed %d\n", s->name, s->warps, s->parts, worst, SEED);
	ck_assert(!s->is_strict || worst == 0);
	ck_assert_double_lt(worst, s->precision == RNEAGEN_F32 ? 2e-5 : s->precision == RNEAGEN_MIXED ? 1e-6 : 1e-12);
	rneagen_result_free(&limbs.text);
	rneagen_result_free(&whole.text);
}
END_TEST

/* ---- a robot without it ---- */

/* An option leaves it out; a device of smaller blocks, or with less shared memory, cannot have it. */
START_TEST(test_without)
{
	static const char *const without[] = {"-DRNEA_NO_LIMBS"};
	static const struct {
		const char *variable, *value; /* of the pretended device */
		int subject, warps;
	} cases[WITHOUT_COUNT] = {
		{NULL, NULL, 0, 4}, {"RNEA_FAKE_CUDA_MAX_BLOCK", "128", 0, 16}, {"RNEA_FAKE_CUDA_SHARED", "65536", CHAIN, 8}};
	struct rnea_options o = {.backend = RNEA_BACKEND_CUDA, .compile = without, .compile_count = !_i};
	struct rnea_robot *robot;
	struct rnea_error e;
	struct launch x;
	struct target t;

	if (cases[_i].variable)
		setenv(cases[_i].variable, cases[_i].value, 1);
	generate(&SUBJECTS[cases[_i].subject], cases[_i].warps, &t);
	ck_assert_msg(!rnea_open(t.text.source, strlen(t.text.source), &o, &robot, &e), "%s", e.message);
	ck_assert_uint_eq(rnea_info(robot)->functions->limbs.warps, 0);
	ck_assert_uint_eq(rnea_info(robot)->functions->limbs.most, 0);
	x = launched_run(robot, 5, SEED, 0);
	ck_assert_uint_eq(threads_of_last_launch(), x.info->block);
	launched_free(&x);
	rneagen_result_free(&t.text);
}
END_TEST

/* Who asks for it where it cannot be is told. */
START_TEST(test_refused)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result result;
	struct rneagen_error e = {0};
	size_t length;
	char *urdf = target_robot("pendulum", &length);

	o.limbs = 4;
	o.target = _i ? RNEAGEN_TARGET_CUDA : RNEAGEN_TARGET_C;
	o.precision = _i ? RNEAGEN_F32X2 : RNEAGEN_F32;
	ck_assert_int_eq(rneagen_generate(urdf, length, &o, &result, &e), RNEAGEN_USAGE);
	ck_assert_msg(strstr(e.message, _i ? "take another --precision" : "take --target cuda") != NULL, "%s", e.message);
	free(urdf);
}
END_TEST

/* ---- NAME_rnea_launch, as nvcc builds it ---- */

START_TEST(test_launch)
{
	int (*launch)(void *q, void *qd, void *qdd, void *tau, size_t count, void *stream);
	unsigned *grid, *block;
	struct target t;
	void *library;

	generate(&SUBJECTS[0], 4, &t);
	ck_assert_ptr_nonnull(strstr(t.text.source, "extern __shared__"));
	library = launch_library(&t, "small_launch", "#define FAKE_WAITS 1",
		"FAKE_ENTRIES(iiwa14_rnea_kernel, iiwa14_rnea_limbs, \"iiwa14_across\")");
	target_symbol(&t, library, "iiwa14_rnea_launch", &launch);
	target_symbol(&t, library, "fake_grid", &grid);
	target_symbol(&t, library, "fake_block", &block);
	for (size_t i = 0; i < 4; i++) {
		const size_t most = most_of(&t), counts[] = {1, 33, most, most + 1}, count = counts[i];
		struct launch x = launched_run(launched_open(&t, RNEA_BACKEND_CUDA, 0), count, SEED, 0);
		struct launch y = launched_run(launched_open(&t, RNEA_BACKEND_CUDA, 0), count, SEED + 1, 0);
		size_t lanes = count > most ? x.info->block : LANES;

		for (size_t k = 0; k < 3; k++)
			memcpy(y.arrays[k], x.arrays[k], count * 7 * sizeof(float));
		ck_assert_int_eq(launch(y.arrays[0], y.arrays[1], y.arrays[2], y.arrays[3], count, NULL), 0);
		ck_assert_uint_eq(*grid, (count + lanes - 1) / lanes);
		ck_assert_uint_eq(*block, expected_threads(x.info, count));
		ck_assert_double_eq(launched_distance(&x, &y, "iiwa14"), 0);
		launched_free(&x);
		launched_free(&y);
	}
	dlclose(library);
	rneagen_result_free(&t.text);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("small_batches");

	launched_pretend();
	suite_add(s, "values", test_values, SUBJECT_COUNT, 600);
	suite_add(s, "without", test_without, WITHOUT_COUNT, 60);
	suite_add(s, "refused", test_refused, 2, 60);
	suite_add(s, "launch", test_launch, 1, 120);
	return suite_run(s);
}
