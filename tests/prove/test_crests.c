/* Magnitudes that are known by knots hold at states drawn within the box, at corners and where an ascent from there
   ends; and they are closer than those by points, or without some rows of q, than norms. It finds a degree that is too low, a
   place that is left out, waves that are taken for none, and a frontier whose ranges are too narrow. */
#include "prove/crests/crests.h"
#include "prove/crests/frontier.h"
#include "prove/peaked.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 71, ROUNDS = 12, CRESTS = 4, COST = 1 };
#define STATES (exhaustive() ? 40 : 25)
#define SECONDS (exhaustive() ? 3 : 2)

static const struct {
	const char *name, *scene;
	size_t output;
	int kind, cut; /* so many rows of q end at a frontier */
} CASES[] = {
	{"iiwa14", "range qdd=-20,20\nrange qd=-2,2", 4, PEAK_LINEAR, 0},
	{"iiwa14", "range qdd=-20,20\nrange qd=-2,2", 4, PEAK_FULL, 0},
	{"panda", "range qdd=-5,20\nrange qd=-2,2\nrange q=-2,2.5", 5, PEAK_LINEAR, 0},
	{"ur5", "range qdd=-20,20\nrange qd=-2,2\nrange q=-3,3", 4, PEAK_LINEAR, 0},
	{"ur5", "range qdd=-20,20\nrange qd=-2,2\nrange q=-3,3", 4, PEAK_FULL, 0},
	{"iiwa14", "range qdd=-20,20\nrange qd=-2,2", 4, PEAK_FULL, 2},
	{"iiwa14", "range qdd=-20,20\nrange qd=-2,2", 1, PEAK_LINEAR, 1},
	{"panda", "range qdd=-5,20\nrange qd=-2,2\nrange q=-2,2.5", 0, PEAK_PLAIN, 1},
	{"ur5", "range qdd=-5,20\nrange qd=-2,2\nrange q=-3,3", 5, PEAK_FULL, 3},
};

/* Its first rows of q end at a frontier. Returns 0 where that is none. */
static int cut_rows(const struct peaked *c, struct peak *k, int rows)
{
	uint64_t left = k->dims;

	for (int i = 0; i < rows; i++)
		left &= left - 1;
	k->cut = k->dims & ~left;
	k->dims = left;
	return frontier_count(&c->p, k) && crests_fit(&c->p, k);
}

/* A few of a kind, those first of which points leave the most between what they find and what may be. */
static size_t list_crests(struct peaked *c, int kind, int cut, struct crest *list)
{
	size_t count = 0;

	for (double ratio = 16; ratio > 1.02 && count < CRESTS; ratio = sqrt(ratio))
		for (size_t i = 0; i < c->p.count && count < CRESTS; i++) {
			struct peak *k = &c->p.list[i];

			if (k->kind == kind && !k->pair && crests_are_known(k) && __builtin_popcountll(k->dims) >= cut + 2 &&
				k->most > ratio * k->found && k->most <= ratio * ratio * k->found && cut_rows(c, k, cut))
				list[count++] = (struct crest){k, k->nodes[0], COST, (double)INFINITY, 0};
		}
	return count;
}

/* Up from where it is: each row of q by steps, all others from one end to the other. */
static double ascend(struct peaked *c, uint32_t node)
{
	double best, step = 0.2;

	peaked_evaluate(c);
	best = fabs(c->v[node]);
	for (int round = 0; round < ROUNDS; round++, step *= round % 2 ? -1 : -0.6)
		for (int i = 0; i < c->x.analysis.dag.argument_count; i++)
			for (int k = 0; k < c->x.analysis.dag.arguments[i].rows && c->x.box.rows[i]; k++) {
				struct interval r = c->x.box.rows[i][k];
				double before = c->in[i][k];

				c->in[i][k] = i == 0 ? fmin(r.upper, fmax(r.lower, before + step * (r.upper - r.lower)))
					      : before == r.upper ? r.lower
								  : r.upper;
				peaked_evaluate(c);
				if (fabs(c->v[node]) > best)
					best = fabs(c->v[node]);
				else
					c->in[i][k] = before;
			}
	return best;
}

START_TEST(test_states)
{
	struct peaked c;
	struct relaxed relaxed;
	struct crest list[CRESTS];
	struct effort x;
	struct rng r = rng_seed(SEED);
	size_t count;
	double least = 1;

	if ((_i % 2 || _i == 2) && !exhaustive())
		return; /* others run nearly the same */
	x = robot_box_effort();
	peaked_open(&c, CASES[_i].name, CASES[_i].scene, CASES[_i].output, SECONDS);
	ck_assert(crests_sample(&c.p));
	ck_assert(!relax(&relaxed, &c.x.analysis, c.x.box.rows, &c.x.arena, &c.x.error));
	count = list_crests(&c, CASES[_i].kind, CASES[_i].cut, list);
	ck_assert_msg(count >= 2, "%s: none to look at", CASES[_i].name);
	ck_assert(crests_find(&(struct crests){&relaxed, &c.p, &x}, list, count));
	for (size_t i = 0; i < count; i++)
		least = fmin(least, list[i].most / list[i].peak->most);
	ck_assert_msg(least < (CASES[_i].cut ? 3 : 0.98), "%s: nothing is closer", CASES[_i].name);
	for (int s = 0; s < STATES; s++)
		for (size_t i = 0; i < count; i++) {
			double found;

			peaked_draw(&c, &r, 0);
			found = ascend(&c, list[i].node);
			ck_assert_msg(found <= list[i].most * (1 + 1e-9),
				"%s, seed %d, state %d: node %u of kind %d is %g, but at most %g", CASES[_i].name, SEED,
				s, list[i].node, list[i].peak->kind, found, list[i].most);
		}
	workers_close(x.workers);
	robot_box_close(&c.x);
}
END_TEST

/* Each is as important as any other. */
static double error_of(void *peaked)
{
	struct peaked *c = peaked;
	double sum = 0;

	norms_evaluate(&c->norms, (const struct interval *const *)c->x.box.rows, &c->values);
	for (size_t i = 0; i < c->p.count; i++)
		sum += c->values.size[c->p.list[i].nodes[0]];
	return sum;
}

/* What is thought of while crests are chosen is not taken for what is known: a frontier's ranges come from there. */
START_TEST(test_choice)
{
	struct peaked c;
	struct crest *list;
	double *sizes;
	size_t size;

	peaked_open(&c, "iiwa14", "range qdd=-20,20\nrange qd=-2,2", 1, SECONDS);
	ck_assert(crests_sample(&c.p));
	error_of(&c);
	size = c.adjoint.d.count * sizeof *sizes;
	sizes = malloc(size);
	list = malloc((2 * c.p.count + 1) * sizeof *list);
	ck_assert(sizes && list);
	memcpy(sizes, c.values.size, size);
	ck_assert(crests_choose(&(struct crests_choice){&c.p, &c.values, error_of, &c, SECONDS, 0.1, 1, 2}, list) > 0);
	ck_assert(!memcmp(sizes, c.values.size, size));
	error_of(&c);
	ck_assert(!memcmp(sizes, c.values.size, size));
	free(sizes);
	free(list);
	robot_box_close(&c.x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("crests");

	suite_add(suite, "states", test_states, (int)(sizeof CASES / sizeof *CASES), 120);
	suite_add(suite, "choice", test_choice, 1, 60);
	return suite_run(suite);
}
