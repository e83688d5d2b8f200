/* Files from outside: the directories that RNEAGEN_BAD_URDF and RNEAGEN_ROBOTS name. */
#define _POSIX_C_SOURCE 200809L
#include "support/read.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A file whose name begins so is answered so; `says` is in the message, or in the first warning. */
struct answer {
	const char *begins;
	enum rneagen_code code;
	const char *says;
};

static const struct answer answers[] = {
	{"s01_", RNEAGEN_XML, "the file is empty"},
	{"s02_", RNEAGEN_XML, "not well-formed XML"},
	{"s03_", RNEAGEN_XML, "not well-formed XML"},
	{"s04_", RNEAGEN_TREE, "links 'b' and 'c' both have no parent joint"},
	{"s05_", RNEAGEN_TREE, "links 'x' and 'y' are in a cycle"},
	{"s06_", RNEAGEN_TREE, "joint 'j2': its child link 'nowhere' is not defined"},
	{"s07_", RNEAGEN_URDF, "link 'l2' is already defined"},
	{"s08_", RNEAGEN_TREE, "link 'l2' is the child of two joints, 'j2' and 'j3'"},
	{"s09_", RNEAGEN_NUMBER, "joint 'j1': its axis is 0 0 0"},
	{"s10_", RNEAGEN_NUMBER, "link 'l1': <mass> value=\"nan\""},
	{"s11_", RNEAGEN_NUMBER, "joint 'j1': <origin> xyz=\"inf 0 0\""},
	{"s12_", RNEAGEN_NUMBER, "link 'l1': <mass> value=\"1,5\""},
	{"s13_", RNEAGEN_NUMBER, "link 'l1': its mass -1 is negative"},
	{"s14_", RNEAGEN_OK, "link 'l1': its inertia is not positive definite (eigenvalues -0.9 0.1 1.1)"},
	{"s15_", RNEAGEN_OK, "link 'l2' and all beyond have no <inertial>"},
	{"s16_", RNEAGEN_OK, NULL},
	{"s17_", RNEAGEN_MIMIC, "joint 'j2' mimics joint 'ghost'"},
	{"s18_", RNEAGEN_MIMIC, "joints 'j1' and 'j2' mimic each other"},
	{"s19_", RNEAGEN_OK, NULL},
	{"s20_", RNEAGEN_OK, NULL},
	{"s21_", RNEAGEN_LIMIT, "link 'l1024' is one too many"},
	{"s22_", RNEAGEN_LIMIT, "nested more than 100 deep"},
	{"s23_", RNEAGEN_XML, "a DOCTYPE"},
	{"s24_", RNEAGEN_XACRO, "the file is xacro"},
	{"s25_", RNEAGEN_OK, NULL}, /* no movable joint: a later pass refuses it */
	{"s26_", RNEAGEN_OK, NULL},
	{"s27_", RNEAGEN_OK, NULL},
	{"s28_", RNEAGEN_OK, "joint 'j1': its axis is 2 long, not 1; normalised"},
	{"s29_", RNEAGEN_URDF, "joint 'j1': type \"spherical\" is unknown"},
};

static const struct answer refused[] = {
	{"xfail_falcon", RNEAGEN_TREE, "joint 'top_propeller_joint': its child link 'Z_propeller' is not defined"},
	{"xfail_bullet_humanoid_spherical", RNEAGEN_URDF, "joint 'chest': type \"spherical\" is unknown"},
	{"xfail_microtaur", RNEAGEN_NUMBER, "joint 'dynamixel7_chassis_left': <origin> rpy=\"-3.14159 1.57079 0 0\""},
};

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

static const struct answer *find(const struct answer *table, int count, const char *file)
{
	for (int i = 0; i < count; i++)
		if (!strncmp(file, table[i].begins, strlen(table[i].begins)))
			return &table[i];
	return NULL;
}

static void expect(const struct read *r, const struct answer *a, const char *file)
{
	const char *text = r->error.message;

	ck_assert_msg(r->error.code == a->code, "%s: code %d, not %d: %s", file, r->error.code, a->code, text);
	if (a->code == RNEAGEN_OK)
		text = r->robot.warning_count ? r->robot.warnings[0] : "";
	if (a->says)
		ck_assert_msg(strstr(text, a->says) && !strncmp(text, file, strlen(file)), "%s: \"%s\" lacks \"%s\"",
			file, text, a->says);
	else
		ck_assert_msg(!*text, "%s: %s", file, text);
}

/* The names in the directory that an environment variable gives, or NULL. */
static char **names_from(const char *variable, const char **directory, int *count)
{
	*directory = getenv(variable);
	if (*directory && **directory)
		return names_list(*directory, count);
	printf("skipped: %s is not set\n", variable);
	return NULL;
}

START_TEST(bad_urdf)
{
	const char *directory;
	int count, answered = 0;
	char **names = names_from("RNEAGEN_BAD_URDF", &directory, &count);

	if (!names)
		return;
	for (int i = 0; i < count; i++) {
		const struct answer *a = find(answers, COUNT(answers), names[i]);
		struct read r;

		if (!a)
			continue;
		read_robot(&r, directory, names[i]);
		expect(&r, a, names[i]);
		read_free(&r);
		answered++;
	}
	ck_assert_int_eq(answered, COUNT(answers));
	names_free(names);
}
END_TEST

START_TEST(robots)
{
	const char *directory;
	int count, loaded = 0, turned_away = 0;
	char **names = names_from("RNEAGEN_ROBOTS", &directory, &count);

	if (!names)
		return;
	for (int i = 0; i < count; i++) {
		const struct answer *a = find(refused, COUNT(refused), names[i]);
		struct read r;

		read_robot(&r, directory, names[i]);
		if (a)
			expect(&r, a, names[i]);
		else
			ck_assert_msg(r.error.code == RNEAGEN_OK, "%s", r.error.message);
		loaded += !a;
		turned_away += !!a;
		read_free(&r);
	}
	ck_assert_int_gt(loaded, 0);
	printf("robots: %d loaded, %d refused\n", loaded, turned_away);
	names_free(names);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("robot: files from outside");
	TCase *tc = tcase_create("directories");

	tcase_set_timeout(tc, 120);
	tcase_add_test(tc, bad_urdf);
	tcase_add_test(tc, robots);
	suite_add_tcase(suite, tc);
	return suite_run(suite);
}
