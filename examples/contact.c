/* contact: how a quadruped's weight rests on its feet. The text (CMakeLists.txt: scene `fext` on the four feet, in axes of
   the world, with qd and qdd folded to zero) has the torques of a HyQ that stands still while forces push at its feet. The
   first six of them are what a hand would have to hold the trunk with, force and moment; they are linear in the feet's
   forces,

     tau_base(f) = tau_base(0) + A f,

   and nobody holds the trunk, so tau_base = 0. Of all vertical forces f that do it, least squares by conjugate gradients
   (Hestenes and Stiefel 1952), begun at zero, find the smallest. Stances on all feet and on three; a foot cannot pull,
   so a negative force means that the robot tips over. The exit status tells whether the trunk's wrench vanishes and
   whether the forces have the robot's weight. */
#include "hyq_rnea.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FEET = 4, BASE = 6 };

static const char *const NAMES[FEET] = {"lf", "rf", "lh", "rh"};
static const double WEIGHT = 86.774005 * 9.81; /* N; hyq.urdf: the sum of its masses */
static const double ROUNDING = 1e-9;	    /* of the weight */

/* Trunk level or turned, then each leg's hip, hip and knee: left before and behind, right before and behind; rad. */
static const struct stance {
	const char *name;
	double q[hyq_nq];
	int lifted; /* the foot that is in the air, or -1 */
} STANCES[] = {
	{"level", {0, 0, 0, 0, 0, 0, 1, 0, 0.7, -1.4, 0, -0.7, 1.4, 0, 0.7, -1.4, 0, -0.7, 1.4}, -1},
	{"feet forward", {0, 0, 0, 0, 0, 0, 1, 0, 0.4, -1.4, 0, -1, 1.4, 0, 0.4, -1.4, 0, -1, 1.4}, -1},
	{"15 degrees uphill", {0, 0, 0, 0, -0.13052619222005157, 0, 0.99144486137381038, 0, 0.7, -1.4, 0, -0.7, 1.4, 0,
		0.7, -1.4, 0, -0.7, 1.4}, -1},
	{"rf lifted, level", {0, 0, 0, 0, 0, 0, 1, 0, 0.7, -1.4, 0, -0.7, 1.4, 0, 0.7, -1.4, 0, -0.7, 1.4}, 1},
	{"rf lifted, feet moved", {0, 0, 0, 0, 0, 0, 1, 0.2, 1, -1.4, 0.2, -0.4, 1.4, -0.2, 1.2, -2, -0.2, -0.4, 1.4}, 1},
};
enum { STANCE_COUNT = sizeof STANCES / sizeof *STANCES };

/* Torques with a vertical force on each foot. */
static void statics(const double q[hyq_nq], const double f[FEET], double tau[hyq_nv])
{
	double fext[FEET][6] = {{0}};

	for (int i = 0; i < FEET; i++)
		fext[i][2] = f[i];
	hyq_rnea(q, fext[0], fext[1], fext[2], fext[3], tau);
}

/* A, column by column, and tau_base(0); a lifted foot's column is zero, and so will be its force. */
static void linear_part(const struct stance *s, double a[FEET][BASE], double tau0[BASE])
{
	double f[FEET] = {0}, tau[hyq_nv];

	statics(s->q, f, tau);
	memcpy(tau0, tau, BASE * sizeof *tau);
	for (int i = 0; i < FEET; i++) {
		f[i] = i != s->lifted;
		statics(s->q, f, tau);
		f[i] = 0;
		for (int row = 0; row < BASE; row++)
			a[i][row] = tau[row] - tau0[row];
	}
}

static double square(const double *x, int n)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += x[i] * x[i];
	return sum;
}

/* s = A'r */
static void gradient(double a[FEET][BASE], const double r[BASE], double s[FEET])
{
	for (int i = 0; i < FEET; i++) {
		s[i] = 0;
		for (int row = 0; row < BASE; row++)
			s[i] += a[i][row] * r[row];
	}
}

/* The smallest f of those with the smallest ||A f + b||. */
static void least_squares(double a[FEET][BASE], const double b[BASE], double f[FEET])
{
	double r[BASE], s[FEET], p[FEET], was, now, first;

	for (int row = 0; row < BASE; row++)
		r[row] = -b[row];
	memset(f, 0, FEET * sizeof *f);
	gradient(a, r, s);
	memcpy(p, s, sizeof p);
	first = now = square(s, FEET);
	/* without rounding, as many steps as the rank of A would do */
	for (int k = 0; k < 4 * FEET && now > 1e-30 * first; k++) {
		double ap[BASE] = {0}, step;

		for (int i = 0; i < FEET; i++)
			for (int row = 0; row < BASE; row++)
				ap[row] += a[i][row] * p[i];
		step = now / square(ap, BASE);
		for (int i = 0; i < FEET; i++)
			f[i] += step * p[i];
		for (int row = 0; row < BASE; row++)
			r[row] -= step * ap[row];
		gradient(a, r, s);
		was = now;
		now = square(s, FEET);
		for (int i = 0; i < FEET; i++)
			p[i] = s[i] + now / was * p[i];
	}
}

/* Returns whether the trunk is free and the feet carry the robot. */
static int stand(const struct stance *s)
{
	double a[FEET][BASE], tau0[BASE], f[FEET], tau[hyq_nv], sum = 0, least = 0, most = 0, left;

	linear_part(s, a, tau0);
	least_squares(a, tau0, f);
	statics(s->q, f, tau);
	left = sqrt(square(tau, BASE));
	printf("%-24s", s->name);
	for (int i = 0; i < FEET; i++) {
		printf(" %9.3f", f[i]);
		sum += f[i];
		least = fmin(least, f[i]);
	}
	for (int j = BASE; j < hyq_nv; j++)
		most = fmax(most, fabs(tau[j]));
	printf(" %9.3f %9.1e %9.3f  %s\n", sum, left, most, least < 0 ? "tips over" : "stands");
	return fabs(sum / WEIGHT - 1) < ROUNDING && left < ROUNDING * WEIGHT;
}

int main(void)
{
	int good = 1;

	printf("%-24s", "vertical forces, N");
	for (int i = 0; i < FEET; i++)
		printf(" %9s", NAMES[i]);
	printf(" %9s %9s %9s\n", "sum", "trunk", "legs, N m");
	for (int k = 0; k < STANCE_COUNT; k++)
		good &= stand(&STANCES[k]);
	printf("%-24s %49.3f\n", "weight", WEIGHT);
	return !good;
}
