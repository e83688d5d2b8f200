/* Scenes of random trees with base parameters, seeds printed: what is given, freed, pushed and asked for, wrenches, twists,
   accelerations and energies among it, against the reference changed in the same way. It would catch a quantity of a link that is
   read in the frame of the text, or an inertia that has left a link whose own is an input or whose wrench is asked for. */
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

int main(void)
{
	Suite *suite = suite_create("params of tasks");
	TCase *c = tcase_create("task");

	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, random_scenes, 0, 2);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
