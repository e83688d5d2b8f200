/* Scenes of random trees with base parameters, seeds printed: what is given, freed, pushed and asked for, wrenches, twists,
   accelerations and energies among it, against the reference changed in the same way. It would catch a quantity of a link that is
   read in the frame of the text, an inertia that has left a link whose own is an input or whose wrench is asked for, or a mass
   that has left for what is held on the ground and counts in no potential there. */
#include "support/suite.h"
#include "support/task/task.h"
#include <stdio.h>
#include <stdlib.h>

enum { ROBOTS = 80, LINKS = 10 };

static void draw(struct task_case *c)
{
	if (rng_chance(&c->rng, 0.3))
		case_draw_tips(c);
	if (rng_chance(&c->rng, 0.3))
		case_draw_locks(c);
	if (rng_chance(&c->rng, 0.3))
		case_draw_folds(c);
	if (rng_chance(&c->rng, 0.5))
		case_draw_frees(c, 0);
	if (rng_chance(&c->rng, 0.5))
		case_draw_pushes(c);
	if (rng_chance(&c->rng, 0.3))
		case_draw_own(c);
	if (rng_chance(&c->rng, 0.8))
		case_draw_wants(c);
}

START_TEST(random_scenes)
{
	const char *word = _i ? "auto" : "base";
	size_t restated = 0;
	int tried = 0;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct task_case *c = case_random(seed + 500, LINKS, NO_ODD_NAMES);
		char what[64];

		if (!c)
			continue;
		snprintf(what, sizeof what, "params %s, seed %llu", word, (unsigned long long)seed);
		draw(c);
		case_say(c, "params %s\n", word);
		restated += case_checked(c, what);
		case_close(c);
		tried++;
	}
	printf("params %s: %d random scenes, seeds 1 to %d, %zu operations\n", word, tried, ROBOTS, restated);
	ck_assert_int_gt(tried, ROBOTS / 2);
}
END_TEST

/* Joints that stand on the ground are held at angles that are not right: their links stay bodies, which do not move. */
static int hold_at_ground(struct task_case *c)
{
	int held = 0;

	for (int j = 1; j < c->r->nj; j++) {
		const struct reference_joint *k = &c->r->joints[j];

		if (k->parent == 0 && case_has_one_row(c, j)) {
			case_lock(c, j);
			held++;
		}
	}
	return held;
}

START_TEST(held_at_ground)
{
	int tried = 0;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct task_case *c = case_random(seed + 900, LINKS, NO_ODD_NAMES);
		char what[64];

		if (!c)
			continue;
		snprintf(what, sizeof what, "held at the ground, seed %llu", (unsigned long long)seed);
		if (hold_at_ground(c) && case_pick(c, case_moves) >= 0) {
			case_want(c, TASK_POTENTIAL, -1);
			case_say(c, "params base\n");
			case_checked(c, what);
			tried++;
		}
		case_close(c);
	}
	printf("potential of what is held at the ground: %d random scenes, seeds 1 to %d\n", tried, ROBOTS);
	ck_assert_int_gt(tried, 20);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("params of tasks");
	TCase *c = tcase_create("task");

	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, random_scenes, 0, 2);
	tcase_add_test(c, held_at_ground);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
