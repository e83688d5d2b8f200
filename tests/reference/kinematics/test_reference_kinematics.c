// The reference's poses, Jacobians, momenta and rates against its own recursion of twists, accelerations and torques, which
// knows none of them; and poses against those of positions alone. Would catch a column, a frame, an arm or a rate that is off.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference/forward.h"
#include "reference/kinematics/momentum.h"
#include "reference/oracle.h"
#include "reference/test_reference.h"
#include "support/random_robot.h"

enum { SEEDS = 60, LINKS = 10, FIRST = 4100 };

struct subject {
	char *urdf, what[64];
	struct reference *r;
	struct rng rng;
	struct state s;
	struct reference_frame f;
	wide J[6 * ROWS];
};

static struct subject *begin(int i)
{
	static const double none[3] = {0, 0, 0};
	struct subject *x = calloc(1, sizeof *x);
	uint64_t seed = FIRST + (uint64_t)i;
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	wide at[6];

	knobs.odd_names = 0;
	x->urdf = random_robot(seed, &knobs);
	x->r = open_text(x->urdf, &(struct reference_options){.floating = i & 1, .gravity = none});
	x->rng = rng_seed(seed);
	sample_state(x->r, &x->rng, &x->s);
	snprintf(x->what, sizeof x->what, "seed %llu", (unsigned long long)seed);
	x->f.entry = rng_below(&x->rng, x->r->nj);
	for (int k = 0; k < 6; k++)
		at[k] = rng_uniform(&x->rng, -1, 1);
	x->f.at = reference_origin(at, at + 3);
	return x;
}

static void end(struct subject *x)
{
	reference_close(x->r);
	free(x->urdf);
	free(x);
}

static void times(const wide *J, const wide *v, int rows, int n, wide *out)
{
	for (int i = 0; i < rows; i++) {
		out[i] = 0;
		for (int k = 0; k < n; k++)
			out[i] += J[i * n + k] * v[k];
	}
}

// J qd is the twist of the recursion, and its derivative the acceleration. Sampled quaternions are of unit length to 1e-16 only.
START_TEST(test_recursion)
{
	struct subject *x = begin(_i);
	wide v[6], a[6], found[6];

	x->f.at = reference_shift(0, 0, 0);
	reference_link(x->r, x->f.entry, v, a, NULL);
	reference_jacobian(x->r, &x->f, REFERENCE_LINK, x->s.wq, x->J);
	times(x->J, x->s.wqd, 6, x->r->nv, found);
	expect_near(found, v, 6, 4e-15, x->what);
	reference_acceleration(x->r, &x->f, REFERENCE_LINK, x->s.wq, x->s.wqd, x->s.wqdd, found);
	expect_near(found, a, 6, 1e-10, x->what);
	end(x);
}
END_TEST

static void flat_pose(void *context, const wide *q, const wide *qd, wide *out)
{
	const struct subject *x = context;
	const struct reference_pose t = reference_pose(x->r, &x->f, q);

	(void)qd;
	memcpy(out, t.m, sizeof t.m);
}

// p' = v, R' = [w] R in the ground's axes; in the others by R and p.
START_TEST(test_pose_rate)
{
	struct subject *x = begin(_i);
	wide t[16], rate[16], aligned[6], link[6], world[6], turned[6], moved[6];
	const wide *none = (const wide[ROWS]){0};

	flat_pose(x, x->s.wq, NULL, t);
	reference_rate(x->r, x->s.wq, x->s.wqd, none, flat_pose, x, 16, rate);
	for (int k = 0; k < 3; k++) {
		wide *to[] = {link, world, aligned};

		reference_jacobian(x->r, &x->f, (enum reference_axes)k, x->s.wq, x->J);
		times(x->J, x->s.wqd, 6, x->r->nv, to[k]);
	}
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;

		turned[i] = rate[4 * i + 3];
		turned[3 + i] = 0;
		for (int c = 0; c < 3; c++)
			turned[3 + i] += (rate[4 * k + c] * t[4 * j + c] - rate[4 * j + c] * t[4 * k + c]) / 2;
		moved[i] = aligned[i] + t[4 * j + 3] * aligned[3 + k] - t[4 * k + 3] * aligned[3 + j];
		moved[3 + i] = aligned[3 + i];
	}
	expect_near(aligned, turned, 6, 1e-12, x->what);
	expect_near(world, moved, 6, 4e-15, x->what);
	for (int i = 0; i < 6; i++)
		turned[i] = t[i % 3] * aligned[i / 3 * 3] + t[4 + i % 3] * aligned[i / 3 * 3 + 1] +
			t[8 + i % 3] * aligned[i / 3 * 3 + 2];
	expect_near(link, turned, 6, 4e-15, x->what);
	end(x);
}
END_TEST

START_TEST(test_poses)
{
	struct subject *x = begin(_i);
	struct oracle o = oracle_open(x->r, x->urdf, strlen(x->urdf));
	struct link_pose *want = calloc((size_t)x->r->nj, sizeof *want);
	struct reference_pose *found = calloc((size_t)x->r->nj, sizeof *found);

	oracle_poses(&o, x->s.wq, want);
	reference_poses(x->r, x->s.wq, found);
	for (int i = 0; i < x->r->nj; i++)
		expect_near(found[i].m[0], want[i].m[0], 16, 1e-14, x->what);
	oracle_close(&o);
	free(want);
	free(found);
	end(x);
}
END_TEST

// A unit wrench on a link, at its origin in its axes, is held by -J^T of it; and J M^-1 J^T by what it accelerates.
START_TEST(test_push)
{
	struct subject *x = begin(_i);
	const wide *none = (const wide[ROWS]){0};
	wide unit[6] = {0}, tau[ROWS], X[ROWS * 40], qdd[ROWS], space[36], column[6];

	x->f.at = reference_shift(0, 0, 0);
	reference_jacobian(x->r, &x->f, REFERENCE_LINK, x->s.wq, x->J);
	int is_regular = x->r->nv <= 40 && reference_inverse(x->r, NULL, x->s.wq, X) > WIDE_C(1e-9);

	if (is_regular)
		reference_opspace_inverse(x->r, &x->f, REFERENCE_LINK, NULL, x->s.wq, space);
	for (int k = 0; k < 6; k++) {
		wide want[ROWS];

		unit[k] = 1;
		reference_set_push(x->r, x->f.entry, unit, false);
		reference_rnea_wide(x->r, x->s.wq, none, none, tau);
		for (int i = 0; i < x->r->nv; i++)
			want[i] = -x->J[k * x->r->nv + i];
		expect_near(tau, want, x->r->nv, 4e-15, x->what);
		if (is_regular) {
			reference_forward(x->r, X, x->s.wq, none, none, qdd);
			times(x->J, qdd, 6, x->r->nv, column);
			for (int i = 0; i < 6; i++)
				want[i] = space[6 * i + k];
			expect_near(column, want, 6, 1e-9, x->what);
		}
		unit[k] = 0;
	}
	end(x);
}
END_TEST

// Of a floating robot nothing but the base's wrench holds the momentum, and gravity pulls at the centre of mass.
START_TEST(test_momentum)
{
	struct subject *x = begin(2 * _i + 1);
	struct reference *heavy =
		open_text(x->urdf, &(struct reference_options){.floating = true, .gravity = (const double[]){1, 2, 3}});
	const wide *none = (const wide[ROWS]){0}, g[3] = {1, 2, 3};
	wide c[3], rate[6], want[6] = {0}, tau[ROWS], pull[ROWS];
	wide mass = reference_com(x->r, NULL, x->s.wq, c);

	if (mass > 0) {
		x->f = (struct reference_frame){0, reference_shift(0, 0, 0)};
		const struct reference_pose t = reference_pose(x->r, &x->f, x->s.wq);

		for (int i = 0; i < 6; i++)
			for (int k = 0; k < 3; k++)
				want[i] += t.m[i % 3][k] * x->s.tau[i / 3 * 3 + k];
		for (int i = 0; i < 3; i++) {
			const int j = (i + 1) % 3, k = (i + 2) % 3;

			want[3 + i] += (t.m[j][3] - c[j]) * want[k] - (t.m[k][3] - c[k]) * want[j];
		}
		reference_momentum_rate(x->r, NULL, x->s.wq, x->s.wqd, x->s.wqdd, rate);
		expect_near(rate, want, 6, 1e-10, x->what);
		reference_com_jacobian(x->r, NULL, x->s.wq, x->J);
		reference_rnea_wide(heavy, x->s.wq, none, none, tau);
		for (int i = 0; i < x->r->nv; i++) {
			pull[i] = 0;
			for (int k = 0; k < 3; k++)
				pull[i] -= mass * g[k] * x->J[k * x->r->nv + i];
		}
		expect_near(tau, pull, x->r->nv, 1e-14, x->what);
	}
	reference_close(heavy);
	end(x);
}
END_TEST

// Without gravity qd' (C qd) is half of qd' M' qd.
START_TEST(test_mass_rate)
{
	struct subject *x = begin(_i);
	int n = x->r->nv;
	wide *rate = calloc((size_t)(n * n), sizeof *rate), tau[ROWS], turned[ROWS], power[2] = {0};
	const wide *none = (const wide[ROWS]){0};

	reference_mass_rate(x->r, NULL, x->s.wq, x->s.wqd, rate);
	times(rate, x->s.wqd, n, n, turned);
	reference_rnea_wide(x->r, x->s.wq, x->s.wqd, none, tau);
	for (int i = 0; i < n; i++) {
		power[0] += x->s.wqd[i] * tau[i];
		power[1] += x->s.wqd[i] * turned[i] / 2;
	}
	expect_near(power, power + 1, 1, 1e-9, x->what);
	free(rate);
	end(x);
}
END_TEST

TCase *kinematics(void)
{
	TCase *t = tcase_create("kinematics");

	printf("seeds: kinematics %d to %d\n", FIRST, FIRST + SEEDS - 1);
	tcase_set_timeout(t, 120);
	tcase_add_loop_test(t, test_recursion, 0, SEEDS);
	tcase_add_loop_test(t, test_pose_rate, 0, SEEDS);
	tcase_add_loop_test(t, test_poses, 0, SEEDS);
	tcase_add_loop_test(t, test_push, 0, SEEDS);
	tcase_add_loop_test(t, test_momentum, 0, SEEDS / 2);
	tcase_add_loop_test(t, test_mass_rate, 0, SEEDS);
	return t;
}
