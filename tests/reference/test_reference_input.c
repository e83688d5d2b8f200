// Reading: names, order, defaults, snapped angles, refusals; sampling; random robots.
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/random_robot.h"
#include "reference/test_reference.h"

#define LINKS_ABCD "<link name='a'/><link name='b'/><link name='c'/><link name='d'/>"
#define ENDS(parent, child) "<parent link='" parent "'/><child link='" child "'/></joint>"

static const char tree[] =
	"<robot name='p'><transmission><joint name='z'/></transmission>" LINKS_ABCD "<link name='e'/><link name='f'/>"
	"<joint name='&lt;&amp;&#233;' type='continuous'>" ENDS("a", "b")
	"<joint name='B' type='floating'>" ENDS("a", "c")
	"<joint name='a' type='fixed'>" ENDS("a", "d")
	"<joint name='A' type='planar'>" ENDS("d", "e")
	"<joint name='Z' type='revolute'><mimic joint='&lt;&amp;&#233;' offset='0.5'/><limit lower='-1' upper='2'/>"
	ENDS("d", "f") "</robot>";

static void expect_joint(const struct reference *r, int i, const char *name, int iq, int nq, int iv, int nv, int body)
{
	const struct reference_joint *j = &r->joints[i];

	ck_assert_str_eq(j->name, name);
	ck_assert_int_eq(j->nq, nq);
	ck_assert_int_eq(j->nv, nv);
	ck_assert_int_eq(j->body, body);
	if (nq) {
		ck_assert_int_eq(j->iq, iq);
		ck_assert_int_eq(j->iv, iv);
	}
}

// Byte order: '<' (3c), 'B' (42), 'a' (61); below link d 'A', 'Z'.
START_TEST(test_order)
{
	struct reference *r = open_text(tree, NULL);

	ck_assert_int_eq(r->nj, 6);
	ck_assert_int_eq(r->nq, 11);
	ck_assert_int_eq(r->nv, 10);
	ck_assert_int_eq(r->nb, 4);
	expect_joint(r, 0, "", 0, 0, 0, 0, -1);
	expect_joint(r, 1, "<&\xc3\xa9", 0, 1, 0, 1, 0);
	expect_joint(r, 2, "B", 1, 7, 1, 6, 1);
	expect_joint(r, 3, "a", 0, 0, 0, 0, -1);
	expect_joint(r, 4, "A", 8, 3, 7, 3, 2);
	expect_joint(r, 5, "Z", 0, 0, 0, 0, 3);
	ck_assert_int_eq(r->joints[5].driver, 1);
	ck_assert(r->joints[5].offset == WIDE_C(0.5) && r->joints[5].multiplier == 1);
	reference_close(r);
}
END_TEST

START_TEST(test_order_options)
{
	struct reference *r = open_text(tree, &(struct reference_options){.floating = true, .independent = true});

	ck_assert_int_eq(r->nq, 19);
	ck_assert_int_eq(r->nb, 5);
	expect_joint(r, 0, "", 0, 7, 0, 6, 0);
	expect_joint(r, 3, "a", 0, 0, 0, 0, 0);
	expect_joint(r, 5, "Z", 18, 1, 16, 1, 4);
	reference_close(r);
	r = open_text(tree, &(struct reference_options){.order = "A,<&\xc3\xa9,B"});
	expect_joint(r, 1, "<&\xc3\xa9", 3, 1, 3, 1, 0);
	expect_joint(r, 2, "B", 4, 7, 4, 6, 1);
	expect_joint(r, 4, "A", 0, 3, 0, 3, 2);
	reference_close(r);
}
END_TEST

static const struct {
	const char *order, *urdf, *message;
} refused[] = {
	{NULL, "", "XML"},
	{NULL, "<robot><link name='a'>", "XML"},
	{NULL, "<sdf/>", "outermost"},
	{NULL, "<robot/>", "0 root links"},
	{NULL, "<robot>" LINKS_ABCD "</robot>", "4 root links"},
	{NULL, "<robot><link/></robot>", "missing attribute"},
	{NULL, "<robot><link name='a'/><joint name='j' type='fixed'><parent link='a'/></joint></robot>", "without parent"},
	{NULL, "<robot><link name='a'><inertial><mass value='x'/></inertial></link></robot>", "not a number"},
	{NULL, "<robot><link name='a'/><joint name='j' type='fixed'>" ENDS("a", "b") "</robot>", "missing or has two"},
	{NULL, "<robot>" LINKS_ABCD "<joint name='j' type='fixed'>" ENDS("a", "b") "<joint name='k' type='fixed'>"
	       ENDS("c", "b") "</robot>", "missing or has two"},
	{NULL, "<robot><link name='a'/><link name='b'/><link name='c'/><joint name='j' type='fixed'>" ENDS("c", "b")
	       "<joint name='k' type='fixed'>" ENDS("b", "c") "</robot>", "2 links hang on no root"},
	{NULL, "<robot><link name='a'/><link name='b'/><joint name='j' type='ball'>" ENDS("a", "b") "</robot>",
	       "unknown type"},
	{NULL, "<robot><link name='a'/><link name='b'/><joint name='j' type='planar'><axis xyz='0 0 0'/>" ENDS("a", "b")
	       "</robot>", "no axis"},
	{NULL, "<robot><link name='a'/><link name='b'/><joint name='j' type='continuous'><mimic joint='k'/>" ENDS("a", "b")
	       "</robot>", "mimic leads"},
	{NULL, "<robot><link name='a'/><link name='b'/><joint name='j' type='continuous'><mimic joint='j'/>" ENDS("a", "b")
	       "</robot>", "mimic leads"},
	{"A,B", tree, "2 names for 3"},
	{"A,B,a", tree, "no such joint"},
	{"A,B,B", tree, "no such joint"},
};

START_TEST(test_refusals)
{
	struct reference_options o = {.order = refused[_i].order};
	const char *urdf = refused[_i].urdf;
	char message[256] = "";

	ck_assert(reference_open(urdf, strlen(urdf), &o, message, sizeof message) == NULL);
	ck_assert_msg(strstr(message, refused[_i].message) != NULL, "%s instead of %s", message, refused[_i].message);
}
END_TEST

static wide lifted(const char *angle)
{
	char text[1024];
	const double zero[1] = {0};
	wide tau;

	snprintf(text, sizeof text, "<robot name='p'><link name='a'/><link name='b'><inertial><mass value='1'/></inertial>"
	         "</link><joint name='j' type='prismatic'><origin rpy='0 %s 0'/><axis xyz='1 0 0'/>" ENDS("a", "b")
	         "</robot>", angle);
	struct reference *r = open_text(text, NULL);

	reference_rnea(r, zero, zero, zero, &tau);
	reference_close(r);
	return tau;
}

// An x axis pitched by p works against gravity by -g sin p. Within 5e-15 of a right angle it does so exactly.
START_TEST(test_right_angles)
{
	static const char *const flat[] = {"3.141592653589793", "-3.14159265358979", "6.283185307179586", "0", "3e-15"};
	static const char *const up[] = {"-1.5707963267948966", "-1.570796326794897", "-1.5707963267949",
	                                 "4.71238898038469"};
	const wide g = (wide)9.81;

	for (int i = 0; i < 5; i++)
		ck_assert_msg(lifted(flat[i]) == 0, "%s", flat[i]);
	for (int i = 0; i < 4; i++)
		ck_assert_msg(lifted(up[i]) == g, "%s", up[i]);
	ck_assert(lifted("3.14159265359") != 0);
	ck_assert(lifted("1e-14") == -g * wide_sin((wide)1e-14));
	ck_assert(lifted("-1.57") == g * wide_sin((wide)1.57));
}
END_TEST

// A decimal comma elsewhere changes nothing here.
START_TEST(test_locale)
{
	wide before = lifted("-1.57");

	if (!setlocale(LC_ALL, "de_DE.UTF-8") && !setlocale(LC_ALL, "de_DE"))
		puts("skipped: no locale with a decimal comma");
	ck_assert(lifted("-1.57") == before);
}
END_TEST

START_TEST(test_sample)
{
	struct reference *r = open_text(tree, &(struct reference_options){.independent = true});
	struct rng rng = rng_seed(11);
	double q[ROWS], qd[ROWS], qdd[ROWS];

	for (int k = 0; k < 200; k++) {
		double norm = 0;

		reference_sample(r, &rng, k & 1, q, qd, qdd);
		for (int i = 4; i < 8; i++)
			norm += q[i] * q[i];
		ck_assert(fabs(q[0]) < 3.2 && fabs(q[1]) <= 1 && q[11] >= -1 && q[11] <= 2);
		ck_assert(fabs(norm - 1) < (k & 1 ? 1e-6 : 1e-15));
		for (int i = 0; i < r->nv; i++)
			ck_assert(fabs(qd[i]) <= 2 && fabs(qdd[i]) <= 5 && (!(k & 1) || qd[i] == (double)(float)qd[i]));
	}
	reference_close(r);
}
END_TEST

START_TEST(test_error)
{
	const wide ref[2] = {3, 4}, zero[2] = {0, 0};

	ck_assert(reference_error((const double[]){3, 5}, ref, 2) == 0.2);
	ck_assert(reference_error((const double[]){0, 0}, zero, 2) == 0);
	ck_assert(isinf(reference_error((const double[]){0, 1}, zero, 2)));
	ck_assert(isnan(reference_error((const double[]){(double)NAN, 1}, zero, 2)));
	ck_assert(isnan(reference_error((const double[]){(double)NAN, 1}, ref, 2)));
}
END_TEST

// The first numbers of xoshiro256** from the state 1 2 3 4, as its authors' program prints them.
START_TEST(test_rng)
{
	struct rng r = {{1, 2, 3, 4}};

	ck_assert_uint_eq(rng_next(&r), 11520);
	ck_assert_uint_eq(rng_next(&r), 0);
	ck_assert_uint_eq(rng_next(&r), 1509978240);
	ck_assert_uint_eq(rng_next(&r), 1215971899390074240u);
}
END_TEST

// Equal seeds give equal texts; every robot opens in every option, and moves.
START_TEST(test_random_robot)
{
	for (uint64_t seed = 0; seed < 300; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, 30);
		char *text = random_robot(seed, &knobs), *again = random_robot(seed, &knobs);
		struct reference *r = open_text(text, &(struct reference_options){.floating = seed & 1});

		ck_assert_str_eq(text, again);
		ck_assert_int_eq(r->nj, knobs.links);
		ck_assert_int_gt(r->nv, 0);
		reference_close(r);
		free(text);
		free(again);
	}
}
END_TEST

TCase *input_reading(void)
{
	TCase *t = tcase_create("input");

	tcase_add_test(t, test_order);
	tcase_add_test(t, test_order_options);
	tcase_add_loop_test(t, test_refusals, 0, (int)(sizeof refused / sizeof *refused));
	tcase_add_test(t, test_right_angles);
	tcase_add_test(t, test_locale);
	tcase_add_test(t, test_sample);
	tcase_add_test(t, test_error);
	tcase_add_test(t, test_rng);
	tcase_add_test(t, test_random_robot);
	return t;
}
