/* payload ROBOT.urdf LINK CANDIDATES.dat: what does an arm of seven joints hold? The torques are linear in the ten
   numbers of what LINK carries, p = (m, m c, I): mass, first moments, inertia about the link's origin,

     tau(q, qd, qdd; p) = tau(q, qd, qdd; 0) + Y(q, qd, qdd) p.

   The text has p as an input of every sample (payload_arm.c: scene `free payload.LINK:sample`), so that any number of
   candidates is evaluated along a whole trajectory in one batch, on the GPU where there is one. First none and the ten
   units: the columns of Y, of which least squares make the best p. Then a map of candidates around it, of which the one
   that fits best is found. The torques "measured" are those of another model, where the payload is a link of the URDF,
   with noise of a known seed. Writes mass, height of the centre of mass and misfit of every candidate. The exit status
   tells whether p was found as well as the noise allows. */
#include "payload_arm.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 32, CANDIDATES = SIDE * SIDE, ROWS = STATES * N, SEED = 7 };

static const double NOISE = 0.05; /* N m, standard deviation */
static const struct body HIDDEN = {2.4, {0.02, -0.03, 0.11}, {0.012, 0.001, -0.0005, 0.01, 0.0008, 0.006}};
static const char *const NAMES[P] = {"m", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"};
static const char *const UNITS[P] = {"kg", "kg m", "kg m", "kg m", "kg m2", "kg m2", "kg m2", "kg m2", "kg m2", "kg m2"};

struct fit {
	double p[P], deviation[P]; /* the standard deviation that NOISE leads to */
};

/* Greater than 0, up to 1: the upper bits of a linear congruential generator, Knuth's MMIX. */
static double draw(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return ((double)(*state >> 11) + 1) / (double)(UINT64_C(1) << 53);
}

/* Gaussian noise, by Box and Muller. */
static void add_noise(double *x, size_t n)
{
	uint64_t state = SEED;

	for (size_t i = 0; i < n; i++) {
		double r = sqrt(-2 * log(draw(&state)));

		x[i] += NOISE * r * cos(6.283185307179586 * draw(&state));
	}
}

/* Solve L L' x = x in place, L the lower triangle of `l`. */
static void solve(double l[P][P], double x[P])
{
	for (int i = 0; i < P; i++) {
		for (int j = 0; j < i; j++)
			x[i] -= l[i][j] * x[j];
		x[i] /= l[i][i];
	}
	for (int i = P - 1; i >= 0; i--) {
		for (int j = i + 1; j < P; j++)
			x[i] -= l[j][i] * x[j];
		x[i] /= l[i][i];
	}
}

/* Y'Y p = Y'(measured - tau(0)), by Cholesky's L L' = Y'Y; the inverse of Y'Y has the variances. `tau`: of no payload,
   then of each unit. */
static void least_squares(const double *tau, const double *measured, struct fit *f)
{
	double l[P][P];

	for (int i = 0; i < P; i++) {
		const double *yi = tau + (i + 1) * ROWS;

		f->p[i] = 0;
		for (int k = 0; k < ROWS; k++)
			f->p[i] += (yi[k] - tau[k]) * (measured[k] - tau[k]);
		for (int j = 0; j <= i; j++) {
			const double *yj = tau + (j + 1) * ROWS;

			l[i][j] = 0;
			for (int k = 0; k < ROWS; k++)
				l[i][j] += (yi[k] - tau[k]) * (yj[k] - tau[k]);
			for (int k = 0; k < j; k++)
				l[i][j] -= l[i][k] * l[j][k];
			l[i][j] = i == j ? sqrt(l[i][i]) : l[i][j] / l[j][j];
		}
	}
	solve(l, f->p);
	for (int i = 0; i < P; i++) {
		double unit[P] = {0};

		unit[i] = 1;
		solve(l, unit);
		f->deviation[i] = NOISE * sqrt(unit[i]);
	}
}

/* Returns whether every number is within five standard deviations. */
static int report(const struct fit *f)
{
	double truth[P];
	int good = 1;

	payload_of(&HIDDEN, truth);
	printf("%-6s%-6s %12s %12s %12s %12s\n", "", "", "hidden", "found", "error", "deviation");
	for (int i = 0; i < P; i++) {
		printf("%-6s%-6s %12.6f %12.6f %12.6f %12.6f\n", NAMES[i], UNITS[i], truth[i], f->p[i], f->p[i] - truth[i],
			f->deviation[i]);
		good &= fabs(f->p[i] - truth[i]) <= 5 * f->deviation[i];
	}
	return good && f->deviation[0] < 0.01 * truth[0];
}

/* Mass from 0.95 to 1.05 times what was found, height of the centre of mass from 0.8 to 1.2 times. */
static void candidates_around(const struct fit *f, double (*c)[P])
{
	for (int k = 0; k < CANDIDATES; k++) {
		for (int i = 0; i < P; i++)
			c[k][i] = f->p[i];
		c[k][0] *= 0.95 + 0.1 * (k % SIDE + 0.5) / SIDE;
		c[k][3] = c[k][0] * f->p[3] / f->p[0] * (0.8 + 0.4 * (k / SIDE + 0.5) / SIDE);
	}
}

static double misfit(const double *tau, const double *measured)
{
	double sum = 0;

	for (int k = 0; k < ROWS; k++)
		sum += (tau[k] - measured[k]) * (tau[k] - measured[k]);
	return sqrt(sum / ROWS);
}

/* Writes the map, and after it what was found and what was hidden; returns the best candidate, or -1. */
static int write_map(const char *path, double (*c)[P], const double *tau, const double *measured, const struct fit *f)
{
	FILE *out = fopen(path, "w");
	double least = INFINITY;
	int best = -1;

	for (int k = 0; k < CANDIDATES; k++) {
		double x = misfit(tau + (size_t)k * ROWS, measured);

		if (x < least) {
			least = x;
			best = k;
		}
		if (out)
			fprintf(out, "%.6f %.6f %.6f\n%s", c[k][0], c[k][3] / c[k][0], x, k % SIDE == SIDE - 1 ? "\n" : "");
	}
	if (out)
		fprintf(out, "\n%.6f %.6f\n\n\n%.6f %.6f\n", f->p[0], f->p[3] / f->p[0], HIDDEN.mass, HIDDEN.centre[2]);
	if (!out || fclose(out)) {
		fprintf(stderr, "payload: %s: cannot be written\n", path);
		return -1;
	}
	printf("%d candidates along %d states, one batch: the best has %.3f kg at %.4f m, misfit %.4f N m\n", CANDIDATES, STATES,
		c[best][0], c[best][3] / c[best][0], least);
	return best;
}

/* 0 if all went well. */
static int estimate(const struct rnea_robot *arm, const struct rnea_robot *loaded, const char *path, double *tau)
{
	static double basis[P + 1][P], c[CANDIDATES][P], measured[ROWS];
	struct fit f;
	int good, best, close;

	for (int i = 0; i < P; i++)
		basis[i + 1][i] = 1;
	if (arm_torques(loaded, NULL, 1, measured) || arm_torques(arm, (const double(*)[P])basis, P + 1, tau))
		return 1;
	add_noise(measured, ROWS);
	least_squares(tau, measured, &f);
	good = report(&f);
	candidates_around(&f, c);
	if (arm_torques(arm, (const double(*)[P])c, CANDIDATES, tau))
		return 1;
	best = write_map(path, c, tau, measured, &f);
	close = best >= 0 && fabs(c[best][0] / f.p[0] - 1) < 0.005;
	return !good || !close || misfit(tau + (size_t)best * ROWS, measured) > 1.1 * NOISE;
}

int main(int argc, char **argv)
{
	struct rnea_robot *arm = argc == 4 ? arm_open(argv[1], argv[2]) : NULL;
	struct rnea_robot *loaded = arm ? arm_open_loaded(argv[1], argv[2], &HIDDEN) : NULL;
	double *tau = calloc(CANDIDATES, ROWS * sizeof *tau);
	int failed = 1;

	if (argc != 4)
		fprintf(stderr, "usage: payload ROBOT.urdf LINK CANDIDATES.dat\n");
	if (loaded && tau) {
		printf("on %s; noise of %g N m, seed %d\n", rnea_build(arm)->device, NOISE, SEED);
		failed = estimate(arm, loaded, argv[3], tau);
	}
	free(tau);
	rnea_close(arm);
	rnea_close(loaded);
	return argc == 4 ? failed : 2;
}
