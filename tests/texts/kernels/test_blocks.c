/* Kernels in blocks of any size, on a pretended device: what a block stages lies in shared memory of the kernel's own,
   in what a launch gives, or nowhere, also where a device has less of it; results are those of the reference, or of the
   same text compiled as C. */
#define _GNU_SOURCE
#include "rnea.h"
#include "reference/reference.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include "target/launch_library.h"
#include "target/target.h"
#include "block_arrays.h"
#include "launched.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 80, OWN = 48 << 10, MOST = 227 << 10, FAKE_OWN = 8 };

static const struct subject {
	const char *robot;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	const char *scene;
	unsigned blocks[3]; /* 0: no more */
	double most;
} SUBJECTS[] = {
	{"iiwa14", RNEAGEN_F32, RNEAGEN_AOS, NULL, {33, 128, 1024}, 2e-5},
	{"iiwa14", RNEAGEN_F64, RNEAGEN_SOA, NULL, {50, 512}, 1e-13},
	{"chain 29", RNEAGEN_F64, RNEAGEN_SOA, NULL, {64, 256, 512}, 1e-13},
	{"chain 24", RNEAGEN_MIXED, RNEAGEN_SOA, NULL, {256, 1024}, 1e-6},
	{"chain 60", RNEAGEN_F64, RNEAGEN_AOS, NULL, {64, 161, 162}, 1e-13}, /* bytes of the last two: 231840, 233280 */
	{"cartpole", RNEAGEN_F32X2, RNEAGEN_AOS, "free inertia.pole:sample,inertia.cart:sample\n", {256}, 1e-10},
	{"cartpole", RNEAGEN_F64, RNEAGEN_SOA,
		"free payload.pole,gravity,inertia.cart:sample\nwant gravity,bias,kinetic\n", {256, 1024}, 1e-13},
	{"cartpole", RNEAGEN_F32, RNEAGEN_AOS, "free payload.pole,gravity,inertia.cart:sample\nwant tau,dtau_dq,M\n",
		{128, 1024}, 2e-5},
	{"pendulum", RNEAGEN_F32, RNEAGEN_SOA, "want tau,dtau_dq\n", {1024}, 2e-5},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

static void generate(const struct subject *s, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot(s->robot, &length);

	o.precision = s->precision;
	o.layout = s->layout;
	o.scene = s->scene;
	o.name = "arm";
	o.limbs = RNEAGEN_LIMBS_NONE;
	o.tell = RNEAGEN_TELL_JSON;
	target_generate(t, urdf, length, &o, s->robot);
	free(urdf);
}

/* tau, by the independent reference. */
static void expect_torques(struct arrays *x, const char *name)
{
	static double in[3][ROWS];
	wide tau[ROWS];
	char message[512];
	size_t length;
	char *urdf = target_robot(name, &length);
	struct reference *r = reference_open(urdf, length, NULL, message, sizeof message);

	ck_assert_msg(r != NULL, "%s", message);
	for (size_t k = 0; k < COUNT; k++) {
		for (size_t i = 0; i < 3; i++)
			for (size_t row = 0; row < x->a[i].rows; row++)
				in[i][row] = arrays_get(x, i, k, row);
		reference_rnea(r, in[0], in[1], in[2], tau);
		for (size_t row = 0; row < x->a[3].rows; row++)
			x->expected[3][k * x->a[3].rows + row] = (double)tau[row];
	}
	reference_close(r);
	free(urdf);
}

/* What a scene asks for, by the same text compiled as C, which stages nothing. */
static void expect_as_c(struct arrays *x, const struct target *t)
{
	struct rnea_robot *robot = launched_open(t, RNEA_BACKEND_HOST, 0);
	struct rnea_error e;

	ck_assert_msg(!rnea_launch(robot, x->data, COUNT, NULL, &e), "%s", e.message);
	for (size_t i = x->inputs; i < x->count; i++)
		for (size_t k = 0; k < COUNT; k++)
			for (size_t row = 0; row < x->a[i].rows; row++)
				x->expected[i][k * x->a[i].rows + row] = arrays_get(x, i, k, row);
	rnea_close(robot);
	arrays_spoil(x);
}

static void expect(struct arrays *x, const struct subject *s, const struct target *t)
{
	if (s->scene)
		expect_as_c(x, t);
	else
		expect_torques(x, s->robot);
}

/* The largest difference of a sample's rows, by the largest of them. */
static double distance(const struct arrays *x)
{
	double worst = 0;

	for (size_t i = x->inputs; i < x->count; i++)
		for (size_t k = 0; k < COUNT; k++) {
			double most = 0, size = 1e-3;

			for (size_t row = 0; row < x->a[i].rows; row++) {
				double want = x->expected[i][k * x->a[i].rows + row], got = arrays_get(x, i, k, row);

				ck_assert_msg(isfinite(got), "%s[%zu] of sample %zu was not written", x->a[i].name, row, k);
				most = fmax(most, fabs(got - want));
				size = fmax(size, fabs(want));
			}
			worst = fmax(worst, most / size);
		}
	return worst;
}

/* ---- on the pretended device ---- */

static char folder[64];

static void use_fakes(void)
{
	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	strcpy(folder, "/tmp/test_blocks_XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(folder));
	setenv("RNEA_CACHE", folder, 1); /* for another device of the same architecture */
}

static void drop_folder(void)
{
	char command[128];

	snprintf(command, sizeof command, "rm -rf %s", folder);
	ck_assert_int_eq(system(command), 0);
}

/* A subject's text on the pretended device, the arrays of a launch, and what comes out. */
struct trial {
	struct target text;
	struct rnea_robot *robot;
	struct arrays x;
};

static void trial_open(struct trial *t, const struct subject *s, unsigned block)
{
	use_fakes();
	generate(s, &t->text);
	t->robot = launched_open(&t->text, RNEA_BACKEND_CUDA, block);
	arrays_new(&t->x, rnea_info(t->robot));
	expect(&t->x, s, &t->text);
}

static void trial_close(struct trial *t)
{
	rnea_close(t->robot);
	arrays_free(&t->x);
	rneagen_result_free(&t->text.text);
	drop_folder();
}

/* What is staged are the arrays, but tau in the place of qdd; in aos a row may be followed by a gap. --info=json says
   the same. */
static void check_table(const struct arrays *x, size_t stage, const struct target *t)
{
	size_t least = 0, gaps = 0;
	char member[64];

	for (size_t i = 0; i < x->count; i++) {
		size_t bytes = x->a[i].scalar == RNEA_F64 ? 8 : 4;

		if (x->a[i].per_batch || strcmp(x->a[i].name, "tau") == 0)
			continue;
		least += x->a[i].rows * bytes;
		gaps += x->aos ? bytes : 0;
	}
	ck_assert_msg(stage == 0 || (least <= stage && stage <= least + gaps), "%s: stage %zu of %zu", t->what, stage, least);
	ck_assert_int_eq(stage != 0, strstr(t->text.source, "\"stage ") != NULL);
	snprintf(member, sizeof member, "\"stage_bytes\": %zu,\n", stage);
	ck_assert_msg(strstr(t->text.info_json, member) != NULL, "%s is not in %s", member, t->text.info_json);
}

/* One block size on a device that can give a block so much. */
static void check_block(const struct subject *s, const struct target *t, struct arrays *x, unsigned block, size_t limit)
{
	struct rnea_robot *robot;
	struct rnea_resources r;
	struct rnea_error e;
	size_t stage, given;
	char number[16];
	double worst;

	snprintf(number, sizeof number, "%zu", limit);
	setenv("RNEA_FAKE_CUDA_SHARED", number, 1);
	robot = launched_open(t, RNEA_BACKEND_CUDA, block);
	stage = rnea_info(robot)->stage_bytes * block;
	given = stage > OWN && stage <= MOST && stage <= limit ? stage : 0;
	ck_assert_uint_eq(rnea_info(robot)->block, block);
	rnea_resources(robot, "rnea", &r, NULL);
	ck_assert_msg(r.shared_bytes == FAKE_OWN + given, "%s, %u: %zu bytes instead of %zu", t->what, block,
		r.shared_bytes - FAKE_OWN, given);
	ck_assert_msg(!rnea_launch(robot, x->data, COUNT, NULL, &e), "%s", e.message);
	worst = distance(x);
	if (limit == MOST)
		printf("%s in blocks of %u: stages %zu bytes, %zu of the launch, within %.1e\n", t->what, block,
			stage, given, worst);
	ck_assert_double_lt(worst, s->most);
	arrays_spoil(x);
	rnea_close(robot);
}

/* ---- outputs through windows ---- */

/* With zeros that no statement writes; in parts; in several flushes; with what all samples share. In blocks of 33, and of 1024,
   each thread writes its own elements; the last warp is not full. */
static const struct subject WINDOWS[] = {
	{"atlas", RNEAGEN_F32, RNEAGEN_AOS, "want M\ndense\n", {32, 33, 1024}, 2e-5},
	{"hyq", RNEAGEN_F64, RNEAGEN_AOS, "want tau,dtau_dq,dtau_dqd\ndense\nfree gravity:batch,mass.lf_lowerleg:sample\n",
		{32, 64, 1024}, 1e-12},
	{"atlas", RNEAGEN_F64, RNEAGEN_AOS, "want M\ndense\n", {32, 64}, 1e-12},
};

/* Transposed at the end: in parts, with kernels of their own for large batches; with zeros that a loop stores. The last group of
   samples is not full. */
static const struct subject TRANSPOSED[] = {
	{"atlas", RNEAGEN_F32, RNEAGEN_AOS, "want tau,dtau_dq\ndense\n", {32, 1024}, 2e-4},
	{"panda", RNEAGEN_F64, RNEAGEN_AOS, "want tau,dtau_dq,dtau_dqd,M\nfree gravity:batch,mass.panda_link5:sample\n",
		{33, 64}, 1e-12},
	{"atlas", RNEAGEN_F64, RNEAGEN_AOS, "want tau,regressor\n", {64}, 1e-12},
};

enum { LITTLE = 64 << 10 }; /* shared memory of a GPU of compute capability 7.5 */

/* --info=json says of the last kernel what the table says. */
static void check_transposed(const struct target *t, unsigned samples)
{
	const char *line = strstr(t->text.source, "\"transpose ");
	unsigned own, threads, bytes;
	char member[80];

	ck_assert(line && sscanf(line, "\"transpose %u %u %u", &own, &threads, &bytes) == 3);
	ck_assert_uint_eq(own, samples);
	snprintf(member, sizeof member, "\"transposed\": {\"samples\": %u, \"threads\": %u, \"bytes\": %u}", own, threads, bytes);
	ck_assert_msg(strstr(t->text.info_json, member) != NULL, "no %s", member);
}

/* This would catch an element that stays where it was written, one of another group's samples, what is transposed too early, and
   a text that takes more shared memory than a GPU has. */
START_TEST(test_transposed)
{
	const struct subject *s = &TRANSPOSED[_i];
	struct trial t;

	trial_open(&t, s, s->blocks[0]);
	check_transposed(&t.text, _i < 2 ? 16 : 4);
	ck_assert(COUNT % 16 != 0);
	for (int b = 0; b < 3 && s->blocks[b]; b++)
		if (exhaustive() || !b)
			check_block(s, &t.text, &t.x, s->blocks[b], LITTLE);
	trial_close(&t);
}
END_TEST

/* This would catch an element in another sample's place, one that is written by nobody, a slot that is taken again before it
   left, and a warp that counts its samples wrong. */
START_TEST(test_windows)
{
	const struct subject *s = &WINDOWS[_i];
	struct trial t;

	trial_open(&t, s, s->blocks[0]);
	ck_assert_ptr_nonnull(strstr(t.text.text.source, "#define RNEA_SLOTS "));
	for (int b = 0; b < 3 && s->blocks[b]; b++)
		if (exhaustive() || !b || _i + b != 2) /* each of the first two leaves out a size that another one has */
			check_block(s, &t.text, &t.x, s->blocks[b], MOST);
	trial_close(&t);
}
END_TEST

/* ---- inputs that are asked for in advance ---- */

static const struct advance {
	struct subject text;
	const char *calls; /* one for each array of inputs, with its rows; NULL: none */
} ADVANCES[] = {
	{{.robot = "iiwa14", .scene = "want qdd,dqdd_dq,dqdd_dqd\n"}, "<7>(q + k, count)<7>(qd + k, count)<7>(tau + k, count)"},
	{{.robot = "hyq", .precision = RNEAGEN_F64, .scene = "want tau,dtau_dq,dtau_dqd\nfree payload.lf_lowerleg,gravity\n"},
		"<12>(q + k, count)<12>(qd + k, count)<12>(qdd + k, count)<10>(payload_lf_lowerleg + k, count)"},
	{{.robot = "iiwa14", .scene = "want qdd,dqdd_dq,dqdd_dqd\n", .layout = RNEAGEN_AOS}, NULL},
	{{.robot = "iiwa14"}, NULL},
};

/* An array that is left out would be fetched late, and nothing but a GPU's clock would tell. */
START_TEST(test_advance)
{
	const struct advance *x = &ADVANCES[_i];
	struct target t = {0};
	char found[512] = "";
	const char *at;

	generate(&x->text, &t);
	for (at = t.text.source; (at = strstr(at, "\trneagen_prefetch")) != NULL; at++)
		strncat(found, at + strlen("\trneagen_prefetch"), strcspn(at, ";") - strlen("\trneagen_prefetch"));
	ck_assert_str_eq(found, x->calls ? x->calls : "");
	rneagen_result_free(&t.text);
}
END_TEST

/* Every way to stage, of every subject; on an H100, one of 99 KiB, one that gives nothing: in one of its blocks, in
   turn, or in each where all is asked for. */
START_TEST(test_values)
{
	static const size_t limits[] = {MOST, 99 << 10, OWN};
	const struct subject *s = &SUBJECTS[_i];
	struct trial t;

	trial_open(&t, s, s->blocks[0]);
	check_table(&t.x, rnea_info(t.robot)->stage_bytes, &t.text);
	for (int b = 0; b < 3 && s->blocks[b]; b++)
		for (size_t l = 0; l < sizeof limits / sizeof *limits; l++)
			if (exhaustive() || b == (s->blocks[_i % 3] ? _i % 3 : 0))
				check_block(s, &t.text, &t.x, s->blocks[b], limits[l]);
	trial_close(&t);
}
END_TEST

/* Threads that are resident together are fewer where launches give a block much: then the text's own blocks win. */
START_TEST(test_occupancy)
{
	static const struct {
		const char *shared;
		unsigned block;
	} devices[] = {{"232448", 128}, {"49152", 256}};
	static const struct subject s = {.robot = "chain 24", .precision = RNEAGEN_MIXED, .layout = RNEAGEN_SOA};
	struct rnea_robot *robot;
	struct target t;

	use_fakes();
	setenv("RNEA_FAKE_CUDA_RESIDENT", "1024 1024 2048", 1);
	setenv("RNEA_FAKE_CUDA_SHARED", devices[_i].shared, 1);
	generate(&s, &t);
	robot = launched_open(&t, RNEA_BACKEND_CUDA, RNEA_BLOCK_OCCUPANCY);
	ck_assert_uint_eq(rnea_info(robot)->block, devices[_i].block);
	rnea_close(robot);
	rneagen_result_free(&t.text);
	drop_folder();
}
END_TEST

/* A driver that has the memory and does not give it is told of, where it is asked for. */
START_TEST(test_refused)
{
	static const struct subject s = {.robot = "chain 24", .precision = RNEAGEN_MIXED, .layout = RNEAGEN_SOA};
	struct rnea_options o = {.backend = RNEA_BACKEND_CUDA, .block = 128};
	struct rnea_robot *robot;
	struct rnea_error e;
	struct target t;

	use_fakes();
	setenv("RNEA_FAKE_CUDA_FAIL", "cuFuncSetAttribute=1", 1);
	generate(&s, &t);
	ck_assert_int_eq(rnea_open(t.text.source, strlen(t.text.source), &o, &robot, &e), RNEA_OK);
	rnea_close(robot);
	o.block = 256;
	ck_assert_int_eq(rnea_open(t.text.source, strlen(t.text.source), &o, &robot, &e), RNEA_DRIVER);
	ck_assert_msg(strstr(e.message, "cuFuncSetAttribute: error 1") != NULL, "%s", e.message);
	rneagen_result_free(&t.text);
	drop_folder();
}
END_TEST

/* ---- NAME_rnea_launch, as nvcc builds it ---- */

/* The text in blocks of `block`. */
static void *build_launch(const struct target *t, unsigned block)
{
	char before[64];

	snprintf(before, sizeof before, "#define RNEA_BLOCK %u", block);
	return launch_library(t, "blocks_launch", before, "FAKE_ENTRY(arm_rnea_kernel)");
}

static const unsigned launch_blocks[] = {64, 256, 512}; /* of 696 bytes a thread: 43.5 KiB, 174, 348 */

/* It gives what the kernel stages in, on each device as far as it can, and torques are right. */
START_TEST(test_launch)
{
	static const struct subject s = {.robot = "chain 29", .precision = RNEAGEN_F64, .layout = RNEAGEN_SOA};
	static const size_t limits[] = {MOST, 99 << 10, OWN};
	size_t stage = 696 * launch_blocks[_i], *limit, *given, *failures;
	int (*launch)(void *q, void *qd, void *qdd, void *tau, size_t count, void *stream);
	struct trial t;
	void *handle;

	trial_open(&t, &s, 0);
	handle = build_launch(&t.text, launch_blocks[_i]);
	target_symbol(&t.text, handle, "arm_rnea_launch", &launch);
	target_symbol(&t.text, handle, "fake_limit", &limit);
	target_symbol(&t.text, handle, "fake_launched", &given);
	target_symbol(&t.text, handle, "fake_failures", &failures);
	for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
		*limit = limits[l];
		ck_assert_int_eq(launch(t.x.data[0], t.x.data[1], t.x.data[2], t.x.data[3], COUNT, NULL), 0);
		ck_assert_uint_eq(*given, stage > OWN && stage <= MOST && stage <= limits[l] ? stage : 0);
		ck_assert_double_lt(distance(&t.x), 1e-13);
		arrays_spoil(&t.x);
	}
	ck_assert_uint_eq(*failures, 0);
	dlclose(handle);
	trial_close(&t);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("blocks");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(s, "values", test_values, SUBJECT_COUNT, 300);
	suite_add(s, "windows", test_windows, sizeof WINDOWS / sizeof *WINDOWS, 300);
	suite_add(s, "transposed", test_transposed, sizeof TRANSPOSED / sizeof *TRANSPOSED, 300);
	suite_add(s, "occupancy", test_occupancy, 2, 60);
	suite_add(s, "refused", test_refused, 1, 60);
	suite_add(s, "advance", test_advance, sizeof ADVANCES / sizeof *ADVANCES, 60);
	suite_add(s, "launch", test_launch, sizeof launch_blocks / sizeof *launch_blocks, 60);
	return suite_run(s);
}
