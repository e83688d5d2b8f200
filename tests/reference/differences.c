#include "reference/differences.h"

#include <string.h>

// A twist of a floating joint, one unit along `row` (linear, then angular, in its own frame), for the time h:
// x += h R e, (u, s) += (h/2)(s e + u x e, -u.e).
static void move_floating(wide *x, int row, wide h)
{
	wide u[3] = {x[3], x[4], x[5]}, s = x[6];
	const wide R[3][3] = {
		{1 - 2 * (u[1] * u[1] + u[2] * u[2]), 2 * (u[0] * u[1] - u[2] * s), 2 * (u[0] * u[2] + u[1] * s)},
		{2 * (u[0] * u[1] + u[2] * s), 1 - 2 * (u[0] * u[0] + u[2] * u[2]), 2 * (u[1] * u[2] - u[0] * s)},
		{2 * (u[0] * u[2] - u[1] * s), 2 * (u[1] * u[2] + u[0] * s), 1 - 2 * (u[0] * u[0] + u[1] * u[1])}};
	int a = row % 3, b = (a + 1) % 3, c = (a + 2) % 3;

	if (row < 3) {
		for (int i = 0; i < 3; i++)
			x[i] += h * R[i][row];
		return;
	}
	x[3 + a] += h / 2 * s;
	x[3 + b] += h / 2 * u[c];
	x[3 + c] -= h / 2 * u[b];
	x[6] -= h / 2 * u[a];
}

void reference_move(const struct reference *r, int j, wide h, wide *q)
{
	for (int e = 0; e < r->nj; e++) {
		const struct reference_joint *k = &r->joints[e];

		if (k->nv == 0 || j < k->iv || j >= k->iv + k->nv)
			continue;
		if (k->type == REFERENCE_FLOATING)
			move_floating(q + k->iq, j - k->iv, h);
		else
			q[k->iq + j - k->iv] += h;
		return;
	}
}

struct point {
	wide *q, *qd, *qdd; // a state, in the working memory
	wide *ahead, *behind; // its torques
};

static void widen(const double *from, int n, wide *to)
{
	for (int i = 0; i < n; i++)
		to[i] = from[i];
}

static void column(const struct reference *r, const struct point *p, int j, wide distance, wide *to)
{
	for (int i = 0; i < r->nv; i++)
		to[i * r->nv + j] = (p->ahead[i] - p->behind[i]) / distance;
}

// M e_j = ID(q, 0, e_j) - ID(q, 0, 0)
static void mass_columns(struct reference *r, struct point *p, wide *M)
{
	memset(p->qd, 0, (size_t)r->nv * sizeof *p->qd);
	memset(p->qdd, 0, (size_t)r->nv * sizeof *p->qdd);
	reference_rnea_wide(r, p->q, p->qd, p->qdd, p->behind);
	for (int j = 0; j < r->nv; j++) {
		p->qdd[j] = 1;
		reference_rnea_wide(r, p->q, p->qd, p->qdd, p->ahead);
		column(r, p, j, 1, M);
		p->qdd[j] = 0;
	}
}

void reference_differences(struct reference *r, const double *q, const double *qd, const double *qdd, wide *dq,
                           wide *dqd, wide *M, wide *work)
{
	wide *rows = work + r->nq;
	struct point p = {work, rows, rows + r->nv, rows + 2 * r->nv, rows + 3 * r->nv};
	const wide h = DIFFERENCE_STEP;

	widen(q, r->nq, p.q);
	widen(qd, r->nv, p.qd);
	widen(qdd, r->nv, p.qdd);
	for (int j = 0; j < r->nv; j++) {
		reference_move(r, j, h, p.q);
		reference_rnea_wide(r, p.q, p.qd, p.qdd, p.ahead);
		widen(q, r->nq, p.q);
		reference_move(r, j, -h, p.q);
		reference_rnea_wide(r, p.q, p.qd, p.qdd, p.behind);
		widen(q, r->nq, p.q);
		column(r, &p, j, 2 * h, dq);
		p.qd[j] = qd[j] + h;
		reference_rnea_wide(r, p.q, p.qd, p.qdd, p.ahead);
		p.qd[j] = qd[j] - h;
		reference_rnea_wide(r, p.q, p.qd, p.qdd, p.behind);
		p.qd[j] = qd[j];
		column(r, &p, j, 2 * h, dqd);
	}
	mass_columns(r, &p, M);
}
