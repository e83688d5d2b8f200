/* Magnitudes that are known of a whole box by its parts hold at states drawn within it and at its corners, for all
   values and sets of a few robots; and they are closer than those over the box at once. */
#include "peaks/caps.h"
#include "norms/adjoint.h"
#include "prove/robot_box.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>

enum { SEED = 47, STATES = 400 };

static const char *const ROBOTS[] = {"iiwa14", "ur5", "hyq", "prismatic_skew"};

struct capped {
	struct robot_box x;
	struct adjoint adjoint;
	struct norms norms;
	struct norms_values with, without;
	struct interval *rows[DAG_ARGUMENTS];
	int dims[64], dim_count;
};

static void capped_open(struct capped *c, const char *name, size_t output)
{
	const struct dag *d;
	struct arena *a = &c->x.arena;
	struct caps caps;

	robot_box_open(&c->x, name, "range qdd=-20,20\nrange qd=-2,2\nrange q=-2,2.5", 0);
	d = &c->x.analysis.dag;
	ck_assert(box_copy(c->rows, &c->x.box, d, a) && adjoint_make(&c->adjoint, d, output, 1, a) &&
		  norms_make(&c->norms, &c->adjoint.d, 0, a));
	ck_assert(norms_lay(&c->norms, a) && norms_values_make(&c->with, &c->norms, a) &&
		  norms_values_make(&c->without, &c->norms, a));
	for (c->dim_count = 0; c->dim_count < d->arguments[0].rows; c->dim_count++)
		c->dims[c->dim_count] = c->dim_count;
	ck_assert(d->arguments[0].role == ROLE_JOINT_POSITION);
	caps = (struct caps){c->rows, c->rows[0], c->dims, c->dim_count, (double)INFINITY};
	ck_assert(caps_find(&caps, &c->norms, &c->with, a));
}

/* A state as a box without room. */
static void draw(struct capped *c, struct rng *r)
{
	const struct dag *d = &c->x.analysis.dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < d->arguments[i].rows && c->rows[i]; k++) {
			struct interval all = c->x.box.rows[i][k];
			double at = rng_chance(r, 0.3) ? rng_chance(r, 0.5) ? all.lower : all.upper
						       : rng_uniform(r, all.lower, all.upper);

			c->rows[i][k] = (struct interval){at, at};
		}
}

START_TEST(test_caps)
{
	struct capped c;
	struct rng r = rng_seed(SEED);
	double closest = 1;

	capped_open(&c, ROBOTS[_i], 0);
	norms_evaluate(&c.norms, (const struct interval *const *)c.x.box.rows, &c.without);
	for (size_t i = 0; i < c.adjoint.d.count; i++)
		if (c.without.size[i] > 0)
			closest = fmin(closest, c.with.most[i] / c.without.size[i]);
	ck_assert_msg(closest < 0.9, "%s: nothing is closer", ROBOTS[_i]);
	for (int k = 0; k < STATES; k++) {
		draw(&c, &r);
		norms_evaluate(&c.norms, (const struct interval *const *)c.rows, &c.without);
		for (size_t i = 0; i < c.adjoint.d.count; i++)
			ck_assert_msg(fabs(norms_range(&c.norms, &c.without, (uint32_t)i).lower) <=
					      c.with.most[i] * (1 + 1e-9) + 1e-12,
				"%s, seed %d, state %d: node %zu is %g, but at most %g", ROBOTS[_i], SEED, k, i,
				c.without.size[i], c.with.most[i]);
		for (uint32_t i = 0; i < c.norms.set_count; i++) {
			double sum = 0;

			for (int n = 0; n < c.norms.sets[i].count; n++) {
				struct interval v = norms_range(&c.norms, &c.without, c.norms.sets[i].nodes[n]);

				sum += v.lower * v.lower;
			}
			ck_assert_msg(sqrt(sum) <= c.with.most_norm[i] * (1 + 1e-9) + 1e-12,
				"%s, seed %d, state %d: set %u is %g, but at most %g", ROBOTS[_i], SEED, k, i,
				sqrt(sum), c.with.most_norm[i]);
		}
	}
	robot_box_close(&c.x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("caps");

	suite_add(suite, "caps", test_caps, (int)(sizeof ROBOTS / sizeof *ROBOTS), 60);
	return suite_run(suite);
}
