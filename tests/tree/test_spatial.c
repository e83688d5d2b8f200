/* Angles, rotations, placements and inertias of the model's constants. */
#include "support/plain.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI_HALF 1.57079632679489661923132169163975144L
#define ROUNDING (8 * 0x1p-64L)       /* of an element of a rotation */
#define SNAPPED (4 * 0x1p-53L * 4)    /* what a zero may stand for: the terms of an element sum to less than 4 */

enum { RANDOM = 2000 };

static const real QUARTER_SIN[4] = {0, 1, 0, -1};

static real uniform(struct rng *rng, real low, real high)
{
	return low + (high - low) * (real)rng_uniform(rng, 0, 1);
}

static void random_axis(struct rng *rng, real n[3])
{
	real length;

	do {
		length = 0;
		for (int i = 0; i < 3; i++) {
			n[i] = uniform(rng, -1, 1);
			length += n[i] * n[i];
		}
	} while (length > 1 || length < 0.01L);
	for (int i = 0; i < 3; i++)
		n[i] /= sqrtl(length);
}

static struct rotation random_rotation(struct rng *rng)
{
	const double rpy[3] = {rng_uniform(rng, -4, 4), rng_uniform(rng, -4, 4), rng_uniform(rng, -4, 4)};

	return exact_rpy(rpy);
}

/* Equal to rounding, or a zero in place of what is no more than the noise of doubles. */
static void check_element(real got, real want, const char *what)
{
	real tolerance = got == 0 ? SNAPPED : ROUNDING;

	ck_assert_msg(fabsl(got - want) <= tolerance, "%s: %.21Lg, not %.21Lg", what, got, want);
}

static void check_rotation(const struct rotation *r, const char *what)
{
	real m[3][3], determinant = 0;

	plain(m[0], r->m[0], 9);
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		determinant += m[0][i] * (m[1][j] * m[2][k] - m[1][k] * m[2][j]);
		for (int l = 0; l < 3; l++) {
			real dot = m[i][0] * m[l][0] + m[i][1] * m[l][1] + m[i][2] * m[l][2];

			ck_assert_msg(fabsl(dot - (i == l)) < 4 * SNAPPED, "%s: rows %d and %d: %Lg", what, i, l, dot);
		}
	}
	ck_assert_msg(fabsl(determinant - 1) < 4 * SNAPPED, "%s: determinant %.21Lg", what, determinant);
}

static int zeros(const struct rotation *r)
{
	int n = 0;

	for (int i = 0; i < 9; i++)
		n += r->m[i / 3][i % 3].x == 0;
	return n;
}

/* ---- angles ---- */

/* As real files write them; quarter -1: the angle is what it says. */
static const struct written {
	double angle;
	int quarter;
} written[] = {
	{0, 0}, {-0.0, 0}, {1.5707963267948966, 1}, {1.570796326794897, 1}, {-1.570796326794897, 3}, {1.57079632679490, 1},
	{3.141592653589793, 2}, {3.14159265358979, 2}, {-3.14159265358979, 2}, {4.71238898038469, 3}, {6.283185307179586, 0},
	{-4.71238898038469, 1}, {1.5707963267949, 1}, {4e-15, 0}, {-4e-15, 0}, {6e-15, -1}, {-6e-15, -1}, {1e-14, -1},
	{1.57, -1}, {1.5708, -1}, {1.57079632679, -1}, {1.570796326795, -1}, {3.1416, -1}, {3.14159, -1},
	{3.1415926535897, -1}, {0.00478, -1}, {0.7853981633974483, -1}, {1, -1}, {100, -1},
};

static void sincos_of(real angle, real *s, real *c)
{
	struct within sine, cosine;

	angle_sincos(within_exact(angle), &sine, &cosine);
	*s = sine.x;
	*c = cosine.x;
}

START_TEST(angle_as_written)
{
	const struct written *w = &written[_i];
	real s, c, angle = w->angle;

	sincos_of(angle, &s, &c);
	ck_assert(s == (w->quarter < 0 ? sinl(angle) : QUARTER_SIN[w->quarter]));
	ck_assert(c == (w->quarter < 0 ? cosl(angle) : QUARTER_SIN[(w->quarter + 1) % 4]));
}
END_TEST

/* Both sides of the rule around multiples of pi/2, as far as long double resolves 1e-16. */
START_TEST(angle_snaps_within_5e_15)
{
	static const long turns[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 101, 1002, 2003};

	for (size_t i = 0; i < 2 * sizeof turns / sizeof *turns; i++) {
		long k = i % 2 ? -turns[i / 2] : turns[i / 2];
		int quarter = (int)((k % 4 + 4) % 4);

		for (int sign = -1; sign <= 1; sign += 2) {
			real s, c, outside = (real)k * PI_HALF + sign * 5.2e-15L;

			sincos_of((real)k * PI_HALF + sign * 4.8e-15L, &s, &c);
			ck_assert_msg(s == QUARTER_SIN[quarter] && c == QUARTER_SIN[(quarter + 1) % 4], "%ld pi/2: %Lg %Lg",
				k, s, c);
			sincos_of(outside, &s, &c);
			ck_assert_msg(s == sinl(outside) && c == cosl(outside), "%ld pi/2, outside: %Lg %Lg", k, s, c);
			ck_assert(s != 0 && c != 0);
		}
	}
}
END_TEST

START_TEST(angle_large_multiples)
{
	static const long long turns[] = {1000000, 4000001, 2147483647, 2147483650, 4294967299, 1000000000003};

	for (size_t i = 0; i < sizeof turns / sizeof *turns; i++)
		for (int sign = -1; sign <= 1; sign += 2) {
			int quarter = (int)((sign * turns[i] % 4 + 4) % 4);
			real s, c;

			sincos_of((real)(sign * turns[i]) * PI_HALF, &s, &c);
			ck_assert_msg(s == QUARTER_SIN[quarter] && c == QUARTER_SIN[(quarter + 1) % 4], "%lld pi/2: %Lg %Lg",
				sign * turns[i], s, c);
		}
}
END_TEST

/* ---- rotations ---- */

START_TEST(about_an_axis)
{
	for (int axis = 0; axis < 3; axis++) {
		struct rotation r = rotation_about(axis, within_exact(0.3L)), right = rotation_about(axis, within_exact(PI_HALF));
		int j = (axis + 1) % 3, k = (axis + 2) % 3;
		real e[3] = {0, 0, 0}, out[3];

		e[j] = 1;
		turned(&r, e, out);
		ck_assert(out[axis] == 0 && out[j] == cosl(0.3L) && out[k] == sinl(0.3L));
		turned(&right, e, e);
		ck_assert(e[axis] == 0 && e[j] == 0 && e[k] == 1);
		ck_assert(r.m[axis][axis].x == 1);
		check_rotation(&r, "about");
	}
}
END_TEST

/* The product written out (Craig, Introduction to Robotics, 2.64). */
START_TEST(rpy_by_formula)
{
	struct rng rng = rng_seed(11);

	for (int n = 0; n < RANDOM; n++) {
		const double rpy[3] = {rng_uniform(&rng, -7, 7), rng_uniform(&rng, -7, 7), rng_uniform(&rng, -7, 7)};
		real sr = sinl(rpy[0]), cr = cosl(rpy[0]), sp = sinl(rpy[1]), cp = cosl(rpy[1]), sy = sinl(rpy[2]),
		     cy = cosl(rpy[2]);
		const real want[9] = {cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp,
			sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr};
		struct rotation r = exact_rpy(rpy);

		for (int i = 0; i < 9; i++)
			check_element(r.m[i / 3][i % 3].x, want[i], "rpy");
		check_rotation(&r, "rpy");
	}
}
END_TEST

START_TEST(rpy_of_right_angles_is_exact)
{
	static const double angles[4] = {0, 1.5707963267948966, 3.141592653589793, -1.570796326794897};

	for (int n = 0; n < 64; n++) {
		const double rpy[3] = {angles[n % 4], angles[n / 4 % 4], angles[n / 16]};
		struct rotation r = exact_rpy(rpy), t = rotation_transpose(&r), one = rotation_mul(&r, &t);

		ck_assert_int_eq(zeros(&r), 6);
		ck_assert(is_identity(&one));
		ck_assert_int_eq(is_identity(&r), !memcmp(rpy, (double[3]){0, 0, 0}, sizeof rpy) ||
			(n % 4 == 2 && n / 4 % 4 == 2 && n / 16 == 2));
	}
}
END_TEST

static void check_third_column(const struct rotation *r, const real n[3], const char *what)
{
	for (int i = 0; i < 3; i++)
		check_element(r->m[i][2].x, n[i], what);
	check_rotation(r, what);
}

static struct rotation to(struct rotation (*turn)(const struct within n[3]), const real n[3])
{
	struct within axis[3];

	exact(axis, n, 3);
	return turn(axis);
}

START_TEST(to_axis)
{
	struct rng rng = rng_seed(12);

	for (int k = 0; k < RANDOM; k++) {
		struct rotation r;
		real n[3];

		random_axis(&rng, n);
		r = to(rotation_to_axis, n);
		check_third_column(&r, n, "to axis");
		ck_assert_int_ge(zeros(&r), 1);
	}
	for (int k = 0; k < 6; k++) {
		real n[3] = {0, 0, 0}, in_plane[3] = {0.6L, 0.6L, 0.6L};
		struct rotation r;

		n[k % 3] = k < 3 ? 1 : -1;
		r = to(rotation_to_axis, n);
		check_third_column(&r, n, "coordinate axis");
		ck_assert_int_eq(zeros(&r), 6);
		in_plane[k % 3] = 0;
		in_plane[(k + 1) % 3] = k < 3 ? 0.8L : -0.8L;
		r = to(rotation_to_axis, in_plane);
		check_third_column(&r, in_plane, "axis in a coordinate plane");
		ck_assert_int_eq(zeros(&r), 4);
	}
}
END_TEST

/* Shortest: what is normal to z and n stays where it is. */
static void check_shortest(const real n[3])
{
	struct rotation r = to(rotation_shortest, n);
	real m[3][3];

	plain(m[0], r.m[0], 9);
	check_third_column(&r, n, "shortest");
	check_element(m[0][0] + m[1][1] + m[2][2], 1 + 2 * n[2], "shortest: trace");
	check_element(m[0][0] * -n[1] + m[0][1] * n[0], -n[1], "shortest: fixed line, x");
	check_element(m[1][0] * -n[1] + m[1][1] * n[0], n[0], "shortest: fixed line, y");
}

START_TEST(shortest)
{
	static const real up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
	static const real half_turn[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
	struct rotation r = to(rotation_shortest, up);
	struct rng rng = rng_seed(13);
	real n[3];

	ck_assert(is_identity(&r));
	r = to(rotation_shortest, down);
	for (int i = 0; i < 9; i++)
		ck_assert(r.m[i / 3][i % 3].x == half_turn[i]);
	for (int k = 0; k < RANDOM; k++) {
		random_axis(&rng, n);
		check_shortest(n);
	}
}
END_TEST

START_TEST(shortest_near_the_poles)
{
	struct rng rng = rng_seed(14);

	for (int k = 0; k < RANDOM; k++) {
		real tilt = powl(10, uniform(&rng, -18, -1)), turn = uniform(&rng, -4, 4), side = k % 2 ? 1 : -1;
		real n[3] = {sinl(tilt) * cosl(turn), sinl(tilt) * sinl(turn), side * cosl(tilt)};

		check_shortest(n);
	}
}
END_TEST

START_TEST(placements_chain)
{
	struct rng rng = rng_seed(15);

	for (int k = 0; k < RANDOM; k++) {
		struct placement a = {.R = random_rotation(&rng)}, b = {.R = random_rotation(&rng)}, ab;
		real y[3], step[3], both[3];

		for (int i = 0; i < 3; i++) {
			a.p[i] = within_exact(uniform(&rng, -1, 1));
			b.p[i] = within_exact(uniform(&rng, -1, 1));
			y[i] = uniform(&rng, -1, 1);
		}
		ab = placement_mul(&a, &b);
		turned(&b.R, y, step);
		for (int i = 0; i < 3; i++)
			step[i] += b.p[i].x;
		turned(&a.R, step, step);
		turned(&ab.R, y, both);
		for (int i = 0; i < 3; i++)
			ck_assert(fabsl(step[i] + a.p[i].x - (both[i] + ab.p[i].x)) <= 2 * SNAPPED);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("spatial");
	TCase *c = tcase_create("rotations");

	tcase_add_loop_test(c, angle_as_written, 0, sizeof written / sizeof *written);
	tcase_add_test(c, angle_snaps_within_5e_15);
	tcase_add_test(c, angle_large_multiples);
	tcase_add_test(c, about_an_axis);
	tcase_add_test(c, rpy_by_formula);
	tcase_add_test(c, rpy_of_right_angles_is_exact);
	tcase_add_test(c, to_axis);
	tcase_add_test(c, shortest);
	tcase_add_test(c, shortest_near_the_poles);
	tcase_add_test(c, placements_chain);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
