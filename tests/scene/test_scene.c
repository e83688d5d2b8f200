/* The scene: which names it takes, what it leaves and says; what is refused, and how. How its text is read is in
   test_scene_read.c. */
#include "support/merged.h"
#include "support/read.h"
#include "support/rng.h"
#include "rneagen.h"
#include "support/generated.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REVOLUTE(name, parent, child) JOINT(name, "revolute", parent, child, "")

/* An arm with a gripper whose right finger follows the left one, a head, a thing that floats, odd names. */
static const char arm[] = ROBOT("arm",
	BALL("base") BALL("upper") BALL("fore") BALL("hand") BALL("left") BALL("right") BALL("head") BALL("thing")
	BALL("a,b") REVOLUTE("shoulder", "base", "upper") REVOLUTE("elbow", "upper", "fore")
		JOINT("wrist", "continuous", "fore", "hand", "") JOINT("grip", "prismatic", "hand", "left", AXIS("0 1 0"))
			JOINT("follow", "prismatic", "hand", "right", AXIS("0 1 0") MIMIC("grip", "-1", "0.25"))
				JOINT("neck", "planar", "base", "head", "") JOINT("free", "floating", "hand", "thing", "")
					REVOLUTE("x=y,z", "base", "a,b") BALL("plate") JOINT("weld", "fixed",
						"base", "plate", ""));

/* A chain to l1 needs m, which stands behind a, which needs n. */
static const char chains[] = ROBOT("chains", BALL("base") BALL("l1") BALL("l2") BALL("l3") BALL("l4") BALL("l5")
	JOINT("z", "revolute", "base", "l1", MIMIC("m", "2", "0")) JOINT("a", "revolute", "base", "l2", MIMIC("n", "3", "1"))
		REVOLUTE("m", "l2", "l3") REVOLUTE("n", "base", "l4") REVOLUTE("o", "base", "l5"));

/* Joints that move, ' after a follower; | held ones with their numbers and the reason; | what is cut away. */
static const struct left {
	const char *urdf, *scene, *summary;
} lefts[] = {
	{arm, NULL, "neck shoulder elbow wrist follow' free grip x=y,z ||"},
	{arm, "", "neck shoulder elbow wrist follow' free grip x=y,z ||"},
	{arm, "# nothing\n\n \t\r\n#", "neck shoulder elbow wrist follow' free grip x=y,z ||"},
	{arm, "lock elbow=1e0", "neck shoulder wrist follow' free grip x=y,z | elbow=1 lock |"},
	{arm, "  lock\telbow = 0.5\t# held\r\nlock wrist=-2 #",
		"neck shoulder follow' free grip x=y,z | elbow=0.5 lock wrist=-2 lock |"},
	{arm, "lock x=y,z=0.5", "neck shoulder elbow wrist follow' free grip | x=y,z=0.5 lock |"},
	{arm, "lock grip=0.5", "neck shoulder elbow wrist free x=y,z | follow=-0.25 mimic grip=0.5 lock |"},
	{arm, "lock neck=1,2,3\nlock free=1,2,3,0,0,0,1",
		"shoulder elbow wrist follow' grip x=y,z | neck=1,2,3 lock free=1,2,3,0,0,0,1 lock |"},
	{arm, "lock-all-but elbow,wrist",
		"elbow wrist | neck=0,0,0 lock-all-but shoulder=0 lock-all-but follow=0.25 mimic "
		"free=0,0,0,0,0,0,1 lock-all-but grip=0 lock-all-but x=y,z=0 lock-all-but |"},
	{arm, "lock-all-but grip\nlock elbow=1\nlock-all-but x=y,z\nlock free=0,0,1,1,0,0,0",
		"follow' grip x=y,z | neck=0,0,0 lock-all-but shoulder=0 lock-all-but elbow=1 lock wrist=0 lock-all-but "
		"free=0,0,1,1,0,0,0 lock |"},
	{arm, "tip hand",
		"shoulder elbow wrist | neck=0,0,0 beside follow=0.25 mimic free=0,0,0,0,0,0,1 beside grip=0 beside x=y,z=0 beside |"},
	{arm, "tip hand\nbeside lock\nlock grip=0.5",
		"shoulder elbow wrist | neck=0,0,0 beside follow=-0.25 mimic "
		"free=0,0,0,0,0,0,1 beside grip=0.5 lock x=y,z=0 beside |"},
	{arm, "tip hand\nbeside drop",
		"shoulder elbow wrist || a,b head left right thing; follow free grip neck x=y,z"},
	{arm, "tip hand\nbeside drop\nlock grip=0.5",
		"shoulder elbow wrist | follow=-0.25 mimic grip=0.5 lock | a,b head thing; free neck x=y,z"},
	{arm, "tip upper\nbeside drop\nlock x=y,z=1",
		"shoulder | x=y,z=1 lock | fore hand head left right thing; elbow follow free grip neck wrist"},
	{arm, "tip right\nbeside drop", "shoulder elbow wrist follow' grip || a,b head thing; free neck x=y,z"},
	{arm, "tip left",
		"shoulder elbow wrist follow' grip | neck=0,0,0 beside free=0,0,0,0,0,0,1 beside x=y,z=0 beside |"},
	{arm, "tip head , a,b", NULL},
	{arm, "tip a,b\ntip head\nbeside drop",
		"neck x=y,z || fore hand left right thing upper; elbow follow free grip shoulder wrist"},
	{arm, "root hand", "follow' free grip || a,b base fore head plate upper; elbow neck shoulder wrist x=y,z"},
	{arm, "root hand\ntip left\nbeside drop",
		"grip || a,b base fore head plate right thing upper; elbow follow free neck shoulder wrist x=y,z"},
	{arm, "root upper\ntip hand\nlock elbow=1",
		"wrist | elbow=1 lock follow=0.25 mimic free=0,0,0,0,0,0,1 beside grip=0 beside | "
		"a,b base head plate; neck shoulder x=y,z"},
	{chains, "tip l1", "a' m n z' | o=0 beside |"},
	{chains, "tip l1\nbeside drop", "a' m n z' || l5; o"},
	{chains, "tip l3\nbeside drop\nlock m=2", "a' n | m=2 lock z=4 mimic | l5; o"},
	{chains, "root l2", "m || base l1 l4 l5; a n o z"},
	{chains, "lock n=2", "m o z' | a=7 mimic n=2 lock |"},
};

static void summarise(const struct analysis *a, char *s, size_t size)
{
	size_t n = 0;

	for (int k = 0; k < a->tree.body_count; k++)
		n += (size_t)snprintf(s + n, size - n, "%s%s ", a->tree.bodies[k].joint, a->tree.bodies[k].follower ? "'" : "");
	n += (size_t)snprintf(s + n, size - n, "|");
	for (int i = 0; i < a->outcome.held_count; i++) {
		n += (size_t)snprintf(s + n, size - n, " %s=", a->outcome.held[i].name);
		for (int k = 0; k < joint_nq(a->outcome.held[i].type); k++)
			n += (size_t)snprintf(s + n, size - n, "%s%Lg", k ? "," : "", a->outcome.held[i].value[k].x);
		n += (size_t)snprintf(s + n, size - n, " %s", a->outcome.held[i].why);
	}
	n += (size_t)snprintf(s + n, size - n, a->outcome.held_count ? " |" : "|");
	for (int i = 0; i < a->outcome.cut.link_count; i++)
		n += (size_t)snprintf(s + n, size - n, " %s", a->outcome.cut.links[i]);
	n += (size_t)snprintf(s + n, size - n, a->outcome.cut.joint_count ? ";" : "");
	for (int i = 0; i < a->outcome.cut.joint_count; i++)
		n += (size_t)snprintf(s + n, size - n, " %s", a->outcome.cut.joints[i]);
	ck_assert(n < size);
}

static enum rneagen_code build(struct read *r, struct analysis **a, const char *urdf, const char *scene)
{
	struct rneagen_options o = rneagen_options_default();

	o.file = "here";
	o.scene = scene;
	read_memory(r, urdf, strlen(urdf), "here");
	ck_assert_msg(!r->error.code, "%s", r->error.message);
	return merged_analysis(a, &r->robot, &o, &r->arena, &r->error);
}

START_TEST(leaves)
{
	const struct left *x = &lefts[_i];
	char summary[2048];
	struct read r;
	struct analysis *a;

	build(&r, &a, x->urdf, x->scene);
	if (!x->summary) {
		ck_assert_str_eq(r.error.message, "here: scene line 1, tip: no link 'a'; did you mean 'a,b'?");
	} else {
		ck_assert_msg(!r.error.code, "%s", r.error.message);
		summarise(a, summary, sizeof summary);
		ck_assert_str_eq(summary, x->summary);
	}
	read_free(&r);
}
END_TEST

/* ---- what is refused ---- */

static const struct refused {
	const char *scene, *message;
} refuseds[] = {
	{"lokc elbow=1", "here: scene line 1: 'lokc' is not known; did you mean 'lock'?"},
	{"base floating",
		"here: scene line 1: 'base' is no word of a scene, but an option: --base, in CMake a keyword, in Python base="},
	{"\n\nsomething else", "here: scene line 3: 'something' is not known"},
	{"lock", "here: scene line 1, lock: needs a value"},
	{"lock # elbow=1", "here: scene line 1, lock: needs a value"},
	{"damping 1", "here: scene line 1, damping: takes no value, and '1' is one"},
	{"lock elbow", "here: scene line 1, lock: takes NAME=VALUE, not 'elbow'"},
	{"lock elbow=", "here: scene line 1, lock: takes NAME=VALUE, not 'elbow='"},
	{"lock =1", "here: scene line 1, lock: takes NAME=VALUE, not '=1'"},
	{"lock elbo=1", "here: scene line 1, lock: no joint 'elbo'; did you mean 'elbow'?"},
	{"lock upper=1", "here: scene line 1, lock: no joint 'upper'"},
	{"lock elbow=nan", "here: scene line 1, lock: takes a finite number, not 'nan'"},
	{"lock elbow=1e999", "here: scene line 1, lock: takes a finite number, not '1e999'"},
	{"lock elbow=0x1", "here: scene line 1, lock: takes a finite number, not '0x1'"},
	{"lock elbow=1,2", "here: scene line 1, lock: takes a finite number, not '1,2'"},
	{"lock elbow=1 2", "here: scene line 1, lock: takes a finite number, not '1 2'"},
	{"lock neck=1,2", "here: scene line 1, lock: takes 3 finite numbers with commas between, not '1,2'"},
	{"lock neck=1,2,3,", "here: scene line 1, lock: takes 3 finite numbers with commas between, not '1,2,3,'"},
	{"lock free=0,0,0,0,0,0,0", "here: scene line 1, lock: the quaternion of joint 'free', numbers 4 to 7, is 0 long, not 1"},
	{"lock elbow=1\n\nlock elbow=1", "here: scene line 3, lock: joint 'elbow' is also locked in line 1; lock it once"},
	{"lock follow=1", "here: scene line 1, lock: joint 'follow' follows joint 'grip'; name that one"},
	{"lock-all-but follow", "here: scene line 1, lock-all-but: joint 'follow' follows joint 'grip'; name that one"},
	{"lock weld=0", "here: scene line 1, lock: joint 'weld' is fixed"},
	{"lock-all-but elbow\nlock elbow=1",
		"here: scene line 1, lock-all-but: joint 'elbow' is locked in line 2; leave one of the two out"},
	{"lock-all-but elbow,,wrist", "here: scene line 1, lock-all-but: 'elbow,,wrist' has an empty name"},
	{"lock-all-but elbow,wirst", "here: scene line 1, lock-all-but: no joint 'wirst'; did you mean 'wrist'?"},
	{"root hnad", "here: scene line 1, root: no link 'hnad'; did you mean 'hand'?"},
	{"root hand\nroot hand", "here: scene line 2, root: is also given in line 1; give it once"},
	{"beside lock\nbeside drop", "here: scene line 2, beside: is also given in line 1; give it once"},
	{"beside nothing", "here: scene line 1, beside: takes lock or drop, not 'nothing'"},
	{"params khalil", "here: scene line 1, params: takes urdf, base or auto, not 'khalil'"},
	{"params", "here: scene line 1, params: needs a value"},
	{"params base\nparams auto", "here: scene line 2, params: is also given in line 1; give it once"},
	{"fext-frame base", "here: scene line 1, fext-frame: takes link or world, not 'base'"},
	{"tip head\nroot hand", "here: scene line 1, tip: link 'head' is not below the root 'hand'"},
	{"root hand\nlock elbow=1", "here: scene line 2, lock: joint 'elbow' is cut away; leave it out"},
	{"root hand\nlock-all-but elbow", "here: scene line 2, lock-all-but: joint 'elbow' is not below the root 'hand'"},
	{"tip fore\nlock-all-but wrist", "here: scene line 2, lock-all-but: joint 'wrist' is not on a chain to a tip"},
	{"lock \"elbow\"=1", "here: scene line 1, lock: a value that begins with a quote must end with one: \"elbow\"=1"},
	{"root\n lock \"elbow=1 # c", "here: scene line 1, root: needs a value"},
	{"\n lock \"elbow=1 # c", "here: scene line 2, lock: a value that begins with a quote must end with one: \"elbow=1 # c"},
	{"free qd:batch",
		"here: scene line 1, free: 'qd' is not known; there is gravity, mass.NAME, inertia.NAME, payload.NAME, offset.NAME, "
		"accel.NAME, armature, damping, friction, armature.NAME, damping.NAME, friction.NAME"},
	{"free :batch", "here: scene line 1, free: takes NAME, NAME:sample or NAME:batch, not ':batch'"},
	{"free gravity,:batch", "here: scene line 1, free: takes NAME, NAME:sample or NAME:batch, not ':batch'"},
	{"free gravity,,mass.hand", "here: scene line 1, free: 'gravity,,mass.hand' has an empty name"},
	{"free gravity,mass.hnad:sample", "here: scene line 1, free: no link 'hnad'; did you mean 'hand'?"},
	{"free gravity,gravity:sample", "here: scene line 1, free: 'gravity' is free already"},
	{"--lokc elbow=1", "here: scene line 1: 'lokc' is not known; did you mean 'lock'?"},
	{"--lock \"elbo=1\"", "here: --lock: no joint 'elbo'; did you mean 'elbow'?"},
	{"--root hand\n# a file\nroot hand", "here: scene line 2, root: is also given by an option; give it once"},
	{"--root hand\n--root hand", "here: --root: is given twice; give it once"},
	{"# a file\nroot hand\n--root hand", "here: --root: is also given in line 2; give it once"},
	{"--lock elbow=1\n--lock elbow=2", "here: --lock: joint 'elbow' is also locked by an option; lock it once"},
	{"--lock elbow=1\nlock-all-but elbow",
		"here: scene line 1, lock-all-but: joint 'elbow' is locked by an option; leave one of the two out"},
	{"tip base", "here: no movable joints in robot 'arm', or none that the scene leaves"},
	{"root left", "here: no movable joints in robot 'arm', or none that the scene leaves"},
};

START_TEST(refuses)
{
	const struct refused *x = &refuseds[_i];
	struct read r;
	struct analysis *a;
	enum rneagen_code code = build(&r, &a, arm, x->scene);

	ck_assert_str_eq(r.error.message, x->message);
	ck_assert_int_eq(code, strstr(x->message, "movable") ? RNEAGEN_NO_JOINTS : RNEAGEN_SCENE);
	read_free(&r);
}
END_TEST

/* What a robot has to do with is not what a locale has. */
START_TEST(other_locale)
{
	struct read r;
	struct analysis *a;

	if (!setlocale(LC_ALL, "de_DE.UTF-8") && !setlocale(LC_ALL, "fr_FR.UTF-8")) {
		printf("skipped: a locale with a decimal comma; neither de_DE.UTF-8 nor fr_FR.UTF-8 is installed\n");
		return;
	}
	ck_assert_int_eq(build(&r, &a, arm, "lock elbow=0.5"), RNEAGEN_OK);
	ck_assert(a->outcome.held[0].value[0].x == 0.5L);
	read_free(&r);
	setlocale(LC_ALL, "C");
}
END_TEST

/* ---- what is said ---- */

/* Scenes put together at random from words, names, values and noise: none does harm, and what is refused is said. */
START_TEST(random_scenes)
{
	static const char *const parts[] = {"root ", "tip ", "beside drop", "beside lock", "lock ", "lock-all-but ",
		"fold ", "free ", "want ", "fext ", "fext-frame world", "damping", "friction", "friction 0.1",
		"snap-angle 1e-3", "round-constants 4", "drop-below 1e-3:sampled", "range ", "range qd=-1,1", "base", "upper",
		"fore", "hand", "left", "right", "head", "a,b", "shoulder", "elbow", "wrist", "grip", "follow", "neck",
		"free", "qd", "qdd", "q.elbow", "tau", "power", "gravity", "mass.", "payload.", "wrench.", "offset.",
		"armature", "friction.",
		"=", "=0", "=0.5", "=1,2,3", "=1,2", "[0]", ":batch", ":sample", ",", "\n", "\n", "\n", " ", " #", "\t",
		"\r\n", "\xc3\xa9", "'", "1e999", "-"};
	enum { PARTS = sizeof parts / sizeof *parts, SCENES = 1000 };
	struct rng rng = rng_seed((uint64_t)_i + 1);
	int built = 0;

	for (int k = 0; k < SCENES; k++) {
		char scene[512] = "";
		struct read r;
		struct analysis *a;

		for (int n = 1 + rng_below(&rng, 10); n > 0; n--) {
			int key = rng_below(&rng, 19); /* the first ones begin a line */

			strcat(scene, n % 3 == 0 ? "\n" : "");
			strcat(scene, n % 3 == 0 ? parts[key] : parts[19 + rng_below(&rng, PARTS - 19)]);
		}
		if (build(&r, &a, arm, scene))
			ck_assert_msg(r.error.message[0] && strlen(r.error.message) > strlen("here: "), "%s", scene);
		else
			built++;
		read_free(&r);
	}
	printf("seed %d: %d of %d random scenes leave a robot\n", _i + 1, built, SCENES);
	ck_assert_int_gt(built, 5);
}
END_TEST

static struct rneagen_result generate(const char *scene)
{
	struct rneagen_options o = rneagen_options_default();

	o.target = RNEAGEN_TARGET_C;
	o.tell = RNEAGEN_TELL_ALL;
	o.scene = scene;
	return generated(arm, &o);
}

static void expect(const char *text, const char *part)
{
	ck_assert_msg(strstr(text, part) != NULL, "no '%s' in\n%.3000s", part, text);
}

START_TEST(told)
{
	struct rneagen_result r = generate("root base\ntip a,b\ntip hand\nbeside drop\nlock elbow=2.5");

	expect(r.source, " --name arm\n *     --root base --tip a,b --tip hand --beside drop --lock elbow=2.5\n");
	expect(r.source, " * Held:\n *   \"elbow\" = 2.5 (lock)\n * Cut away: 4 links of 4 kg, 4 joints\n"
			 " *   joints: \"follow\", \"free\", \"grip\", \"neck\"\n *   links: \"head\", \"left\", \"right\", \"thing\"\n");
	expect(r.source, "elbow' is held at 2.5, outside of its limits");
	expect(r.info,
		"\nscene\n  --root base\n  --tip a,b\n  --tip hand\n  --beside drop\n  --lock elbow=2.5\nheld\n  elbow = 2.5 (lock)\n"
		"cut away: 4 links of 4 kg, 4 joints\n  joints: follow, free, grip, neck\n  links: head, left, right, thing\n");
	expect(r.info_json, "\"held\": [\n      {\"name\": \"elbow\", \"value\": [2.5], \"why\": \"lock\"}],\n"
			    "    \"cut\": {\"mass\": 4, \"joints\": [\"follow\", \"free\", \"grip\", \"neck\"], \"links\": [\"head\", ");
	expect(r.info_json, "\"options\": [\"--root base\", \"--tip a,b\", ");
	ck_assert_uint_eq(r.warning_count, 1);
	expect(r.warnings[0], "<input>: joint 'elbow' is held at 2.5, outside of its limits (lock)");
	rneagen_result_free(&r);
}
END_TEST

/* What its arrays are, in the head of a text. */
START_TEST(told_of_arrays)
{
	struct rneagen_result r = generate("free mass.hand,payload.left");

	expect(r.source, "mass.hand: kg; the link's centre of mass, and its inertia about that,\n *     stay, so h = m c\n");
	expect(r.source, "payload.left: m hx hy hz Ixx Ixy Ixz Iyy Iyz Izz about the link's origin, in its frame\n");
	rneagen_result_free(&r);
}
END_TEST

#define FIXED(parent, child) JOINT(parent child, "fixed", parent, child, "")
#define LEGS JOINT("left", "revolute", "trunk", "a", "") JOINT("right", "revolute", "trunk", "b", "") BALL("a") BALL("b")
#define AIR LINK("air", "0", "0 0 0", "0 0 0", "0", "0", "0", "0", "0", "0")

/* --base floating on a root that has no mass. */
static const struct {
	const char *urdf, *scene, *base; /* base: what --root is to name; NULL: no warning */
} FLOATING[] = {
	{ROBOT("r", BARE("world") FIXED("world", "trunk") BALL("trunk") LEGS), NULL, "trunk"},
	{ROBOT("r", BARE("world") FIXED("world", "air") AIR FIXED("air", "trunk") BALL("trunk") LEGS), NULL, "trunk"},
	{ROBOT("r", BARE("world") JOINT("free", "floating", "world", "trunk", "") BALL("trunk") LEGS), NULL, "trunk"},
	{ROBOT("r", BARE("footprint") JOINT("drive", "planar", "footprint", "trunk", "") BALL("trunk") LEGS), NULL, "trunk"},
	{ROBOT("r", BARE("footprint") JOINT("lift", "prismatic", "footprint", "air", "") AIR FIXED("air",
		"trunk") BALL("trunk") LEGS),
		NULL, "trunk"},
	{ROBOT("r", BARE("footprint") FIXED("footprint", "trunk") BALL("trunk") LEGS), NULL, NULL},
	{ROBOT("r", BARE("footprint") JOINT("lift", "prismatic", "footprint", "trunk", "") BALL("trunk") LEGS),
		"lock lift=0.5", NULL},
	{ROBOT("r", BARE("footprint") JOINT("turn", "revolute", "footprint", "trunk", "") BALL("trunk") LEGS),
		"lock turn=0.5", NULL},
	{ROBOT("r", BALL("world") FIXED("world", "trunk") BALL("trunk") LEGS), NULL, NULL},
	{ROBOT("r", BARE("world") FIXED("world", "trunk") BALL("trunk") LEGS), "root trunk", NULL},
};

START_TEST(floating_without_mass)
{
	struct rneagen_options o = rneagen_options_default();
	char want[256];

	o.scene = FLOATING[_i].scene;
	for (int floats = 0; floats < 2; floats++) {
		struct rneagen_result r;

		o.base = floats ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
		r = generated(FLOATING[_i].urdf, &o);
		ck_assert_msg(r.warning_count == (floats && FLOATING[_i].base), "%zu warnings: %s", r.warning_count,
			r.warning_count ? r.warnings[0] : "");
		snprintf(want, sizeof want, "which has no mass; --root '%s' floats that link instead",
			FLOATING[_i].base ? FLOATING[_i].base : "");
		ck_assert_msg(!r.warning_count ||
			(strstr(r.warnings[0], "--base floating floats link '") && strstr(r.warnings[0], want)),
			"%s", r.warnings[0]);
		rneagen_result_free(&r);
	}
}
END_TEST

#define DYNAMIC(name, type, parent, child, damping, friction)                                                                \
	JOINT(name, type, parent, child, "<dynamics damping='" damping "' friction='" friction "'/>")

START_TEST(ignored)
{
	static const char text[] = ROBOT("r",
		BALL("base") BALL("a") BALL("b") BALL("c") BALL("d") DYNAMIC("ja", "revolute", "base", "a", "0.5", "0")
		DYNAMIC("jb", "revolute", "a", "b", "0", "0.25") DYNAMIC("jc", "continuous", "b", "c", "0.5", "1")
			DYNAMIC("jd", "fixed", "c", "d", "1", "1") "<transmission name='t'><joint name='ja'/></transmission>");
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;

	o.tell = RNEAGEN_TELL_ALL;
	r = generated(text, &o);
	expect(r.info,
		"\nin the URDF and not modelled\n  damping of ja, jc\n  friction of jb, jc\n  limits of ja, jb\n  1 transmissions\n");
	expect(r.info_json,
		"  \"ignored\": {\"damping\": [\"ja\", \"jc\"], \"friction\": [\"jb\", \"jc\"], \"limits\": [\"ja\", \"jb\"], "
		"\"transmissions\": 1},\n");
	rneagen_result_free(&r);
	o.scene = "lock jc=0";
	r = generated(text, &o);
	expect(r.source, " * In the URDF and not modelled: damping of 1 joints, friction of 1, limits of 2\n");
	rneagen_result_free(&r);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("scene");
	TCase *c = tcase_create("scene");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 60);
	tcase_add_loop_test(c, leaves, 0, sizeof lefts / sizeof *lefts);
	tcase_add_loop_test(c, refuses, 0, sizeof refuseds / sizeof *refuseds);
	tcase_add_test(c, other_locale);
	tcase_add_loop_test(c, random_scenes, 0, 2);
	tcase_add_test(c, told);
	tcase_add_test(c, told_of_arrays);
	tcase_add_loop_test(c, floating_without_mass, 0, sizeof FLOATING / sizeof *FLOATING);
	tcase_add_test(c, ignored);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
