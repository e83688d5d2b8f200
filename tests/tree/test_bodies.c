/* The numbers of the tree: axes and their frames, placements, offsets of followers, and inertias that were merged. */
#define _POSIX_C_SOURCE 200809L
#include "support/plain.h"
#include "support/random_robot.h"
#include "support/read.h"
#include "support/suite.h"
#include "support/merged.h"
#include "support/urdf_text.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 300 };

struct planted {
	struct read from;
	struct tree t;
};

static void plant(struct planted *p, const char *urdf, enum rneagen_base base, enum rneagen_mimic mimic)
{
	struct rneagen_options o = rneagen_options_default();
	struct request k;

	o.base = base;
	o.mimic = mimic;
	read_memory(&p->from, urdf, strlen(urdf), "here");
	merged_tree(&p->t, &k, &p->from.robot, &o, &p->from.arena, &p->from.error);
	ck_assert_msg(!p->from.error.code, "%s", p->from.error.message);
}

static void check_close(real got, real want, real tolerance, const char *what)
{
	ck_assert_msg(fabsl(got - want) <= tolerance, "%s: %.20Lg, not %.20Lg", what, got, want);
}

struct plain_inertia {
	real mass, h[3], I[6];
};

static void check_inertia(const struct inertia *got, const struct plain_inertia *want, const char *what)
{
	check_close(got->mass.x, want->mass, 1e-15L, what);
	for (int i = 0; i < 3; i++)
		check_close(got->h[i].x, want->h[i], 1e-15L, what);
	for (int i = 0; i < 6; i++)
		check_close(got->I[i].x, want->I[i], 1e-15L, what);
}

/* ---- axes ---- */

static const struct axis {
	const char *xyz;
	int axis, sign, turned; /* turned: the frame is, and its z is along the axis */
	real n[3];
} axes[] = {
	{"1 0 0", 0, 1, 0, {1, 0, 0}}, {"0 1 0", 1, 1, 0, {0, 1, 0}}, {"0 0 1", 2, 1, 0, {0, 0, 1}},
	{"-1 0 0", 0, -1, 0, {-1, 0, 0}}, {"0 -1 0", 1, -1, 0, {0, -1, 0}}, {"0 0 -1", 2, -1, 0, {0, 0, -1}},
	{"0 0 5", 2, 1, 0, {0, 0, 1}}, {"-1e-300 0 0", 0, -1, 0, {-1, 0, 0}}, {"0 1e300 -0", 1, 1, 0, {0, 1, 0}},
	{"3 0 4", 2, 1, 1, {0.6L, 0, 0.8L}}, {"0 -3 4", 2, 1, 1, {0, -0.6L, 0.8L}}, {"-4 3 0", 2, 1, 1, {-0.8L, 0.6L, 0}},
	{"1 2 2", 2, 1, 1, {1 / 3.0L, 2 / 3.0L, 2 / 3.0L}}, {"-20 10 20", 2, 1, 1, {-2 / 3.0L, 1 / 3.0L, 2 / 3.0L}},
	{"1 1e-9 0", 2, 1, 1, {1, 1e-9L, 0}},
};

START_TEST(axis_of)
{
	const struct axis *a = &axes[_i];
	static const char *const types[] = {"revolute", "continuous", "prismatic"};

	for (int i = 0; i < 3; i++) {
		char urdf[2048];
		struct planted p;
		const struct body *k;

		snprintf(urdf, sizeof urdf, ROBOT("r", BALL("base") BALL("l") JOINT("j", "%s", "base", "l", AXIS("%s"))),
			types[i], a->xyz);
		plant(&p, urdf, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
		k = &p.t.bodies[0];
		ck_assert_int_eq(k->axis, a->axis);
		ck_assert_int_eq(k->sign, a->sign);
		ck_assert_int_eq(!is_identity(&k->frame), a->turned);
		for (int e = 0; e < 3; e++)
			check_close(k->frame.m[e][k->axis].x * k->sign, a->n[e], 1e-15L, a->xyz);
		read_free(&p.from);
	}
}
END_TEST

/* Planar joints: z of the frame is the axis, whatever it is, and the frame is the shortest turn of z onto it. */
START_TEST(axis_of_planar)
{
	const struct axis *a = &axes[_i];
	struct rotation want;
	struct within n[3];
	char urdf[2048];
	struct planted p;
	const struct body *k;

	snprintf(urdf, sizeof urdf, ROBOT("r", BALL("base") BALL("l") JOINT("j", "planar", "base", "l", AXIS("%s"))), a->xyz);
	plant(&p, urdf, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
	exact(n, a->n, 3);
	want = rotation_shortest(n);
	k = &p.t.bodies[0];
	ck_assert(k->axis == 2 && k->sign == 1);
	for (int e = 0; e < 9; e++)
		check_close(k->frame.m[e / 3][e % 3].x, want.m[e / 3][e % 3].x, 1e-15L, a->xyz);
	read_free(&p.from);
}
END_TEST

/* ---- placements ---- */

static struct placement link_at(const struct robot *r, int link)
{
	const struct joint *j;
	struct placement up, own;

	if (r->links[link].parent_joint < 0)
		return (struct placement){.R = ROTATION_IDENTITY};
	j = &r->joints[r->links[link].parent_joint];
	up = link_at(r, j->parent);
	own = (struct placement){.R = rotation_rpy(j->rpy), .p = {j->xyz[0], j->xyz[1], j->xyz[2]}};
	return placement_mul(&up, &own);
}

static struct placement body_at(const struct tree *t, int body)
{
	struct placement up;

	if (body < 0)
		return (struct placement){.R = ROTATION_IDENTITY};
	up = body_at(t, t->bodies[body].parent);
	return placement_mul(&up, &t->bodies[body].X);
}

static int link_index(const struct robot *r, const char *name)
{
	for (int i = 0; i < r->link_count; i++)
		if (!strcmp(r->links[i].name, name))
			return i;
	ck_abort_msg("no link %s", name);
	return -1;
}

/* At q = 0 the chain of bodies puts every link where the chain of the file's joints puts it, its frame turned. */
static void check_zero_pose(const struct planted *p, uint64_t seed)
{
	for (int i = 0; i < p->t.body_count; i++) {
		const struct body *k = &p->t.bodies[i];
		struct placement body = body_at(&p->t, i), link = link_at(&p->from.robot, link_index(&p->from.robot, k->link));
		struct rotation want = rotation_mul(&link.R, &k->frame);
		char what[64];

		snprintf(what, sizeof what, "seed %llu, body %d", (unsigned long long)seed, k->number);
		for (int e = 0; e < 3; e++)
			check_close(body.p[e].x, link.p[e].x, 1e-13L, what);
		for (int e = 0; e < 9; e++)
			check_close(body.R.m[e / 3][e % 3].x, want.m[e / 3][e % 3].x, 1e-13L, what);
	}
}

/* Inertia of everything at q = 0 in the root's frame, from the file's links or from the bodies. */
static struct inertia whole_robot(const struct robot *r)
{
	struct inertia_sum s = {0};

	for (int i = 0; i < r->link_count; i++) {
		const struct link *l = &r->links[i];
		struct placement at = link_at(r, i);

		if (l->has_inertial)
			inertia_add(&s, &at, l->mass, l->com, l->com_rpy, l->inertia);
	}
	return inertia_total(&s);
}

/* A body's inertia about its origin goes to the root's frame as one about the centre of mass; 0 mass: as it is. */
static void add_body(struct inertia_sum *s, const struct inertia *I, const struct placement *at)
{
	static const struct within straight[3] = {0};
	struct within com[3] = {0}, about[6];
	real c[3] = {0}, sum;

	if (I->mass.x > 0)
		for (int i = 0; i < 3; i++)
			com[i] = within_exact((real)(double)(c[i] = I->h[i].x / I->mass.x));
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			sum = I->I[inertia_index(i, j)].x -
			      I->mass.x * ((i == j ? c[0] * c[0] + c[1] * c[1] + c[2] * c[2] : 0) - c[i] * c[j]);
			about[inertia_index(i, j)] = within_exact((real)(double)sum);
		}
	inertia_add(s, at, within_exact((real)(double)I->mass.x), com, straight, about);
}

static void check_whole(const struct planted *p, uint64_t seed)
{
	struct inertia want = whole_robot(&p->from.robot), got;
	struct placement root = {.R = ROTATION_IDENTITY};
	struct inertia_sum s = {0};
	char what[64];

	add_body(&s, &p->t.fixed, &root);
	for (int i = 0; i < p->t.body_count; i++) {
		struct placement at = body_at(&p->t, i);

		add_body(&s, &p->t.bodies[i].inertia, &at);
	}
	got = inertia_total(&s);
	snprintf(what, sizeof what, "seed %llu, whole robot", (unsigned long long)seed);
	check_close(got.mass.x, want.mass.x, 1e-13L * want.mass.x, what);
	for (int i = 0; i < 3; i++)
		check_close(got.h[i].x, want.h[i].x, 1e-12L * (want.mass.x + 1), what);
	for (int i = 0; i < 6; i++)
		check_close(got.I[i].x, want.I[i].x, 1e-11L * (want.I[0].x + want.I[3].x + want.I[5].x + 1), what);
}

START_TEST(random_trees_at_zero)
{
	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, 2 + (int)(seed % 20));
		char *urdf = random_robot(seed, &knobs);
		struct planted p;

		plant(&p, urdf, seed % 2 ? RNEAGEN_FIXED : RNEAGEN_FLOATING, RNEAGEN_MIMIC_INDEPENDENT);
		check_zero_pose(&p, seed);
		check_whole(&p, seed);
		read_free(&p.from);
		free(urdf);
	}
	printf("%d random trees at zero, seeds 1 to %d\n", ROBOTS, ROBOTS);
}
END_TEST

/* ---- followers ---- */

/* The offset is part of the placement: along or about the axis, with its sign, by the resolved offset. */
START_TEST(offsets_are_placed)
{
	static const char urdf[] = ROBOT("r",
		BALL("base") BALL("a") BALL("b") BALL("c") BALL("d") JOINT("lead", "revolute", "base", "a", "") JOINT(
			"slide", "prismatic", "a", "b",
			ORIGIN("1 2 3", "0 0 0") AXIS("0 -1 0") MIMIC("lead", "2", "0.5")) JOINT("turn", "revolute",
			"b", "c", AXIS("0 0 -1") MIMIC("lead", "-1", "1.5707963267948966")) JOINT("skew", "prismatic",
			"c", "d", ORIGIN("0 0 1", "0 0 0") AXIS("3 0 4") MIMIC("slide", "1", "1")));
	struct placement at;
	struct planted p;
	real shift[3];

	plant(&p, urdf, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
	plain(shift, p.t.bodies[1].X.p, 3);
	ck_assert(shift[0] == 1 && shift[1] == 1.5L && shift[2] == 3);
	ck_assert(is_identity(&p.t.bodies[1].X.R));
	/* -z by +pi/2 is z by -pi/2, exactly */
	ck_assert(p.t.bodies[2].X.R.m[0][1].x == 1 && p.t.bodies[2].X.R.m[1][0].x == -1 && p.t.bodies[2].X.R.m[0][0].x == 0);
	ck_assert_str_eq(p.t.bodies[3].joint, "skew");
	ck_assert(p.t.bodies[3].multiplier.x == 2);
	check_close(p.t.bodies[3].X.p[0].x, 0.6L * 1.5L, 1e-18L, "skew x");
	check_close(p.t.bodies[3].X.p[2].x, 1 + 0.8L * 1.5L, 1e-18L, "skew z");
	at = body_at(&p.t, 3);
	check_close(at.p[1].x, 1.5L - 0.9L, 1e-18L, "all, y");
	read_free(&p.from);
}
END_TEST

/* ---- merging ---- */

/* What hangs on fixed joints joins its body; what hangs on the root is the world's, or the floating base's. */
static const char merged[] = ROBOT("r", POINT("base", "7", "1 0 0") POINT("shelf", "2", "0 0 1") POINT("arm", "3", "1 0 0")
	POINT("hand", "5", "0 2 0") LINK("tool", "1", "0 0 0", "0 0 0", "1", "0.1", "0.2", "2", "0.3", "3") BARE("frame")
		JOINT("s", "fixed", "base", "shelf", ORIGIN("0 0 4", "1.5707963267948966 0 0"))
			JOINT("j", "revolute", "base", "arm", AXIS("0 0 1"))
				JOINT("h", "fixed", "arm", "hand", ORIGIN("0 0 1", "0 0 1.5707963267948966"))
					JOINT("t", "fixed", "hand", "tool", ORIGIN("0 1 0", "0 0 1.5707963267948966"))
						JOINT("f", "fixed", "tool", "frame", ""));

START_TEST(fixed_joints_are_merged)
{
	/* base 7 at (1,0,0), shelf 2 at (0,-1,4) */
	static const struct plain_inertia root = {9, {7, -2, 8}, {2 * 17, 0, 0, 7 + 2 * 16, 2 * 4, 7 + 2 * 1}};
	/* arm 3 at (1,0,0); hand 5 at (-2,0,1); tool 1 at (-1,0,1), its axes turned by pi: xz and yz change sign */
	static const struct plain_inertia moving = {9, {3 - 10 - 1, 0, 5 + 1},
		{5 + 1 + 1, 0.1L, 10 + 1 - 0.2L, 3 + 25 + 2 + 2, -0.3L, 3 + 20 + 1 + 3}};
	struct planted p;

	plant(&p, merged, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
	ck_assert_int_eq(p.t.body_count, 1);
	ck_assert_str_eq(p.t.bodies[0].link, "arm");
	check_inertia(&p.t.fixed, &root, "world");
	check_inertia(&p.t.bodies[0].inertia, &moving, "arm");
	read_free(&p.from);
	plant(&p, merged, RNEAGEN_FLOATING, RNEAGEN_MIMIC_HONOUR);
	ck_assert_int_eq(p.t.body_count, 2);
	ck_assert_str_eq(p.t.bodies[0].link, "base");
	ck_assert_str_eq(p.t.bodies[0].joint, "");
	ck_assert(p.t.fixed.mass.x == 0);
	check_inertia(&p.t.bodies[0].inertia, &root, "base");
	check_inertia(&p.t.bodies[1].inertia, &moving, "arm");
	read_free(&p.from);
}
END_TEST

START_TEST(massless)
{
	struct planted p;

	plant(&p, ROBOT("r", BARE("base") BARE("l") JOINT("j", "revolute", "base", "l", "")), RNEAGEN_FLOATING,
		RNEAGEN_MIMIC_HONOUR);
	for (int k = 0; k < 2; k++) {
		ck_assert(p.t.bodies[k].inertia.mass.x == 0);
		for (int i = 0; i < 6; i++)
			ck_assert(p.t.bodies[k].inertia.I[i].x == 0 && p.t.bodies[k].inertia.h[i % 3].x == 0);
	}
	read_free(&p.from);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bodies");
	TCase *c = tcase_create("numbers");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_add_loop_test(c, axis_of, 0, sizeof axes / sizeof *axes);
	tcase_add_loop_test(c, axis_of_planar, 0, sizeof axes / sizeof *axes);
	tcase_add_test(c, random_trees_at_zero);
	tcase_add_test(c, offsets_are_placed);
	tcase_add_test(c, fixed_joints_are_merged);
	tcase_add_test(c, massless);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
