// The reference against equations of motion found in textbooks.
#include <math.h>
#include <string.h>

#include "reference/test_reference.h"

static const double g = 9.81;

static void expect_torque(const char *urdf, const struct reference_options *o, const double *x, const double *expected)
{
	struct reference *r = open_text(urdf, o);
	wide tau[ROWS], wanted[ROWS];

	reference_rnea(r, x, x + r->nq, x + r->nq + r->nv, tau);
	for (int i = 0; i < r->nv; i++)
		wanted[i] = (wide)expected[i];
	expect_near(tau, wanted, r->nv, 1e-14, "closed form");
	reference_close(r);
}

static const char pendulum[] =
	"<robot name='p'><link name='a'/>"
	"<link name='b'><inertial><origin xyz='0 0 -0.7'/><mass value='1.3'/>"
	"<inertia ixx='0.2' ixy='0' ixz='0' iyy='0.05' iyz='0' izz='0.3'/></inertial></link>"
	"<joint name='j' type='continuous'><origin xyz='0.3 0.2 0.1'/><axis xyz='0 1 0'/>"
	"<parent link='a'/><child link='b'/></joint></robot>";

// tau = (I + m l^2) q'' + m g l sin q
START_TEST(test_pendulum)
{
	const double x[] = {0.4, -1.7, 2.3};
	const double expected[] = {(0.05 + 1.3 * 0.7 * 0.7) * x[2] + 1.3 * g * 0.7 * sin(x[0])};

	expect_torque(pendulum, NULL, x, expected);
}
END_TEST

// Gravity along x turns the pendulum's torque by 90 degrees: m l g_x cos q.
START_TEST(test_gravity_option)
{
	const double gravity[3] = {3, 0, 0}, x[] = {0.4, 1, 0};
	const double expected[] = {1.3 * 0.7 * 3 * cos(x[0])};

	expect_torque(pendulum, &(struct reference_options){.gravity = gravity}, x, expected);
}
END_TEST

static const char double_pendulum[] =
	"<robot name='p'><link name='a'/>"
	"<link name='b'><inertial><origin xyz='0 0 -0.4'/><mass value='1.3'/>"
	"<inertia ixx='0.2' ixy='0' ixz='0' iyy='0.05' iyz='0' izz='0.3'/></inertial></link>"
	"<link name='c'><inertial><origin xyz='0 0 -0.3'/><mass value='0.8'/>"
	"<inertia ixx='0.2' ixy='0' ixz='0' iyy='0.03' iyz='0' izz='0.3'/></inertial></link>"
	"<joint name='j1' type='continuous'><axis xyz='0 1 0'/><parent link='a'/><child link='b'/></joint>"
	"<joint name='j2' type='continuous'><origin xyz='0 0 -0.9'/><axis xyz='0 2 0'/><parent link='b'/><child link='c'/>"
	"</joint></robot>";

// Spong, Hutchinson, Vidyasagar, Robot Modeling and Control, section 7.3.2, angles from the vertical.
START_TEST(test_double_pendulum)
{
	const double x[] = {0.4, -1.1, 0.7, 1.9, -2.1, 1.2};
	const double *q = x, *v = x + 2, *a = x + 4, m1 = 1.3, m2 = 0.8, i1 = 0.05, i2 = 0.03, l = 0.9, c1 = 0.4, c2 = 0.3;
	double m11 = i1 + i2 + m1 * c1 * c1 + m2 * (l * l + c2 * c2 + 2 * l * c2 * cos(q[1]));
	double m12 = i2 + m2 * (c2 * c2 + l * c2 * cos(q[1])), m22 = i2 + m2 * c2 * c2;
	double h = -m2 * l * c2 * sin(q[1]), g2 = m2 * g * c2 * sin(q[0] + q[1]);
	const double expected[] = {
		m11 * a[0] + m12 * a[1] + h * (2 * v[0] * v[1] + v[1] * v[1]) + (m1 * c1 + m2 * l) * g * sin(q[0]) + g2,
		m12 * a[0] + m22 * a[1] - h * v[0] * v[0] + g2,
	};

	expect_torque(double_pendulum, NULL, x, expected);
}
END_TEST

static const char cartpole[] =
	"<robot name='p'><link name='a'/>"
	"<link name='b'><inertial><mass value='5'/></inertial></link>"
	"<link name='c'><inertial><origin xyz='0 0 0.6'/><mass value='0.8'/>"
	"<inertia ixx='0.2' ixy='0' ixz='0' iyy='0.03' iyz='0' izz='0.3'/></inertial></link>"
	"<joint name='j1' type='prismatic'><parent link='a'/><child link='b'/></joint>"
	"<joint name='j2' type='continuous'><origin xyz='0 0 0.2'/><axis xyz='0 1 0'/><parent link='b'/><child link='c'/>"
	"</joint></robot>";

// F = (M + m) x'' + m l (t'' cos t - t'^2 sin t), tau = m l x'' cos t + (I + m l^2) t'' - m g l sin t; no axis means x.
START_TEST(test_cartpole)
{
	const double x[] = {0.4, -1.1, 0.7, 1.9, -2.1, 1.2}, t = x[1], m = 0.8, l = 0.6;
	const double expected[] = {
		(5 + m) * x[4] + m * l * (x[5] * cos(t) - x[3] * x[3] * sin(t)),
		m * l * x[4] * cos(t) + (0.03 + m * l * l) * x[5] - m * g * l * sin(t),
	};

	expect_torque(cartpole, NULL, x, expected);
}
END_TEST

static const char top[] =
	"<robot name='top'><link name='a'/><link name='b'/><link name='c'/>"
	"<link name='d'><inertial><origin xyz='0 0 0.4'/><mass value='1.5'/>"
	"<inertia ixx='0.02' ixy='0' ixz='0' iyy='0.02' iyz='0' izz='0.07'/></inertial></link>"
	"<joint name='j1' type='continuous'><axis xyz='0 0 1'/><parent link='a'/><child link='b'/></joint>"
	"<joint name='j2' type='continuous'><axis xyz='1 0 0'/><parent link='b'/><child link='c'/></joint>"
	"<joint name='j3' type='continuous'><axis xyz='0 0 3'/><parent link='c'/><child link='d'/></joint></robot>";

// Lagrange's heavy top (Goldstein, Classical Mechanics, section 5.7) in Euler's angles: precession, nutation, spin.
static void top_torque(const double *x, double *tau)
{
	const double *v = x + 3, *a = x + 6, s = sin(x[1]), c = cos(x[1]), weight = 1.5 * g * 0.4;
	double i1 = 0.02 + 1.5 * 0.4 * 0.4, i3 = 0.07, w = v[2] + v[0] * c, dw = a[2] + a[0] * c - v[0] * v[1] * s;

	tau[0] = i1 * (a[0] * s * s + 2 * v[0] * v[1] * s * c) + i3 * (dw * c - w * s * v[1]);
	tau[1] = i1 * (a[1] - v[0] * v[0] * s * c) + i3 * w * v[0] * s - weight * s;
	tau[2] = i3 * dw;
}

START_TEST(test_top)
{
	const double x[] = {0.3, 0.8, -2.2, 1.4, -0.6, 11, 0.5, 2.5, -3};
	double expected[3];

	top_torque(x, expected);
	expect_torque(top, NULL, x, expected);
}
END_TEST

// Steady precession needs no torque: w3 = (m g l + I1 p^2 cos t) / (I3 p).
START_TEST(test_steady_precession)
{
	double p = 1.7, t = 0.6, w = (1.5 * g * 0.4 + (0.02 + 1.5 * 0.16) * p * p * cos(t)) / (0.07 * p);
	const double x[] = {0.3, t, 1.1, p, 0, w - p * cos(t), 0, 0, 0}, none[3] = {0};

	expect_torque(top, NULL, x, none);
}
END_TEST

static const char body[] =
	"<robot name='p'><link name='a'><inertial><origin xyz='0.1 -0.2 0.3'/><mass value='2.5'/>"
	"<inertia ixx='0.2' ixy='0.01' ixz='-0.02' iyy='0.25' iyz='0.03' izz='0.3'/></inertial></link></robot>";

static void cross(const double *a, const double *b, double *out)
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

// Newton at the centre of mass, Euler about it, both in the body's axes; `fall` is gravity there.
static void body_wrench(const double *v, const double *a, const double *fall, double *wrench)
{
	static const double c[3] = {0.1, -0.2, 0.3};
	static const double in[3][3] = {{0.2, 0.01, -0.02}, {0.01, 0.25, 0.03}, {-0.02, 0.03, 0.3}};
	const double *w = v + 3, *b = a + 3;
	double wv[3], bc[3], wc[3], wwc[3], h[3], wh[3], cf[3];

	cross(w, v, wv);
	cross(b, c, bc);
	cross(w, c, wc);
	cross(w, wc, wwc);
	for (int i = 0; i < 3; i++)
		wrench[i] = 2.5 * (a[i] + wv[i] + bc[i] + wwc[i] - fall[i]);
	for (int i = 0; i < 3; i++)
		h[i] = in[i][0] * w[0] + in[i][1] * w[1] + in[i][2] * w[2];
	cross(w, h, wh);
	cross(c, wrench, cf);
	for (int i = 0; i < 3; i++)
		wrench[3 + i] = in[i][0] * b[0] + in[i][1] * b[1] + in[i][2] * b[2] + wh[i] + cf[i];
}

// A unit quaternion, and one of length s: then R = 1 + s^2 (R1 - 1), by its formula.
START_TEST(test_free_body)
{
	const double length = _i ? 1.2 : 1, angle = 0.9, n[3] = {0.6, 0, 0.8}, fall[3] = {0, 0, -g};
	double x[19] = {0.3, -0.2, 0.5, 0, 0, 0, 0, 0.7, -1.1, 0.4, 1.9, -0.3, 0.8, 2.1, -1.7, 0.6, 3.3, 2.2, -4.1};
	double turned[3], once[3], twice[3], expected[6];

	for (int i = 0; i < 3; i++)
		x[3 + i] = length * n[i] * sin(angle / 2);
	x[6] = length * cos(angle / 2);
	cross(n, fall, once);
	cross(n, once, twice);
	for (int i = 0; i < 3; i++)
		turned[i] = fall[i] + length * length * (-sin(angle) * once[i] + (1 - cos(angle)) * twice[i]);
	body_wrench(x + 7, x + 13, turned, expected);
	expect_torque(body, &(struct reference_options){.floating = true}, x, expected);
}
END_TEST

// z x y = the fixed-axis angles of a joint's origin: yaw 90 and then roll 90 send the child's y to the parent's z.
START_TEST(test_rpy)
{
	static const char lift[] =
		"<robot name='p'><link name='a'/><link name='b'><inertial><mass value='2'/></inertial></link>"
		"<joint name='j' type='prismatic'><origin rpy='1.5707963267948966 0 1.5707963267948966'/>"
		"<axis xyz='0 1 0'/><parent link='a'/><child link='b'/></joint></robot>";
	const double x[] = {0.4, -1.7, 2.3}, expected[] = {2 * (x[2] + g)};

	expect_torque(lift, NULL, x, expected);
}
END_TEST

TCase *closed_forms(void)
{
	TCase *t = tcase_create("closed forms");

	tcase_add_test(t, test_pendulum);
	tcase_add_test(t, test_gravity_option);
	tcase_add_test(t, test_double_pendulum);
	tcase_add_test(t, test_cartpole);
	tcase_add_test(t, test_top);
	tcase_add_test(t, test_steady_precession);
	tcase_add_loop_test(t, test_free_body, 0, 2);
	tcase_add_test(t, test_rpy);
	return t;
}
