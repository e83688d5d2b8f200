/* Energy along a rollout: a robot without friction that nothing drives keeps kinetic and potential energy up to the error of the
   integrator, which falls by 2^order where the step is halved. An acceleration that is wrong by any part does not. */
#include "support/rng.h"
#include "support/scene_model.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 48, STARTS = 4, SEED = 31 };

static const struct subject {
	const char *name;
	int floating, steps;
	double seconds;
} SUBJECTS[] = {
	{"double_pendulum", 0, 120, 0.4},
	{"mimic_chain", 0, 60, 0.3},
	{"planar_tilted", 0, 60, 0.4},
	{"floating_joint", 0, 80, 0.4},
	{"root_with_mass", 1, 60, 0.5},
	{"hyq", 1, 60, 0.1},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

struct rollout {
	struct scene_model m;
	int nq, nv, size;        /* size: of a state, q and then qd */
	double energy;
};

/* ---- dx/dt = f(x) ---- */

/* dp = R v, d(u, s) = ((s w + u x w)/2, -u.w/2) for a twist (v, w) in the body's frame. */
static void float_rate(const double *q, const double *v, double *dq)
{
	const double *u = q + 3, *w = v + 3, s = q[6];
	const double R[3][3] = {
		{1 - 2 * (u[1] * u[1] + u[2] * u[2]), 2 * (u[0] * u[1] - u[2] * s), 2 * (u[0] * u[2] + u[1] * s)},
		{2 * (u[0] * u[1] + u[2] * s), 1 - 2 * (u[0] * u[0] + u[2] * u[2]), 2 * (u[1] * u[2] - u[0] * s)},
		{2 * (u[0] * u[2] - u[1] * s), 2 * (u[1] * u[2] + u[0] * s), 1 - 2 * (u[0] * u[0] + u[1] * u[1])}};

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		dq[i] = R[i][0] * v[0] + R[i][1] * v[1] + R[i][2] * v[2];
		dq[3 + i] = (s * w[i] + u[j] * w[k] - u[k] * w[j]) / 2;
	}
	dq[6] = -(u[0] * w[0] + u[1] * w[1] + u[2] * w[2]) / 2;
}

static void rate(struct rollout *r, const double *x, double *dx)
{
	const double *q = x, *qd = x + r->nq;
	double kinetic, potential;

	ck_assert(eval_f64(&r->m.dag, (const double *[]){q, qd, NULL, NULL, NULL},
		(double *[]){NULL, NULL, dx + r->nq, &kinetic, &potential}, NULL));
	r->energy = kinetic + potential;
	for (int i = 0; i < r->m.tree.joint_count; i++) {
		const struct tree_joint *k = &r->m.tree.joints[i];

		if (k->nq == 7)
			float_rate(q + k->iq, qd + k->iv, dx + k->iq);
		else
			memcpy(dx + k->iq, qd + k->iv, (size_t)k->nq * sizeof *dx);
	}
}

static void ahead(const struct rollout *r, const double *x, double h, const double *dx, double *to)
{
	for (int i = 0; i < r->size; i++)
		to[i] = x[i] + h * dx[i];
}

/* Classical Runge and Kutta, order 4, or the midpoint rule, order 2. */
static void step(struct rollout *r, double *x, double h, int order)
{
	double k[4][MOST], y[MOST];

	rate(r, x, k[0]);
	ahead(r, x, h / 2, k[0], y);
	rate(r, y, k[1]);
	if (order == 2) {
		ahead(r, x, h, k[1], x);
		return;
	}
	ahead(r, x, h / 2, k[1], y);
	rate(r, y, k[2]);
	ahead(r, x, h, k[2], y);
	rate(r, y, k[3]);
	for (int i = 0; i < r->size; i++)
		x[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* ---- rollouts ---- */

static void make_units(const struct rollout *r, double *x)
{
	for (int i = 0; i < r->m.tree.joint_count; i++) {
		double *u = x + r->m.tree.joints[i].iq + 3, size = 0;

		for (int k = 0; k < 4 && r->m.tree.joints[i].nq == 7; k++)
			size += u[k] * u[k];
		for (int k = 0; k < 4 && r->m.tree.joints[i].nq == 7; k++)
			u[k] /= sqrt(size);
	}
}

/* What the energy has changed by at the end. */
static double drift(struct rollout *r, const double *start, double seconds, int steps, int order)
{
	double x[MOST], dx[MOST], energy;

	memcpy(x, start, sizeof x);
	rate(r, x, dx);
	energy = r->energy;
	for (int i = 0; i < steps; i++) {
		step(r, x, seconds / steps, order);
		make_units(r, x);
	}
	rate(r, x, dx);
	return fabs(r->energy - energy);
}

static void roll_out(struct rollout *r, const struct subject *s, const char *what)
{
	struct rng rng = rng_seed(SEED);
	double start[STARTS][MOST] = {{0}};

	for (int k = 0; k < STARTS; k++) {
		for (int i = 0; i < r->size; i++)
			start[k][i] = rng_uniform(&rng, -1, 1);
		make_units(r, start[k]);
	}
	for (int order = 2; order <= 4; order += 2) {
		double whole = 0, half = 0;

		for (int k = 0; k < STARTS; k++) {
			whole += drift(r, start[k], s->seconds, s->steps, order);
			half += drift(r, start[k], s->seconds, 2 * s->steps, order);
		}
		printf("%s, order %d: %.1e J, %.1e J by half the step: %.1f times less\n", what, order, whole,
			half, whole / half);
		ck_assert_msg(whole > 1e-13, "%s, order %d: %g J is rounding: take larger steps", what, order, whole);
		ck_assert_msg(half < 1.25 * whole / (1 << order), "%s, order %d: %g J, and %g J by half the step", what,
			order, whole, half);
	}
}

START_TEST(energy)
{
	const struct subject *s = &SUBJECTS[_i / 2];
	struct rneagen_options o = rneagen_options_default();
	struct rollout *r = calloc(1, sizeof *r);
	int is_articulated = _i % 2 && strcmp(s->name, "mimic_chain") != 0;
	char scene[128], what[128], *urdf = robot_text(s->name);

	ck_assert(r != NULL);
	snprintf(scene, sizeof scene, "want qdd,kinetic,potential\nfold tau=0\ndynamics %s\n",
		is_articulated ? "articulated" : "factor");
	snprintf(what, sizeof what, "%s, %s", s->name, is_articulated ? "articulated" : "factor");
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.scene = scene;
	ck_assert_msg(!scene_open(&r->m, urdf, &o), "%s: %s", what, r->m.error.message);
	r->nq = r->m.tree.nq;
	r->nv = r->m.tree.nv;
	r->size = r->nq + r->nv;
	ck_assert_int_le(r->size, MOST);
	ck_assert_int_eq(r->m.dag.argument_count, 5);
	roll_out(r, s, what);
	scene_close(&r->m);
	free(r);
	free(urdf);
}
END_TEST

/* A link that --lock holds on the ground is no part of what moves, be it merged or, where that costs more, a body of its own:
   which of both it is goes by what else is wanted. By hand the energy of b and c is g cos(held) (0.5 - 0.3 sin q_0 + 0.4 +
   q_1). */
START_TEST(held)
{
#define BODY(name, x, z, mass)                                                            \
	"<link name='" name "'><inertial><origin xyz='" x " 0 " z "'/><mass value='" mass \
	"'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
	static const char urdf[] =
		"<robot name='p'><link name='base'/>" BODY("a", "0", "1", "5") BODY("b", "0.3", "0", "1") BODY("c", "0.2", "0", "1")
		"<joint name='j1' type='continuous'><parent link='base'/><child link='a'/><axis xyz='1 0 0'/></joint>"
		"<joint name='j2' type='continuous'><parent link='a'/><child link='b'/><origin xyz='0 0 0.5'/><axis xyz='0 1 0'/></joint>"
		"<joint name='j3' type='prismatic'><parent link='a'/><child link='c'/><origin xyz='0 0 0.4'/><axis xyz='0 0 1'/>"
		"<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
	static const char *const scenes[] = {"lock j1=0.7\nwant potential", "lock j1=0.7\nwant potential,tau\nfold qdd=0",
		"lock j1=0.7\nwant potential\nfree gravity"};
	const double q[] = {0.3, 0.1}, gravity[] = {0, 0, -9.81}, right = 9.81 * cos(0.7) * (0.9 - 0.3 * sin(q[0]) + q[1]);
	struct rneagen_options o = rneagen_options_default();
	double tau[2], potential = 0;
	struct scene_model m;

	o.scene = scenes[_i];
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s", m.error.message);
	ck_assert_int_eq(m.tree.nq, 2);
	const double *in[DAG_ARGUMENTS] = {q};
	double *out[DAG_ARGUMENTS] = {NULL};
	for (int i = 1; i < m.dag.argument_count; i++) {
		in[i] = gravity;
		out[i] = m.dag.arguments[i].rows == 1 ? &potential : tau;
	}
	ck_assert(eval_f64(&m.dag, in, out, NULL));
	ck_assert_msg(fabs(potential - right) < 1e-13, "%s: %.12g J, by hand %.12g", scenes[_i], potential, right);
	scene_close(&m);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("energy");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("seed %d\n", SEED);
	suite_add(suite, "rollouts", energy, 2 * SUBJECT_COUNT, 60);
	suite_add(suite, "held", held, 3, 60);
	return suite_run(suite);
}
