/* What a generation takes from its allocator as robots and inputs grow: bytes, not time, so that no machine decides. It catches
   a pass that keeps what it tried, makes a robot's whole DAG again at each try, or hands on what nobody reads. */
#include "urdf/precheck.h"
#include "rneagen.h"
#include "scene/scene.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MEGABYTE = 1000000 };

/* Bytes that are out, the most that ever were, and all that ever came. */
struct meter {
	size_t now, most, all;
};

static void *meter_alloc(void *context, size_t size)
{
	struct meter *m = context;
	max_align_t *p = malloc(sizeof *p + size);

	ck_assert_ptr_nonnull(p);
	memcpy(p, &size, sizeof size);
	m->now += size;
	m->all += size;
	m->most = m->now > m->most ? m->now : m->most;
	return p + 1;
}

static void meter_release(void *context, void *block)
{
	max_align_t *p = (max_align_t *)block - 1;
	size_t size;

	memcpy(&size, p, sizeof size);
	((struct meter *)context)->now -= size;
	free(p);
}

/* ---- chains ---- */

/* Each link turned against the one before about all axes, so that no constant is zero. */
static const char *chain(int links, struct arena *a)
{
	struct text t;

	text_init(&t, a);
	text_put(&t, "<robot name='chain'><link name='l0'/>");
	for (int i = 1; i <= links; i++) {
		text_printf(&t, "<link name='l%d'><inertial><origin xyz='0.01 0.02 0.%d'/><mass value='1.%d'/>", i, 1 + i % 7, i);
		text_put(&t, "<inertia ixx='0.02' ixy='0.001' ixz='0.002' iyy='0.03' iyz='0.003' izz='0.04'/></inertial></link>");
		text_printf(&t, "<joint name='j%d' type='continuous'><parent link='l%d'/><child link='l%d'/>", i, i - 1, i);
		text_printf(&t, "<origin xyz='0.1 0.2 0.3' rpy='0.%d 0.2 0.3'/><axis xyz='0 0 1'/></joint>", 1 + i % 9);
	}
	text_put(&t, "</robot>");
	ck_assert(!t.failed);
	return text_string(&t);
}

static struct meter generate_text(const char *urdf, struct rneagen_options o)
{
	struct meter m = {0};
	const struct rneagen_allocator allocator = {meter_alloc, meter_release, &m};
	struct rneagen_error e;
	struct rneagen_result r;

	o.allocator = &allocator;
	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &r, &e), "%s", e.message);
	rneagen_result_free(&r);
	ck_assert_uint_eq(m.now, 0);
	return m;
}

static struct meter generate(int links, struct rneagen_options o)
{
	struct arena a;
	struct meter m;

	arena_init(&a, NULL);
	m = generate_text(chain(links, &a), o);
	arena_free(&a);
	return m;
}

/* By the URDF's constants, but where base parameters are searched for. */
#define GRADIENTS "params urdf\nwant tau,dtau_dq,dtau_dqd\n"

static const struct growth {
	const char *scene;
	enum rneagen_target target;
	enum rneagen_base base;
	size_t most, all; /* MB: half as much again as it takes */
	int links;
} GROWTHS[] = {
	{GRADIENTS, RNEAGEN_TARGET_CUDA, RNEAGEN_FIXED, 110, 480, 60},
	{GRADIENTS, RNEAGEN_TARGET_C, RNEAGEN_FIXED, 190, 450, 60},
	{GRADIENTS, RNEAGEN_TARGET_CUDA, RNEAGEN_FLOATING, 110, 520, 60},
	{"params urdf\nwant M\n", RNEAGEN_TARGET_CUDA, RNEAGEN_FIXED, 80, 3400, 60},
	{"params urdf\nwant M\n", RNEAGEN_TARGET_C, RNEAGEN_FLOATING, 72, 250, 60},
	{"params urdf\nwant jvp,vjp\n", RNEAGEN_TARGET_C, RNEAGEN_FLOATING, 29, 81, 60},
	{"params urdf\n", RNEAGEN_TARGET_CUDA, RNEAGEN_FIXED, 53, 96, 60},
	{"params base\n", RNEAGEN_TARGET_C, RNEAGEN_FIXED, 23, 9600, 60},
	{"params base\n", RNEAGEN_TARGET_C, RNEAGEN_FIXED, 17, 5200, 40}, /* where not all is asked for, in place of the one before */
};

/* A matrix of twice as many links has four times as many elements. Under the sanitizers the short texts alone, without a
   search. */
START_TEST(chains)
{
	const struct growth *g = &GROWTHS[_i];
	struct rneagen_options o = rneagen_options_default();
	const int is_search = strstr(g->scene, "base") != NULL;
	struct meter half, whole;

	if ((sanitized() && (g->most > 50 || is_search)) || (is_search && exhaustive() != (g->links == 60)))
		return;
	o.scene = g->scene;
	o.tell = RNEAGEN_TELL_ALL;
	o.target = g->target;
	o.base = g->base;
	half = generate(g->links / 2, o);
	whole = generate(g->links, o);
	printf("%d: %zu MB at once, %zu in all; %d links: %zu, %zu\n", _i, whole.most / MEGABYTE, whole.all / MEGABYTE, g->links / 2,
		half.most / MEGABYTE, half.all / MEGABYTE);
	ck_assert_uint_le(whole.most, g->most * MEGABYTE);
	ck_assert_uint_le(whole.all, g->all * MEGABYTE);
	ck_assert_uint_le(2 * whole.all, 9 * half.all);
}
END_TEST

/* Factors of the mass matrix grow with the cube of a chain's length: of a long one they are not even tried. With a vjp a long
   chain is cut into pieces, and for each of them it is tried how much of the motion is made again. */
static const struct long_chain {
	const char *scene;
	enum rneagen_precision precision;
	size_t most, all; /* MB */
} LONG_CHAINS[] = {
	{"params urdf\nwant qdd\n", RNEAGEN_F32, 150, 330},
	{"params urdf\nwant tau,vjp\n", RNEAGEN_F64, 106, 890},
};

START_TEST(long_chains)
{
	const struct long_chain *c = &LONG_CHAINS[_i];
	struct rneagen_options o = rneagen_options_default();
	struct meter m;

	if (sanitized())
		return;
	o.scene = c->scene;
	o.precision = c->precision;
	m = generate(160, o);
	printf("160 links: %zu MB at once, %zu in all: %s", m.most / MEGABYTE, m.all / MEGABYTE, c->scene);
	ck_assert_uint_le(m.most, c->most * MEGABYTE);
	ck_assert_uint_le(m.all, c->all * MEGABYTE);
}
END_TEST

/* A third of the joints is held: not for each of them is the whole made again. */
START_TEST(held_joints)
{
	struct rneagen_options o = rneagen_options_default();
	struct meter none, some;
	struct arena a;
	struct text scene;

	if (sanitized())
		return;
	arena_init(&a, NULL);
	text_init(&scene, &a);
	text_put(&scene, GRADIENTS);
	for (int i = 1; i <= 25; i++)
		text_printf(&scene, "lock j%d=0.%d\n", 3 * i, i);
	o.target = RNEAGEN_TARGET_C;
	o.scene = GRADIENTS;
	none = generate(75, o);
	o.scene = text_string(&scene);
	some = generate(75, o);
	printf("%zu MB in all, and %zu with joints held\n", none.all / MEGABYTE, some.all / MEGABYTE);
	ck_assert_uint_le(some.all, 4 * none.all);
	arena_free(&a);
}
END_TEST

/* ---- what is read ---- */

/* An element in each of whose places `count` attributes stand that mean nothing; returns the clean copy's length. */
static size_t copied(const char *before, const char *after, int count)
{
	struct rneagen_error e = {0};
	struct robot r = {0};
	struct arena a;
	struct text t;
	struct outline o;
	const struct diagnostic p = {"here", &r, &a, &e};
	size_t length;

	arena_init(&a, NULL);
	text_init(&t, &a);
	text_put(&t, before);
	for (int i = 0; i < count; i++)
		text_printf(&t, " a%d='%d'", i, i);
	text_put(&t, after);
	ck_assert_msg(!precheck(&o, text_string(&t), t.length, &p), "%s", e.message);
	length = o.urdf.length;
	arena_free(&a);
	return length;
}

#define BODY "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"
#define ENDS "<parent link='a'/><child link='b'/>"

static const char *const PLACES[][2] = {
	{"<robot name='r'", "><link name='a'/></robot>"},
	{"<robot name='r'><link name='a'", "/></robot>"},
	{"<robot name='r'><link name='a'><inertial",
		"><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>"},
	{"<robot name='r'><link name='a'><inertial><mass value='1'",
		"/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>"},
	{"<robot name='r'><link name='a'/><link name='b'>" BODY "</link><joint name='j' type='fixed'",
		">" ENDS "</joint></robot>"},
	{"<robot name='r'><link name='a'/><link name='b'>" BODY "</link><joint name='j' type='continuous'>" ENDS
	 "<axis xyz='0 0 1'",
		"/></joint></robot>"},
	{"<robot name='r'><link name='a'><visual", "/></link></robot>"},
};

/* urdfdom looks through all attributes of an element at each new one: it is given those alone that it reads. */
START_TEST(attributes)
{
	const char *const *place = PLACES[_i];

	ck_assert_uint_eq(copied(place[0], place[1], 50000), copied(place[0], place[1], 0));
}
END_TEST

/* What no attribute may lose on the way. */
START_TEST(attributes_that_mean_something)
{
	static const char text[] = "<robot name='r' version='1.0'><link name='a'/><link name='b'/><joint name='j' type='revolute'>" ENDS
		"<origin xyz='1 2 3' rpy='4 5 6'/><limit effort='1' velocity='2' lower='-3' upper='4'/><dynamics damping='5' friction='6'/>"
		"<safety_controller soft_lower_limit='7' soft_upper_limit='8' k_position='9' k_velocity='10'/>"
		"<calibration reference_position='11' rising='12' falling='13'/><mimic joint='j' multiplier='14' offset='15'/>";
	static const char *const kept[] = {"version=\"1.0\"", "xyz=\"1 2 3\"", "rpy=\"4 5 6\"", "effort=\"1\"", "velocity=\"2\"",
		"lower=\"-3\"", "upper=\"4\"", "damping=\"5\"", "friction=\"6\"", "soft_lower_limit=\"7\"",
		"soft_upper_limit=\"8\"", "k_position=\"9\"", "k_velocity=\"10\"", "reference_position=\"11\"", "rising=\"12\"",
		"falling=\"13\"", "multiplier=\"14\"", "offset=\"15\""};
	struct rneagen_error e = {0};
	struct robot r = {0};
	struct arena a;
	struct outline o;
	const struct diagnostic p = {"here", &r, &a, &e};
	char urdf[sizeof text + 32];

	snprintf(urdf, sizeof urdf, "%s</joint></robot>", text);
	arena_init(&a, NULL);
	ck_assert_msg(!precheck(&o, urdf, strlen(urdf), &p), "%s", e.message);
	for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
		ck_assert_msg(strstr(text_string(&o.urdf), kept[i]) != NULL, "%s is lost", kept[i]);
	arena_free(&a);
}
END_TEST

/* Lines that say nothing are not kept. */
START_TEST(empty_lines)
{
	static const char *const lines[] = {"\n", " \t\n", "# a comment\n", "  # a comment\n"};
	struct meter m = {0};
	const struct rneagen_allocator allocator = {meter_alloc, meter_release, &m};
	struct rneagen_error e = {0};
	struct arena spare, a;
	struct text t;
	struct scene s;

	arena_init(&spare, NULL);
	text_init(&t, &spare);
	for (int i = 0; i < 100000; i++)
		text_put(&t, lines[_i]);
	text_put(&t, "damping");
	arena_init(&a, &allocator);
	ck_assert_msg(!scene_read(&s, text_string(&t), "here", &a, &e), "%s", e.message);
	ck_assert_int_eq(s.line_count, 1);
	ck_assert_int_eq(s.lines[0].told, 100001);
	ck_assert_uint_lt(m.all, 100000);
	arena_free(&a);
	arena_free(&spare);
}
END_TEST

/* A scene names each joint and link some times, not each a million times. */
START_TEST(choices)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	struct rneagen_result r;
	struct arena a;
	struct text t;
	const char *urdf;

	arena_init(&a, NULL);
	text_init(&t, &a);
	urdf = chain(2, &a);
	text_put(&t, "damping\ntip l2");
	for (int i = 0; i < LIMIT_CHOICES - 2; i++)
		text_put(&t, i % 2 ? ",l2" : "\ntip l2");
	o.scene = text_string(&t);
	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &r, &e), "%s", e.message);
	rneagen_result_free(&r);
	text_put(&t, _i ? ",l2" : "\nfriction");
	o.scene = text_string(&t);
	ck_assert_int_eq(rneagen_generate(urdf, strlen(urdf), &o, &r, &e), RNEAGEN_SCENE);
	ck_assert_msg(strstr(e.message, "more than 16384 choices in the scene, of a list each name") != NULL, "%s", e.message);
	arena_free(&a);
}
END_TEST

/* ---- columns that stand apart ---- */

enum { SIDE = 64 };

/* A base with two chains of joints that slide, and its order of q: one of each chain by turns. */
static const char *two_chains(struct text *order, struct arena *a)
{
	struct text t;

	text_init(&t, a);
	text_put(&t, "<robot name='two'><link name='base'><inertial><mass value='5'/>"
		"<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>");
	for (int i = 0; i < 2 * SIDE; i++) {
		char parent[16] = "base";

		if (i > 1)
			snprintf(parent, sizeof parent, "l%d", i - 2);
		text_printf(&t, "<link name='l%d'><inertial><mass value='1'/>", i);
		text_put(&t, "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>");
		text_printf(&t, "<joint name='j%d' type='prismatic'><parent link='%s'/><child link='l%d'/>", i, parent, i);
		text_printf(&t, "<axis xyz='%s'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>",
			i / 2 % 3 == 0 ? "1 0 0" : i / 2 % 3 == 1 ? "0 1 0" : "0 0 1");
		text_printf(order, "%sj%d", i ? "," : "", i);
	}
	text_put(&t, "</robot>");
	return text_string(&t);
}

/* It would catch a way that does not serve so many runs of columns and ends with "out of memory", where another one does. */
START_TEST(runs)
{
	struct rneagen_options o = rneagen_options_default();
	struct text order;
	struct arena a;
	const char *urdf;

	if (!exhaustive() || sanitized())
		return;
	arena_init(&a, NULL);
	text_init(&order, &a);
	urdf = two_chains(&order, &a);
	o.base = RNEAGEN_FLOATING;
	o.target = RNEAGEN_TARGET_CUDA;
	o.order = text_string(&order);
	o.scene = "want qdd,dqdd_dq,dqdd_dqd\n";
	generate_text(urdf, o);
	arena_free(&a);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("growth");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "chains", chains, sizeof GROWTHS / sizeof *GROWTHS, 100);
	suite_add(suite, "long_chains", long_chains, sizeof LONG_CHAINS / sizeof *LONG_CHAINS, 100);
	suite_add(suite, "held_joints", held_joints, 1, 100);
	suite_add(suite, "attributes", attributes, sizeof PLACES / sizeof *PLACES, 100);
	suite_add(suite, "attributes_that_mean_something", attributes_that_mean_something, 1, 10);
	suite_add(suite, "empty_lines", empty_lines, 4, 10);
	suite_add(suite, "choices", choices, 2, 10);
	suite_add(suite, "runs", runs, 1, 100);
	return suite_run(suite);
}
