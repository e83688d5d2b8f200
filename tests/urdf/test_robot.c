#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "test_robot.h"
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void expect_loaded(const struct read *r, size_t warnings)
{
	ck_assert_msg(r->error.code == RNEAGEN_OK, "%s", r->error.message);
	ck_assert_str_eq(r->error.message, "");
	ck_assert_msg(r->robot.warning_count == warnings, "%s", warnings ? "too few" : r->robot.warnings[0]);
}

static void expect_vector(const struct within *v, double x, double y, double z)
{
	ck_assert(v[0].x == (real)x && v[1].x == (real)y && v[2].x == (real)z);
}

START_TEST(every_number_arrives)
{
	const struct joint *j;
	const struct link *l;
	struct read r;

	read_string(&r, ROBOT("<joint name='b' type='revolute'>" ENDS("base", "arm") ORIGIN "<axis xyz='0 0 -1'/>" LIMIT
			      "<dynamics damping='0.5' friction='0.25'/>"
			      "<mimic joint='a' multiplier='-2' offset='0.125'/></joint>"
			      "<link name='slider'>" INERTIAL "</link>"
			      "<joint name='a' type='prismatic'>" ENDS("arm", "slider") LIMIT "</joint>"));
	expect_loaded(&r, 0);
	ck_assert_str_eq(r.robot.name, "r");
	ck_assert_int_eq(r.robot.link_count, 3);
	ck_assert_int_eq(r.robot.joint_count, 2);
	ck_assert_str_eq(r.robot.links[r.robot.root].name, "base");
	ck_assert_int_eq(r.robot.links[r.robot.root].parent_joint, -1);
	ck_assert_int_eq(r.robot.links[r.robot.root].has_inertial, 0);
	j = &r.robot.joints[0];
	ck_assert_str_eq(j->name, "a");
	ck_assert_int_eq(j->type, JOINT_PRISMATIC);
	ck_assert_int_eq(j->driver, -1);
	expect_vector(j->axis, 1, 0, 0);
	expect_vector(j->xyz, 0, 0, 0);
	j = &r.robot.joints[1];
	ck_assert_str_eq(j->name, "b");
	ck_assert_int_eq(j->type, JOINT_REVOLUTE);
	ck_assert_str_eq(r.robot.links[j->parent].name, "base");
	ck_assert_str_eq(r.robot.links[j->child].name, "arm");
	expect_vector(j->xyz, 0.1, -2e-3, 0.5);
	expect_vector(j->rpy, 1.5707963267948966, 0, -3.141592653589793);
	expect_vector(j->axis, 0, 0, -1);
	ck_assert(j->has_limits && j->lower == -1 && j->upper == 2 && j->effort == 3 && j->velocity == 4);
	ck_assert(j->has_dynamics && j->damping.x == 0.5 && j->friction.x == 0.25);
	ck_assert(j->driver == 0 && j->multiplier.x == -2 && j->offset.x == 0.125);
	l = &r.robot.links[j->child];
	ck_assert_int_eq(l->parent_joint, 1);
	ck_assert(l->has_inertial && l->mass.x == 4);
	expect_vector(l->com, 1, 2, 3);
	expect_vector(l->com_rpy, 0.1, 0.2, 0.3);
	expect_vector(l->inertia, 1, 0.1, 0.2);
	expect_vector(l->inertia + 3, 2, 0.3, 2.5);
	/* decimals, not the doubles nearest to them; half a unit where they are not numbers of the type */
	ck_assert(l->com_rpy[0].near == 0.1L && l->com_rpy[0].e > 0 && l->com_rpy[0].e < 1e-18L);
	ck_assert(l->com[2].near == 3 && l->com[2].e == 0 && j->damping.e == 0 && l->inertia[4].near == 0.3L &&
		l->inertia[4].e > 0);
	ck_assert(j->xyz[1].near == -2e-3L && j->xyz[1].e > 0 && r.robot.joints[0].axis[0].e == 0);
	read_free(&r);
}
END_TEST

/* What may look odd and is no reason to refuse or to warn. */
static const char *const fine[] = {
	/* a mark, a declaration, a plain DOCTYPE, CDATA, a processing instruction */
	"\xef\xbb\xbf<?xml version='1.0' encoding='utf-8'?><!DOCTYPE robot><?note x?>" ROBOT(
		"<![CDATA[<link>]]><joint name='j' type='floating'>" ENDS("base", "arm") "</joint>"),
	"<?xml version='1.0' encoding='utf8'?>" ROBOT("<link name='\xc3\xa9'/><joint name='k' type='fixed'>" ENDS("arm",
		"\xc3\xa9") "</joint><joint name='j' type='fixed'>" ENDS("base", "arm") "</joint>"),
	"<?xml version='1.0'?>" ROBOT("<joint name='j' type='fixed'>" ENDS("base", "arm") "</joint>"),
	/* xacro's namespace alone */
	"<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><link name='base'/></robot>",
	/* visual, collision, material and the like are not looked at */
	ROBOT("<material name='grey'/><material name='grey'><color rgba='a b c'/></material>"
	      "<link name='shell'><visual><origin xyz='a'/><geometry/><material name='none'/></visual>"
	      "<visual name='again'/><collision><geometry><mesh filename='$(find x)'/></geometry></collision></link>"
	      "<joint name='j' type='fixed'>" ENDS("base", "arm") "</joint>"
	      "<joint name='k' type='fixed'>" ENDS("arm", "shell") "<hardware>x</hardware></joint>"
	      "<transmission name='t'><joint name='j'><axis xyz='0'/></joint></transmission>"
	      "<gazebo><link name='base'/><joint name='j'/><plugin value='${x}'/></gazebo>"),
	/* several blanks, also outside; a blank before a single number */
	ROBOT("<joint name='j' type='continuous'>" ENDS("base", "arm") "<origin\n\txyz='  0  1   2 '/>"
	      "<axis xyz=' 0 1 0 '/><dynamics damping=' 1'/></joint>"),
	/* an axis that nobody reads */
	ROBOT("<joint name='j' type='fixed'>" ENDS("base", "arm") "<axis xyz='0 0 0'/></joint>"),
	ROBOT("<joint name='j' type='floating'>" ENDS("base", "arm") "<axis xyz='none'/></joint>"),
	/* an axis of length one but for rounding; an underflow; no attributes */
	ROBOT("<joint name='j' type='planar'>" ENDS("base", "arm") "<dynamics friction='1e-400'/><origin/>"
	      "<axis xyz='0.57735026918962584 0.57735026918962584 0.57735026918962584'/></joint>"),
	/* joints before links */
	"<robot name='r' version='1.0'><joint name='j' type='fixed'>" ENDS("b", "a") "</joint>"
	"<link name='a'/><link name='b'/></robot>",
	"<robot name=''><link name='only'/></robot>",
};

START_TEST(fine_robot)
{
	struct read r;

	read_string(&r, fine[_i]);
	expect_loaded(&r, 0);
	read_free(&r);
}
END_TEST

START_TEST(names_are_kept)
{
	static const char *const names[] = {" ", "*/ evil(); /*", "a\"b\\c", "a&b<c>'", "a\nb", "\xc3\xa9t\xc3\xa9"};
	struct read r;

	read_string(&r, "<robot name='&quot;&#10;'><link name='a&quot;b\\c'/><link name='\xc3\xa9t\xc3\xa9'/>"
			"<link name='a&amp;b&lt;c>&apos;'/><link name=' '/><link name='*/ evil(); /*'/>"
			"<link name='a&#10;b'/>"
			"<joint name='1' type='fixed'>" ENDS(" ", "*/ evil(); /*") "</joint>"
			"<joint name='2' type='fixed'>" ENDS(" ", "a&#x22;b\\c") "</joint>"
			"<joint name='3' type='fixed'>" ENDS(" ", "a&amp;b&lt;c>&apos;") "</joint>"
			"<joint name='4' type='fixed'>" ENDS(" ", "&#233;t&#xe9;") "</joint>"
			"<joint name='5' type='fixed'>" ENDS(" ", "a&#xa;b") "</joint></robot>");
	expect_loaded(&r, 0);
	ck_assert_str_eq(r.robot.name, "\"\n");
	for (int i = 0; i < 6; i++) {
		int found = 0;

		for (int k = 0; k < r.robot.link_count; k++)
			found += !strcmp(r.robot.links[k].name, names[i]);
		ck_assert_msg(found == 1, "link \"%s\" found %d times", names[i], found);
	}
	read_free(&r);
}
END_TEST

START_TEST(joints_are_in_byte_order)
{
	static const char *const order[] = {"B", "a", "a-b", "a.b", "a_b", "b10", "b9", "\xc3\xa9"};
	char *xml = malloc(4096);
	struct read r;
	size_t n;

	ck_assert_ptr_nonnull(xml);
	n = (size_t)snprintf(xml, 4096, "<robot name='r'><link name='base'/>");
	for (int i = 7; i >= 0; i--)
		n += (size_t)snprintf(xml + n, 4096 - n,
			"<link name='%d'/><joint name='%s' type='fixed'>" ENDS("base", "%d") "</joint>", i, order[i],
			i);
	snprintf(xml + n, 4096 - n, "</robot>");
	read_string(&r, xml);
	expect_loaded(&r, 0);
	for (int i = 0; i < 8; i++)
		ck_assert_str_eq(r.robot.joints[i].name, order[i]);
	read_free(&r);
	free(xml);
}
END_TEST

START_TEST(fixed_follower_is_dropped)
{
	struct read r;

	read_robot(&r, TEST_DIR "/bad", "odd_follower.urdf");
	ck_assert_str_eq(r.robot.joints[0].name, "elbow");
	ck_assert_int_eq(r.robot.joints[0].driver, -1);
	read_free(&r);
}
END_TEST

START_TEST(decimal_comma)
{
	static const char *const locales[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "nl_NL.UTF-8"};
	const char *set = NULL;
	struct text t;
	struct read r;

	for (size_t i = 0; i < sizeof locales / sizeof *locales && !set; i++)
		set = setlocale(LC_ALL, locales[i]);
	if (!set) {
		printf("skipped: no locale with a decimal comma is installed\n");
		return;
	}
	read_robot(&r, TEST_DIR "/bad", "odd_axis.urdf");
	ck_assert_msg(r.error.code == RNEAGEN_OK, "%s", r.error.message);
	read_free(&r);
	read_string(&r, ROBOT("<joint name='j' type='planar'>" ENDS("base", "arm") "<axis xyz='0 0.5 0'/></joint>"));
	expect_loaded(&r, 1);
	ck_assert_msg(strstr(r.robot.warnings[0], "0.5 long") != NULL, "%s", r.robot.warnings[0]);
	ck_assert(r.robot.joints[0].axis[1].x == 0.5);
	text_init(&t, &r.arena);
	robot_dump(&r.robot, &t);
	ck_assert_ptr_nonnull(strstr(text_string(&t), "axis 0 0.5 0\n"));
	ck_assert_int_eq(localeconv()->decimal_point[0], ',');
	read_free(&r);
}
END_TEST

/* Moments that are zero but for rounding are zero: only what no body can have is told, with digits that show it. */
START_TEST(inertias)
{
	static const struct {
		const char *xx, *xy, *xz, *yy, *yz, *zz, *says;
	} cases[] = {{"1e-6", "1e-6", "1e-6", "1e-6", "1e-6", "1e-6", NULL}, {"1", "1", "1", "1", "1", "1", NULL},
		{"4", "2", "-2", "1", "-1", "1", NULL}, {"0.36e9", "0.48e9", "0", "0.64e9", "0", "0", NULL},
		{"0", "0", "0", "0", "0", "0", NULL}, {"0", "0", "0", "0", "0", "0.002", NULL},
		{"1", "0", "0", "1", "0", "0", NULL}, {"1", "0", "0", "2", "0", "3", NULL},
		{"1", "0", "0", "2", "0", "3.000001", NULL},
		{"1", "0", "0", "2", "0", "3.000004", "triangle inequality (eigenvalues 1 2 3.000004)"},
		{"0", "0", "0", "1", "0", "2", "triangle inequality (eigenvalues 0 1 2)"},
		{"1", "0", "0", "1", "0", "-1e-12", "not positive definite (eigenvalues -1e-12 1 1)"},
		{"0", "1e-20", "0", "0", "0", "0", "not positive definite (eigenvalues -1e-20 0 1e-20)"},
		{"-1", "0", "0", "-1", "0", "-1", "not positive definite (eigenvalues -1 -1 -1)"}};
	char xml[1024];

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct read r;

		snprintf(xml, sizeof xml, "<robot name='r'><link name='l'><inertial><mass value='1'/><inertia ixx='%s' ixy='%s' ixz='%s' "
			"iyy='%s' iyz='%s' izz='%s'/></inertial></link></robot>", cases[i].xx, cases[i].xy,
			cases[i].xz, cases[i].yy, cases[i].yz, cases[i].zz);
		read_string(&r, xml);
		expect_loaded(&r, cases[i].says != NULL);
		ck_assert_msg(!cases[i].says || strstr(r.robot.warnings[0], cases[i].says) != NULL, "%zu: %s", i,
			r.robot.warnings[0]);
		read_free(&r);
	}
}
END_TEST

/* An axis that is told not to be 1 long is shown so. */
START_TEST(axis_length)
{
	struct read r;

	read_string(&r, ROBOT("<joint name='j' type='continuous'>"
		ENDS("base", "arm") "<axis xyz='0 0 1.000000000004'/></joint>"));
	expect_loaded(&r, 1);
	ck_assert_msg(strstr(r.robot.warnings[0], "its axis is 1.000000000004 long, not 1") != NULL, "%s", r.robot.warnings[0]);
	read_free(&r);
}
END_TEST

START_TEST(dump)
{
	struct text t;
	struct read r;

	read_string(&r, ROBOT("<joint name='a\"' type='prismatic'>" ENDS("base", "arm") ORIGIN LIMIT "</joint>"));
	expect_loaded(&r, 0);
	text_init(&t, &r.arena);
	robot_dump(&r.robot, &t);
	ck_assert_str_eq(text_string(&t),
		"robot \"r\", 2 links, 1 joints, root link \"base\"\n"
		"link \"arm\", parent joint \"a\\\"\"\n"
		"\tmass 4\n"
		"\tcom 1 2 3, rpy 0.1 0.2 0.3\n"
		"\tinertia xx 1 xy 0.1 xz 0.2 yy 2 yz 0.3 zz 2.5\n"
		"link \"base\", no inertial\n"
		"joint \"a\\\"\", prismatic, from \"base\" to \"arm\"\n"
		"\torigin 0.1 -0.002 0.5, rpy 1.5707963267948966 0 -3.141592653589793\n"
		"\taxis 1 0 0\n"
		"\tlimits: lower -1, upper 2, velocity 4, effort 3\n");
	read_free(&r);
}
END_TEST

static Suite *robot_suite(void)
{
	Suite *suite = suite_create("robot");
	TCase *tc = tcase_create("read");

	tcase_set_timeout(tc, 120);
	tcase_add_test(tc, every_number_arrives);
	tcase_add_loop_test(tc, fine_robot, 0, sizeof fine / sizeof *fine);
	tcase_add_test(tc, names_are_kept);
	tcase_add_test(tc, joints_are_in_byte_order);
	tcase_add_test(tc, fixed_follower_is_dropped);
	tcase_add_test(tc, decimal_comma);
	tcase_add_test(tc, inertias);
	tcase_add_test(tc, axis_length);
	tcase_add_test(tc, dump);
	suite_add_tcase(suite, tc);
	suite_add_tcase(suite, case_limits());
	return suite;
}

int main(void)
{

	return suite_run(robot_suite());
}
