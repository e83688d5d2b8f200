/* Loops over limbs that are alike, in kernels: what they give beside the whole text compiled as C, for robots whose limbs mirror
   each other, turn the other way, and follow; which texts have loops, and which have none. */
#include "launched.h"
#include "base/text.h"
#include "support/exhaustive.h"
#include "target/launch_library.h"
#include "support/suite.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 1300, SEED = 20261127, LARGE_BLOCK = 512 }; /* beyond what the limbs' kernel takes; no multiple of a block */

/* Two legs on the ground, and a back that carries a neck and two arms. Each arm has fingers, the last joint of which follows the
   one before it. */
struct shape {
	int leg, arm, fingers; /* links of a leg, and of an arm */
	/* the right arm has one link more; no joint turns the other way; the neck follows the left arm's first joint */
	enum { MIRRORED, UNEVEN, STRAIGHT, FOLLOWED } how;
};

static const struct subject {
	struct shape shape;
	const char *scene, *order;
	enum rneagen_precision precision;
	int floating, loops, again, threads; /* what is to be found in the text */
	int is_long;                         /* others run nearly the same: where all is asked for */
} SUBJECTS[] = {
	{{6, 7, 3, MIRRORED}, "", NULL, RNEAGEN_F64, 0, 2, 0, 1, 1},
	{{6, 7, 5, MIRRORED}, "", NULL, RNEAGEN_F32, 0, 2, 0, 1, 1},
	{{6, 7, 5, MIRRORED}, "", NULL, RNEAGEN_F64, 1, 2, 0, 1, 1},
	{{6, 7, 3, UNEVEN}, "", NULL, RNEAGEN_F64, 0, 0, 0, 0, 1}, /* only the legs are alike, and fingers */
	{{6, 7, 2, MIRRORED}, "want tau,vjp\n", NULL, RNEAGEN_F64, 0, 2, 1, 1, 0},
	{{6, 10, 0, MIRRORED}, "want tau,vjp\n", NULL, RNEAGEN_F32, 0, 2, 1, 0, 1},
	{{6, 11, 0, MIRRORED}, "want tau,vjp\n", NULL, RNEAGEN_F32, 0, 2, 1, 1, 1}, /* more values than registers hold */
	{{4, 5, 1, MIRRORED}, "want tau,bias,gravity\n", NULL, RNEAGEN_F64, 0, 2, 0, 1, 1},
	{{6, 7, 3, MIRRORED}, "want tau,vjp\nfold qdd=0\n", NULL, RNEAGEN_F64, 0, 2, 1, 1, 1},
	/* a wrench that the other limb does not feel */
	{{6, 7, 3, STRAIGHT}, "fext right_103\nfext back_1\n", NULL, RNEAGEN_F64, 0, 2, 0, 1, 1},
	{{6, 7, 3, STRAIGHT}, "free payload.right_103:sample\n", NULL, RNEAGEN_F64, 0, 2, 0, 1, 1},
	{{3, 12, 0, MIRRORED}, "", "legs", RNEAGEN_F64, 0, 2, 0, 0, 0}, /* rows of the legs in turn */
	{{6, 9, 11, MIRRORED}, "", NULL, RNEAGEN_F32, 1, 2, 0, 1, 1},
	{{32, 2, 0, MIRRORED}, "", NULL, RNEAGEN_F32, 0, 2, 0, 1, 1}, /* legs that leave nothing */
	{{6, 9, 5, FOLLOWED}, "", NULL, RNEAGEN_F64, 0, 0, 0, 0, 1},
	/* motion is made again from a joint's row on to the next */
	{{6, 10, 0, MIRRORED}, "want tau,vjp\n", "last first", RNEAGEN_F64, 0, 2, 0, 1, 1},
};

/* Of one side. Coordinates across are mirrored, and each third joint may turn the other way on the right. */
struct side {
	const char *name;
	int sign, turns;
};

static const struct side LEFT = {"left", 1, 1}, RIGHT = {"right", -1, -1}, STRAIGHT_RIGHT = {"right", -1, 1},
			 MIDDLE = {"back", 1, 1};

/* Links from number `first` on, the first of which hangs on another link. The last joint follows `driver`; NULL: none. */
static void put_chain(struct text *t, const struct side *s, int first, int links, const char *parent, const char *driver)
{
	static const char *const axes[] = {"0 %d 0", "0 0 %d", "%d 0 0"};

	for (int i = first; i < first + links; i++) {
		char axis[32];

		snprintf(axis, sizeof axis, axes[i % 3], i % 3 == 2 ? s->turns : 1);
		text_printf(t,
			"<link name='%s_%d'><inertial><origin xyz='0.1 %g 0.05'/><mass value='%g'/><inertia ixx='0.02' iyy='0.03' izz='0.04' "
			"ixy='%g' ixz='0.002' iyz='%g'/></inertial></link>\n",
			s->name, i, s->sign * 0.02, 1 + 0.1 * (i % 3) + 0.01 * s->sign, s->sign * 0.001, s->sign * 0.003);
		text_printf(t, "<joint name='%s_j%02d' type='revolute'><parent link='", s->name, i);
		if (i > first)
			text_printf(t, "%s_%d", s->name, i - 1);
		else
			text_put(t, parent);
		text_printf(t, "'/><child link='%s_%d'/><origin xyz='0.2 %g 0.1' rpy='%g 0.2 0'/><axis xyz='%s'/><limit lower='-3' upper='3' "
			"effort='9' velocity='3'/>", s->name, i, s->sign * 0.05, s->sign * 0.3, axis);
		if (driver && i == first + links - 1)
			text_printf(t, "<mimic joint='%s' multiplier='0.5' offset='0.1'/>", driver);
		text_put(t, "</joint>\n");
	}
}

static void put_side(struct text *t, const struct shape *x, const struct side *s)
{
	int arm = x->arm + (x->how == UNEVEN && s->sign < 0);
	char hand[32], before[32];

	put_chain(t, s, 100, x->leg, "ground", NULL);
	put_chain(t, s, 0, arm, "back_1", NULL);
	snprintf(hand, sizeof hand, "%s_%d", s->name, arm - 1);
	for (int i = 0; i < x->fingers; i++) {
		snprintf(before, sizeof before, "%s_j%02d", s->name, 21 + 3 * i);
		put_chain(t, s, 20 + 3 * i, 3, hand, before);
	}
}

/* The legs' rows in turn, or each leg's last row first; then all others, side by side. */
static const char *order_text(const struct shape *x, const char *order, struct text *t)
{
	int turned = strcmp(order, "legs");

	for (int i = 0; i < x->leg && !turned; i++)
		text_printf(t, "left_j%02d,right_j%02d,", 100 + i, 100 + i);
	for (int i = 2 * x->leg; i-- > 0 && turned;)
		text_printf(t, "%s_j%02d,", i < x->leg ? "right" : "left", 100 + i % x->leg);
	text_put(t, "back_j00,back_j01,back_j50");
	for (int side = 0; side < 2; side++)
		for (int i = 0; i < x->arm; i++)
			text_printf(t, ",%s_j%02d", side ? "right" : "left", i);
	return text_string(t);
}

static void generate(const struct subject *s, const struct rneagen_options *given, struct target *t)
{
	struct rneagen_options o = *given;
	struct arena a;
	struct text urdf, order;

	arena_init(&a, NULL);
	text_init(&urdf, &a);
	text_init(&order, &a);
	o.precision = s->precision;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.scene = *s->scene ? s->scene : NULL;
	o.order = s->order ? order_text(&s->shape, s->order, &order) : NULL;
	text_put(&urdf, "<robot name='mirrored'><link name='ground'/>\n");
	put_chain(&urdf, &MIDDLE, 0, 2, "ground", NULL);
	put_chain(&urdf, &MIDDLE, 50, 1, "back_1", s->shape.how == FOLLOWED ? "left_j00" : NULL);
	put_side(&urdf, &s->shape, &LEFT);
	put_side(&urdf, &s->shape, s->shape.how == STRAIGHT ? &STRAIGHT_RIGHT : &RIGHT);
	text_put(&urdf, "</robot>\n");
	target_generate(t, text_string(&urdf), urdf.length, &o, "mirrored");
	arena_free(&a);
}

static int count_loops(const char *source)
{
	int count = 0;

	for (const char *at = source; (at = strstr(at, "for (unsigned each = ")); at++)
		count++;
	return count;
}

static void check(
	const struct subject *s, const struct target *t, enum rnea_backend backend, unsigned block, const struct launch *y)
{
	struct launch x = launched_run(launched_open(t, backend, block), COUNT, SEED, s->floating);
	double worst = launched_distance(&x, y, "mirrored");

	printf("%d and %d links, %d fingers, blocks of %u: within %.1e, seed %d\n", s->shape.leg, s->shape.arm, s->shape.fingers,
		block, worst, SEED);
	ck_assert_double_lt(worst, s->precision == RNEAGEN_F32 ? 2e-5 : 1e-13);
	launched_free(&x);
}

START_TEST(test_values)
{
	const struct subject *s = &SUBJECTS[_i];
	struct rneagen_options o = rneagen_options_default(), plain;
	struct target loops, whole;
	struct launch one;

	if (s->is_long && !exhaustive())
		return;
	o.layout = RNEAGEN_AOS;
	plain = o;
	plain.parts = 1;
	generate(s, &o, &loops);
	generate(s, &plain, &whole);
	ck_assert_int_eq(count_loops(loops.text.source), s->loops);
	ck_assert_int_eq(count_loops(whole.text.source), 0);
	ck_assert_int_eq(strstr(loops.text.source, " = RNEA_READ_ANEW(") != NULL, s->again);
	ck_assert_int_eq(strstr(loops.text.source, "\"threads 2 ") != NULL, s->threads);
	one = launched_run(launched_open(&whole, RNEA_BACKEND_HOST, 0), COUNT, SEED, s->floating);
	check(s, &loops, RNEA_BACKEND_CUDA, _i % 2 ? LARGE_BLOCK : 0, &one);
	if (exhaustive()) {
		check(s, &loops, RNEA_BACKEND_CUDA, _i % 2 ? 0 : LARGE_BLOCK, &one);
		check(s, &loops, RNEA_BACKEND_HOST, 0, &one);
	}
	launched_free(&one);
	rneagen_result_free(&loops.text);
	rneagen_result_free(&whole.text);
}
END_TEST

/* NAME_rnea_launch, as nvcc builds it, of a text whose limbs have threads of their own. */
START_TEST(test_launch)
{
	int (*launch)(void *q, void *qd, void *qdd, void *weights, void *tau, void *vjp, size_t count, void *stream);
	struct rneagen_options o = rneagen_options_default();
	const struct subject *s = &SUBJECTS[4];
	unsigned *grid, *block;
	struct launch x, y;
	struct target t;
	void *library;

	o.layout = RNEAGEN_AOS;
	generate(s, &o, &t);
	library = launch_library(&t, "each_launch", "#define FAKE_WAITS 1\n#define RNEA_NO_LIMBS",
		"FAKE_ENTRY_WAITS(mirrored_rnea_kernel)");
	target_symbol(&t, library, "mirrored_rnea_launch", &launch);
	target_symbol(&t, library, "fake_grid", &grid);
	target_symbol(&t, library, "fake_block", &block);
	x = launched_run(launched_open(&t, RNEA_BACKEND_CUDA, 0), COUNT, SEED, 0);
	y = launched_run(launched_open(&t, RNEA_BACKEND_CUDA, 0), COUNT, SEED + 1, 0);
	for (size_t k = 0; k < x.info->input_count; k++)
		memcpy(y.arrays[k], x.arrays[k], COUNT * x.info->arguments[k].rows * sizeof(double));
	ck_assert_int_eq(launch(y.arrays[0], y.arrays[1], y.arrays[2], y.arrays[3], y.arrays[4], y.arrays[5], COUNT, NULL), 0);
	ck_assert_uint_eq(*block, 2 * x.info->block);
	ck_assert_uint_eq(*grid, (COUNT + x.info->block - 1) / x.info->block);
	ck_assert_double_lt(launched_distance(&x, &y, "mirrored"), 1e-13);
	launched_free(&x);
	launched_free(&y);
	dlclose(library);
	rneagen_result_free(&t.text);
}
END_TEST

static void expect_none(const struct subject *s, const struct rneagen_options *o)
{
	struct target t;

	generate(s, o, &t);
	ck_assert_msg(count_loops(t.text.source) == 0, "%s, precision %d, floating %d", s->scene, (int)s->precision, s->floating);
	rneagen_result_free(&t.text);
}

/* Rows side by side, the same bits for all, a precision that was not measured, a vjp on a base that moves, an
   input that all samples share, accelerations, and few operations. */
START_TEST(test_none)
{
	struct rneagen_options aos = rneagen_options_default(), soa = aos, strict, segments, c;
	struct subject s = SUBJECTS[0];

	aos.layout = RNEAGEN_AOS;
	strict = segments = c = aos;
	strict.strict = 1;
	segments.segments = 1000;
	c.target = RNEAGEN_TARGET_C;
	expect_none(&s, &soa);
	expect_none(&s, &strict);
	expect_none(&s, &segments);
	expect_none(&s, &c);
	s.precision = RNEAGEN_MIXED;
	expect_none(&s, &aos);
	s = SUBJECTS[4];
	s.floating = 1;
	expect_none(&s, &aos);
	s.shape = (struct shape){0, 12, 0, MIRRORED}; /* rows for qd would stand where the other arm's first input is */
	expect_none(&s, &aos);
	s = SUBJECTS[0];
	s.scene = "free gravity\n";
	expect_none(&s, &aos);
	s.scene = "want qdd\n";
	expect_none(&s, &aos);
	s = SUBJECTS[0];
	s.shape = (struct shape){2, 3, 0, MIRRORED};
	expect_none(&s, &aos);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("each");

	launched_pretend();
	suite_add(s, "values", test_values, sizeof SUBJECTS / sizeof *SUBJECTS, 300);
	suite_add(s, "launch", test_launch, 1, 120);
	suite_add(s, "none", test_none, 1, 120);
	return suite_run(s);
}
