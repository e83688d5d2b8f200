/* Energies, momentum and forces from outside, by what mechanics says of them: against poses alone and their differences in
   time (reference/oracle.h), and against a Jacobian's columns. On random trees, seeds printed. */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "support/task/task.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 60, LINKS = 9 };

/* One random tree with its scene open, fed, and its outputs. */
struct bench {
	struct task_case *c;
	struct scene_model m;
	struct task_arrays x;
	struct link_pose at[3][ROWS]; /* of entries: poses, and their derivatives in time */
	uint64_t seed;
};

static void look(struct bench *b)
{
	wide q[ROWS], qd[ROWS], qdd[ROWS];
	struct task_case *c = b->c;

	for (int i = 0; i < c->r->nq; i++)
		q[i] = (wide)c->q[i];
	for (int i = 0; i < c->r->nv; i++) {
		qd[i] = (wide)c->qd[i];
		qdd[i] = (wide)c->qdd[i];
	}
	oracle_poses(&c->oracle, q, b->at[0]);
	oracle_derivative(&c->oracle, q, qd, qdd, 1, b->at[1]);
	oracle_derivative(&c->oracle, q, qd, qdd, 2, b->at[2]);
}

/* The case is said already. */
static void open_bench(struct bench *b)
{
	case_check(b->c, &b->m, "as the reference");
	case_feed(b->c, &b->m, &b->x);
	case_evaluate(&b->m.dag, TASK_REAL, &b->x);
	look(b);
}

static void close_bench(struct bench *b)
{
	scene_close(&b->m);
	case_close(b->c);
}

/* The rows of an argument, an input or an output. */
static int argument(const struct bench *b, const char *name)
{
	for (int i = 0; i < b->m.dag.argument_count; i++)
		if (!strcmp(b->m.dag.arguments[i].name, name))
			return i;
	return -1;
}

static void near_to(const struct bench *b, real got, wide want, wide size, const char *what)
{
	ck_assert_msg(fabsl(got - (real)want) <= 1e-11L * (real)size + 1e-12L,
		"seed %d, %s: %.17Lg, not %.17Lg; scene:\n%s", (int)b->seed, what, got, (real)want, b->c->scene);
}

/* ---- by mass points ---- */

/* tr(A J B^T): the sum over the mass of a.b, where a point r has a = A (r, 1) and b = B (r, 1). */
static wide dot_over_mass(struct link_pose a, struct link_pose j, struct link_pose b)
{
	wide sum = 0;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++)
			for (int l = 0; l < 4; l++)
				sum += a.m[i][k] * j.m[k][l] * b.m[i][l];
	return sum;
}

/* Sums over the mass of A (r, 1), and of (T (r, 1)) x (A (r, 1)). */
static void moment_over_mass(struct link_pose t, struct link_pose j, struct link_pose a, wide *linear, wide *angular)
{
	wide m[3][3] = {{0}}; /* of a_i t_k */

	for (int i = 0; i < 3; i++)
		for (int l = 0; l < 4; l++)
			for (int n = 0; n < 4; n++) {
				for (int k = 0; k < 3; k++)
					m[i][k] += a.m[i][l] * j.m[l][n] * t.m[k][n];
				linear[i] += n == 3 ? a.m[i][l] * j.m[l][n] : 0;
			}
	for (int i = 0; i < 3; i++) {
		int k = (i + 1) % 3, l = (i + 2) % 3;

		angular[i] += m[l][k] - m[k][l];
	}
}

/* A wrench from outside in the ground's axes. */
static void ground_push(const struct bench *b, int entry, wide *force, wide *moment)
{
	const struct link_pose *t = &b->at[0][entry];
	const wide *w = b->c->push[entry];

	for (int i = 0; i < 3; i++) {
		force[i] = b->c->in_world ? w[i] : 0;
		moment[i] = b->c->in_world ? w[3 + i] : 0;
		for (int k = 0; k < 3 && !b->c->in_world; k++) {
			force[i] += t->m[i][k] * w[k];
			moment[i] += t->m[i][k] * w[3 + k];
		}
	}
}

/* w_i of [w]x = dR/dt R^T. */
static wide turn_rate(const struct bench *b, int entry, int i)
{
	wide sum = 0;

	for (int k = 0; k < 3; k++)
		sum += b->at[1][entry].m[(i + 2) % 3][k] * b->at[0][entry].m[(i + 1) % 3][k];
	return sum;
}

/* ---- energy ---- */

/* d/dt (kinetic + potential) less the power of forces from outside; kinetic and potential. */
static void energies(const struct bench *b, wide *power, wide *kinetic, wide *potential, wide *size)
{
	*power = *kinetic = *potential = 0;
	*size = 1;
	for (int i = 0; i < b->c->r->nj; i++) {
		struct link_pose j = oracle_inertia(&b->c->oracle, i);
		wide at[3] = {0}, rate[3] = {0}, unused[3] = {0}, force[3], moment[3];

		moment_over_mass(b->at[0][i], j, b->at[0][i], at, unused);
		moment_over_mass(b->at[0][i], j, b->at[1][i], rate, unused);
		ground_push(b, i, force, moment);
		*kinetic += dot_over_mass(b->at[1][i], j, b->at[1][i]) / 2;
		*power += dot_over_mass(b->at[1][i], j, b->at[2][i]);
		*size += wide_abs(dot_over_mass(b->at[1][i], j, b->at[2][i]));
		for (int k = 0; k < 3; k++) {
			*potential -= case_moves(b->c, i) ? b->c->r->gravity[k] * at[k] : 0;
			*power -= b->c->r->gravity[k] * rate[k] + force[k] * b->at[1][i].m[k][3] + moment[k] * turn_rate(b, i, k);
			*size += wide_abs(b->c->r->gravity[k] * rate[k]) + wide_abs(force[k] * b->at[1][i].m[k][3]);
			*size += wide_abs(moment[k]) * 10;
		}
	}
}

START_TEST(power_is_rate_of_energy)
{
	static struct bench b;
	int tried = 0;

	for (b.seed = 1; b.seed <= ROBOTS; b.seed++) {
		wide power, kinetic, potential, size;

		b.c = case_random(b.seed, LINKS, NO_ODD_NAMES);
		if (!b.c)
			continue;
		if (b.seed % 2)
			case_draw_pushes(b.c);
		case_want(b.c, TASK_POWER, 0);
		case_want(b.c, TASK_KINETIC, 0);
		case_want(b.c, TASK_POTENTIAL, 0);
		open_bench(&b);
		energies(&b, &power, &kinetic, &potential, &size);
		near_to(&b, b.x.out[argument(&b, "power")][0], power, size * 100, "power");
		near_to(&b, b.x.out[argument(&b, "kinetic")][0], kinetic, size, "kinetic");
		near_to(&b, b.x.out[argument(&b, "potential")][0], potential, size, "potential");
		close_bench(&b);
		tried++;
	}
	printf("energies: %d random trees, seeds 1 to %d\n", tried, ROBOTS);
}
END_TEST

/* The text's own energies at time t on q + qd t + qdd t^2/2, where v = dq/dt. */
static real energy_at(const struct bench *b, real t)
{
	static const char *const names[] = {"q", "qd", "qdd", "power", "kinetic", "potential"};
	static real in[3][ROWS], out[3];
	const real *ins[DAG_ARGUMENTS] = {0};
	real *outs[DAG_ARGUMENTS] = {0};

	for (int i = 0; i < b->c->r->nv; i++) {
		in[0][i] = (real)b->c->q[i] + (real)b->c->qd[i] * t + (real)b->c->qdd[i] * t * t / 2;
		in[1][i] = (real)b->c->qd[i] + (real)b->c->qdd[i] * t;
		in[2][i] = (real)b->c->qdd[i];
	}
	for (int k = 0; k < 6; k++)
		if (argument(b, names[k]) >= 0 && k < 3)
			ins[argument(b, names[k])] = in[k];
		else if (k >= 3)
			outs[argument(b, names[k])] = &out[k - 3];
	ck_assert(eval_real(&b->m.dag, ins, outs, NULL));
	return out[1] + out[2];
}

/* Differences of order 8. */
START_TEST(power_along_a_trajectory)
{
	static const real weights[5] = {0, 4 / 5.0L, -1 / 5.0L, 4 / 105.0L, -1 / 280.0L};
	const struct rneagen_options o = rneagen_options_default();
	static struct bench b;
	const real h = 0.004L;

	for (b.seed = 1; b.seed <= ROBOTS; b.seed++) {
		real rate = 0, size = 1;

		b.c = case_new(torque_robot(b.seed, LINKS, NO_FLOATING | NO_ODD_NAMES), &o, b.seed);
		case_want(b.c, TASK_POWER, 0);
		case_want(b.c, TASK_KINETIC, 0);
		case_want(b.c, TASK_POTENTIAL, 0);
		open_bench(&b);
		for (int step = 1; step <= 4; step++) {
			real before = energy_at(&b, -(real)step * h), after = energy_at(&b, (real)step * h);

			rate += weights[step] * (after - before) / h;
			size += fabsl(after) + fabsl(before);
		}
		near_to(&b, b.x.out[argument(&b, "power")][0], (wide)rate, (wide)size * 100, "power");
		close_bench(&b);
	}
	printf("along trajectories: random trees, seeds 1 to %d\n", ROBOTS);
}
END_TEST

/* ---- momentum ---- */

/* d/dt of the momentum about the ground's origin, less weights and forces from outside. */
static void rates(const struct bench *b, wide *force, wide *moment, wide *size)
{
	for (int i = 0; i < b->c->r->nj; i++) {
		struct link_pose j = oracle_inertia(&b->c->oracle, i), net = b->at[2][i];
		wide f[3], n[3];

		for (int k = 0; k < 3; k++)
			net.m[k][3] -= b->c->r->gravity[k];
		moment_over_mass(b->at[0][i], j, net, force, moment);
		ground_push(b, i, f, n);
		for (int k = 0; k < 3; k++) {
			int l = (k + 1) % 3, o = (k + 2) % 3;

			force[k] -= f[k];
			moment[k] -= n[k] + b->at[0][i].m[l][3] * f[o] - b->at[0][i].m[o][3] * f[l];
			*size += wide_abs(force[k]) + wide_abs(moment[k]) + wide_abs(f[k]) + wide_abs(n[k]);
		}
	}
}

START_TEST(base_wrench_is_rate_of_momentum)
{
	static struct bench b;
	int tried = 0;

	for (b.seed = 3; b.seed <= 3 * ROBOTS; b.seed += 3) {
		wide force[3] = {0}, moment[3] = {0}, size = 1, f[3] = {0}, n[3] = {0};
		const struct link_pose *t = &b.at[0][0];
		const real *w;

		b.c = case_random(b.seed, LINKS, NO_ODD_NAMES);
		ck_assert(b.c && b.c->options.base == RNEAGEN_FLOATING);
		if (b.seed % 2)
			case_draw_pushes(b.c);
		case_want(b.c, TASK_WRENCH, 0);
		open_bench(&b);
		rates(&b, force, moment, &size);
		w = b.x.out[argument(&b, "wrench_base")];
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++) {
				f[i] += t->m[i][k] * (wide)w[k];
				n[i] += t->m[i][k] * (wide)w[3 + k];
			}
		for (int i = 0; i < 3; i++) {
			int k = (i + 1) % 3, l = (i + 2) % 3;

			near_to(&b, (real)f[i], force[i], size * 100, "force");
			near_to(&b, (real)(n[i] + t->m[k][3] * f[l] - t->m[l][3] * f[k]), moment[i], size * 100, "moment");
		}
		close_bench(&b);
		tried++;
	}
	printf("momentum: %d random floating trees, seeds 3 to %d\n", tried, 3 * ROBOTS);
}
END_TEST

/* ---- a Jacobian's transpose ---- */

/* v.w for the link's twist v at unit qd in this row, w in the link's axes: a column of J, times w. */
static wide work_of_row(struct task_case *c, int entry, int row, const wide *w)
{
	wide q[ROWS], qd[ROWS] = {0}, qdd[ROWS] = {0}, tau[ROWS], v[6], sum = 0;

	for (int i = 0; i < c->r->nq; i++)
		q[i] = (wide)c->q[i];
	qd[row] = 1;
	reference_rnea_wide(c->r, q, qd, qdd, tau);
	reference_link(c->r, entry, v, NULL, NULL);
	for (int i = 0; i < 6; i++)
		sum += v[i] * w[i];
	return sum;
}

START_TEST(push_by_jacobian)
{
	static struct bench b;
	int tried = 0;

	for (b.seed = 1; b.seed <= ROBOTS; b.seed++) {
		real with[ROWS];
		wide w[6] = {0};
		int entry;

		b.c = case_random(b.seed, LINKS, NO_ODD_NAMES);
		if (!b.c)
			continue;
		b.c->in_world = (int)(b.seed % 2);
		case_say(b.c, "fext-frame %s\n", b.c->in_world ? "world" : "link");
		entry = case_pick(b.c, case_moves);
		case_push(b.c, entry);
		open_bench(&b);
		memcpy(with, b.x.out[b.m.dag.argument_count - 1], sizeof with);
		memset(b.x.in[b.m.dag.argument_count - 2], 0, sizeof b.x.in[0]);
		case_evaluate(&b.m.dag, TASK_REAL, &b.x);
		for (int i = 0; i < 6; i++)
			for (int k = 0; k < 3; k++)
				w[i] += b.c->in_world ? b.at[0][entry].m[k][i % 3] * b.c->push[entry][i / 3 * 3 + k]
						      : (k == 0) * b.c->push[entry][i];
		for (int i = 0; i < b.c->r->nv; i++)
			near_to(&b, with[i] - b.x.out[b.m.dag.argument_count - 1][i],
				-work_of_row(b.c, entry, i, w), 1e3L, "J^T w");
		close_bench(&b);
		tried++;
	}
	printf("forces from outside: %d random trees, seeds 1 to %d\n", tried, ROBOTS);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("task_motion");
	TCase *c = tcase_create("mechanics");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_test(c, power_is_rate_of_energy);
	tcase_add_test(c, power_along_a_trajectory);
	tcase_add_test(c, base_wrench_is_rate_of_momentum);
	tcase_add_test(c, push_by_jacobian);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
