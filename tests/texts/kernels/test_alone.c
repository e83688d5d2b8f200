/* A kernel of its own for each part: from LEAST samples on both launches run these, with the whole text's values, and below it
   the one kernel; a robot works without them. In the text the one kernel is broken, so that who ran is seen. Their tiles are
   moved by an engine that tests/fake plays. */
#define _GNU_SOURCE
#include "launched.h"
#include "cuda/compile/jit.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include "target/launch_library.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* the text's own number is larger; rows begin at multiples of 16 bytes */
enum { LEAST = 1000, COUNT = LEAST + 44, SEED = 20261127 };

static const struct subject {
	const char *robot, *scene;
	int floating, parts;
	const char *least;
	int is_double;
} SUBJECTS[] = {
	{"hyq", "want tau,dtau_dq,dtau_dqd,M\ndense\n", 1, 3, "16896", 0},
	{"hyq", "want qdd,dqdd_dq,dqdd_dqd\n", 1, 6, "16896", 0},   /* of accelerations */
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", 0, 4, "16896", 0}, /* it asks for angles first */
	{"g1_29dof", "want tau,vjp\n", 0, 0, "253440", 1},	       /* outputs in the places of inputs */
	{"chain_75", "", 0, 0, "524288", 1},			       /* hands, and rows with a gap */
	{"atlas", "", 0, 0, "524288", 0},			       /* whole */
	{"atlas", "want qdd\n", 0, 0, "524288", 1},
	{"atlas", "want qdd\n", 1, 0, "16384", 1},			       /* the base's acceleration first */
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", 0, 5, "16896", 1},
	{"atlas", "vjp qdd\n", 1, 0, "253440", 1},		       /* tiles of inputs alone, in some of the kernels */
	{"hyq", "jvp qdd\n", 1, 0, "253440", 1},
	{"g1_29dof", "want qdd\nweld left_ankle_roll_link,right_ankle_roll_link\n", 1, 0, "65536", 1}, /* forces first */
	{"g1_29dof", "want tau,vjp\n", 1, 0, "253440", 1},	       /* sides of a base */
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

/* Of the text; `to` is as long. */
static void replace(struct target *t, const char *from, const char *to)
{
	char *at = strstr(t->text.source, from);

	ck_assert_msg(at != NULL, "%s: no %s", t->what, from);
	ck_assert_uint_eq(strlen(from), strlen(to));
	memcpy(at, to, strlen(to));
}

/* Of the text; the number in as many digits, or places. */
static void replace_number(struct target *t, const char *before, const char *from, const char *format)
{
	char old[64], new[64];

	snprintf(old, sizeof old, "%s%s", before, from);
	snprintf(new, sizeof new, format, before, (int)strlen(from), LEAST);
	replace(t, old, new);
}

static void generate(const struct subject *s, int parts, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();

	o.precision = s->is_double ? RNEAGEN_F64 : RNEAGEN_F32;
	o.limbs = RNEAGEN_LIMBS_NONE;
	o.parts = parts;
	launched_generate(t, s->robot, s->scene, s->floating, &o);
	if (parts == 1)
		return;
	replace_number(t, "part_kernels ", s->least, "%s%0*d");
	replace_number(t, "define RNEA_PART_KERNELS ", s->least, "%s%*d");
}

/* In the one kernel no block has a part to make, or no thread a sample. */
static void break_one(struct target *t)
{
	char *at = strstr(strstr(t->text.source, "#if !defined RNEA_ONLY_PART_KERNELS"), "switch (blockIdx.y) { /* no loop");

	if (!at && (at = strstr(t->text.source, "_rnea_kernel(const")) == NULL)
		at = strstr(t->text.source, "_fd_kernel(const");
	if (strstr(at, "switch (blockIdx.y)"))
		memcpy(strstr(at, "switch (blockIdx.y)"), "switch (0x7fffffff)", strlen("switch (0x7fffffff)"));
	else
		memcpy(strstr(at, "k >= count"), "k >= 0    ", strlen("k >= 0    "));
}

static struct rnea_robot *open_robot(const struct target *t, const char *option)
{
	struct rnea_options o = {.backend = RNEA_BACKEND_CUDA, .compile = &option, .compile_count = option != NULL};
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(!rnea_open(t->text.source, strlen(t->text.source), &o, &robot, &e), "%s: %s", t->what, e.message);
	return robot;
}

/* The second output, where there is one: the first may be a relay's first kernel's. */
static size_t looked_at(const struct launch *x)
{
	return x->info->input_count + (x->info->output_count > 1);
}

/* How many of its numbers were written. Zeros have a loop of their own. */
static size_t written(const struct launch *x)
{
	const struct rnea_argument *a = &x->info->arguments[looked_at(x)];
	const void *array = x->arrays[looked_at(x)];
	size_t count = 0;

	for (size_t k = 0; k < x->count * a->rows; k++)
		count += isnan(a->scalar == RNEA_F64 ? ((const double *)array)[k] : (double)((const float *)array)[k]) ? 0 : 1;
	return count;
}

static size_t all(const struct launch *x)
{
	return x->count * x->info->arguments[looked_at(x)].rows;
}

/* The one kernel, which is broken, runs. What hands hand on stands in its rows. */
static void check_other(const struct subject *s, const struct target *broken, size_t count)
{
	struct launch x = launched_run(open_robot(broken, NULL), count, SEED, s->floating);

	ck_assert_uint_lt(written(&x), all(&x));
	launched_free(&x);
}

/* The text whose one kernel is broken, and what its parts' kernels gave: the values of the whole text, compiled as C. */
static void run_parts(const struct subject *s, struct target *broken, struct launch *x)
{
	struct target whole;
	struct launch y;
	double worst;

	generate(s, s->parts, broken);
	generate(s, 1, &whole);
	break_one(broken);
	*x = launched_run(open_robot(broken, NULL), COUNT, SEED, s->floating);
	y = launched_run(launched_open(&whole, RNEA_BACKEND_HOST, 0), COUNT, SEED, s->floating);
	worst = launched_distance(x, &y, s->robot);
	printf("%s, %s: within %.1e, seed %d\n", s->robot, s->scene, worst, SEED);
	ck_assert_double_lt(worst, s->is_double ? 1e-11 : 2e-4);
	launched_free(&y);
	rneagen_result_free(&whole.text);
}

START_TEST(test_values)
{
	const struct subject *s = &SUBJECTS[_i];
	struct target broken;
	struct launch x;

	if (_i && !exhaustive())
		return;
	run_parts(s, &broken, &x);
	ck_assert_uint_eq(x.info->functions->part_kernels, LEAST);
	/* a relay's third kernel would solve with what is not there */
	if (!x.info->functions->relay_threads && !x.info->functions->hands[0]) {
		check_other(s, &broken, LEAST - 1);
		check_other(s, &broken, COUNT + 1); /* rows begin anywhere */
	}
	launched_free(&x);
	rneagen_result_free(&broken.text);
}
END_TEST

/* A device without the engine: the same kernels read and write the arrays themselves. It would catch a kernel that takes tiles
   for granted. */
START_TEST(test_older)
{
	struct target broken;
	struct launch x;

	setenv("RNEA_FAKE_CUDA_ARCH", "80", 1);
	run_parts(&SUBJECTS[0], &broken, &x);
	launched_free(&x);
	rneagen_result_free(&broken.text);
	unsetenv("RNEA_FAKE_CUDA_ARCH");
}
END_TEST

/* With wrenches of many links parts have more tiles than a launch passes on: then they have none. It would catch kernels of maps
   that are not there. */
START_TEST(test_too_many)
{
	static const char *const links[] = {"head", "l_clav", "l_foot", "l_hand", "l_larm", "l_lfarm", "l_lglut", "l_lleg", "l_scap",
		"l_talus", "l_uarm", "l_ufarm", "l_uglut", "l_uleg", "ltorso", "mtorso", "r_clav", "r_foot", "r_hand", "r_larm",
		"r_lfarm", "r_lglut", "r_lleg", "r_scap", "r_talus", "r_uarm"};
	struct subject s = {"atlas", NULL, 0, 0, "16896", 0};
	char scene[2048] = "want tau,dtau_dq,dtau_dqd\n";
	struct target t;

	for (size_t i = 0; i < sizeof links / sizeof *links; i++)
		snprintf(scene + strlen(scene), sizeof scene - strlen(scene), "fext %s\n", links[i]);
	s.scene = scene;
	generate(&s, s.parts, &t);
	ck_assert_ptr_nonnull(strstr(t.text.source, "_part0_kernel("));
	ck_assert_ptr_null(strstr(t.text.source, "tiles.map"));
	ck_assert_ptr_null(strstr(t.text.source, "inner"));
	rneagen_result_free(&t.text);
}
END_TEST

/* Of a base that moves q has one row more than qd and tau. It would catch tiles in which all rows between the base's and a
   limb's come with these. */
START_TEST(test_gap)
{
	const struct subject s = {"atlas", "want qdd\n", 1, 0, "16384", 1};
	struct target t;

	generate(&s, s.parts, &t);
	ck_assert_ptr_nonnull(strstr(t.text.source, "tiles.map["));
	ck_assert_ptr_nonnull(strstr(t.text.source, " 0 4 0 12 1 6 1 12 ")); /* orientation and 12 legs' joints; twist and these */
	rneagen_result_free(&t.text);
}
END_TEST

/* An option leaves them out; where their program does not compile there are none. */
START_TEST(test_without)
{
	struct target t;
	struct launch x;

	generate(&SUBJECTS[0], SUBJECTS[0].parts, &t);
	if (_i)
		replace(&t, "/* Kernels of large batches, ", "#error of their own programs ");
	x = launched_run(open_robot(&t, _i ? NULL : "-DRNEA_NO_PART_KERNELS"), COUNT, SEED, 1);
	ck_assert_uint_eq(x.info->functions->part_kernels, 0);
	ck_assert_uint_eq(written(&x), all(&x));
	launched_free(&x);
	rneagen_result_free(&t.text);
}
END_TEST

/* The programs that librnea makes of a text, by the real NVRTC where it is: each has its kernel, and no other's. */
static const struct program {
	const char *options[2], *has, *lacks;
} PROGRAMS[] = {
	{{"-DRNEA_NO_LIMBS", "-DRNEA_NO_PART_KERNELS"}, "hyq_rnea_kernel", "hyq_rnea_part1_kernel"},
	{{"-DRNEA_NO_LIMBS", "-DRNEA_ONLY_PART_KERNELS"}, "hyq_rnea_part1_kernel", "hyq_rnea_kernel"},
};

START_TEST(test_program)
{
	const struct program *p = &PROGRAMS[_i];
	char log[4096] = "";
	struct jit_request r = {
		.file = "hyq.cu", .arch = 90, .options = p->options, .option_count = 2, .log = log, .log_size = sizeof log};
	struct jit_image image;
	struct rnea_error e = {0};
	struct target t;

	unsetenv("RNEA_NVRTC");
	generate(&SUBJECTS[0], SUBJECTS[0].parts, &t);
	r.source = t.text.source;
	if (jit_compile(&r, &image, &e) == RNEA_NO_COMPILER) {
		printf("skipped: %s\n", e.message);
		return;
	}
	ck_assert_msg(e.code == RNEA_OK, "%s", e.message);
	ck_assert_msg(!*log, "NVRTC says %s", log);
	ck_assert_ptr_nonnull(memmem(image.data, image.size, p->has, strlen(p->has)));
	ck_assert_ptr_null(memmem(image.data, image.size, p->lacks, strlen(p->lacks)));
	jit_free(&image);
	rneagen_result_free(&t.text);
}
END_TEST

/* NAME_rnea_launch, as nvcc builds it. */
START_TEST(test_launch)
{
	int (*launch)(void *q, void *qd, void *qdd, void *tau, void *dq, void *dqd, void *m, size_t count, void *stream);
	struct target t;
	struct launch x;
	void *library;

	generate(&SUBJECTS[0], SUBJECTS[0].parts, &t);
	break_one(&t);
	library = launch_library(&t, "alone_launch", "#define FAKE_PARTS", "FAKE_ENTRY_PARTS(hyq_rnea_kernel, hyq_rnea_part0_kernel)");
	target_symbol(&t, library, "hyq_rnea_launch", &launch);
	for (size_t count = LEAST - 1; count <= LEAST; count++) {
		x = launched_run(open_robot(&t, NULL), count, SEED, 1);
		for (size_t i = 3; i < 7; i++)
			memset(x.arrays[i], 0xff, x.info->arguments[i].rows * count * sizeof(float)); /* NaN */
		ck_assert_int_eq(launch(x.arrays[0], x.arrays[1], x.arrays[2], x.arrays[3], x.arrays[4], x.arrays[5], x.arrays[6],
					 count, NULL),
			0);
		ck_assert_int_eq(written(&x) == all(&x), count == LEAST);
		launched_free(&x);
	}
	dlclose(library);
	rneagen_result_free(&t.text);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("alone");

	launched_pretend();
	setenv("RNEA_FAKE_PARTS", "1", 1);
	suite_add(s, "values", test_values, SUBJECT_COUNT, 600);
	suite_add(s, "older", test_older, 1, 600);
	suite_add(s, "without", test_without, 2, 120);
	suite_add(s, "too_many", test_too_many, 1, 120);
	suite_add(s, "gap", test_gap, 1, 120);
	suite_add(s, "program", test_program, sizeof PROGRAMS / sizeof *PROGRAMS, 120);
	suite_add(s, "launch", test_launch, 1, 120);
	return suite_run(s);
}
