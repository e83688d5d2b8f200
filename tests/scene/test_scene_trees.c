/* What a scene leaves of a tree: held joints are the whole robot at rest there, chains are the rest held, a subtree or a
   robot without what hangs beside is its own URDF, where joints beside are locked too, with their followers; nothing costs
   more for being held. On random trees, seeds printed, and on robots. */
#define _POSIX_C_SOURCE 200809L
#include "support/scene_model.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 14 };
#define ROBOTS (exhaustive() ? 100 : sanitized() ? 20 : 50) /* random trees */

static struct rneagen_options options;
static struct reference *whole;
static struct scene_held held;
static char *urdf;
static struct rng rng;
static char scene[1 << 16];

/* By the URDF's constants: what a search for others finds of a part may cost more than what it finds of the whole. */
static const char BY_URDF[] = "params urdf\n";

static void begin_scene(void)
{
	strcpy(scene, BY_URDF);
}

static void set_up(uint64_t seed)
{
	rng = rng_seed(seed + 900);
	options = rneagen_options_default();
	options.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	options.mimic = seed % 4 ? RNEAGEN_MIMIC_HONOUR : RNEAGEN_MIMIC_INDEPENDENT;
	options.gravity[1] = 1.25;
	options.scene = scene;
	begin_scene();
	urdf = torque_robot(seed, LINKS, NO_ODD_NAMES);
	whole = scene_reference(urdf, &options);
	scene_held_init(&held, whole);
}

static void tear_down(void)
{
	reference_close(whole);
	free(urdf);
}

static void say(const char *format, const char *name)
{
	size_t used = strlen(scene);

	snprintf(scene + used, sizeof scene - used, format, name);
}

static void say_lock(int j)
{
	const struct reference_joint *x = &whole->joints[j];

	say("lock %s=", x->name);
	for (int i = 0; i < x->nq; i++) {
		char number[64];

		snprintf(number, sizeof number, "%s%.17g", i ? "," : "", held.q[x->iq + i]);
		say("%s", number);
	}
	say("%s", "\n");
	held.held[j] = 1;
}

/* Joints with entries in q and a name. */
static int can_hold(int j)
{
	return whole->joints[j].nq > 0 && *whole->joints[j].name;
}

static int entries(void)
{
	int count = 0;

	for (int j = 0; j < whole->nj; j++)
		count += whole->joints[j].nq > 0 && !held.held[j];
	return count;
}

static void open_scene(struct scene_model *m, uint64_t seed)
{
	ck_assert_msg(!scene_open(m, urdf, &options), "seed %llu: %s; scene:\n%s", (unsigned long long)seed,
		m->error.message, scene);
}

/* The scene as it stands against the whole robot; a scene that leaves nothing is refused. Returns whether it left any. */
static int compare(uint64_t seed, const char *what)
{
	struct scene_model m;

	if (!entries()) {
		ck_assert_int_eq(scene_open(&m, urdf, &options), RNEAGEN_NO_JOINTS);
		scene_close(&m);
		return 0;
	}
	open_scene(&m, seed);
	ck_assert_int_eq(m.tree.joint_count, entries());
	scene_compare(&m, whole, &held, seed, what);
	scene_close(&m);
	return 1;
}

static size_t cost_of(const char *text, const struct rneagen_options *o)
{
	struct scene_model m;
	size_t n;

	ck_assert_msg(!scene_open(&m, text, o), "%s", m.error.message);
	n = operation_total(&m);
	scene_close(&m);
	return n;
}

/* ---- held joints ---- */

static void sample_values(uint64_t seed)
{
	struct rng r = rng_seed(seed);
	double qd[ROWS], qdd[ROWS];

	reference_sample(whole, &r, false, held.q, qd, qdd);
}

/* The scene is no dearer than the whole robot. */
static void check_cost(uint64_t seed)
{
	struct rneagen_options o = options;
	size_t part = cost_of(urdf, &options), all;

	o.scene = BY_URDF;
	all = cost_of(urdf, &o);
	ck_assert_msg(part <= all, "seed %llu: %zu operations, more than %zu", (unsigned long long)seed, part, all);
}

START_TEST(locked)
{
	int tried = 0, joints = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		set_up(seed);
		sample_values(seed);
		for (int j = 0; j < whole->nj; j++)
			if (can_hold(j) && rng_chance(&rng, 0.4)) {
				say_lock(j);
				joints++;
			}
		tried += compare(seed, "locked");
		if (entries())
			check_cost(seed);
		tear_down();
	}
	printf("random trees, seeds 1 to %d: %d joints locked, in %d robots that still move\n", ROBOTS, joints, tried);
	ck_assert_int_gt(tried, ROBOTS / 2);
}
END_TEST

START_TEST(all_but)
{
	int tried = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		int kept = 0;

		set_up(seed);
		for (int j = 0; j < whole->nj; j++)
			if (can_hold(j)) {
				held.held[j] = !rng_chance(&rng, 0.4);
				if (!held.held[j])
					say(kept++ ? ", %s" : "lock-all-but %s", whole->joints[j].name);
			}
		say("%s", "\n");
		for (int j = 0; kept && j < whole->nj; j++)
			if (held.held[j] && whole->joints[j].nq == 1 && rng_chance(&rng, 0.3)) {
				held.q[whole->joints[j].iq] = rng_uniform(&rng, -1, 1);
				say_lock(j);
			}
		tried += kept && compare(seed, "lock-all-but");
		tear_down();
	}
	ck_assert_int_gt(tried, ROBOTS / 2);
}
END_TEST

/* What every joint alone saves; zero is the value that most robots are held at. */
static void cost_alone(const char *path, const char *name, void *context)
{
	size_t length, full;
	int *joints = context;

	urdf = read_file(path, &length);
	options = rneagen_options_default();
	options.scene = BY_URDF;
	full = cost_of(urdf, &options);
	whole = scene_reference(urdf, &options);
	options.scene = scene;
	for (int j = 0; j < whole->nj; j++)
		for (int value = 0; value < 2 && can_hold(j) && whole->nv > whole->joints[j].nv; value++) {
			struct scene_model m;
			size_t cost;

			begin_scene();
			scene_held_init(&held, whole);
			if (value && whole->joints[j].nq == 1)
				held.q[whole->joints[j].iq] = 0.7;
			say_lock(j);
			open_scene(&m, 0);
			cost = operation_total(&m);
			scene_compare(&m, whole, &held, 1, name);
			scene_close(&m);
			ck_assert_msg(cost <= full, "%s, '%s' held: %zu operations, more than %zu", name,
				whole->joints[j].name, cost, full);
			++*joints;
		}
	tear_down();
}

START_TEST(alone)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	int joints = 0;

	for_each_urdf(TEST_DIR "/robots", cost_alone, &joints);
	if (!folder)
		printf("skipped: further robots, an arm of its own; set RNEAGEN_ROBOTS\n");
	printf("%d joints of robots held one by one\n", joints);
	ck_assert_int_gt(joints, 200);
}
END_TEST

/* ---- chains ---- */

/* Entries on chains to random links, with those of the joints that they follow. */
static void choose_tips(char *chain)
{
	int count = 1 + rng_below(&rng, 2);

	for (int i = 0; i < count; i++) {
		int link = rng_below(&rng, whole->nj);

		say(i ? ",%s" : "tip %s", whole->joints[link].link);
		for (; link > 0; link = whole->joints[link].parent)
			chain[link] = 1;
	}
	for (int again = 1; again;) {
		again = 0;
		for (int j = 0; j < whole->nj; j++)
			for (int up = chain[j] ? whole->joints[j].driver : 0; up > 0 && !chain[up];
				up = whole->joints[up].parent) {
				chain[up] = 1;
				again = 1;
			}
	}
	say("%s", "\n");
}

START_TEST(tips)
{
	int tried = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		char chain[ROWS] = {0};

		set_up(seed);
		choose_tips(chain);
		for (int j = 0; j < whole->nj; j++)
			held.held[j] = !chain[j] && can_hold(j);
		tried += compare(seed, "tip");
		tear_down();
	}
	ck_assert_int_gt(tried, ROBOTS / 3);
}
END_TEST

/* Joints beside the chains that are to be locked: such that nothing before them is cut away. */
static void choose_locked(const char *chain, char *stay)
{
	for (int j = 1; j < whole->nj; j++) {
		int is_there = 1;

		for (int up = whole->joints[j].parent; up > 0; up = whole->joints[up].parent)
			is_there &= chain[up] || stay[up] || whole->joints[up].type == REFERENCE_FIXED;
		stay[j] = (char)(is_there && !chain[j] && can_hold(j) && rng_chance(&rng, 0.6));
	}
}

/* The names of joints that are cut away: those beside the chains that are not locked, nor follow one that is. */
static int list_gone(const char *chain, const char *stay, const char **gone)
{
	int count = 0;

	for (int j = 1; j < whole->nj; j++)
		if (!chain[j] && !stay[whole->joints[j].driver] && whole->joints[j].type != REFERENCE_FIXED)
			gone[count++] = whole->joints[j].name;
	return count;
}

/* The part that is left, with the joints of these names locked, some not at zero. */
static void take_part(const char *part, const char *const *names, int count)
{
	reference_close(whole);
	whole = scene_reference(part, &options);
	scene_held_init(&held, whole);
	for (int j = 1; j < whole->nj; j++)
		for (int i = 0; i < count; i++)
			if (!strcmp(names[i], whole->joints[j].name)) {
				if (whole->joints[j].nq == 1)
					held.q[whole->joints[j].iq] = rng_uniform(&rng, -1, 1);
				say_lock(j);
			}
}

/* What is left is the URDF without the rest; in the second round with joints beside the chains locked. */
START_TEST(dropped)
{
	int tried = 0, followers = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		char chain[ROWS] = {0}, stay[ROWS] = {0}, *names[ROWS], *part;
		const char *gone[ROWS];
		int lock_count = 0;

		set_up(seed);
		choose_tips(chain);
		say("%s", "beside drop\n");
		if (_i)
			choose_locked(chain, stay);
		for (int j = 1; j < whole->nj; j++) {
			if (stay[j])
				names[lock_count++] = strdup(whole->joints[j].name);
			followers += !chain[j] && whole->joints[j].driver != j && stay[whole->joints[j].driver];
		}
		part = scene_urdf(urdf, whole->joints[0].link, gone, list_gone(chain, stay, gone));
		if (part) {
			take_part(part, (const char *const *)names, lock_count);
			tried += compare(seed, "drop");
		}
		while (lock_count)
			free(names[--lock_count]);
		free(part);
		tear_down();
	}
	printf("dropped, seeds 1 to %d: %d followers of locked joints\n", ROBOTS, followers);
	ck_assert_int_gt(tried, ROBOTS / 3);
	ck_assert(!_i || followers > 0);
}
END_TEST

/* ---- subtrees ---- */

START_TEST(roots)
{
	int tried = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		char *part;
		int root;

		set_up(seed);
		root = rng_below(&rng, whole->nj);
		say("root %s\n", whole->joints[root].link);
		part = scene_urdf(urdf, whole->joints[root].link, NULL, 0);
		if (part) {
			reference_close(whole);
			whole = scene_reference(part, &options);
			scene_held_init(&held, whole);
			for (int j = 1; j < whole->nj; j++)
				if (can_hold(j) && rng_chance(&rng, 0.2))
					say_lock(j);
			tried += compare(seed, "root");
		}
		free(part);
		tear_down();
	}
	ck_assert_int_gt(tried, ROBOTS / 3);
}
END_TEST

/* An arm out of a robot with two costs what the arm's own URDF costs. */
START_TEST(arm_of_its_own)
{
	static const char *const names[][3] = {{"pr2.urdf", "torso_lift_link", "r_wrist_roll_link"},
		{"baxter.urdf", "torso", "left_wrist"}, {"yumi.urdf", "yumi_body", "yumi_link_7_r"}};
	const char *folder = getenv("RNEAGEN_ROBOTS");
	char path[4096], *part;
	const char *gone[ROWS];
	size_t length, cost, own;
	int count = 0;

	if (!folder)
		return;
	snprintf(path, sizeof path, "%s/%s", folder, names[_i][0]);
	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s", path);
	options = rneagen_options_default();
	options.scene = BY_URDF;
	whole = scene_reference(urdf, &options);
	begin_scene();
	say("root %s\nbeside drop\n", names[_i][1]);
	say("tip %s\n", names[_i][2]);
	for (int j = 1; j < whole->nj; j++) {
		int on = 0;

		for (int k = 1; k < whole->nj; k++)
			for (int up = k; !strcmp(whole->joints[k].link, names[_i][2]) && up > 0; up = whole->joints[up].parent)
				on |= up == j;
		if (!on && whole->joints[j].type != REFERENCE_FIXED)
			gone[count++] = whole->joints[j].name;
	}
	part = scene_urdf(urdf, names[_i][1], gone, count);
	own = cost_of(part, &options);
	options.scene = scene;
	cost = cost_of(urdf, &options);
	printf("%s, %s to %s: %zu operations\n", names[_i][0], names[_i][1], names[_i][2], cost);
	ck_assert_msg(cost <= own, "%zu operations, more than %zu", cost, own);
	reference_close(whole);
	whole = scene_reference(part, &options);
	scene_held_init(&held, whole);
	compare(1, names[_i][0]);
	free(part);
	tear_down();
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("scene_trees");
	TCase *c = tcase_create("trees");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_test(c, locked);
	tcase_add_test(c, all_but);
	tcase_add_test(c, alone);
	tcase_add_test(c, tips);
	tcase_add_loop_test(c, dropped, 0, 2);
	tcase_add_test(c, roots);
	tcase_add_loop_test(c, arm_of_its_own, 0, 3);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
