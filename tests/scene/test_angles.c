/* Which sine and cosine a text has where nobody says: bounded ones if ranges that the scene states keep every angle within what
   they take, and never by limits of the URDF alone. It would catch an angle that is forgotten (a follower's, a planar joint's,
   one with a free offset), a range that counts although a narrower one says more, and a head that does not make the same text
   again. */
#include "support/scene_model.h"
#include "support/generated.h"
#include "support/suite.h"
#include "rneagen.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct chosen {
	const char *robot, *scene;
	enum rneagen_trig asked, chosen;
} CHOSEN[] = {
	{"iiwa14", "", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"iiwa14", "range q=-3,3", RNEAGEN_TRIG_AUTO, RNEAGEN_BOUNDED},
	{"iiwa14", "range q=-3,3", RNEAGEN_ACCURATE, RNEAGEN_ACCURATE},
	{"iiwa14", "range q=-3,3", RNEAGEN_FAST, RNEAGEN_FAST},
	{"iiwa14", "range qd=-3,3\nrange qdd=-1,1", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"iiwa14", "range q.iiwa_joint_3=-3,3", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"iiwa14", "range q=-3,20000", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"iiwa14", "range q=-3,3\nrange q.iiwa_joint_3=-20000,1", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"iiwa14", "range q=-3,20000\nrange q.iiwa_joint_3=-1,1", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"double_pendulum", "range q=-3,20000\nrange q[0]=-1,1\nrange q[1]=-1,1", RNEAGEN_TRIG_AUTO, RNEAGEN_BOUNDED},
	{"double_pendulum", "range q[0]=-1,1\nfold q.elbow=0.5", RNEAGEN_TRIG_AUTO, RNEAGEN_BOUNDED},
	{"iiwa14", "range q=-3,3\nfree offset.iiwa_joint_3", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE},
	{"iiwa14", "range q=-3,3\nfree offset.iiwa_joint_3\nrange offset.iiwa_joint_3=-1,1", RNEAGEN_TRIG_AUTO, RNEAGEN_BOUNDED},
	{"iiwa14", "range q=-3,3\nfree offset.iiwa_joint_3\nrange offset.iiwa_joint_3=-1,10000", RNEAGEN_TRIG_AUTO,
		RNEAGEN_ACCURATE},
	{"double_pendulum", "fold q.elbow=20000\nfree offset.elbow\nrange q[0]=-1,1\nrange offset.elbow=-1,1", RNEAGEN_TRIG_AUTO,
		RNEAGEN_ACCURATE},
	{"double_pendulum", "fold q.elbow=0.5\nfree offset.elbow\nrange q[0]=-1,1\nrange offset.elbow=-1,1", RNEAGEN_TRIG_AUTO,
		RNEAGEN_BOUNDED},
	{"mimic_chain", "range q=-6000,6000", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE}, /* followers turn by up to twice the angle */
	{"mimic_chain", "range q=-3,3", RNEAGEN_TRIG_AUTO, RNEAGEN_BOUNDED},
	{"planar_joint", "range q=-3,3", RNEAGEN_TRIG_AUTO, RNEAGEN_BOUNDED},
	{"gantry", "range q=-1,1", RNEAGEN_TRIG_AUTO, RNEAGEN_ACCURATE}, /* nothing turns */
};

START_TEST(chosen)
{
	const struct chosen *c = &CHOSEN[_i];
	struct rneagen_options o = rneagen_options_default();
	char *text = robot_text(c->robot);
	struct scene_model m;

	ck_assert_int_eq(o.trig, RNEAGEN_TRIG_AUTO);
	o.scene = c->scene;
	o.trig = c->asked;
	ck_assert_msg(!scene_open(&m, text, &o), "%s", m.error.message);
	ck_assert_msg(m.analysis.options.trig == c->chosen, "%s, %s: %d", c->robot, c->scene, (int)m.analysis.options.trig);
	scene_close(&m);
	free(text);
}
END_TEST

static struct rneagen_result text_of(const char *urdf, const char *scene, enum rneagen_trig trig)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = scene;
	o.trig = trig;
	return generated(urdf, &o);
}

/* The head says it, with the ranges that it rests on; asking for the same gives the same bytes; without ranges nothing is
   said. */
START_TEST(told)
{
	char *urdf = robot_text("double_pendulum");
	struct rneagen_result by_range = text_of(urdf, "range q=-3,3", RNEAGEN_TRIG_AUTO),
		asked = text_of(urdf, "range q=-3,3", RNEAGEN_BOUNDED);
	struct rneagen_result accurate = text_of(urdf, "range q=-3,3", RNEAGEN_ACCURATE),
		plain = text_of(urdf, NULL, RNEAGEN_TRIG_AUTO);

	ck_assert(strstr(by_range.source, "--trig bounded") && strstr(by_range.source, "--range q=-3,3"));
	ck_assert(strstr(by_range.source, "Sine and cosine are bounded: the scene states a range of every joint's angle"));
	ck_assert_str_eq(by_range.source, asked.source);
	ck_assert(!strstr(accurate.source, "Sine and cosine are bounded") && !strstr(accurate.source, "--range"));
	ck_assert_str_eq(accurate.source, plain.source);
	rneagen_result_free(&by_range);
	rneagen_result_free(&asked);
	rneagen_result_free(&accurate);
	rneagen_result_free(&plain);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("angles");

	suite_add(suite, "chosen", chosen, sizeof CHOSEN / sizeof *CHOSEN, 60);
	suite_add(suite, "told", told, 1, 60);
	return suite_run(suite);
}
