/* What --info says that each choice of a scene saves, against texts made with and without it. */
#include "support/read.h"
#include "rneagen.h"
#include "support/generated.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct rneagen_result make(const char *urdf, const char *scene, enum rneagen_precision precision)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = scene;
	o.precision = precision;
	o.tell = RNEAGEN_TELL_ALL;
	return generated(urdf, &o);
}

/* The flops of the text itself. */
static long flops_of(const char *urdf, const char *scene)
{
	struct rneagen_result r = make(urdf, scene, RNEAGEN_F32);
	const char *last = strstr(r.info_json, "\"operations\"");
	long flops;

	ck_assert(last && (last = strstr(last, "\"flops\": ")) && sscanf(last, "\"flops\": %ld", &flops) == 1);
	rneagen_result_free(&r);
	return flops;
}

static void check(const char *json, const char *without, long flops, int bytes)
{
	char begin[128];
	const char *at;
	long got;
	int alive, got_bytes;

	snprintf(begin, sizeof begin, "{\"without\": \"%s\", ", without);
	at = strstr(json, begin);
	ck_assert_msg(at != NULL, "no %s in %s", begin, json);
	ck_assert_int_eq(sscanf(at + strlen(begin), "\"flops\": %ld, \"alive\": %d, \"bytes\": %d", &got, &alive, &got_bytes), 3);
	ck_assert_int_eq(got, flops);
	ck_assert_int_eq(got_bytes, bytes);
	ck_assert(alive > 10 && alive < 200);
}

START_TEST(test_lines)
{
	static const char scene[] = "fold qdd=0\nlock iiwa_joint_3=0.2\n# no choice\nfree payload.iiwa_link_7\n";
	size_t length;
	char *urdf = read_file(TEST_DIR "/robots/iiwa14.urdf", &length);
	struct rneagen_result r = make(urdf, scene, RNEAGEN_F64);

	check(r.info_json, "the scene", flops_of(urdf, NULL), 4 * 7 * 8);
	check(r.info_json, "", flops_of(urdf, scene), (3 * 6 + 10) * 8);
	check(r.info_json, "--fold qdd=0", flops_of(urdf, "lock iiwa_joint_3=0.2\nfree payload.iiwa_link_7"), (4 * 6 + 10) * 8);
	check(r.info_json, "--free payload.iiwa_link_7", flops_of(urdf, "fold qdd=0\nlock iiwa_joint_3=0.2"), 3 * 6 * 8);
	ck_assert(strstr(r.info, "full model") && strstr(r.info, "without it"));
	rneagen_result_free(&r);
	free(urdf);
}
END_TEST

/* A range is no choice, and goes with what makes its input. */
START_TEST(test_ranges)
{
	static const char scene[] = "range payload.iiwa_link_7=0,5\nfree payload.iiwa_link_7\nrange qd=-1,1\nfold qdd=0\n";
	size_t length;
	char *urdf = read_file(TEST_DIR "/robots/iiwa14.urdf", &length);
	struct rneagen_result r = make(urdf, scene, RNEAGEN_F64);

	check(r.info_json, "", flops_of(urdf, "free payload.iiwa_link_7\nfold qdd=0"), (3 * 7 + 10) * 8);
	check(r.info_json, "--free payload.iiwa_link_7", flops_of(urdf, "fold qdd=0"), 3 * 7 * 8);
	check(r.info_json, "--fold qdd=0", flops_of(urdf, "free payload.iiwa_link_7"), (4 * 7 + 10) * 8);
	ck_assert_ptr_null(strstr(r.info_json, "{\"without\": \"--range"));
	rneagen_result_free(&r);
	free(urdf);
}
END_TEST

/* What is no scene without a line, and no scene at all. */
START_TEST(test_unknown)
{
	static const char urdf[] =
		"<robot name='r'><link name='a'/><joint name='j' type='continuous'><parent link='a'/><child link='b'/>"
		"</joint><link name='b'/><joint name='k' type='continuous'><parent link='b'/><child link='c'/></joint>"
		"<link name='c'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
		"</inertial></link></robot>";
	struct rneagen_result r = make(urdf, "root b\nlock-all-but k\n", RNEAGEN_F32);

	ck_assert(strstr(r.info_json, "\"savings\""));
	rneagen_result_free(&r);
	r = make(urdf, NULL, RNEAGEN_F32);
	ck_assert(!strstr(r.info_json, "\"savings\"") && !strstr(r.info, "full model"));
	rneagen_result_free(&r);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("saving");
	TCase *c = tcase_create("saving");

	tcase_add_test(c, test_lines);
	tcase_add_test(c, test_ranges);
	tcase_add_test(c, test_unknown);
	suite_add_tcase(s, c);
	return suite_run(s);
}
