/* The reference in quad precision against the one in extended precision: own robots, fixed and floating, and random
   trees. They differ by no more than rounding in extended precision. */
#define _POSIX_C_SOURCE 200809L
#include "quad.h"
#include "support/numbers.h"
#include "support/random_robot.h"
#include "support/read.h"
#include "reference/reference.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 100, RANDOM_ROBOTS = 200, LIMIT = 8 };

static const char *const ROBOTS[] = {"iiwa14", "ur5", "panda", "hyq", "atlas", "g1_29dof", "planar_tilted", "mimic_chain",
	"shadow_hand_right", "near_parallel", "angles", "rotated_inertial", "floating_joint", "prismatic_skew"};

/* Largest difference, in 2^-64 of the magnitudes that were summed, and whether quad is more than extended renamed. */
struct tally {
	double worst;
	int finer;
};

static void compare(struct reference *r, struct quad *x, struct rng *rng, const char *what, struct tally *t)
{
	double *q = numbers_new(r->nq, sizeof *q), *qd = numbers_new(r->nv, sizeof *qd), *qdd = numbers_new(r->nv, sizeof *qdd);
	double *size = numbers_new(r->nv, sizeof *size);
	__float128 *exact = numbers_new(r->nv, sizeof *exact);
	wide *tau = numbers_new(r->nv, sizeof *tau);

	reference_sample(r, rng, false, q, qd, qdd);
	reference_rnea(r, q, qd, qdd, tau);
	quad_rnea(x, q, qd, qdd, exact);
	quad_magnitude(x, q, qd, qdd, size);
	for (int i = 0; i < r->nv; i++) {
		double off = fabs((double)((__float128)tau[i] - exact[i]));

		ck_assert_msg(off <= LIMIT * 0x1p-64 * size[i], "%s: torque %d differs by %g, terms of %g", what,
			i, off, size[i]);
		if (size[i] > 0)
			t->worst = fmax(t->worst, off / size[i] * 0x1p64);
		t->finer += off > 0;
	}
	free(q);
	free(qd);
	free(qdd);
	free(size);
	free(exact);
	free(tau);
}

static void compare_robot(const char *urdf, int floating, int samples, uint64_t seed, const char *what, struct tally *t)
{
	struct reference_options o = {.floating = floating};
	static const double gravity[3] = {0, 0, -9.81};
	struct rng rng = rng_seed(seed);
	char message[256];
	struct reference *r = reference_open(urdf, strlen(urdf), &o, message, sizeof message);
	struct quad *x = quad_open(urdf, strlen(urdf), floating, 0, QUAD_DOUBLES, gravity, NULL, message, sizeof message);

	ck_assert_msg(r && x, "%s: %s", what, message);
	for (int i = 0; i < samples; i++)
		compare(r, x, &rng, what, t);
	reference_close(r);
	quad_close(x);
}

static void report(const struct tally *t, const char *what)
{
	printf("%s: quad and extended precision differ by at most %.2f * 2^-64 of the magnitudes summed\n", what, t->worst);
	ck_assert_int_gt(t->finer, 100);
}

START_TEST(own_robots)
{
	struct tally t = {0};

	for (size_t i = 0; i < sizeof ROBOTS / sizeof *ROBOTS; i++)
		for (int floating = 0; floating < 2; floating++) {
			char *urdf = robot_text(ROBOTS[i]);

			compare_robot(urdf, floating, SAMPLES, 1, ROBOTS[i], &t);
			free(urdf);
		}
	report(&t, "own robots, seed 1");
}
END_TEST

START_TEST(random_trees)
{
	struct tally t = {0};

	for (uint64_t seed = 1; seed <= RANDOM_ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, 2 + (int)(seed % 24));
		char *urdf = random_robot(seed, &knobs), what[64];

		snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
		compare_robot(urdf, seed % 3 == 0, 4, seed, what, &t);
		free(urdf);
	}
	report(&t, "random trees, seeds 1 to 200");
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("quad");
	TCase *c = tcase_create("quad");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 600);
	tcase_add_test(c, own_robots);
	tcase_add_test(c, random_trees);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
