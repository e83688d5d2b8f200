/* Kernels of matrices. In parts of the grid: values as those of the whole text, on the pretended driver and compiled as C;
   every element written, and by one part alone; what the text and the runtime say of it; what is refused. Which stores go past
   the cache. */
#include "launched.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 300, SEED = 20261123, AUTO = RNEAGEN_PARTS_AUTO }; /* two blocks, and a piece of one */

#define ALL "want tau,dtau_dq,dtau_dqd,M\n"

static const struct subject {
	const char *name, *scene;
	int floating;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
	int parts, expected; /* expected: how many `auto` makes; 0: not looked at */
	int is_long;         /* others run nearly the same: run where all is asked for */
} SUBJECTS[] = {
	{"iiwa14", ALL, 0, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"iiwa14", ALL, 0, RNEAGEN_F32, RNEAGEN_ACCURATE, 3, 3, 1},
	{"iiwa14", "want dtau_dqd,tau\n", 0, RNEAGEN_F64, RNEAGEN_BOUNDED, 7, 7, 0},
	{"panda", ALL, 0, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"panda", "want tau,dtau_dq,dtau_dqd\n", 0, RNEAGEN_F64, RNEAGEN_ACCURATE, AUTO, 2, 0},
	{"hyq", ALL, 1, RNEAGEN_F32, RNEAGEN_ACCURATE, 3, 3, 0},
	{"hyq", ALL, 1, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 1},
	{"hyq", ALL "dense\n", 0, RNEAGEN_MIXED, RNEAGEN_ACCURATE, 2, 2, 0},
	{"hyq", ALL "derivatives forward\n", 0, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"mimic_chain", ALL, 1, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"planar_joint", ALL, 1, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"hyq", "want tau,regressor\n", 1, RNEAGEN_F64, RNEAGEN_ACCURATE, 3, 3, 0},
	{"ur5", "want tau,dtau_dq,dtau_dqd,power,jvp\nfree payload.wrist_3_link\n", 0, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"iiwa14", "want qdd,Minv,dqdd_dq,dqdd_dqd\n", 0, RNEAGEN_F64, RNEAGEN_ACCURATE, 3, 3, 0},
	{"hyq", "want dqdd_dq,qdd,M\ndynamics articulated\n", 0, RNEAGEN_F64, RNEAGEN_ACCURATE, 2, 2, 0},
	{"hyq", "want qdd,dqdd_dq,dqdd_dqd\ncontact lf_foot\n", 1, RNEAGEN_F64, RNEAGEN_ACCURATE, AUTO, 10, 0},
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", 0, RNEAGEN_F64, RNEAGEN_ACCURATE, AUTO, 5, 0},
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", 0, RNEAGEN_F32, RNEAGEN_ACCURATE, AUTO, 4, 1},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

static struct rneagen_options options_of(const struct subject *s, int parts)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = s->scene;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.precision = s->precision;
	o.trig = s->trig;
	o.parts = parts;
	o.limbs = RNEAGEN_LIMBS_NONE; /* of parts: test_small_batches */
	o.tell = RNEAGEN_TELL_JSON;
	return o;
}

static void generate(const struct subject *s, const struct rneagen_options *o, struct target *t)
{
	size_t length;
	char *urdf = target_robot(s->name, &length);

	target_generate(t, urdf, length, o, s->name);
	free(urdf);
}

/* ---- tests ---- */

/* The text in parts by one backend; y: what the whole text gives. */
static void check_values(const struct subject *s, const struct target *parts, enum rnea_backend backend, const struct launch *y)
{
	struct launch x = launched_run(launched_open(parts, backend, 0), COUNT, SEED, s->floating);
	double worst = launched_distance(&x, y, s->name);

	ck_assert_uint_eq(x.info->parts, (unsigned)s->expected);
	printf("%s in %u parts on %s: within %.1e, seed %d\n", s->name, x.info->parts,
		backend == RNEA_BACKEND_CUDA ? "the pretended GPU" : "the host", worst, SEED);
	ck_assert_double_lt(worst, s->precision == RNEAGEN_F32 ? 2e-5 : s->precision == RNEAGEN_MIXED ? 1e-6 : 1e-13);
	launched_free(&x);
}

/* Statements that store a row of an output. */
static int store_count(const char *source, const char *name, int row)
{
	char store[128];
	int count = 0;

	if (row < 2)
		snprintf(store, sizeof store, "\tRNEA_STORE(%s[%s], ", name, row ? "stride" : "0");
	else
		snprintf(store, sizeof store, "\tRNEA_STORE(%s[%d*stride], ", name, row);
	for (const char *at = source; (at = strstr(at, store)) != NULL; at++)
		count++;
	return count;
}

/* One statement for each row of each output that the table names; returns how many. */
static int check_stores(const char *source, const char *robot)
{
	int stores = 0;

	for (const char *at = source; (at = strstr(at, "\"output ")) != NULL; at++) {
		char name[64];
		int rows;

		ck_assert_int_eq(sscanf(at, "\"output %63s %d", name, &rows), 2);
		for (int r = 0; r < rows; r++, stores++)
			ck_assert_msg(store_count(source, name, r) == 1, "%s: %s[%d] is stored %d times", robot, name, r,
				store_count(source, name, r));
	}
	return stores;
}

static void check_text(const struct subject *s, const struct target *parts, const struct target *whole)
{
	char line[64];

	ck_assert_int_gt(check_stores(parts->text.source, s->name), s->expected);
	snprintf(line, sizeof line, "dim3((unsigned)blocks, %d)", s->expected);
	ck_assert_ptr_nonnull(strstr(parts->text.source, line));
	snprintf(line, sizeof line, "if (gridDim.y != %d)", s->expected);
	ck_assert_ptr_nonnull(strstr(parts->text.source, line));
	snprintf(line, sizeof line, "parts %d\\n", s->expected);
	ck_assert_ptr_nonnull(strstr(parts->text.source, line));
	ck_assert_ptr_nonnull(strstr(parts->text.info_json, "\"parts\": ["));
	ck_assert_ptr_null(strstr(whole->text.source, "_part0_"));
	ck_assert_ptr_null(strstr(whole->text.source, "\"parts "));
}

/* As the whole text compiled as C has it: by one backend, in turns, or by both where all is asked for. */
static void run(const struct subject *s, const struct target *parts, const struct target *whole, int turn)
{
	const int is_large = !strcmp(s->name, "atlas");
	struct launch one = launched_run(launched_open(whole, RNEA_BACKEND_HOST, 0), COUNT, SEED, s->floating);

	ck_assert_uint_eq(one.info->parts, 1);
	if (turn % 2 == 0 || (exhaustive() && !is_large))
		check_values(s, parts, RNEA_BACKEND_HOST, &one);
	if (turn % 2 == 1 || (exhaustive() && !is_large))
		check_values(s, parts, RNEA_BACKEND_CUDA, &one);
	launched_free(&one);
}

START_TEST(test_parts)
{
	const struct subject *s = &SUBJECTS[_i];
	struct rneagen_options o = options_of(s, s->parts), plain = options_of(s, 1);
	struct target parts, whole;

	generate(s, &o, &parts);
	generate(s, &plain, &whole);
	check_text(s, &parts, &whole);
	if (exhaustive() || !s->is_long)
		run(s, &parts, &whole, _i);
	rneagen_result_free(&parts.text);
	rneagen_result_free(&whole.text);
}
END_TEST

/* What fits stays whole, unless told otherwise. */
static const struct subject FITS[] = {
	{"iiwa14", ALL, 0, RNEAGEN_F64, RNEAGEN_ACCURATE, AUTO, 1, 0},
	{"panda", "want tau,dtau_dq,dtau_dqd\n", 0, RNEAGEN_F32, RNEAGEN_ACCURATE, AUTO, 1, 0},
	{"hyq", ALL, 0, RNEAGEN_F64, RNEAGEN_ACCURATE, AUTO, 1, 0},
	{"atlas", "want M\n", 1, RNEAGEN_F32, RNEAGEN_ACCURATE, AUTO, 1, 0},
};

START_TEST(test_fits)
{
	const struct subject *s = &FITS[_i];
	struct rneagen_options o = options_of(s, AUTO), one = options_of(s, 1), two = options_of(s, 2);
	struct target by_itself, whole, split;

	generate(s, &o, &by_itself);
	generate(s, &one, &whole);
	generate(s, &two, &split);
	ck_assert_ptr_null(strstr(by_itself.text.source, "_part0_"));
	ck_assert_str_eq(strstr(by_itself.text.source, "_rnea_body("), strstr(whole.text.source, "_rnea_body("));
	ck_assert_ptr_nonnull(strstr(split.text.source, "_part1_"));
	rneagen_result_free(&by_itself.text);
	rneagen_result_free(&whole.text);
	rneagen_result_free(&split.text);
}
END_TEST

/* Stores past the cache are for global memory alone: not for what is staged in shared memory, and not for scattered words. */
static const struct stored {
	const char *robot, *scene;
	enum rneagen_target target;
	enum rneagen_layout layout;
	enum rneagen_precision precision;
	int streamed;
} STORED[] = {
	{"iiwa14", ALL, RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 1},
	{"iiwa14", ALL, RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 1},
	{"iiwa14", "want jvp\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 1},
	{"hyq", "want tau,regressor\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 1},
	{"ur5", "want tau,dtau_dq,dtau_dqd\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0}, /* staged */
	{"iiwa14", ALL, RNEAGEN_TARGET_CUDA, RNEAGEN_AOS, RNEAGEN_F32, 0}, /* staged */
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", RNEAGEN_TARGET_CUDA, RNEAGEN_AOS, RNEAGEN_F32, 1}, /* transposed at the end */
	{"atlas", "want tau,regressor\n", RNEAGEN_TARGET_CUDA, RNEAGEN_AOS, RNEAGEN_F32, 1}, /* the same */
	{"atlas", "want M\ndense\n", RNEAGEN_TARGET_CUDA, RNEAGEN_AOS, RNEAGEN_F32, 0}, /* through windows */
	{"iiwa14", NULL, RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 0},
	{"iiwa14", ALL, RNEAGEN_TARGET_C, RNEAGEN_SOA, RNEAGEN_F64, 0},
	{"iiwa14", ALL, RNEAGEN_TARGET_HEADER, RNEAGEN_SOA, RNEAGEN_F32, 0},
};

static struct rneagen_options options_for(const char *scene, enum rneagen_target target, enum rneagen_layout layout)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = scene;
	o.target = target;
	o.layout = layout;
	return o;
}

START_TEST(test_stores)
{
	const struct stored *r = &STORED[_i];
	struct rneagen_options o = options_for(r->scene, r->target, r->layout);
	struct rneagen_result result;
	struct rneagen_error e;
	size_t length;
	char *urdf = target_robot(r->robot, &length);

	o.precision = r->precision;
	ck_assert_msg(!rneagen_generate(urdf, length, &o, &result, &e), "%s", e.message);
	ck_assert_int_eq(strstr(result.source, "RNEA_STORE(tau[") || strstr(result.source, "RNEA_STORE(jvp["), r->streamed);
	ck_assert_int_eq(strstr(result.source, "st.global.cs") != NULL, r->streamed);
	ck_assert_int_eq(strstr(result.source, "[stride] = ") || strstr(result.source, "\ttau[0] = ") ||
		strstr(result.source, "RNEA_HOLD("), !r->streamed);
	rneagen_result_free(&result);
	free(urdf);
}
END_TEST

/* Where a text cannot be in parts, `auto` leaves it whole, and a number is refused. */
static const struct refusal {
	const char *scene, *message;
	enum rneagen_target target;
	enum rneagen_layout layout;
	int parts;
} REFUSALS[] = {
	{NULL, "is for matrices", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, 2},
	{"want jvp\n", "is for matrices", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, 2},
	{ALL, "take --target cuda", RNEAGEN_TARGET_C, RNEAGEN_SOA, 2},
	{ALL, "take --target cuda", RNEAGEN_TARGET_HEADER, RNEAGEN_SOA, 2},
	{ALL, "elements of 7 bodies", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, 8},
};

START_TEST(test_refused)
{
	const struct refusal *r = &REFUSALS[_i];
	struct rneagen_options o = options_for(r->scene, r->target, r->layout);
	struct rneagen_result result;
	struct rneagen_error e;
	size_t length;
	char *urdf = target_robot("iiwa14", &length);

	o.parts = r->parts;
	ck_assert_int_eq(rneagen_generate(urdf, length, &o, &result, &e), RNEAGEN_USAGE);
	ck_assert_msg(strstr(e.message, r->message) != NULL, "%s", e.message);
	o.parts = AUTO;
	ck_assert_msg(!rneagen_generate(urdf, length, &o, &result, &e), "%s", e.message);
	ck_assert_ptr_null(strstr(result.source, "_part0_"));
	rneagen_result_free(&result);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("parts");

	launched_pretend();
	suite_add(s, "parts", test_parts, SUBJECT_COUNT, 600);
	suite_add(s, "fits", test_fits, sizeof FITS / sizeof *FITS, 60);
	suite_add(s, "stores", test_stores, sizeof STORED / sizeof *STORED, 60);
	suite_add(s, "refused", test_refused, sizeof REFUSALS / sizeof *REFUSALS, 60);
	return suite_run(s);
}
