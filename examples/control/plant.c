/* Forward dynamics from inverse dynamics: ID is linear in qdd, so its columns are those of the mass matrix,
   M e_j = ID(q, 0, e_j) - ID(q, 0, 0), and M qdd = tau - D qd - ID(q, qd, 0). (Walker and Orin 1982, method 1) */
#include "plant.h"
#include <math.h>

static const double ZERO[N];

/* The lower triangle of M(q). */
static void mass_matrix(const double q[N], double m[N][N])
{
	double gravity[N], unit[N] = {0}, column[N];

	PLANT_RNEA(q, ZERO, ZERO, gravity);
	for (int j = 0; j < N; j++) {
		unit[j] = 1;
		PLANT_RNEA(q, ZERO, unit, column);
		unit[j] = 0;
		for (int i = j; i < N; i++)
			m[i][j] = column[i] - gravity[i];
	}
}

/* Solve m x = b in place of m and b: m = L L', L y = b, L' x = y. */
static void cholesky_solve(double m[N][N], double b[N])
{
	for (int i = 0; i < N; i++) {
		for (int j = 0; j <= i; j++) {
			for (int k = 0; k < j; k++)
				m[i][j] -= m[i][k] * m[j][k];
			m[i][j] = i == j ? sqrt(m[i][i]) : m[i][j] / m[j][j];
		}
		for (int k = 0; k < i; k++)
			b[i] -= m[i][k] * b[k];
		b[i] /= m[i][i];
	}
	for (int i = N - 1; i >= 0; i--) {
		for (int k = i + 1; k < N; k++)
			b[i] -= m[k][i] * b[k];
		b[i] /= m[i][i];
	}
}

/* The rate of change of a state: r->q = dq/dt, r->qd = dqd/dt. */
static void rate(const struct state *s, const double tau[N], const double damping[N], struct state *r)
{
	double m[N][N], bias[N];

	mass_matrix(s->q, m);
	PLANT_RNEA(s->q, s->qd, ZERO, bias);
	for (int i = 0; i < N; i++) {
		r->q[i] = s->qd[i];
		r->qd[i] = tau[i] - damping[i] * s->qd[i] - bias[i];
	}
	cholesky_solve(m, r->qd);
}

static struct state along(const struct state *s, const struct state *r, double dt)
{
	struct state t;

	for (int i = 0; i < N; i++) {
		t.q[i] = s->q[i] + dt * r->q[i];
		t.qd[i] = s->qd[i] + dt * r->qd[i];
	}
	return t;
}

/* One step of the classical Runge-Kutta method of order 4. */
static void step(struct state *s, const double tau[N], const double damping[N], double dt)
{
	struct state a, b, c, d, t;

	rate(s, tau, damping, &a);
	t = along(s, &a, dt / 2);
	rate(&t, tau, damping, &b);
	t = along(s, &b, dt / 2);
	rate(&t, tau, damping, &c);
	t = along(s, &c, dt);
	rate(&t, tau, damping, &d);
	*s = along(s, &a, dt / 6);
	*s = along(s, &b, dt / 3);
	*s = along(s, &c, dt / 3);
	*s = along(s, &d, dt / 6);
}

/* The wrist is quick: 0.001 kg m^2 against 0.5 N m s/rad is a time constant of 2 ms. */
void plant_move(struct state *s, const double tau[N], const double damping[N], double dt)
{
	enum { STEPS = 4 };

	for (int i = 0; i < STEPS; i++)
		step(s, tau, damping, dt / STEPS);
}
