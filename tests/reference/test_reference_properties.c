// What every mechanism obeys: power, mass matrix, momentum, magnitudes.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/random_robot.h"
#include "reference/oracle.h"
#include "reference/test_reference.h"

enum { SEEDS = 30, LINKS = 10 };

struct robot_case {
	char *urdf;
	struct reference *r;
	struct rng rng;
	struct state s;
	char what[64];
};

static struct robot_case *begin(uint64_t seed, const struct random_robot_knobs *knobs, bool floating,
                                const double *gravity)
{
	struct robot_case *c = calloc(1, sizeof *c);

	c->urdf = random_robot(seed, knobs);
	c->r = open_text(c->urdf, &(struct reference_options){.floating = floating, .gravity = gravity});
	c->rng = rng_seed(seed);
	sample_state(c->r, &c->rng, &c->s);
	snprintf(c->what, sizeof c->what, "seed %llu", (unsigned long long)seed);
	return c;
}

static void finish(struct robot_case *c)
{
	reference_close(c->r);
	free(c->urdf);
	free(c);
}

// M y = ID(q, 0, y) - ID(q, 0, 0)
static void mass_times(struct reference *r, const wide *q, const wide *y, wide *out)
{
	static const wide zero[ROWS];
	wide rest[ROWS];

	reference_rnea_wide(r, q, zero, zero, rest);
	reference_rnea_wide(r, q, zero, y, out);
	for (int i = 0; i < r->nv; i++)
		out[i] -= rest[i];
}

static wide dot(const wide *a, const wide *b, int n)
{
	wide sum = 0;

	for (int i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

// q, qd at time t of the motion with constant qdd.
static void at_time(const struct reference *r, const struct state *s, wide t, wide *q, wide *qd)
{
	oracle_move(r, s->wq, s->wqd, s->wqdd, t, q);
	for (int i = 0; i < r->nv; i++)
		qd[i] = s->wqd[i] + t * s->wqdd[i];
}

static const wide weights[5] = {0, WIDE_C(4.0) / 5, -WIDE_C(1.0) / 5, WIDE_C(4.0) / 105, -WIDE_C(1.0) / 280};
static const wide step = WIDE_C(0.002);

// d/dt (1/2 qd . M qd) + qd . gravity torque = qd . tau, by central differences of order 8. The curve's own twist
// differs from qd + t qdd by terms in t^2 (floating joints): they have no part in the derivative at t = 0.
START_TEST(test_power)
{
	static const wide zero[ROWS];
	struct random_robot_knobs knobs = random_robot_knobs(3000 + (uint64_t)_i, LINKS);
	struct robot_case *c = begin(3000 + (uint64_t)_i, &knobs, _i & 1, NULL);
	wide q[ROWS], qd[ROWS], y[ROWS], power = 0, wanted;

	for (int k = -4; k <= 4; k++) {
		at_time(c->r, &c->s, (wide)k * step, q, qd);
		mass_times(c->r, q, qd, y);
		power += weights[abs(k)] * (k < 0 ? -1 : 1) / step * dot(qd, y, c->r->nv) / 2;
	}
	reference_rnea_wide(c->r, c->s.wq, zero, zero, y);
	power += dot(c->s.wqd, y, c->r->nv);
	wanted = dot(c->s.wqd, c->s.tau, c->r->nv);
	expect_near(&power, &wanted, 1, 1e-11, c->what);
	finish(c);
}
END_TEST

// Cholesky: all pivots positive.
static void expect_positive(wide (*m)[ROWS], int n, const char *what)
{
	for (int k = 0; k < n; k++) {
		ck_assert_msg(m[k][k] > 0, "%s: pivot %d is %g", what, k, (double)m[k][k]);
		for (int i = k + 1; i < n; i++)
			for (int j = k + 1; j < n; j++)
				m[i][j] -= m[i][k] * m[k][j] / m[k][k];
	}
}

START_TEST(test_mass_matrix)
{
	struct random_robot_knobs knobs = random_robot_knobs(4000 + (uint64_t)_i, LINKS);
	wide (*m)[ROWS] = calloc(ROWS, sizeof *m), transposed[ROWS], unit[ROWS] = {0};
	struct robot_case *c;

	knobs.bare = knobs.massless = knobs.points = 0;
	knobs.root_mass = true;
	c = begin(4000 + (uint64_t)_i, &knobs, _i & 1, NULL);
	for (int k = 0; k < c->r->nv; k++) {
		unit[k] = 1;
		mass_times(c->r, c->s.wq, unit, m[k]);
		unit[k] = 0;
	}
	for (int k = 0; k < c->r->nv; k++) {
		for (int i = 0; i < c->r->nv; i++)
			transposed[i] = m[i][k];
		expect_near(m[k], transposed, c->r->nv, 1e-16, c->what);
	}
	expect_positive(m, c->r->nv, c->what);
	free(m);
	finish(c);
}
END_TEST

// The base's rows of M qd are the momentum (Featherstone, section 9.3), in its axes and about its origin. As a force:
// into the ground's axes and about the ground's origin.
static void to_ground(const wide *q, const wide *f, wide *out)
{
	struct link_pose t;
	struct reference_joint joint = {.type = REFERENCE_FLOATING, .nq = 7, .nv = 6};
	struct reference base = {.nq = 7, .nv = 6, .nj = 1, .joints = &joint};
	struct oracle o = {.r = &base};

	oracle_poses(&o, q, &t);
	for (int i = 0; i < 6; i++)
		out[i] = dot(t.m[i % 3], f + (i < 3 ? 0 : 3), 3);
	for (int i = 0; i < 3; i++) {
		int y = (i + 1) % 3, z = (i + 2) % 3;

		out[3 + i] += t.m[y][3] * out[z] - t.m[z][3] * out[y];
	}
}

// Without gravity the base's wrench is the rate of change of the momentum.
START_TEST(test_momentum)
{
	static const double none[3] = {0, 0, 0};
	struct random_robot_knobs knobs = random_robot_knobs(5000 + (uint64_t)_i, LINKS);
	struct robot_case *c = begin(5000 + (uint64_t)_i, &knobs, true, none);
	wide q[ROWS], qd[ROWS], y[ROWS], h[6], rate[6] = {0}, wrench[6];

	for (int k = -4; k <= 4; k++) {
		at_time(c->r, &c->s, (wide)k * step, q, qd);
		mass_times(c->r, q, qd, y);
		to_ground(q, y, h);
		for (int i = 0; i < 6; i++)
			rate[i] += weights[abs(k)] * (k < 0 ? -1 : 1) / step * h[i];
	}
	to_ground(c->s.wq, c->s.tau, wrench);
	expect_near(rate, wrench, 6, 1e-11, c->what);
	finish(c);
}
END_TEST

// |tau| <= S
START_TEST(test_magnitude)
{
	struct random_robot_knobs knobs = random_robot_knobs(6000 + (uint64_t)_i, LINKS);
	struct robot_case *c = begin(6000 + (uint64_t)_i, &knobs, _i & 1, NULL);
	wide sum[ROWS];

	reference_magnitude(c->r, c->s.q, c->s.qd, c->s.qdd, sum);
	for (int i = 0; i < c->r->nv; i++)
		ck_assert_msg(sum[i] >= wide_abs(c->s.tau[i]), "%s: row %d", c->what, i);
	finish(c);
}
END_TEST

TCase *properties(void)
{
	TCase *t = tcase_create("properties");

	printf("seeds: power 3000, mass matrix 4000, momentum 5000, magnitude 6000, %d of each\n", SEEDS);
	tcase_set_timeout(t, 60);
	tcase_add_loop_test(t, test_power, 0, SEEDS);
	tcase_add_loop_test(t, test_mass_matrix, 0, SEEDS);
	tcase_add_loop_test(t, test_momentum, 0, SEEDS);
	tcase_add_loop_test(t, test_magnitude, 0, SEEDS);
	return t;
}
