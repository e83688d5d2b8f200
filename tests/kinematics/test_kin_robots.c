/* Robots of tests/robots, about every second where not all is asked for, and numerically hard cases: a base and a frame
   1000 km off, angles of 1e5 rad, at the qdd found. In quad precision against the independent reference, and in f64 and
   f32, where an arm of one metre must not lose the digits that the base's 1000 km take. Would catch a sum about the world's
   origin, and a chain of a real robot that is ordered otherwise. */
#define _POSIX_C_SOURCE 200809L
#include "kinematics/kin_case.h"
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/suite.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 77, SCENE = 1024, SAMPLES = 5 };

static const double NOISE = 4 * 0x1p-53, EPS[] = {0x1p-52, 0x1p-23};

/* How many rows of qd move an entry. */
static int chain_rows(const struct reference *r, int entry)
{
	int rows = 0;

	for (int i = entry; i >= 0; i = r->joints[i].parent)
		rows += r->joints[i].driver == i ? r->joints[i].nv : 0;
	return rows;
}

static int deepest(const struct reference *r)
{
	int best = 0;

	for (int i = 0; i < r->nj; i++)
		if (chain_rows(r, i) >= chain_rows(r, best))
			best = i;
	return best;
}

/* The robot of this number. */
static int is_left_out(const char *name, int number)
{
	const int each = sanitized() ? 4 : exhaustive() ? 1 : 2;
	const int is_kept = !sanitized() && has_rare_joints(name);

	/* differences of 75 columns take their time */
	return strncmp(name, "xfail", 5) == 0 || strcmp(name, "chain_75.urdf") == 0 || (number % each && !is_kept);
}

static void check_robot(const char *folder, const char *name, enum rneagen_base base, enum want_frame frame,
	double *worst, int *compared)
{
	static const char *const frames[] = {"link", "world", "world-aligned"};
	struct kin_case *c = calloc(1, sizeof *c);
	struct rneagen_options o = rneagen_options_default();
	const struct reference_options ro = {.floating = base == RNEAGEN_FLOATING};
	size_t length;
	char *urdf = read_text(folder, name, &length), scene[SCENE], message[256];
	struct reference *r = reference_open(urdf, strlen(urdf), &ro, message, sizeof message);
	const char *link;

	ck_assert_msg(r != NULL, "%s: %s", name, message);
	link = r->joints[deepest(r)].link;
	snprintf(scene, sizeof scene,
		"want pose.%s,jacobian.%s,djacobian.%s,opspace_inv.%s%s%s\nwant "
		"com,vcom,com_jacobian,momentum,momentum_matrix,dmomentum,coriolis\n"
		"frame %s\n",
		link, link, link, link, chain_rows(r, deepest(r)) >= 6 ? ",opspace." : "",
		chain_rows(r, deepest(r)) >= 6 ? link : "", frames[frame]);
	o.scene = scene;
	o.base = base;
	snprintf(c->what, sizeof c->what, "%s, %s, frame %s, seed %d", name,
		base == RNEAGEN_FLOATING ? "floating" : "fixed", frames[frame], SEED);
	if (kin_open(c, urdf, NULL, &o, SEED)) {
		kin_draw(c);
		kin_evaluate(c);
		*compared += kin_compare(c, NOISE);
		*worst = c->worst > *worst ? c->worst : *worst;
		kin_close(c);
	}
	reference_close(r);
	free(urdf);
	free(c);
}

static void check_folder(const char *folder, int least)
{
	struct dirent **names;
	int count = scandir(folder, &names, NULL, alphasort), robots = 0, compared = 0;
	double worst = 0;

	for (int i = 0; i < count; i++) {
		const char *dot = strrchr(names[i]->d_name, '.');

		if (dot && !strcmp(dot, ".urdf") && !is_left_out(names[i]->d_name, i)) {
			for (int floating = 0; floating < 2; floating++)
				check_robot(folder, names[i]->d_name, floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED,
					(enum want_frame)((robots + floating) % 3), &worst, &compared);
			robots++;
		}
		free(names[i]);
	}
	free(names);
	printf("%s: %d robots, %d arrays, seed %d, off by %.2g of the tolerance at most\n", folder, robots,
		compared, SEED, worst);
	ck_assert_int_ge(robots, sanitized() ? least / 5 : exhaustive() ? least : least / 2);
	ck_assert_int_gt(compared, 10 * robots);
}

START_TEST(own)
{
	check_folder(TEST_DIR "/robots", 25);
}
END_TEST

START_TEST(others)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");

	if (folder && exhaustive())
		check_folder(folder, 10);
	else
		printf("skipped: %s\n", folder ? "only with RNEAGEN_ALL=1" : "RNEAGEN_ROBOTS is not set");
}
END_TEST

/* ---- hard cases ---- */

static const struct hard {
	const char *name, *robot, *scene;
	enum rneagen_base base;
	double far;            /* m, of the base */
	double angle;          /* rad, added to each joint that turns */
	double noise;          /* eps of the largest element */
} HARD[] = {
	{"a base 1000 km off, arms", "hyq",
		"want jacobian.lf_foot,djacobian.lf_foot,com_jacobian,vcom,momentum,momentum_matrix,dmomentum\n"
		"frame world-aligned\n",
		RNEAGEN_FLOATING, 1e6, 0, 16},
	{"a base 1000 km off, places", "atlas", "want pose.l_foot,com\n", RNEAGEN_FLOATING, 1e6, 0, 4},
	{"a base 1000 km off, in the world", "hyq", "want jacobian.rh_foot,djacobian.rh_foot\nframe world\n",
		RNEAGEN_FLOATING, 1e6, 0, 16},
	{"a base 1000 km off, in the link", "hyq",
		"want jacobian.rh_foot,djacobian.rh_foot,opspace_inv.rh_foot,coriolis\nframe link\n", RNEAGEN_FLOATING,
		1e6, 0, 64},
	{"angles of 1e5 rad", "iiwa14",
		"want pose.iiwa_link_ee,jacobian.iiwa_link_ee,djacobian.iiwa_link_ee,com,momentum_matrix,dmomentum\n",
		RNEAGEN_FIXED, 0, 1e5, 16},
	{"angles of 1e5 rad, quaternion", "panda",
		"want pose.panda_hand_tcp,jacobian.panda_hand\npose quaternion\nframe world\n", RNEAGEN_FIXED, 0, -1e5,
		32},
	{"a frame 1000 km off", "ur5",
		"add-frame far=tool0,1e6,-7e5,3e5,0.1,0.2,0.3\nwant pose.far,jacobian.far,djacobian.far\nframe world-aligned\n",
		RNEAGEN_FIXED, 0, 0, 16},
	{"a frame 1000 km off, in the link", "ur5",
		"add-frame far=tool0,1e6,-7e5,3e5,0.1,0.2,0.3\nwant jacobian.far,djacobian.far\nframe link\n",
		RNEAGEN_FIXED, 0, 0, 64},
};
enum { HARD_COUNT = sizeof HARD / sizeof *HARD };

static void make_hard(struct kin_case *c, const struct hard *h)
{
	static const double off[3] = {1, -0.7, 0.3};

	for (int i = 0; i < c->reference->nj; i++) {
		const struct reference_joint *j = &c->reference->joints[i];

		for (int k = 0; k < 3 && j->nq == 7 && h->far > 0; k++)
			c->q[j->iq + k] = h->far * off[k];
		if (j->nq == 1 && (j->type == REFERENCE_REVOLUTE || j->type == REFERENCE_CONTINUOUS))
			c->q[j->iq] += h->angle;
	}
	kin_settle(c);
}

START_TEST(hard)
{
	const struct hard *h = &HARD[_i];
	struct rneagen_options o = rneagen_options_default();
	char *urdf = robot_text(h->robot);

	o.scene = h->scene;
	o.base = h->base;
	for (int is_f32 = 0; is_f32 < 2; is_f32++) {
		struct kin_case *c = calloc(1, sizeof *c);

		snprintf(c->what, sizeof c->what, "%s, %s, %s, seed %d", h->name, h->robot, is_f32 ? "f32" : "f64", SEED);
		c->added[c->added_count++] = (struct kin_added){"far", "tool0", {1e6, -7e5, 3e5, 0.1, 0.2, 0.3}};
		ck_assert(kin_open(c, urdf, NULL, &o, SEED));
		for (int k = 0; k < SAMPLES; k++) {
			kin_draw(c);
			make_hard(c, h);
			kin_round(c, is_f32);
			kin_evaluate(c);
			c->is_by_largest = 0;
			if (!is_f32) /* a quaternion of floats is of no unit length */
				kin_compare(c, NOISE);
			c->is_by_largest = 1;
			kin_evaluate_rounded(c, is_f32);
			c->worst = 0;
			kin_compare(c, h->noise * EPS[is_f32]);
		}
		printf("%s: off by %.2g of %g eps of the largest element\n", c->what, c->worst, h->noise);
		kin_close(c);
		free(c);
	}
	free(urdf);
}
END_TEST

/* ---- at the qdd found ---- */

START_TEST(forward)
{
	static const struct {
		const char *robot;
		enum rneagen_base base;
	} of[] = {{"iiwa14", RNEAGEN_FIXED}, {"panda", RNEAGEN_FIXED}, {"hyq", RNEAGEN_FLOATING}};
	struct kin_case *c = calloc(1, sizeof *c);
	struct rneagen_options o = rneagen_options_default();
	char *urdf = robot_text(of[_i].robot);

	o.scene = "want qdd,dmomentum,momentum,vcom,coriolis\n";
	o.base = of[_i].base;
	snprintf(c->what, sizeof c->what, "%s at the qdd found, seed %d", of[_i].robot, SEED);
	ck_assert(kin_open(c, urdf, NULL, &o, SEED));
	for (int k = 0; k < SAMPLES; k++) {
		kin_draw(c);
		kin_evaluate(c);
		ck_assert_int_eq(kin_compare(c, 64 * NOISE), 4);
	}
	kin_close(c);
	free(c);
	free(urdf);
}
END_TEST

/* ---- what is always zero ---- */

/* dJ/dt qd of a frame that is one with a floating base is 0, since qdd is the spatial acceleration: numbers that cancel but for
   their rounding would be an error without bounds. In axes of the world it is classical. */
START_TEST(rates_of_a_base)
{
	static const struct {
		const char *frame;
		int is_zero;
	} of[] = {{"link", 1}, {"world", 1}, {"world-aligned", 0}};
	struct kin_case *c = calloc(1, sizeof *c);
	struct rneagen_options o = rneagen_options_default();
	char *urdf = robot_text("hyq"), scene[100];
	int varying = 0;

	snprintf(scene, sizeof scene, "add-frame camera=trunk,0.1,0.2,0.3,0.3,0.2,0.1\nwant djacobian.camera\nframe %s\n", of[_i].frame);
	o.scene = scene;
	o.base = RNEAGEN_FLOATING;
	c->added[c->added_count++] = (struct kin_added){"camera", "trunk", {0.1, 0.2, 0.3, 0.3, 0.2, 0.1}};
	ck_assert(kin_open(c, urdf, NULL, &o, SEED));
	for (size_t k = 0; k < c->analysis.dag.output_count; k++)
		varying += c->analysis.dag.outputs[k].value.i != 0;
	ck_assert_int_eq(varying, of[_i].is_zero ? 0 : 3);
	kin_close(c);
	free(c);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("kinematics of robots");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "own", own, 1, 3000);
	suite_add(suite, "others", others, 1, 3000);
	suite_add(suite, "hard", hard, HARD_COUNT, 300);
	suite_add(suite, "forward", forward, 3, 300);
	suite_add(suite, "rates_of_a_base", rates_of_a_base, 3, 30);
	return suite_run(suite);
}
