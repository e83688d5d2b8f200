/* What mechanics says of any robot's torques, on random trees and by the evaluated DAG: no second program is asked. */
#include "support/exhaustive.h"
#include "support/suite.h"
#include "support/torque.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 16 };
#define ROBOTS (exhaustive() ? 36ull : 18ull) /* random trees */

/* Rounding of long double, by the magnitudes that were summed. */
#define ROUNDING 2e-17L

static struct model model;
static struct pose pose;

static void set_up(uint64_t seed, int flags, const double gravity[3])
{
	struct rneagen_options o = rneagen_options_default();
	char *urdf = torque_robot(seed, LINKS, flags), what[64];
	struct rng rng = rng_seed(seed + 1000);

	o.base = flags & NO_FLOATING || seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	memcpy(o.gravity, gravity, sizeof o.gravity);
	snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
	model_open(&model, urdf, strlen(urdf), &o, what);
	pose_random(&pose, model.reference, &rng);
	free(urdf);
}

static void check_near(real got, real want, real tolerance, uint64_t seed, int row, const char *what)
{
	ck_assert_msg(fabsl(got - want) <= tolerance, "%s: seed %llu, row %d: %.20Lg, not %.20Lg (tolerance %Lg)", what,
		(unsigned long long)seed, row, got, want, tolerance);
}

static const double tilted[3] = {1.5, -2, -9}, none[3] = {0, 0, 0};

/* tau(a x + b y) = a tau(x) + b tau(y) + (1 - a - b) tau(0) in qdd = x, y */
START_TEST(linear_in_qdd)
{
	const real a = 0.75L, b = -2.5L;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct torque x, y, zero, both;
		struct pose p;

		set_up(seed, 0, tilted);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &x);
		p = pose;
		for (int i = 0; i < pose.nv; i++)
			p.qdd[i] = sinl(i + 1);
		torque_of(&model.dag[ALGORITHM_rnea], &p, &y);
		memset(p.qdd, 0, sizeof p.qdd);
		torque_of(&model.dag[ALGORITHM_rnea], &p, &zero);
		for (int i = 0; i < pose.nv; i++)
			p.qdd[i] = a * pose.qdd[i] + b * sinl(i + 1);
		torque_of(&model.dag[ALGORITHM_rnea], &p, &both);
		for (int i = 0; i < pose.nv; i++)
			check_near(both.tau[i], a * x.tau[i] + b * y.tau[i] + (1 - a - b) * zero.tau[i],
				ROUNDING * 8 * ((real)x.size[i] + (real)y.size[i]), seed, i, "linear in qdd");
		model_close(&model);
	}
}
END_TEST

/* Forces of inertia and of velocity apart from gravity's: quadratic in qd, and gravity's linear in gravity. */
START_TEST(gravity_and_velocity_scale)
{
	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct torque g, g3, bias, bias2;
		double more[3] = {3 * tilted[0], 3 * tilted[1], 3 * tilted[2]};
		struct pose p;

		set_up(seed, 0, tilted);
		memset(pose.qdd, 0, sizeof pose.qdd);
		p = pose;
		memset(p.qd, 0, sizeof p.qd);
		torque_of(&model.dag[ALGORITHM_rnea], &p, &g);
		model_close(&model);
		set_up(seed, 0, more);
		torque_of(&model.dag[ALGORITHM_rnea], &p, &g3);
		model_close(&model);
		set_up(seed, 0, none);
		memset(pose.qdd, 0, sizeof pose.qdd);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &bias);
		for (int i = 0; i < pose.nv; i++)
			pose.qd[i] *= -2;
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &bias2);
		for (int i = 0; i < pose.nv; i++) {
			check_near(g3.tau[i], 3 * g.tau[i], ROUNDING * (real)g3.size[i], seed, i, "three times the gravity");
			check_near(bias2.tau[i], 4 * bias.tau[i], ROUNDING * (real)bias2.size[i], seed, i,
				"twice the velocity, backwards");
		}
		model_close(&model);
	}
}
END_TEST

/* A floating base that falls freely feels nothing; accelerating it upwards is gravity. */
START_TEST(gravity_is_an_acceleration)
{
	for (uint64_t seed = 3; seed <= 3 * ROBOTS; seed += 9) {
		struct torque with, without;
		real x, y, z, w, up[3];

		set_up(seed, 0, tilted);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &with);
		model_close(&model);
		set_up(seed, 0, none);
		x = pose.q[3], y = pose.q[4], z = pose.q[5], w = pose.q[6];
		up[0] = -((1 - 2 * (y * y + z * z)) * tilted[0] + 2 * (x * y + z * w) * tilted[1] +
			2 * (x * z - y * w) * tilted[2]);
		up[1] = -(2 * (x * y - z * w) * tilted[0] + (1 - 2 * (x * x + z * z)) * tilted[1] +
			2 * (y * z + x * w) * tilted[2]);
		up[2] = -(2 * (x * z + y * w) * tilted[0] + 2 * (y * z - x * w) * tilted[1] +
			(1 - 2 * (x * x + y * y)) * tilted[2]);
		for (int i = 0; i < 3; i++)
			pose.qdd[i] += up[i];
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &without);
		for (int i = 0; i < pose.nv; i++)
			check_near(with.tau[i], without.tau[i], ROUNDING * 4 * (real)with.size[i], seed, i, "base accelerates");
		model_close(&model);
	}
}
END_TEST

/* ---- the mass matrix, by columns ---- */

struct matrix {
	real m[ROWS][ROWS];
	double size[ROWS][ROWS];
};

static struct matrix matrix;

/* Gravity and velocity are zero. */
static void mass_matrix(void)
{
	static struct torque t;

	memset(pose.qd, 0, sizeof pose.qd);
	for (int j = 0; j < pose.nv; j++) {
		memset(pose.qdd, 0, sizeof pose.qdd);
		pose.qdd[j] = 1;
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &t);
		for (int i = 0; i < pose.nv; i++) {
			matrix.m[i][j] = t.tau[i];
			matrix.size[i][j] = t.size[i];
		}
	}
}

/* One Jacobi rotation that takes m[p][q] to zero. */
static void jacobi(int n, int p, int q)
{
	real theta = 0.5L * atan2l(2 * matrix.m[p][q], matrix.m[q][q] - matrix.m[p][p]), c = cosl(theta), s = sinl(theta);

	for (int i = 0; i < n; i++) {
		real ip = matrix.m[i][p], iq = matrix.m[i][q];

		matrix.m[i][p] = c * ip - s * iq;
		matrix.m[i][q] = s * ip + c * iq;
	}
	for (int i = 0; i < n; i++) {
		real pi = matrix.m[p][i], qi = matrix.m[q][i];

		matrix.m[p][i] = c * pi - s * qi;
		matrix.m[q][i] = s * pi + c * qi;
	}
}

/* The least eigenvalue of the matrix scaled to ones on its diagonal; rows of zeros are left out. Destroys the matrix. */
static real least_eigenvalue(int n)
{
	real scale[ROWS], least = 1;

	for (int i = 0; i < n; i++)
		scale[i] = matrix.m[i][i] > 0 ? 1 / sqrtl(matrix.m[i][i]) : 0;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			matrix.m[i][j] *= scale[i] * scale[j];
	for (int sweep = 0; sweep < 12; sweep++)
		for (int p = 0; p < n; p++)
			for (int q = p + 1; q < n; q++)
				jacobi(n, p, q);
	for (int i = 0; i < n; i++)
		least = scale[i] > 0 && matrix.m[i][i] < least ? matrix.m[i][i] : least;
	return least;
}

/* Quaternions are unit to the rounding of double, and zeros in the constants stand for the noise of doubles. */
static void check_symmetric(uint64_t seed)
{
	for (int i = 0; i < pose.nv; i++) {
		ck_assert_msg(matrix.m[i][i] >= 0, "seed %llu: M[%d][%d] = %Lg", (unsigned long long)seed, i, i, matrix.m[i][i]);
		for (int j = 0; j < i; j++)
			check_near(matrix.m[i][j], matrix.m[j][i], 1e-14L * (real)fmax(matrix.size[i][j], matrix.size[j][i]),
				seed, i, "symmetric");
	}
}

START_TEST(mass_matrix_is_semidefinite)
{
	real worst = 1;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		real least;

		set_up(seed, 0, none);
		mass_matrix();
		check_symmetric(seed);
		least = least_eigenvalue(pose.nv);
		ck_assert_msg(least > -1e-13L, "seed %llu: an eigenvalue of %Lg", (unsigned long long)seed, least);
		worst = least < worst ? least : worst;
		model_close(&model);
	}
	printf("mass matrices of random trees, seeds 1 to %llu: least scaled eigenvalue %.2Lg\n", ROBOTS, worst);
}
END_TEST

/* Where every body has a mass with extent. */
START_TEST(mass_matrix_is_definite)
{
	static const char *const robots[] = {"iiwa14", "ur5", "hyq", "panda", "atlas", "g1_29dof", "skew_axis", "planar_tilted",
		"mimic_chain", "floating_joint"};

	for (size_t i = 0; i < sizeof robots / sizeof *robots; i++) {
		struct rneagen_options o = rneagen_options_default();
		struct rng rng = rng_seed(i);
		char path[1024], *urdf;
		size_t length;
		real least;

		memset(o.gravity, 0, sizeof o.gravity);
		o.base = i < 6 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
		snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", robots[i]);
		urdf = read_file(path, &length);
		model_open(&model, urdf, length, &o, robots[i]);
		pose_random(&pose, model.reference, &rng);
		mass_matrix();
		check_symmetric(i);
		least = least_eigenvalue(pose.nv);
		ck_assert_msg(least > 1e-6L, "%s: an eigenvalue of %Lg", robots[i], least);
		model_close(&model);
		free(urdf);
	}
}
END_TEST

/* ---- power ---- */

/* Kinetic energy, qd M qd / 2, at time t of the motion q + qd t + qdd t t / 2; the model knows no gravity. */
static real kinetic_energy(real t)
{
	static struct torque momentum;
	static struct pose p;
	real energy = 0;

	p.nq = pose.nq;
	p.nv = pose.nv;
	for (int i = 0; i < pose.nv; i++) {
		p.q[i] = pose.q[i] + t * (pose.qd[i] + t * pose.qdd[i] / 2);
		p.qdd[i] = pose.qd[i] + t * pose.qdd[i];
	}
	torque_of(&model.dag[ALGORITHM_rnea], &p, &momentum);
	for (int i = 0; i < pose.nv; i++)
		energy += p.qdd[i] * momentum.tau[i] / 2;
	return energy;
}

/* tau . qd = d/dt (kinetic energy), by a difference of order 4. */
START_TEST(power_balance)
{
	const real h = 0x1p-11L;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		real power = 0, scale = 0, change;
		struct torque t;

		set_up(seed, NO_FLOATING, none);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &t);
		for (int i = 0; i < pose.nv; i++) {
			power += t.tau[i] * pose.qd[i];
			scale += (real)t.size[i] * fabsl(pose.qd[i]);
		}
		change = (8 * (kinetic_energy(h) - kinetic_energy(-h)) - (kinetic_energy(2 * h) - kinetic_energy(-2 * h))) /
			(12 * h);
		check_near(power, change, 1e-8L * scale, seed, 0, "power");
		model_close(&model);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("properties");
	TCase *c = tcase_create("mechanics");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_test(c, linear_in_qdd);
	tcase_add_test(c, gravity_and_velocity_scale);
	tcase_add_test(c, gravity_is_an_acceleration);
	tcase_add_test(c, mass_matrix_is_semidefinite);
	tcase_add_test(c, mass_matrix_is_definite);
	tcase_add_test(c, power_balance);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
