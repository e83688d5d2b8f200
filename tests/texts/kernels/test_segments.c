/* Kernels in segments: values as those of the whole text compiled as C, on the pretended driver, where each thread
   takes one sample or several, where a block's shared memory has room for their values and where it has not, and where
   an angle of one of them is large; what the runtime says of it, and which texts are cut. This would catch a value
   fetched from another's slot, a sample that a grid leaves out, and a second round that loses a sample. Texts for
   target C in segments: test_targets, against the independent reference. Derivatives of qdd of one sample by a loop over
   their columns: as those of the whole text, which has none; this would catch a column left out or solved twice, a factor of
   another row, and the end of a batch, whose rows are apart. */
#include "launched.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* With blocks of 32 threads: so many samples that a thread takes three, or four, and that some blocks are not full;
   with blocks of 1024 one block, and a piece of one. */
enum { SMALL = 32, MANY = 32 * 512 * 3 + 77, LARGE = 1024, FEW = 1400, SEED = 20261124 };

static const struct subject {
	const char *name, *scene;
	int floating, segments;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
	unsigned samples; /* of a thread, at most */
} SUBJECTS[] = {
	{"iiwa14", "", 0, 60, RNEAGEN_F32, RNEAGEN_ACCURATE, 4},
	{"iiwa14", "want wrench.iiwa_joint_3,tau\n", 0, 100, RNEAGEN_F64, RNEAGEN_BOUNDED, 2},
	{"mimic_chain", "", 1, 40, RNEAGEN_F64, RNEAGEN_ACCURATE, 2},
	{"planar_joint", "free gravity\n", 1, 50, RNEAGEN_MIXED, RNEAGEN_ACCURATE, 2},
	{"ur5", "want qdd\nrefine 1\n", 0, 90, RNEAGEN_F32, RNEAGEN_ACCURATE, 4},
	{"double_pendulum", "want tau,M\n", 0, 20, RNEAGEN_F32X2, RNEAGEN_ACCURATE, 2},
	{"ur5", "vjp tau\njvp vjp\n", 1, 300, RNEAGEN_F64, RNEAGEN_ACCURATE, 2},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

static void generate(const struct subject *s, int segments, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();

	o.precision = s->precision;
	o.trig = s->trig;
	o.segments = segments;
	o.parts = 1;
	o.limbs = RNEAGEN_LIMBS_NONE;
	launched_generate(t, s->name, s->scene, s->floating, &o);
}

START_TEST(test_values)
{
	const struct subject *s = &SUBJECTS[_i / 2];
	int is_small = _i % 2;
	size_t count = is_small ? MANY : FEW;
	struct target cut, whole;
	struct launch x, y;
	double worst;

	if (!exhaustive() && is_small != _i / 2 % 2)
		return;
	generate(s, s->segments, &cut);
	generate(s, RNEAGEN_SEGMENTS_WHOLE, &whole);
	x = launched_run(launched_open(&cut, RNEA_BACKEND_CUDA, is_small ? SMALL : LARGE), count, SEED, s->floating);
	y = launched_run(launched_open(&whole, RNEA_BACKEND_HOST, 0), count, SEED, s->floating);
	ck_assert_uint_eq(x.info->functions[0].most_samples, s->samples);
	ck_assert_uint_gt(x.info->functions[0].across_bytes, 0);
	ck_assert_uint_eq(y.info->functions[0].most_samples, 1);
	ck_assert_uint_eq(y.info->functions[0].across_bytes, 0);
	worst = launched_distance(&x, &y, s->name);
	printf("%s, %zu bytes across, blocks of %u: within %.1e, seed %d\n", s->name, x.info->functions[0].across_bytes,
		x.info->block, worst, SEED);
	ck_assert_double_lt(worst, s->precision == RNEAGEN_F32 ? 2e-5 : s->precision == RNEAGEN_MIXED ? 1e-6 : 1e-12);
	launched_free(&x);
	launched_free(&y);
	rneagen_result_free(&cut.text);
	rneagen_result_free(&whole.text);
}
END_TEST

static const struct looped {
	const char *name, *scene;
	int floating, loops;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	int is_strict, is_long; /* to compile */
} LOOPED[] = {
	{"hyq", "want dqdd_dqd,kinetic,M\n", 1, 1, RNEAGEN_F64, RNEAGEN_SOA, 0, 0},
	{"hyq", "want qdd,dqdd_dq\nfext lf_foot\nfext-frame world\nfree payload.trunk\n", 1, 1, RNEAGEN_F64, RNEAGEN_AOS,
		0, 1},
	{"panda", "want dqdd_dq,dqdd_dqd\nderivatives forward\n", 1, 1, RNEAGEN_F64, RNEAGEN_SOA, 0, 1},
	{"g1_29dof", "want dqdd_dq\n", 0, 3, RNEAGEN_F64, RNEAGEN_SOA, 0, 1}, /* its legs feel nothing of the rest */
	{"allegro_right", "want dqdd_dqd,dqdd_dq\n", 0, 4, RNEAGEN_F64, RNEAGEN_SOA, 0, 0},
	{"iiwa14", "want qdd,dqdd_dqd,dqdd_dq\ndense\n", 0, 1, RNEAGEN_F32, RNEAGEN_AOS, 0, 0},
	{"two chains", "want dqdd_dq,dqdd_dqd\n", 0, 2, RNEAGEN_F64, RNEAGEN_AOS, 0, 0},
	{"two chains", "want dqdd_dqd\ndense\n", 0, 2, RNEAGEN_F32, RNEAGEN_SOA, 0, 1},
	{"stage", "want dqdd_dq,dqdd_dqd\n", 1, 0, RNEAGEN_F64, RNEAGEN_SOA, 0, 0},
	{"hyq", "want dqdd_dq\n", 1, 0, RNEAGEN_F64, RNEAGEN_SOA, 1, 0},
	{"hyq", "want dqdd_dq\n", 0, 0, RNEAGEN_F64, RNEAGEN_SOA, 0, 0}, /* legs that do not feel each other */
	{"hyq", "want dqdd_dq\n", 1, 0, RNEAGEN_MIXED, RNEAGEN_SOA, 0, 0},
	{"hyq", "want dqdd_dq\ndynamics articulated\n", 1, 0, RNEAGEN_F64, RNEAGEN_SOA, 0, 0},
	{"hyq", "want qdd,dqdd_dq\nvjp dqdd_dq\n", 1, 0, RNEAGEN_F64, RNEAGEN_SOA, 0, 0},
};

/* On the ground: neither feels the other. */
static void generate_chains(const struct rneagen_options *o, struct target *t)
{
	enum { LINKS = 10 };
	char urdf[16384];
	int n = snprintf(urdf, sizeof urdf, "<robot name='chains'><link name='world'/>");

	for (int k = 0; k < 2 * LINKS; k++) {
		char parent[16];

		snprintf(parent, sizeof parent, k < 2 ? "world" : "l%02d", k - 2);
		n += snprintf(urdf + n, sizeof urdf - (size_t)n,
			"<link name='l%02d'><inertial><origin xyz='0.1 0.02 %g'/><mass value='%g'/>"
			"<inertia ixx='0.02' iyy='0.03' izz='0.04' ixy='0.001' ixz='0' iyz='0.002'/></inertial></link>"
			"<joint name='j%02d' type='revolute'><parent link='%s'/><child link='l%02d'/>"
			"<origin xyz='0.2 0.1 %g' rpy='0.3 0 %g'/><axis xyz='0 %d %d'/>"
			"<limit lower='-3' upper='3' effort='9' velocity='9'/></joint>",
			k, 0.01 * k, 1 + 0.1 * k, k, parent, k, 0.3 - 0.2 * (k % 2), 0.1 * k, k / 2 % 2, 1 - k / 2 % 2);
	}
	n += snprintf(urdf + n, sizeof urdf - (size_t)n, "</robot>");
	ck_assert_int_lt(n, (int)sizeof urdf);
	target_generate(t, urdf, (size_t)n, o, "two chains");
}

/* A factor of its mass matrix is an input, q, which no loop is told. */
static void generate_stage(const struct rneagen_options *o, struct target *t)
{
	char urdf[4096];
	int n = snprintf(urdf, sizeof urdf, "<robot name='stage'><link name='l'><inertial><mass value='3'/>"
		"<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>");

	for (int k = 0; k < 3; k++)
		n += snprintf(urdf + n, sizeof urdf - (size_t)n,
			"<link name='l%d'><inertial><mass value='2'/>"
			"<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
			"<joint name='j%d' type='prismatic'><parent link='%s'/><child link='l%d'/><axis xyz='%d %d %d'/>"
			"<limit lower='-1' upper='1' effort='9' velocity='9'/></joint>",
			k, k, k == 0 ? "l" : k == 1 ? "l0" : "l1", k, k == 0, k == 1, k == 2);
	n += snprintf(urdf + n, sizeof urdf - (size_t)n, "</robot>");
	target_generate(t, urdf, (size_t)n, o, "stage");
}

static void generate_looped(const struct looped *s, int segments, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();

	o.target = RNEAGEN_TARGET_C;
	o.precision = s->precision;
	o.layout = s->layout;
	o.strict = s->is_strict;
	o.segments = segments;
	o.scene = s->scene;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	if (!strcmp(s->name, "two chains"))
		generate_chains(&o, t);
	else if (!strcmp(s->name, "stage"))
		generate_stage(&o, t);
	else
		launched_generate(t, s->name, s->scene, s->floating, &o);
}

/* One sample, and a batch whose last samples are fewer than a segment runs for. */
static void compare_looped(const struct looped *s, const struct target *looped, const struct target *whole)
{
	struct rnea_robot *a = launched_open(looped, RNEA_BACKEND_HOST, 0), *b = launched_open(whole, RNEA_BACKEND_HOST, 0);

	for (size_t count = 1; count <= 77; count += 76) {
		struct launch x = launched_run(a, count, SEED, s->floating), y = launched_run(b, count, SEED, s->floating);
		double worst = launched_distance(&x, &y, s->name);

		printf("%s, columns of %zu samples: within %.1e, seed %d\n", looped->what, count, worst, SEED);
		ck_assert_double_lt(worst, s->precision == RNEAGEN_F32 ? 1e-3 : 1e-9);
		launched_drop(&x);
		launched_drop(&y);
	}
	rnea_close(a);
	rnea_close(b);
}

START_TEST(test_looped)
{
	const struct looped *s = &LOOPED[_i];
	struct target looped, whole;

	generate_looped(s, RNEAGEN_SEGMENTS_AUTO, &looped);
	generate_looped(s, RNEAGEN_SEGMENTS_WHOLE, &whole);
	ck_assert_int_eq(strstr(looped.text.source, "_columns0(") != NULL, s->loops > 0);
	for (int loop = 1; loop < 5; loop++) {
		char function[16];

		snprintf(function, sizeof function, "_columns%d(", loop);
		ck_assert_int_eq(strstr(looped.text.source, function) != NULL, s->loops > loop);
	}
	ck_assert_ptr_null(strstr(whole.text.source, "_columns0("));
	if (s->loops && (exhaustive() || !s->is_long))
		compare_looped(s, &looped, &whole);
	rneagen_result_free(&looped.text);
	rneagen_result_free(&whole.text);
}
END_TEST

/* What is cut where nobody says. */
static const struct choice {
	const char *name, *scene;
	enum rneagen_target target;
	enum rneagen_layout layout;
	enum rneagen_precision precision;
	int only, is_cut;
	enum rneagen_base base;
} CHOICES[] = {
	{"iiwa14", "", RNEAGEN_TARGET_C, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FIXED},
	{"atlas", "", RNEAGEN_TARGET_C, RNEAGEN_SOA, RNEAGEN_F64, 0, 1, RNEAGEN_FIXED},
	{"atlas", "", RNEAGEN_TARGET_C, RNEAGEN_AOS, RNEAGEN_F32, 0, 1, RNEAGEN_FIXED},
	{"atlas", "", RNEAGEN_TARGET_C, RNEAGEN_SOA, RNEAGEN_F64, 1, 1, RNEAGEN_FIXED}, /* no batches */
	{"atlas", "", RNEAGEN_TARGET_HEADER, RNEAGEN_SOA, RNEAGEN_F64, 0, 1, RNEAGEN_FIXED}, /* in lanes */
	{"iiwa14", "", RNEAGEN_TARGET_HEADER, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FIXED},
	{"atlas", "", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 0, 0, RNEAGEN_FIXED},
	{"atlas", "", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FIXED},       /* staged */
	{"chain_75", "", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FIXED}, /* too many values go across */
	{"hyq", "want tau,vjp\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_MIXED, 0, 1, RNEAGEN_FLOATING},
	{"hyq", "want tau,vjp\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FLOATING}, /* motion is made again */
	{"hyq", "want tau,jvp\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0, 1, RNEAGEN_FLOATING},
	{"atlas", "want qdd\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FIXED}, /* parts */
	{"atlas", "want qdd\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 0, 0, RNEAGEN_FIXED},
	/* too many values go across */
	{"atlas", "want qdd\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F64, 0, 0, RNEAGEN_FLOATING},
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", RNEAGEN_TARGET_CUDA, RNEAGEN_SOA, RNEAGEN_F32, 0, 0, RNEAGEN_FIXED}, /* parts */
};

START_TEST(test_chosen)
{
	const struct choice *c = &CHOICES[_i];
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot(c->name, &length);
	struct target t, whole;

	o.scene = *c->scene ? c->scene : NULL;
	o.target = c->target;
	o.layout = c->layout;
	o.precision = c->precision;
	o.only = c->only;
	o.base = c->base;
	target_generate(&t, urdf, length, &o, c->name);
	ck_assert_int_eq(strstr(t.text.source, "_segment1(") != NULL, c->is_cut);
	rneagen_result_free(&t.text);
	o.segments = RNEAGEN_SEGMENTS_WHOLE;
	if (c->is_cut || exhaustive()) {
		target_generate(&whole, urdf, length, &o, c->name);
		ck_assert_ptr_null(strstr(whole.text.source, "_segment1("));
		rneagen_result_free(&whole.text);
	}
	free(urdf);
}
END_TEST

/* The most zeros that a function of a text stores among its lines. */
static int most_zeros(const char *text)
{
	static const char zero[] = " = 0.0;\n";
	int most = 0, count = 0;

	for (const char *s = text; *s; s++) {
		if (!strncmp(s, "\n}\n", 3))
			count = 0;
		count += !strncmp(s, zero, sizeof zero - 1);
		most = count > most ? count : most;
	}
	return most;
}

/* Hundreds of zeros are stored in loops. gcc took 13 minutes and more for those of floating panda among lines. */
START_TEST(test_zeros)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot("iiwa14", &length);
	struct target t;

	o.scene = "want tau,regressor\n";
	o.target = RNEAGEN_TARGET_C;
	o.precision = RNEAGEN_F64;
	o.base = RNEAGEN_FLOATING;
	o.layout = _i ? RNEAGEN_AOS : RNEAGEN_SOA;
	target_generate(&t, urdf, length, &o, "iiwa14");
	ck_assert_ptr_nonnull(strstr(t.text.source, "rneagen_zeros_regressor[rneagen_run]"));
	ck_assert_int_lt(most_zeros(t.text.source), 32);
	rneagen_result_free(&t.text);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("segments");

	launched_pretend();
	suite_add(s, "values", test_values, 2 * SUBJECT_COUNT, 600);
	suite_add(s, "looped", test_looped, sizeof LOOPED / sizeof *LOOPED, 120);
	suite_add(s, "chosen", test_chosen, sizeof CHOICES / sizeof *CHOICES, 60);
	suite_add(s, "zeros", test_zeros, 2, 60);
	return suite_run(s);
}
