/* Constants that a scene changes: angles that are nearly right become right and no others do, digits go, and what is said
   of both is what the reference finds. Seeds printed. */
#define _POSIX_C_SOURCE 200809L
#include "tell/effect.h"
#include "support/exhaustive.h"
#include "support/scene_model.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 10 };
#define ROBOTS (exhaustive() ? 60 : 20) /* random trees */

/* The angle PART of two joints and of an inertial. */
#define BENT(part)                                                                                                           \
	ROBOT("bent", BALL("base") BALL("a") LINK("b", "2", "0.1 0.2 0.3", part " 0 0", "0.1", "0", "0", "0.2", "0", "0.25") BALL("c") \
		JOINT("ja", "revolute", "base", "a", ORIGIN("0 0 1", part " 0 0") AXIS("0 0 1"))                                 \
			JOINT("jb", "revolute", "a", "b", ORIGIN("0.2 0 1", "0 -" part " 0") AXIS("0 0 1"))                      \
				JOINT("jc", "prismatic", "b", "c", ORIGIN("0 0.3 0", "0 0 0.7") AXIS("0 1 0")))

static const char nearly[] = BENT("1.57075"), right[] = BENT("1.5707963267948966");

static void open_or_fail(struct scene_model *m, const char *urdf, const char *scene)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = scene;
	ck_assert_msg(!scene_open(m, urdf, &o), "%s", m->error.message);
	ck_assert_msg(!effect_measure(&m->effects, &m->analysis), "%s", m->error.message);
}

static void check_same_dag(const struct dag *a, const struct dag *b)
{
	ck_assert_uint_eq(a->count, b->count);
	for (size_t i = 0; i < a->count; i++)
		ck_assert(a->nodes[i].op == b->nodes[i].op && a->nodes[i].value == b->nodes[i].value);
}

START_TEST(snapped)
{
	struct scene_model plain, at, below, exact;

	open_or_fail(&plain, nearly, NULL);
	open_or_fail(&at, nearly, "snap-angle 5e-5");
	open_or_fail(&below, nearly, "snap-angle 4e-5");
	open_or_fail(&exact, right, NULL);
	check_same_dag(&at.dag, &exact.dag);
	check_same_dag(&below.dag, &plain.dag);
	ck_assert_uint_gt(operation_total(&plain), operation_total(&exact));
	/* all three are listed while they stand, and what there is to win */
	ck_assert_int_eq(plain.analysis.outcome.angle_count, 3);
	ck_assert_int_eq(exact.analysis.outcome.angle_count, 0);
	ck_assert_int_eq(exact.effects.count, 0);
	ck_assert_str_eq(plain.analysis.outcome.angles[2].what, "inertial of link");
	ck_assert(fabs(plain.analysis.outcome.angles[0].off - (1.5707963267948966 - 1.57075)) < 1e-12);
	ck_assert_int_eq(plain.effects.count, 1);
	ck_assert(!plain.effects.of[0].is_asked && plain.effects.of[0].argument == 1e-4);
	ck_assert(at.effects.of[0].is_asked && at.effects.of[0].argument == 5e-5);
	ck_assert(at.effects.of[0].saved == plain.effects.of[0].saved && at.effects.of[0].change == plain.effects.of[0].change);
	ck_assert_int_eq(below.effects.of[0].saved, 0);
	ck_assert_int_eq(at.effects.of[0].saved, (long)(operation_total(&plain) - operation_total(&exact)));
	ck_assert(below.effects.of[0].change == 0);
	scene_close(&plain);
	scene_close(&at);
	scene_close(&below);
	scene_close(&exact);
}
END_TEST

/* The reference of the two robots, over states of its own: sampled figures are within a factor of each other. */
START_TEST(change_is_sampled)
{
	struct rneagen_options o = rneagen_options_default();
	struct reference *a = scene_reference(nearly, &o), *b = scene_reference(right, &o);
	struct rng rng = rng_seed(5);
	struct scene_model m;
	double change = 0, most = 0, largest = 0, share;

	open_or_fail(&m, nearly, NULL);
	for (int k = 0; k < 400; k++) {
		double q[3], qd[3], qdd[3], off = 0, size = 0;
		wide x[3], y[3];

		for (int i = 0; i < 3; i++) { /* the limits of JOINT, and the ranges of effect_measure */
			q[i] = rng_uniform(&rng, -1, 1);
			qd[i] = rng_uniform(&rng, -1, 1);
			qdd[i] = rng_uniform(&rng, -10, 10);
		}
		reference_rnea(a, q, qd, qdd, x);
		reference_rnea(b, q, qd, qdd, y);
		for (int i = 0; i < 3; i++) {
			off = hypot(off, (double)(x[i] - y[i]));
			size = hypot(size, (double)x[i]);
			change = fmax(change, fabs((double)(x[i] - y[i])));
		}
		most = fmax(most, off);
		largest = fmax(largest, size);
	}
	share = most / largest;
	printf("seed 5: %g and %g of |tau|, sampled %g and %g\n", change, share, m.effects.of[0].change, m.effects.of[0].share);
	ck_assert(m.effects.of[0].change > 0.7 * change && m.effects.of[0].change < 1.05 * change);
	ck_assert(m.effects.of[0].share > 0.5 * share && m.effects.of[0].share < 2 * share);
	scene_close(&m);
	reference_close(a);
	reference_close(b);
}
END_TEST

/* ---- digits ---- */

static void check_digits(const struct within *x, const struct within *whole, int count, int digits, uint64_t seed)
{
	for (int i = 0; i < count; i++) {
		char text[64];
		real back;

		snprintf(text, sizeof text, "%.*Le", digits - 1, x[i].x);
		back = strtold(text, NULL);
		ck_assert_msg(back == x[i].x, "seed %llu: %.20Lg has more than %d digits",
			(unsigned long long)seed, x[i].x, digits);
		ck_assert_msg(fabsl(x[i].x - whole[i].x) <= 0.5000001L * fabsl(whole[i].x) * powl(10, (real)(1 - digits)),
			"seed %llu: %.20Lg, not near %.20Lg", (unsigned long long)seed, x[i].x, whole[i].x);
	}
}

START_TEST(rounded)
{
	static const char *const scenes[] = {"round-constants 3", "round-constants 17"};

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct scene_model whole, m;
		char *urdf = torque_robot(seed, LINKS, 0);
		int digits = _i ? 17 : 3;

		open_or_fail(&whole, urdf, "params urdf");
		open_or_fail(&m, urdf, scenes[_i]);
		for (int k = 0; k < m.tree.body_count; k++) {
			const struct body *x = &m.tree.bodies[k], *y = &whole.tree.bodies[k];

			check_digits(&x->X.R.m[0][0], &y->X.R.m[0][0], 9, digits, seed);
			check_digits(x->X.p, y->X.p, 3, digits, seed);
			check_digits(&x->inertia.mass, &y->inertia.mass, 1, digits, seed);
			check_digits(x->inertia.h, y->inertia.h, 3, digits, seed);
			check_digits(x->inertia.I, y->inertia.I, 6, digits, seed);
		}
		ck_assert_msg(m.effects.of[0].share < (_i ? 1e-13 : 0.05), "seed %llu: %g", (unsigned long long)seed,
			m.effects.of[0].share);
		scene_close(&m);
		scene_close(&whole);
		free(urdf);
	}
}
END_TEST

/* ---- small terms ---- */

#define SLANTED(ixy) ROBOT("slanted", BALL("base") BALL("a")       \
	JOINT("ja", "revolute", "base", "a", AXIS("1 0 0")) LINK("b", "1", "0 0 0.2", "0 0 0", "0.1", ixy, "0", "0.2", "0", "0.25")  \
		JOINT("jb", "revolute", "a", "b", ORIGIN("0 0 1", "0 0 0") AXIS("0 1 0")))

/* A product of inertia that no torque feels is as good as none; one that is felt stays. */
START_TEST(dropped_as_if_zero)
{
	struct scene_model tiny, none, felt, kept;

	open_or_fail(&tiny, SLANTED("1e-9"), "drop-below 1e-6:sampled");
	open_or_fail(&none, SLANTED("0"), "drop-below 1e-6:sampled");
	open_or_fail(&felt, SLANTED("1e-2"), "drop-below 1e-6:sampled");
	open_or_fail(&kept, SLANTED("1e-9"), NULL);
	ck_assert_uint_eq(operation_total(&tiny), operation_total(&none));
	ck_assert_uint_gt(operation_total(&felt), operation_total(&none));
	ck_assert_uint_gt(operation_total(&kept), operation_total(&none));
	ck_assert_int_eq(tiny.effects.of[0].saved, (long)(operation_total(&kept) - operation_total(&tiny)));
	ck_assert(tiny.effects.of[0].share > 0 && tiny.effects.of[0].share < 1e-6);
	scene_close(&tiny);
	scene_close(&none);
	scene_close(&felt);
	scene_close(&kept);
}
END_TEST

#define SCALED(e) ROBOT("scaled",                                                                                      \
	BALL("base") LINK("a", "2" e, "0.1 0.2 0.3", "0 0 0", "0.1" e, "0", "0", "0.2" e, "0", "0.25" e)               \
	JOINT("ja", "revolute", "base", "a", AXIS("1 0 0"))                                                            \
	LINK("b", "1" e, "0.001 0 0.2", "0 0 0", "0.1" e, "0.0001" e, "0", "0.2" e, "0", "0.25" e)                     \
		JOINT("jb", "revolute", "a", "b", ORIGIN("0 0.002 1", "0 0 0") AXIS("0 1 0")))

/* The width of friction is nothing beside the velocities that are sampled, and all that there is at rest. */
START_TEST(friction_at_rest)
{
	static const char text[] = ROBOT("r", BALL("base") BALL("a") JOINT("ja", "revolute", "base", "a",
		AXIS("0 0 1") "<dynamics damping='0' friction='2'/>"));
	struct scene_model m;
	struct pose p = {.nq = 1, .nv = 1};
	struct torque t;

	open_or_fail(&m, text, "friction 1e-6\ndrop-below 1e-3:sampled");
	/* q is not among the inputs */
	ck_assert(eval_real(&m.dag, (const real *[]){p.qd, p.qdd, NULL}, (real *[]){NULL, NULL, t.tau}, NULL));
	ck_assert(t.tau[0] == 0);
	p.qd[0] = 1e-6L;
	ck_assert(eval_real(&m.dag, (const real *[]){p.qd, p.qdd, NULL}, (real *[]){NULL, NULL, t.tau}, NULL));
	ck_assert(fabsl(t.tau[0] - sqrtl(2)) < 1e-9L);
	scene_close(&m);
}
END_TEST

/* A fraction of the joint's torque, not of a newton metre. */
START_TEST(dropped_at_any_scale)
{
	struct scene_model light, heavy, whole;

	open_or_fail(&light, SCALED("e-6"), "params urdf\ndrop-below 1e-2:sampled");
	open_or_fail(&heavy, SCALED("e6"), "params urdf\ndrop-below 1e-2:sampled");
	open_or_fail(&whole, SCALED("e6"), "params urdf");
	ck_assert_uint_eq(operation_total(&light), operation_total(&heavy));
	ck_assert_uint_lt(operation_total(&heavy), operation_total(&whole));
	scene_close(&light);
	scene_close(&heavy);
	scene_close(&whole);
}
END_TEST

/* The largest change over states of the test's own, by rows, as a part of the row's largest torque. */
static double change_of(const struct scene_model *m, struct reference *r, uint64_t seed)
{
	struct rng rng = rng_seed(seed);
	double change[ROWS] = {0}, largest[ROWS] = {0}, share = 0;

	for (int k = 0; k < 200; k++) {
		struct pose p;
		struct torque t;
		double q[ROWS], qd[ROWS], qdd[ROWS];
		wide tau[ROWS];

		pose_random(&p, r, &rng);
		for (int i = 0; i < ROWS; i++) {
			q[i] = (double)p.q[i];
			qd[i] = (double)p.qd[i];
			qdd[i] = (double)p.qdd[i];
		}
		torque_of(&m->dag, &p, &t);
		reference_rnea(r, q, qd, qdd, tau);
		for (int i = 0; i < r->nv; i++) {
			change[i] = fmax(change[i], (double)fabsl(t.tau[i] - (real)tau[i]));
			largest[i] = fmax(largest[i], (double)fabsl((real)tau[i]));
		}
	}
	for (int i = 0; i < r->nv; i++)
		share = change[i] > 0 ? fmax(share, change[i] / largest[i]) : share;
	return share;
}

/* Terms add up: what the reference sees stays within so many of them. */
START_TEST(dropped)
{
	static const char *const scenes[] = {"drop-below 1e-18:sampled", "drop-below 1e-5:sampled", "drop-below 1e-3:sampled"};
	static const double limits[] = {1e-12, 40e-5, 40e-3};
	double worst = 0;
	long saved = 0;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct rneagen_options o = rneagen_options_default();
		struct scene_model whole, m;
		char *urdf = torque_robot(seed, LINKS, 0);
		struct reference *r = scene_reference(urdf, &o);
		double share;

		open_or_fail(&whole, urdf, "params urdf");
		open_or_fail(&m, urdf, scenes[_i]);
		ck_assert_int_eq(m.dag.argument_count, 4);
		share = change_of(&m, r, seed);
		ck_assert_msg(share < limits[_i], "%s, seed %llu: %g", scenes[_i], (unsigned long long)seed, share);
		ck_assert_msg(operation_total(&m) <= operation_total(&whole), "%s, seed %llu", scenes[_i],
			(unsigned long long)seed);
		worst = fmax(worst, share);
		saved += m.effects.of[m.effects.count - 1].saved;
		scene_close(&m);
		scene_close(&whole);
		reference_close(r);
		free(urdf);
	}
	printf("%s, seeds 1 to %d: %ld flops saved, torques change by up to %.2g of the largest\n", scenes[_i],
		ROBOTS, saved, worst);
	ck_assert(_i == 0 || saved > 0);
}
END_TEST

/* ---- what is refused, and what is said ---- */

static const struct refused {
	const char *scene, *message;
} refuseds[] = {
	{"snap-angle -1", "here: scene line 1, snap-angle: takes an angle from 0 to 0.1 rad, not -1"},
	{"snap-angle 0.2", "here: scene line 1, snap-angle: takes an angle from 0 to 0.1 rad, not 0.2"},
	{"snap-angle 1e-4 rad", "here: scene line 1, snap-angle: takes a finite number, not '1e-4 rad'"},
	{"round-constants 0", "here: scene line 1, round-constants: takes a whole number from 1 to 17, not 0"},
	{"round-constants 2.5", "here: scene line 1, round-constants: takes a whole number from 1 to 17, not 2.5"},
	{"drop-below 1", "here: scene line 1, drop-below: takes a fraction from 0 to below 1, not 1"},
	{"drop-below 0.1:often", "here: scene line 1, drop-below: takes FRACTION or FRACTION:sampled, not '0.1:often'"},
	{"drop-below x:sampled", "here: scene line 1, drop-below: takes a finite number, not 'x'"},
	{"range qd=-1,1\ndrop-below 0.1",
		"here: scene line 2, drop-below: no limit is known of qdd: give --range NAME=LOWER,UPPER for each, or "
		"FRACTION:sampled, which proves nothing"},
	{"drop-below -0.1", "here: scene line 1, drop-below: takes a fraction from 0 to below 1, not -0.1"},
	{"round-constants 18", "here: scene line 1, round-constants: takes a whole number from 1 to 17, not 18"},
};

START_TEST(refuses)
{
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.file = "here";
	o.scene = refuseds[_i].scene;
	ck_assert_int_eq(scene_open(&m, right, &o), RNEAGEN_SCENE);
	ck_assert_str_eq(m.error.message, refuseds[_i].message);
	scene_close(&m);
}
END_TEST

static void expect(const char *text, const char *part)
{
	ck_assert_msg(strstr(text, part) != NULL, "no '%s' in\n%.4000s", part, text);
}

/* A comment's lines as one: they go on where a line is full. */
static void expect_in_comment(const char *text, const char *part)
{
	char *line = malloc(strlen(text) + 1), *to = line;

	for (const char *s = text; *s; s++) {
		if (!strncmp(s, "\n *", 3))
			s += 3 + strspn(s + 3, " ") - 1;
		*to++ = *s;
	}
	*to = '\0';
	expect(line, part);
	free(line);
}

START_TEST(told)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct rneagen_error e;

	o.tell = RNEAGEN_TELL_ALL;
	ck_assert(!rneagen_generate(nearly, sizeof nearly - 1, &o, &r, &e));
	expect(r.info, "\nangles that are nearly right, rad\n  joint 'ja', by 4.6e-05\n  joint 'jb', by 4.6e-05\n"
		       "  inertial of link 'b', by 4.6e-05\n");
	expect(r.info, "\nchanged constants\n  --snap-angle 0.0001 would save ");
	expect(r.info_json, "  \"nearly_right\": [\n    {\"joint\": \"ja\", \"off\": 4.63");
	expect(r.info_json, "{\"option\": \"snap-angle\", \"value\": 0.0001, \"asked\": false, \"saved\": ");
	ck_assert_ptr_null(strstr(r.source, "snap-angle"));
	rneagen_result_free(&r);
	o.scene = "round-constants 5\nsnap-angle 1e-4";
	ck_assert(!rneagen_generate(nearly, sizeof nearly - 1, &o, &r, &e));
	expect(r.source, "\n * --snap-angle 0.0001 saves ");
	expect(r.source, "\n * --round-constants 5 saves ");
	expect_in_comment(r.source, ", sampled in 100 states ");
	rneagen_result_free(&r);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("scene_constants");
	TCase *c = tcase_create("constants");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_test(c, snapped);
	tcase_add_test(c, change_is_sampled);
	tcase_add_loop_test(c, rounded, 0, 2);
	tcase_add_test(c, dropped_as_if_zero);
	tcase_add_test(c, dropped_at_any_scale);
	tcase_add_test(c, friction_at_rest);
	tcase_add_loop_test(c, dropped, 0, 3);
	tcase_add_loop_test(c, refuses, 0, sizeof refuseds / sizeof *refuseds);
	tcase_add_test(c, told);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
