/* Links that stand are refused exactly where they hold more than joints move: where fewer rows of their Jacobian are independent
   than it has, by the reference's in quad precision. Links of robots and of random trees. Would catch a scene that nothing can
   hold so, whose forces are then any numbers, and one that is refused though it can be held. */
#define _POSIX_C_SOURCE 200809L
#include "kinematics/kin_case.h"
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/read.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST = 7700, LINKS = 9, MOST = 3, ROWS = 6 * MOST, TEXT = 2048 };

/* What is left of a row when those before it are taken off, over the row. Less: it depends on them; the generator's numbers are
   squares of these, with masses in them. More: it does not. Between: who knows. */
static const double DEPENDS = 1e-9, IS_FREE = 1e-3;

static const struct subject {
	const char *robot;
	enum rneagen_base base;
} SUBJECTS[] = {{"iiwa14", RNEAGEN_FIXED}, {"ur5", RNEAGEN_FIXED}, {"ur5", RNEAGEN_FLOATING}, {"panda", RNEAGEN_FIXED},
	{"hyq", RNEAGEN_FLOATING}, {"hyq", RNEAGEN_FIXED}, {"allegro_right", RNEAGEN_FIXED}, {"mimic_chain", RNEAGEN_FLOATING}};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

/* Points that joints move in two directions: the third one is along each axis of theirs in turn. */
static const struct {
	const char *robot, *scene;
	enum rneagen_base base;
} REDUNDANT[] = {
	{"iiwa14", "contact iiwa_link_3\n", RNEAGEN_FIXED},
	{"iiwa14", "add-frame p=iiwa_link_3,0,0,0,0.3,1.5707963267948966,0.7\ncontact p\n", RNEAGEN_FIXED},
	{"iiwa14", "add-frame p=iiwa_link_3,0,0,0,1.5707963267948966,0,0.7\ncontact p\n", RNEAGEN_FIXED},
	{"iiwa14", "lock-all-but iiwa_joint_1,iiwa_joint_2,iiwa_joint_3\ncontact iiwa_link_3\n", RNEAGEN_FIXED},
	{"iiwa14", "contact iiwa_link_ee\ncontact iiwa_link_3\nframe world-aligned\n", RNEAGEN_FIXED},
	{"ur5", "contact wrist_2_link\nweld shoulder_link\nframe world-aligned\n", RNEAGEN_FLOATING},
	{"ur5", "weld wrist_2_link\nweld base_link\nframe world-aligned\ndynamics factor\n", RNEAGEN_FLOATING},
};
enum { REDUNDANT_COUNT = sizeof REDUNDANT / sizeof *REDUNDANT };

struct drawn {
	const char *links[MOST];
	int rows[MOST], count;
	int in_world;
};

static void draw_links(struct drawn *x, struct rng *rng, const struct reference *r)
{
	*x = (struct drawn){.in_world = rng_chance(rng, 0.5)};
	for (int most = 1 + rng_below(rng, MOST); x->count < most;) {
		int drawn = rng_below(rng, r->nj), at = drawn, taken = 0;

		while (at >= 0 && r->joints[at].type == REFERENCE_FIXED)
			at = r->joints[at].parent;
		for (int i = 0; i < x->count; i++)
			taken |= !strcmp(x->links[i], r->joints[drawn].link);
		if (at < 0 || taken) {
			most -= rng_chance(rng, 0.5); /* of few that move */
			continue;
		}
		x->links[x->count] = r->joints[drawn].link;
		x->rows[x->count++] = rng_chance(rng, 0.3) ? 6 : 3;
	}
}

/* ---- the rank ---- */

/* The least that is left of a row of J, in one state. */
static double least_left(wide *J, int rows, int nv)
{
	double least = 1;

	for (int i = 0; i < rows; i++) {
		wide *row = J + i * nv, whole = 0, left = 0;

		for (int k = 0; k < nv; k++)
			whole += row[k] * row[k];
		for (int again = 0; again < 2; again++)
			for (int j = 0; j < i; j++) {
				wide along = 0;

				for (int k = 0; k < nv; k++)
					along += row[k] * J[j * nv + k];
				for (int k = 0; k < nv; k++)
					row[k] -= along * J[j * nv + k];
			}
		for (int k = 0; k < nv; k++)
			left += row[k] * row[k];
		for (int k = 0; k < nv && left > 0; k++)
			row[k] /= wide_sqrt(left);
		least = fmin(least, whole > 0 ? (double)wide_sqrt(left / whole) : 0);
	}
	return least;
}

/* Of the scene's links: Jacobians by the reference, [rows][nv]. -1: nothing moves. */
static double rank(const struct drawn *x, const char *urdf, const struct rneagen_options *options, uint64_t seed)
{
	struct rneagen_options o = *options;
	struct kin_case *c = calloc(1, sizeof *c);
	char scene[TEXT];
	wide J[ROWS * KIN_ROWS];
	double least;
	int at = 0, nv;

	at = snprintf(scene, sizeof scene, "frame world-aligned\nwant jacobian.%s", x->links[0]);
	for (int i = 1; i < x->count; i++)
		at += snprintf(scene + at, sizeof scene - (size_t)at, ",jacobian.%s", x->links[i]);
	o.scene = scene;
	snprintf(c->what, sizeof c->what, "seed %llu", (unsigned long long)seed);
	if (!kin_open(c, urdf, NULL, &o, seed)) {
		free(c);
		return -1;
	}
	kin_draw(c);
	kin_settle(c);
	nv = c->analysis.tree.nv;
	at = 0;
	for (int i = 0; i < x->count; i++) {
		struct kin_matrix m = kin_expected(c, &c->analysis.request.wants[i]);

		ck_assert_int_eq(m.cols, nv);
		memcpy(J + at * nv, m.x, (size_t)(x->rows[i] * nv) * sizeof *J);
		at += x->rows[i];
		kin_matrix_free(&m);
	}
	least = at <= nv ? least_left(J, at, nv) : 0;
	kin_close(c);
	free(c);
	return least;
}

/* ---- the verdict ---- */

enum verdict { HELD, REFUSED, NOT_ASKED, VERDICTS };

static enum verdict ask(const struct drawn *x, const char *urdf, const struct rneagen_options *options, char *scene)
{
	struct rneagen_options o = *options;
	struct rneagen_result text = {0};
	struct rneagen_error e;
	int at = snprintf(scene, TEXT, "want qdd\n%s", x->in_world ? "frame world-aligned\n" : "");

	for (int i = 0; i < x->count; i++)
		at += snprintf(scene + at, (size_t)(TEXT - at), "%s %s\n", x->rows[i] == 6 ? "weld" : "contact", x->links[i]);
	o.scene = scene;
	o.dump = RNEAGEN_DUMP_REQUEST;
	if (!rneagen_generate(urdf, strlen(urdf), &o, &text, &e)) {
		rneagen_result_free(&text);
		return HELD;
	}
	if (!strstr(e.message, "cannot stand"))
		ck_assert_msg(strstr(e.message, "M is singular") || strstr(e.message, "has a mass"), "%s: %s", scene, e.message);
	return strstr(e.message, "cannot stand") ? REFUSED : NOT_ASKED;
}

static void check(const char *urdf, enum rneagen_base base, uint64_t seed, int *found)
{
	struct rneagen_options o = rneagen_options_default();
	struct reference_options ro = {.floating = base == RNEAGEN_FLOATING};
	struct rng rng = rng_seed(seed);
	char message[256], scene[TEXT];
	struct reference *r = reference_open(urdf, strlen(urdf), &ro, message, sizeof message);
	struct drawn x;
	enum verdict v;
	double left;

	ck_assert_msg(r != NULL, "%s", message);
	o.base = base;
	draw_links(&x, &rng, r);
	if (x.count) {
		left = rank(&x, urdf, &o, seed);
		v = left < 0 ? NOT_ASKED : ask(&x, urdf, &o, scene);
		ck_assert_msg(v != HELD || left > DEPENDS, "seed %llu: not refused, %.2g is left:\n%s", (unsigned long long)seed, left, scene);
		ck_assert_msg(v != REFUSED || left < IS_FREE, "seed %llu: refused, but %.2g is left:\n%s", (unsigned long long)seed, left,
			scene);
		found[v]++;
	}
	reference_close(r);
}

static void tell(const char *what, const int *found)
{
	printf("%s: %d held, %d refused, %d not asked\n", what, found[HELD], found[REFUSED], found[NOT_ASKED]);
}

START_TEST(robots)
{
	const struct subject *s = &SUBJECTS[_i];
	char *urdf = robot_text(s->robot);
	int found[VERDICTS] = {0}, count = exhaustive() ? 120 : 20;

	for (int i = 0; i < count; i++)
		check(urdf, s->base, FIRST + (uint64_t)i, found);
	tell(s->robot, found);
	ck_assert_int_gt(found[REFUSED], 0);
	free(urdf);
}
END_TEST

START_TEST(redundant)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result text;
	struct rneagen_error e;
	char *urdf = robot_text(REDUNDANT[_i].robot), scene[TEXT];

	snprintf(scene, sizeof scene, "%swant qdd\n", REDUNDANT[_i].scene);
	o.scene = scene;
	o.base = REDUNDANT[_i].base;
	ck_assert_msg(rneagen_generate(urdf, strlen(urdf), &o, &text, &e), "not refused: %s", scene);
	ck_assert_msg(strstr(e.message, "cannot stand") != NULL, "%s: says '%s'", scene, e.message);
	free(urdf);
}
END_TEST

START_TEST(trees)
{
	int found[VERDICTS] = {0}, count = exhaustive() ? 600 : 60;

	for (int i = 0; i < count; i++) {
		uint64_t seed = FIRST + (uint64_t)i;
		struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
		char *urdf;

		knobs.odd_names = 0;
		urdf = random_robot(seed, &knobs);
		check(urdf, seed % 3 ? RNEAGEN_FLOATING : RNEAGEN_FIXED, seed, found);
		free(urdf);
	}
	tell("trees", found);
	ck_assert_int_gt(found[HELD], count / 10);
	ck_assert_int_gt(found[REFUSED], count / 10);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("contacts rank");

	suite_add(suite, "robots", robots, SUBJECT_COUNT, 120);
	suite_add(suite, "redundant", redundant, REDUNDANT_COUNT, 60);
	suite_add(suite, "trees", trees, 1, 120);
	return suite_run(suite);
}
