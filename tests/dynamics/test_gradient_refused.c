#include "test_gradient.h"
#include "rneagen.h"
#include "support/read.h"
#include <stdlib.h>
#include <string.h>

static void refuse(const char *scene, const char *text)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct rneagen_error e;
	size_t length;
	char *urdf = read_file(TEST_DIR "/robots/iiwa14.urdf", &length);

	o.scene = scene;
	ck_assert(rneagen_generate(urdf, length, &o, &r, &e));
	ck_assert_msg(strstr(e.message, text) != NULL, "%s", e.message);
	free(urdf);
}

START_TEST(test_refused)
{
	refuse("want dtau_dq\nfold q.iiwa_joint_2=1\n", "'dtau_dq': row 1 of q, joint 'iiwa_joint_2', is given: no derivative by it");
	refuse("want dtau_dqd\nfold qd=0\n", "row 0 of qd, joint 'iiwa_joint_1', is given");
	refuse("want dtau_dpayload.iiwa_link_6\n", "'payload.iiwa_link_6' is not free");
	refuse("want dtau_dqq\n", "'qq' is not free");
	refuse("want dtau_dqdd\n", "the derivative by qdd is the mass matrix: want M");
	refuse("want M,M\n", "'M' is wanted already");
}
END_TEST

/* A joint that is called what the floating base is called. */
START_TEST(test_base)
{
	static const char urdf[] =
		"<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
		"</inertial></link><joint name='base' type='continuous'><parent link='a'/><child link='b'/></joint><link name='b'/></robot>";
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct rneagen_error e;

	o.scene = "want wrench.base\n";
	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &r, &e), "%s", e.message);
	rneagen_result_free(&r);
	o.base = RNEAGEN_FLOATING;
	ck_assert(rneagen_generate(urdf, strlen(urdf), &o, &r, &e));
	ck_assert_msg(strstr(e.message, "'base' is the floating base, and a joint of the robot") != NULL, "%s", e.message);
}
END_TEST

TCase *gradient_refused(void)
{
	TCase *c = tcase_create("refused");

	tcase_set_timeout(c, 120);
	tcase_add_test(c, test_refused);
	tcase_add_test(c, test_base);
	return c;
}
