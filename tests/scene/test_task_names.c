/* What a scene's choices are told when they cannot be: every message of gen/request, with its line; and names that are no
   identifiers, which still find their links, and arrays of their own. */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "support/task/task.h"
#include "support/urdf_text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A revolute joint, a prismatic one that follows it, a planar and a floating one, a fixed link; names of all sorts. */
static const char urdf[] = ROBOT("r", BALL("world") BALL("arm") BALL("left hand") BALL("left_hand") BALL("a*/b") BALL("x,y")
	BALL("slab") BALL("ship") JOINT("turn", "revolute", "world", "arm", AXIS("0 0 2"))
	JOINT("follow", "prismatic", "arm", "left hand", AXIS("0 1 0") MIMIC("turn", "-2", "0.5"))
	JOINT("weld", "fixed", "left hand", "left_hand", ORIGIN("0 0 1", "0.1 0.2 0.3"))
	JOINT("a=b", "revolute", "left_hand", "a*/b", AXIS("1 1 0")) JOINT("comma", "continuous", "arm", "x,y", AXIS("1 0 0"))
	JOINT("slide", "planar", "arm", "slab", AXIS("0 0 1")) JOINT("sail", "floating", "arm", "ship", ""));

/* ---- refused ---- */

static const struct refusal {
	const char *scene, *message;
} REFUSALS[] = {
	/* words */
	{"fold qddd=0", "scene line 1, fold: 'qddd' is not known; did you mean 'qdd'?"},
	{"free pyload.arm", "scene line 1, free: 'pyload.arm' is not known; did you mean 'payload'?"},
	{"want kinetc", "scene line 1, want: 'kinetc' is not known; did you mean 'kinetic'?"},
	{"want zzzzzz", "scene line 1, want: 'zzzzzz' is not known"},
	{"free zzzzzz",
		"scene line 1, free: 'zzzzzz' is not known; there is gravity, mass.NAME, inertia.NAME, payload.NAME, offset.NAME, accel.NAME, "
		"armature, damping, friction, armature.NAME, damping.NAME, friction.NAME"},
	{"free mass", "scene line 1, free: 'mass' needs a name: mass.NAME"},
	{"want twist.", "scene line 1, want: 'twist' needs a name: twist.NAME"},
	{"want tau.arm", "scene line 1, want: 'tau' takes no name: write tau"},
	{"want tau.", "scene line 1, want: 'tau' takes no name: write tau"},
	{"fold q.=0", "scene line 1, fold: 'q' takes no name: write q"},
	{"free gravity.x", "scene line 1, free: 'gravity' takes no name: write gravity"},
	{"fold gravity.x=1", "scene line 1, fold: 'gravity' takes no name: write gravity"},
	{"fext-frame wrold", "scene line 1, fext-frame: takes link or world, not 'wrold'"},
	/* links and joints */
	{"free mass.arn", "scene line 1, free: no link 'arn'; did you mean 'arm'?"},
	{"free payload.lefthand", "scene line 1, free: no link 'lefthand'; did you mean 'left hand'?"},
	{"want twist.slap", "scene line 1, want: no link 'slap'; did you mean 'slab'?"},
	{"# a remark\n\nfext shop", "scene line 3, fext: no link 'shop'; did you mean 'ship'?"},
	{"want wrench.trun", "scene line 1, want: no joint 'trun'; did you mean 'turn'?"},
	{"fold q.trun=1", "scene line 1, fold: no joint 'trun'; did you mean 'turn'?"},
	{"free offset.commas", "scene line 1, free: no joint 'commas'; did you mean 'comma'?"},
	{"armature slid=1", "scene line 1, armature: no joint 'slid'; did you mean 'slide'?"},
	{"free mass.world", "scene line 1, free: link 'world' does not move in this scene"},
	{"want accel.world", "scene line 1, want: link 'world' does not move in this scene"},
	{"fext world", "scene line 1, fext: link 'world' does not move in this scene"},
	{"lock comma=0\nfree inertia.arm\nlock turn=0\nfext slab", "scene line 2, free: link 'arm' does not move in this scene"},
	{"tip slab\nbeside drop\nfext ship", "scene line 3, fext: link 'ship' is not part of this scene"},
	{"want wrench.weld", "scene line 1, want: joint 'weld' does not move in this scene"},
	{"lock comma=0\nfold q.comma=1", "scene line 2, fold: joint 'comma' does not move in this scene"},
	{"want wrench.base", "scene line 1, want: no joint 'base'"},
	/* frames */
	{"want pose.slap", "scene line 1, want: no link 'slap'; did you mean 'slab'?"},
	{"add-frame grip=arm,0,0,0,0,0,0\nwant jacobian.grib", "scene line 2, want: no link 'grib'; did you mean 'grip'?"},
	{"want djacobian.wield", "scene line 1, want: no link 'wield'; did you mean 'weld'?"},
	{"tip slab\nbeside drop\nwant pose.ship", "scene line 3, want: link 'ship' is not part of this scene"},
	{"want jacobian.world", "scene line 1, want: link 'world' does not move in this scene"},
	{"add-frame grip=arm,0",
		"scene line 1, add-frame: takes NAME=LINK,x,y,z,r,p,y, a link and six numbers, m and rad; 'arm,0' has 1 number"},
	{"add-frame grip=arm,0,0,0,0,0",
		"scene line 1, add-frame: takes NAME=LINK,x,y,z,r,p,y, a link and six numbers, m and rad; "
		"'arm,0,0,0,0,0' has 5 numbers"},
	{"add-frame grip=arm,0,0,0,0,0,0,0",
		"scene line 1, add-frame: takes NAME=LINK,x,y,z,r,p,y, a link and six numbers, m and rad; "
		"'arm,0,0,0,0,0,0,0' has 7 numbers"},
	{"add-frame grip", "scene line 1, add-frame: takes NAME=LINK,x,y,z,r,p,y, not 'grip'"},
	{"add-frame grip=arm,0,0,0,0,0,z",
		"scene line 1, add-frame: takes 6 finite numbers with commas between, not '0,0,0,0,0,z'"},
	{"add-frame grip=arn,0,0,0,0,0,0", "scene line 1, add-frame: no link 'arn'; did you mean 'arm'?"},
	{"add-frame grip=world,0,0,0,0,0,0", "scene line 1, add-frame: link 'world' does not move in this scene"},
	{"add-frame ship=arm,0,0,0,0,0,0",
		"scene line 1, add-frame: there is a link 'ship' already: give the frame another name"},
	{"add-frame weld=arm,0,0,0,0,0,0",
		"scene line 1, add-frame: there is a joint 'weld' already: give the frame another name"},
	{"add-frame grip=arm,0,0,0,0,0,0\nadd-frame grip=slab,0,0,0,0,0,0",
		"scene line 2, add-frame: there is a frame 'grip' already: give the frame another name"},
	{"pose euler", "scene line 1, pose: takes rows or quaternion, not 'euler'"},
	{"frame body", "scene line 1, frame: takes link, world or world-aligned, not 'body'"},
	/* rows */
	{"fold q.follow=1", "scene line 1, fold: 'follow' follows another joint: fold that"},
	{"fold q=0", "scene line 1, fold: takes 13 finite numbers with commas between, not '0'"},
	{"fold q.sail=0", "scene line 1, fold: takes 7 finite numbers with commas between, not '0'"},
	{"fold qd=1,2", "scene line 1, fold: takes 12 finite numbers with commas between, not '1,2'"},
	{"fold qdd.turn=nan", "scene line 1, fold: takes a finite number, not 'nan'"},
	{"fold gravity=1", "scene line 1, fold: takes 3 finite numbers with commas between, not '1'"},
	{"fold q.turn=1\nfold q.turn=2", "scene line 2, fold: 'q.turn' is given already"},
	{"fold gravity=0,0,0\nfold gravity=0,0,1", "scene line 2, fold: 'gravity' is given already"},
	{"fold qd=0\nfold qd.turn=2", "scene line 2, fold: 'qd.turn' has a row that is given already"},
	{"fold qd.slide=0,1,2\nfold qd=2", "scene line 2, fold: 'qd' has a row that is given already"},
	/* constants */
	{"free gravity\nfree gravity:sample", "scene line 2, free: 'gravity' is free already"},
	{"free payload.arm\nfree payload.arm:batch", "scene line 2, free: 'payload.arm' is free already"},
	{"free mass.arm\nfree inertia.arm",
		"scene line 2, free: the mass is part of the inertia: free one of 'inertia.arm' and 'mass.arm'"},
	{"free inertia.arm\nfree mass.arm",
		"scene line 2, free: the mass is part of the inertia: free one of 'mass.arm' and 'inertia.arm'"},
	{"free offset.slide", "scene line 1, free: an offset belongs to a joint with one row in q, which 'slide' is not"},
	{"free offset.follow", "scene line 1, free: an offset belongs to a joint with one row in q, which 'follow' is not"},
	{"free damping.sail", "scene line 1, free: 'damping.sail' is of a joint with one row in qd, which 'sail' is not"},
	{"free friction.weld", "scene line 1, free: joint 'weld' does not move in this scene"},
	{"free armature,armature", "scene line 1, free: 'armature' is free already"},
	{"free armature\nfree armature.turn", "scene line 2, free: 'armature.turn' is part of 'armature': free one of them"},
	{"free damping.turn,damping", "scene line 1, free: 'damping.turn' is part of 'damping': free one of them"},
	{"free offset.weld", "scene line 1, free: joint 'weld' does not move in this scene"},
	/* forces, terms of the joints' own, wants */
	{"fext arm,arm", "scene line 1, fext: the wrench on 'arm' is an input already"},
	{"armature slide=1", "scene line 1, armature: an armature belongs to a joint with one row in qd, which 'slide' is not"},
	{"armature turn=-1", "scene line 1, armature: an armature of -1 kg m^2 is less than nothing"},
	{"armature turn=heavy", "scene line 1, armature: takes a finite number, not 'heavy'"},
	{"armature turn=1\narmature turn=1", "scene line 2, armature: the armature of 'turn' is given already"},
	{"friction 0",
		"scene line 1, friction: a width of 0 rad/s or m/s is none: friction must be smooth, in f32 too, so at least 1e-12"},
	{"friction 1e-23",
		"scene line 1, friction: a width of 1e-23 rad/s or m/s is none: friction must be smooth, in f32 too, so at least 1e-12"},
	{"want tau,tau", "scene line 1, want: 'tau' is wanted already"},
	{"want dqdd_dtau,Minv", "scene line 1, want: 'Minv' is wanted already, as 'dqdd_dtau'"},
	{"vjp twist.x,y\nvjp twist.x,y", "scene line 2, vjp: 'twist.x,y' is named twice"},
	{"want twist.x,y\nwant twist.x,y", "scene line 2, want: 'twist.x,y' is wanted already"},
	/* products */
	{"jvp tua", "scene line 1, jvp: 'tua' is not known; did you mean 'tau'?"},
	{"vjp twist.slap", "scene line 1, vjp: no link 'slap'; did you mean 'slab'?"},
	{"vjp bias,tau,bias", "scene line 1, vjp: 'bias' is named twice"},
	{"jvp tau\njvp tau", "scene line 2, jvp: 'tau' is named twice"},
	{"jvp vjp", "scene line 1, jvp: there is no vjp here: --vjp NAME,... says of which outputs"},
	{"vjp tau,vjp", "scene line 1, vjp: 'vjp' is a product itself: second derivatives are those of --jvp vjp"},
	{"jvp tau,jvp", "scene line 1, jvp: 'jvp' is a product itself: second derivatives are those of --jvp vjp"},
	{"vjp tau\njvp vjp,vjp", "scene line 2, jvp: 'vjp' is named twice"},
	{"vjp qdd,qdd_bound", "scene line 1, vjp: 'qdd_bound' is a bound, which has no derivative: take qdd"},
	{"want jvp\njvp kinetic", "scene line 2, jvp: --want jvp is --jvp tau: name tau here, and leave that out"},
	{"vjp tau,qdd", "scene line 1, vjp: tau is an input where qdd is wanted: leave it out"},
	{"fold qd=0\nvjp tau,kinetic",
		"scene line 2, vjp: 'kinetic' does not vary with what --fold leaves: leave it out"},
	{"by gravity", "scene line 1, by: 'gravity' is no constant of --free and no wrench of --fext"},
	{"free gravity\nby gravity", "scene line 2, by: there is no product that could be by 'gravity': take --jvp or --vjp"},
	{"free payload.arm\nvjp tau\nby payload.arn", "scene line 3, by: 'payload.arn' is no constant of --free and no "
						      "wrench of --fext; did you mean 'payload.arm'?"},
	{"fext arm\nvjp tau\nby fext.arm,fext.arm", "scene line 3, by: 'fext.arm' is named twice"},
	{"jvp qdd\nby tau", "scene line 2, by: products are by q, qd, and qdd or tau anyway: leave out 'tau'"},
	{"vjp tau,kinetic\nrange vjp_v[13]=0,1", "scene line 2, range: 'vjp_v' has no row 13: the last is 12"},
	/* ranges */
	{"range qddd=0,1", "scene line 1, range: 'qddd' is not known; did you mean 'qdd'?"},
	{"range jvp=0,1", "scene line 1, range: 'jvp' is not known; did you mean 'jvp_v'?"},
	{"range payload=0,1", "scene line 1, range: 'payload' needs a name: payload.NAME"},
	{"range q.trun=0,1", "scene line 1, range: no joint 'trun'; did you mean 'turn'?"},
	{"range q.follow=0,1", "scene line 1, range: 'follow' follows another joint: name that"},
	{"lock comma=0\nrange q.comma=0,1", "scene line 2, range: joint 'comma' does not move in this scene"},
	{"range gravity=0,1", "scene line 1, range: 'gravity' is no input of this scene; --free gravity makes it one"},
	{"range payload.arm=0,1",
		"scene line 1, range: 'payload.arm' is no input of this scene; --free payload.arm makes it one"},
	{"free gravity,payload.arm\nrange payload.arn=0,1",
		"scene line 2, range: 'payload.arn' is no input of this scene; did you mean 'payload.arm'?"},
	{"range fext.arm=0,1", "scene line 1, range: 'fext.arm' is no input of this scene; --fext arm makes it one"},
	{"range jvp_v=0,1", "scene line 1, range: 'jvp_v' is no input of this scene; --want jvp makes it one"},
	{"want jvp\nrange vjp_v=0,1", "scene line 2, range: 'vjp_v' is no input of this scene; --want vjp makes it one"},
	{"range qd", "scene line 1, range: takes NAME=VALUE, not 'qd'"},
	{"range qd=1", "scene line 1, range: takes 2 finite numbers with commas between, not '1'"},
	{"range qd=0,inf", "scene line 1, range: takes 2 finite numbers with commas between, not '0,inf'"},
	{"range qd=0,1,2", "scene line 1, range: takes 2 finite numbers with commas between, not '0,1,2'"},
	{"range qd=1,-0.5", "scene line 1, range: takes LOWER,UPPER, and 1 is more than -0.5"},
	{"range qd=-1e308,1e308", "scene line 1, range: from -1e+308 to 1e+308 is farther than a number reaches"},
	{"free mass.arm\nrange mass.arm=-1,1", "scene line 2, range: 'mass.arm' has the range of a mass, kg, which is never -1"},
	{"free payload.arm\nrange payload.arm[2]=0,1",
		"scene line 2, range: ten numbers that no body has apart are drawn together: the range of "
		"'payload.arm' is that of its mass, kg"},
	{"range q[13]=0,1", "scene line 1, range: 'q' has no row 13: the last is 12"},
	{"range qd.slide[3]=0,1", "scene line 1, range: 'qd.slide' has no row 3: the last is 2"},
	{"range q.sail[3]=0,1", "scene line 1, range: row 3 of 'q.sail' is of a quaternion, which is drawn over all "
				"orientations: leave it out"},
	{"fold qd=0\nrange qd.turn=0,1",
		"scene line 2, range: 'qd.turn' is given by --fold, and nothing of it is drawn: leave one of them out"},
	{"fold qdd.slide=0,1,2\nrange qdd.slide[1]=0,1", "scene line 2, range: 'qdd.slide[1]' is given by --fold, and "
							 "nothing of it is drawn: leave one of them out"},
	{"range qd=0,1\nrange qd=0,1", "scene line 2, range: 'qd' has a range already; give it one"},
	{"range q.turn[0]=0,1\nrange q[0]=0,2", "scene line 2, range: 'q[0]' has a range already; give it one"},
};

START_TEST(refused)
{
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;
	char expected[512];

	o.scene = REFUSALS[_i].scene;
	ck_assert_int_eq(scene_open(&m, urdf, &o), RNEAGEN_SCENE);
	snprintf(expected, sizeof expected, "<input>: %s", REFUSALS[_i].message);
	ck_assert_str_eq(m.error.message, expected);
	scene_close(&m);
}
END_TEST

/* As many arrays as a kernel takes, and one more: a wrench, or the vector of a product. */
START_TEST(arrays)
{
	enum { LINKS = 62 };
	struct rneagen_options o = rneagen_options_default();
	static char text[1 << 16], scene[1 << 13], *last;
	size_t at = (size_t)sprintf(text, "<robot name='r'><link name='l0'/>");

	for (int i = 1; i <= LINKS; i++) {
		at += (size_t)sprintf(text + at,
			"<link name='l%d'/><joint name='j%d' type='prismatic'><parent link='l%d'/><child link='l%d'/>"
						 "<limit effort='1' velocity='1'/></joint>", i, i, i - 1, i);
		if (i < LINKS)
			sprintf(scene + strlen(scene), "fext l%d\n", i);
	}
	strcpy(text + at, "</robot>");
	last = strrchr(scene, 'f');
	o.scene = scene;
	for (int more = 0; more < 3; more++) {
		struct scene_model m;
		enum rneagen_code code;

		strcpy(last, more == 0 ? "" : more == 1 ? "fext l61\n" : "want jvp\n");
		code = scene_open(&m, text, &o);
		ck_assert_msg(code == (more ? RNEAGEN_LIMIT : RNEAGEN_OK), "%s", m.error.message);
		ck_assert_str_eq(m.error.message,
			more ? "<input>: the scene makes more than 64 arrays, which is all that a kernel takes" : "");
		scene_close(&m);
	}
}
END_TEST

/* ---- hostile names ---- */

/* Names that come out the same have arrays of their own, each of its own link. */
START_TEST(hostile)
{
	static const char *const names[] = {"payload_left_hand", "payload_left_hand_2", "mass_a__b", "offset_a_b", "inertia_x_y",
		"fext_a__b", "fext_left_hand", "wrench_a_b", "twist_left_hand", "twist_left_hand_2", "accel_x_y"};
	struct rneagen_options o = rneagen_options_default();
	struct task_case *c = case_new(strdup(urdf), &o, 1);
	int entry[8];
	struct scene_model m;

	for (int i = 0; i < 8; i++) {
		static const char *const links[] = {"world", "arm", "left hand", "left_hand", "a*/b", "x,y", "slab", "ship"};

		for (entry[i] = 0; strcmp(c->r->joints[entry[i]].link, links[i]);)
			entry[i]++;
	}
	case_add_payload(c, entry[2], 0);
	case_add_payload(c, entry[3], 0);
	case_free_mass(c, entry[4], 0);
	case_free_offset(c, entry[4], 0);
	case_free_inertia(c, entry[5], 0);
	case_push(c, entry[4]);
	case_push(c, entry[2]);
	case_give(c, entry[4], 1);
	case_armature(c, entry[5]);
	case_want(c, TASK_WRENCH, entry[4]);
	case_want(c, TASK_TWIST, entry[2]);
	case_want(c, TASK_TWIST, entry[3]);
	case_want(c, TASK_ACCEL, entry[5]);
	case_want(c, TASK_TAU, 0);
	case_check(c, &m, "hostile names");
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		ck_assert_msg(dag_find_argument(&m.dag, names[i]) >= 0, "there is no array %s", names[i]);
	scene_close(&m);
	case_close(c);
}
END_TEST

/* No array is called as a kernel calls its part of another. */
START_TEST(kernels_own)
{
	static const char text[] = ROBOT("r", BALL("world") BALL("a") BALL("a_here") BALL("a_slice")
		JOINT("one", "revolute", "world", "a", AXIS("0 0 1")) JOINT("two", "revolute", "a", "a_here", AXIS("0 1 0"))
		JOINT("three", "revolute", "a_here", "a_slice", AXIS("1 0 0")));
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.scene = "free mass.a\nfree mass.a_here\nfree mass.a_slice";
	ck_assert_int_eq(scene_open(&m, text, &o), RNEAGEN_OK);
	ck_assert_int_ge(dag_find_argument(&m.dag, "mass_a"), 0);
	ck_assert_int_eq(dag_find_argument(&m.dag, "mass_a_here"), -1);
	ck_assert_int_eq(dag_find_argument(&m.dag, "mass_a_slice"), -1);
	ck_assert_int_ge(dag_find_argument(&m.dag, "mass_a_here_2"), 0);
	ck_assert_int_ge(dag_find_argument(&m.dag, "mass_a_slice_2"), 0);
	scene_close(&m);
}
END_TEST

/* Nor are the directions of two inputs that come out the same. */
START_TEST(directions)
{
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.scene = "free payload.left hand,payload.left_hand\njvp tau\nby payload.left hand,payload.left_hand";
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s", m.error.message);
	ck_assert_int_ge(dag_find_argument(&m.dag, "jvp_v_payload_left_hand"), 0);
	ck_assert_int_ge(dag_find_argument(&m.dag, "jvp_v_payload_left_hand_2"), 0);
	scene_close(&m);
}
END_TEST

/* Blanks at the end of a name are its own, where the robot has such a name: each word that takes one finds it. At the end of a
   line they take quotes. */
START_TEST(blanks)
{
	static const char padded[] = ROBOT("r", BALL("world") BALL("arm ") JOINT("swing ", "revolute", "world", "arm ", ""));
	static const char *const scenes[] = {"range q.swing =-1,1", "fold qd.swing =0", "free \"offset.swing \"",
		"free \"damping.swing \"", "want \"wrench.swing \"", "want \"pose.arm \"", "jvp \"pose.arm \""};
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.scene = scenes[_i];
	ck_assert_msg(!scene_open(&m, padded, &o), "%s: %s", o.scene, m.error.message);
	scene_close(&m);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("task_names");
	TCase *c = tcase_create("names");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_add_loop_test(c, refused, 0, sizeof REFUSALS / sizeof *REFUSALS);
	tcase_add_test(c, arrays);
	tcase_add_test(c, hostile);
	tcase_add_test(c, kernels_own);
	tcase_add_test(c, directions);
	tcase_add_loop_test(c, blanks, 0, 7);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
