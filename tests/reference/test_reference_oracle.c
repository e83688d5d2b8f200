// The reference against torques, twists and accelerations found from positions alone.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/random_robot.h"
#include "reference/oracle.h"
#include "reference/test_reference.h"

enum { SEEDS = 60, LINKS = 12 };

static void compare_torque(const char *what, const char *urdf, const struct reference_options *options, uint64_t seed)
{
	struct reference *r = open_text(urdf, options);
	struct oracle o = oracle_open(r, urdf, strlen(urdf));
	struct rng rng = rng_seed(seed);
	struct state s;
	wide tau[ROWS];

	sample_state(r, &rng, &s);
	oracle_torque(&o, s.wq, s.wqd, s.wqdd, tau);
	expect_near(s.tau, tau, r->nv, 1e-10, what);
	oracle_close(&o);
	reference_close(r);
}

static void compare_all_options(const char *what, const char *urdf, uint64_t seed)
{
	static const double tilted[3] = {1.5, -3, 8};

	for (int k = 0; k < 4; k++)
		compare_torque(what, urdf, &(struct reference_options){
			.floating = k & 1,
			.independent = k & 2,
			.gravity = k == 3 ? tilted : NULL,
		}, seed);
}

START_TEST(test_random_torque)
{
	uint64_t seed = 1000 + (uint64_t)_i;
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	char *urdf = random_robot(seed, &knobs), what[64];

	snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
	compare_all_options(what, urdf, seed);
	free(urdf);
}
END_TEST

static void compare_real(const char *name, const char *urdf)
{
	compare_all_options(name, urdf, 5);
}

START_TEST(test_real_torque)
{
	each_real_robot(compare_real);
}
END_TEST

// R^T u for the first three rows of a pose.
static void into_axes(const struct link_pose *t, const wide *u, wide *out)
{
	for (int i = 0; i < 3; i++)
		out[i] = t->m[0][i] * u[0] + t->m[1][i] * u[1] + t->m[2][i] * u[2];
}

static void cross(const wide *a, const wide *b, wide *out)
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

// v = R^T p', [w] = R^T R'; a = R^T (p'' - g) - w x v, [b] = R^T R'' - [w][w], whose skew part is R^T R'' - its own.
static void twist_and_acceleration(const struct link_pose *t, const struct link_pose *t1, const struct link_pose *t2,
                                   const wide *gravity, wide *v, wide *a)
{
	wide p1[3], p2[3], r1[3][3], r2[3][3], wv[3];

	for (int i = 0; i < 3; i++) {
		wide c1[3] = {t1->m[0][i], t1->m[1][i], t1->m[2][i]}, c2[3] = {t2->m[0][i], t2->m[1][i], t2->m[2][i]};

		into_axes(t, c1, r1[i]);
		into_axes(t, c2, r2[i]);
		p1[i] = t1->m[i][3];
		p2[i] = t2->m[i][3] - gravity[i];
	}
	into_axes(t, p1, v);
	into_axes(t, p2, a);
	for (int i = 0; i < 3; i++) {
		int y = (i + 1) % 3, z = (i + 2) % 3;

		v[3 + i] = (r1[y][z] - r1[z][y]) / 2;
		a[3 + i] = (r2[y][z] - r2[z][y]) / 2;
	}
	cross(v + 3, v, wv);
	for (int i = 0; i < 3; i++)
		a[i] -= wv[i];
}

struct passes {
	wide v[ROWS][6], a[ROWS][6], f[ROWS][6];
	struct link_pose t0[ROWS], t1[ROWS], t2[ROWS];
};

static void fill_passes(struct reference *r, const struct oracle *o, const struct state *s, struct passes *p)
{
	static const wide zero[ROWS];

	reference_passes(r, s->q, s->qd, s->qdd, p->v, p->a, p->f);
	oracle_poses(o, s->wq, p->t0);
	oracle_derivative(o, s->wq, s->wqd, zero, 1, p->t1);
	oracle_derivative(o, s->wq, s->wqd, s->wqdd, 2, p->t2);
}

// With a floating base the bodies' own wrenches add up to the base's: force R0^T sum R f, moment about its origin. The
// sampled quaternions are of unit length to 1e-16 only, and so R^T is the inverse of R.
static void compare_sum(const struct reference *r, const struct state *s, const struct passes *p, const char *what)
{
	wide total[6] = {0}, base[6];

	for (int i = 0; i < r->nj; i++) {
		const struct link_pose *t = &p->t0[i];
		const wide *f = p->f[r->joints[i].body];
		wide force[3], moment[3], arm[3];

		if (r->joints[i].type == REFERENCE_FIXED)
			continue;
		for (int k = 0; k < 3; k++) {
			force[k] = t->m[k][0] * f[0] + t->m[k][1] * f[1] + t->m[k][2] * f[2];
			moment[k] = t->m[k][0] * f[3] + t->m[k][1] * f[4] + t->m[k][2] * f[5];
			arm[k] = t->m[k][3] - p->t0[0].m[k][3];
			total[k] += force[k];
			total[3 + k] += moment[k];
		}
		cross(arm, force, moment);
		for (int k = 0; k < 3; k++)
			total[3 + k] += moment[k];
	}
	into_axes(&p->t0[0], total, base);
	into_axes(&p->t0[0], total + 3, base + 3);
	expect_near(base, s->tau, 6, 2e-14, what);
}

static void compare_passes(const char *what, const char *urdf, uint64_t seed)
{
	struct reference *r = open_text(urdf, &(struct reference_options){.floating = true});
	struct oracle o = oracle_open(r, urdf, strlen(urdf));
	struct rng rng = rng_seed(seed);
	struct passes *p = calloc(1, sizeof *p);
	struct state s;
	int body = 0;

	sample_state(r, &rng, &s);
	fill_passes(r, &o, &s, p);
	for (int i = 0; i < r->nj; i++) {
		wide v[6], a[6];

		if (r->joints[i].type == REFERENCE_FIXED)
			continue;
		ck_assert_int_eq(r->joints[i].body, body);
		twist_and_acceleration(&p->t0[i], &p->t1[i], &p->t2[i], r->gravity, v, a);
		expect_near(p->v[body], v, 6, 1e-11, what);
		expect_near(p->a[body], a, 6, 1e-11, what);
		body++;
	}
	ck_assert_int_eq(r->nb, body);
	compare_sum(r, &s, p, what);
	free(p);
	oracle_close(&o);
	reference_close(r);
}

START_TEST(test_random_passes)
{
	uint64_t seed = 2000 + (uint64_t)_i;
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	char *urdf = random_robot(seed, &knobs), what[64];

	snprintf(what, sizeof what, "passes, seed %llu", (unsigned long long)seed);
	compare_passes(what, urdf, seed);
	free(urdf);
}
END_TEST

TCase *oracle_agreement(void)
{
	TCase *t = tcase_create("positions alone");

	printf("seeds: torques 1000 to %d, passes 2000 to %d\n", 999 + SEEDS, 1999 + SEEDS);
	tcase_set_timeout(t, 120);
	tcase_add_loop_test(t, test_random_torque, 0, SEEDS);
	tcase_add_test(t, test_real_torque);
	tcase_add_loop_test(t, test_random_passes, 0, SEEDS);
	return t;
}
