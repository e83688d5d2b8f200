#include "reference/forward.h"

#include <stdlib.h>
#include <string.h>

#include "reference/differences.h"

static wide *numbers(size_t count)
{
	wide *x = calloc(count + 1, sizeof *x);

	if (!x)
		abort();
	return x;
}

static int is_held(const char *held, int row)
{
	return held && held[row];
}

void reference_mass(struct reference *r, const char *held, const wide *q, wide *M)
{
	int n = r->nv;
	wide *none = numbers(4 * (size_t)n), *unit = none + n, *with = none + 2 * n, *without = none + 3 * n;

	reference_rnea_wide(r, q, none, none, without);
	for (int j = 0; j < n; j++) {
		unit[j] = 1;
		reference_rnea_wide(r, q, none, unit, with);
		unit[j] = 0;
		for (int i = 0; i < n; i++)
			M[i * n + j] = is_held(held, i) || is_held(held, j) ? i == j : with[i] - without[i];
	}
	free(none);
}

// L below the diagonal of a, D on it; the least pivot in parts of its diagonal element.
static wide factor(int n, wide *a)
{
	wide least = 1;

	for (int j = 0; j < n; j++) {
		wide diagonal = a[j * n + j];

		for (int k = 0; k < j; k++)
			a[j * n + j] -= a[j * n + k] * a[j * n + k] * a[k * n + k];
		if (!(a[j * n + j] > 0))
			return 0;
		least = a[j * n + j] < least * diagonal ? a[j * n + j] / diagonal : least;
		for (int i = j + 1; i < n; i++) {
			for (int k = 0; k < j; k++)
				a[i * n + j] -= a[i * n + k] * a[j * n + k] * a[k * n + k];
			a[i * n + j] /= a[j * n + j];
		}
	}
	return least;
}

static void solve(int n, const wide *a, wide *x)
{
	for (int i = 0; i < n; i++)
		for (int k = 0; k < i; k++)
			x[i] -= a[i * n + k] * x[k];
	for (int i = 0; i < n; i++)
		x[i] /= a[i * n + i];
	for (int i = n - 1; i >= 0; i--)
		for (int k = i + 1; k < n; k++)
			x[i] -= a[k * n + i] * x[k];
}

wide reference_inverse(struct reference *r, const char *held, const wide *q, wide *X)
{
	int n = r->nv;
	wide *a = numbers((size_t)(n * n + n)), *column = a + n * n, least;

	reference_mass(r, held, q, a);
	least = factor(n, a);
	for (int j = 0; j < n && least > 0; j++) {
		memset(column, 0, (size_t)n * sizeof *column);
		column[j] = !is_held(held, j);
		solve(n, a, column);
		for (int i = 0; i < n; i++)
			X[i * n + j] = column[i];
	}
	free(a);
	return least;
}

void reference_forward(struct reference *r, const wide *X, const wide *q, const wide *qd, const wide *tau, wide *qdd)
{
	int n = r->nv;
	wide *is = numbers((size_t)n);

	memset(qdd, 0, (size_t)n * sizeof *qdd);
	for (int again = 0; again < 3; again++) {
		reference_rnea_wide(r, q, qd, qdd, is);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++)
				qdd[i] += X[i * n + j] * (tau[j] - is[j]);
	}
	free(is);
}

struct state {
	struct reference *r;
	const char *held;
	const wide *tau;
	wide *X;
};

static void column(const struct state *s, const wide *q, const wide *qd, wide factor, int j, wide *qdd, wide *to)
{
	int n = s->r->nv;

	reference_inverse(s->r, s->held, q, s->X);
	reference_forward(s->r, s->X, q, qd, s->tau, qdd);
	for (int i = 0; i < n; i++)
		to[i * n + j] += factor * qdd[i];
}

void reference_forward_differences(struct reference *r, const char *held, const wide *q, const wide *qd,
                                   const wide *tau, wide *dq, wide *dqd)
{
	size_t nq = (size_t)r->nq, n = (size_t)r->nv;
	wide *p = numbers(nq + 2 * n + n * n), *v = p + nq, *qdd = v + n;
	const struct state s = {r, held, tau, qdd + n};

	memset(dq, 0, n * n * sizeof *dq);
	memset(dqd, 0, n * n * sizeof *dqd);
	memcpy(v, qd, n * sizeof *v);
	for (int j = 0; j < r->nv; j++)
		for (int side = -1; side <= 1 && !is_held(held, j); side += 2) {
			const wide h = (wide)side * DIFFERENCE_STEP;

			memcpy(p, q, nq * sizeof *p);
			reference_move(r, j, h, p);
			column(&s, p, qd, 1 / (2 * h), j, qdd, dq);
			v[j] = qd[j] + h;
			column(&s, q, v, 1 / (2 * h), j, qdd, dqd);
			v[j] = qd[j];
		}
	free(p);
}

// One rotation that makes a_pq zero (Golub and Van Loan, Matrix Computations, 8.5).
static void rotate(int n, wide *a, int p, int q)
{
	wide apq = a[p * n + q], theta, t, c, s;

	if (apq == 0)
		return;
	theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
	t = (theta < 0 ? -1 : 1) / (wide_abs(theta) + wide_sqrt(1 + theta * theta));
	c = 1 / wide_sqrt(1 + t * t);
	s = t * c;
	for (int k = 0; k < n; k++) {
		wide x = a[k * n + p], y = a[k * n + q];

		a[k * n + p] = c * x - s * y;
		a[k * n + q] = s * x + c * y;
	}
	for (int k = 0; k < n; k++) {
		wide x = a[p * n + k], y = a[q * n + k];

		a[p * n + k] = c * x - s * y;
		a[q * n + k] = s * x + c * y;
	}
}

wide reference_condition(int n, wide *M)
{
	wide most = 0, least = 0;

	for (int sweep = 0; sweep < 12; sweep++)
		for (int p = 0; p < n; p++)
			for (int q = p + 1; q < n; q++)
				rotate(n, M, p, q);
	for (int i = 0; i < n; i++) {
		most = i == 0 || M[i * n + i] > most ? M[i * n + i] : most;
		least = i == 0 || M[i * n + i] < least ? M[i * n + i] : least;
	}
	return most / least;
}
