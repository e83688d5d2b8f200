/* Texts of earlier generators, whose tables have versions 1 and 2: catches a runtime that no longer opens them, or calls their
   functions with other arrays. tests/old holds them as they were written; the torques are tests/robots/double_pendulum.urdf's,
   in closed form. On the host and on the pretended driver. */
#define _POSIX_C_SOURCE 200809L
#include "rnea.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 300, SEED = 20261122, NV = 2 };

struct states {
	float q[NV][COUNT], qd[NV][COUNT], qdd[NV][COUNT], tau[NV][COUNT];
};

static struct rnea_robot *open_robot(const char *file, int on_cuda)
{
	struct rnea_options o = {.backend = on_cuda ? RNEA_BACKEND_CUDA : RNEA_BACKEND_HOST, .threads = 2};
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(!rnea_open_file(file, &o, &robot, &e), "%s", e.message);
	return robot;
}

static void draw(struct states *x)
{
	struct rng rng = rng_seed(SEED);

	for (int i = 0; i < NV; i++)
		for (int k = 0; k < COUNT; k++) {
			x->q[i][k] = (float)rng_uniform(&rng, -3, 3);
			x->qd[i][k] = (float)rng_uniform(&rng, -3, 3);
			x->qdd[i][k] = (float)rng_uniform(&rng, -3, 3);
			x->tau[i][k] = NAN;
		}
}

/* M of sample k. */
static void mass(const struct states *x, int k, double m[3])
{
	const double h = 0.3, a = 0.04 + 2 * 0.25 + 1, b = 0.02 + 0.09;

	m[0] = a + b + 2 * h * cos((double)x->q[1][k]);
	m[1] = b + h * cos((double)x->q[1][k]);
	m[2] = b;
}

static void check_torques(const struct states *x)
{
	const double h = 0.3, g = 9.81;

	for (int k = 0; k < COUNT; k++) {
		double m[3], q1 = (double)x->q[0][k], q2 = (double)x->q[1][k], v1 = (double)x->qd[0][k], v2 = (double)x->qd[1][k];
		double a1 = (double)x->qdd[0][k], a2 = (double)x->qdd[1][k], lower = g * 0.3 * sin(q1 + q2);

		mass(x, k, m);
		ck_assert_double_eq_tol((double)x->tau[0][k],
			m[0] * a1 + m[1] * a2 - h * sin(q2) * (2 * v1 + v2) * v2 + g * 2 * sin(q1) + lower, 1e-4);
		ck_assert_double_eq_tol((double)x->tau[1][k], m[1] * a1 + m[2] * a2 + h * sin(q2) * v1 * v1 + lower, 1e-4);
	}
}

/* The whole, and its halves by name: their arrays stand in no table of version 1. */
START_TEST(version_1)
{
	static struct states x;
	static float v[6 * NV][COUNT], a[6 * NV][COUNT], f[6 * NV][COUNT];
	struct rnea_robot *robot = open_robot(TEST_DIR "/old/version_1.cu", _i);
	const struct rnea_info *info = rnea_info(robot);
	struct rnea_error e;

	ck_assert_uint_eq(info->version, 1);
	ck_assert_uint_eq(info->function_count, 3);
	ck_assert_str_eq(info->functions[1].name, "fpass");
	ck_assert_str_eq(info->functions[1].arguments[5].name, "f");
	ck_assert_uint_eq(info->functions[1].arguments[5].rows, 6 * NV);
	ck_assert_int_eq(rnea_bind_role(robot, "rnea", RNEA_ROLE_JOINT_ACCELERATION, NULL), 2);
	ck_assert_int_eq(rnea_bind_role(robot, "bpass", RNEA_ROLE_JOINT_TORQUE, NULL), 2);
	ck_assert_int_eq(rnea_bind_role(robot, "bpass", RNEA_ROLE_JOINT_ACCELERATION, NULL), -1);
	ck_assert_int_eq(rnea_bind_role(robot, "aba", RNEA_ROLE_JOINT_TORQUE, NULL), -1);
	draw(&x);
	ck_assert_msg(!rnea_run(robot, (void *[]){x.q, x.qd, x.qdd, x.tau}, COUNT, &e), "%s", e.message);
	check_torques(&x);
	memset(x.tau, 0xff, sizeof x.tau);
	ck_assert_msg(!rnea_launch_kernel(robot, "fpass", (void *[]){x.q, x.qd, x.qdd, v, a, f}, COUNT, NULL, &e),
		"%s", e.message);
	ck_assert_msg(!rnea_launch_kernel(robot, "bpass", (void *[]){x.q, f, x.tau}, COUNT, NULL, &e), "%s", e.message);
	check_torques(&x);
	rnea_close(robot);
}
END_TEST

/* Two parts of the grid, each of which makes some of the outputs, and one function. */
START_TEST(version_2)
{
	static struct states x;
	static float m[3][COUNT], dq[NV * NV][COUNT];
	struct rnea_robot *robot = open_robot(TEST_DIR "/old/version_2.cu", _i);
	const struct rnea_info *info = rnea_info(robot);
	struct rnea_error e;

	ck_assert_uint_eq(info->version, 2);
	ck_assert_uint_eq(info->parts, 2);
	ck_assert_uint_eq(info->function_count, 1);
	ck_assert_uint_eq(info->functions->matrix_count, 2);
	ck_assert_uint_eq(rnea_argument_count(robot, "fpass"), 0);
	draw(&x);
	ck_assert_msg(!rnea_launch(robot, (void *[]){x.q, x.qd, x.qdd, x.tau, m, dq}, COUNT, NULL, &e), "%s", e.message);
	check_torques(&x);
	for (int k = 0; k < COUNT; k++) {
		double right[3];

		mass(&x, k, right);
		for (int i = 0; i < 3; i++)
			ck_assert_double_eq_tol((double)m[i][k], right[i], 1e-5);
		ck_assert_double_eq_tol((double)dq[2][k], 9.81 * 0.3 * cos((double)x.q[0][k] + (double)x.q[1][k]), 1e-4);
	}
	rnea_close(robot);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("runtime_old");
	TCase *c = tcase_create("runtime_old");

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	setenv("RNEA_CACHE", "", 1);
	tcase_set_timeout(c, 60);
	tcase_add_loop_test(c, version_1, 0, 2);
	tcase_add_loop_test(c, version_2, 0, 2);
	suite_add_tcase(s, c);
	return suite_run(s);
}
