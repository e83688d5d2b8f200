#include "quad.h"
#include "reference/reference.h"
#include "reference/oracle.h"
#include "reference/forward.h"
#include <stdlib.h>

#define VISIBLE __attribute__((visibility("default")))

struct quad {
	struct reference *reference;
	wide *out;
};

VISIBLE struct quad *quad_open(const char *urdf, size_t length, int floating, int independent, enum quad_numbers numbers,
	const double gravity[3], const char *order, char *message, size_t size)
{
	struct reference_options o = {
		.floating = floating, .independent = independent, .decimals = numbers == QUAD_DECIMALS, .gravity = gravity,
		.order = order};
	struct quad *x = calloc(1, sizeof *x);

	if (!x)
		abort();
	x->reference = reference_open(urdf, length, &o, message, size);
	if (!x->reference) {
		free(x);
		return NULL;
	}
	x->out = calloc((size_t)x->reference->nv + 1, sizeof *x->out);
	if (!x->out)
		abort();
	return x;
}

VISIBLE void quad_close(struct quad *x)
{
	reference_close(x->reference);
	free(x->out);
	free(x);
}

VISIBLE void quad_rnea(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *tau)
{
	reference_rnea(x->reference, q, qd, qdd, tau);
}

VISIBLE void quad_rnea_wide(
	struct quad *x, const __float128 *q, const __float128 *qd, const __float128 *qdd, __float128 *tau)
{
	reference_rnea_wide(x->reference, q, qd, qdd, tau);
}

VISIBLE void quad_set_gravity(struct quad *x, const __float128 gravity[3])
{
	for (int i = 0; i < 3; i++)
		x->reference->gravity[i] = gravity[i];
}

VISIBLE void quad_magnitude(struct quad *x, const double *q, const double *qd, const double *qdd, double *size)
{
	reference_magnitude(x->reference, q, qd, qdd, x->out);
	for (int i = 0; i < x->reference->nv; i++)
		size[i] = (double)x->out[i];
}

/* Half of what two states are apart: what is neglected is below 1e-20 of the terms, and so is what rounding takes. */
static const wide STEP = WIDE_C(1e-11);

enum { BY_Q, BY_QD, BY_QDD };

/* A state of three arrays, moved by h along row j of q's tangent space, of qd or of qdd. */
static void move(const struct reference *r, const double *const *state, int by, int j, wide h, wide *const *to)
{
	wide *unit = calloc(3 * (size_t)r->nv + (size_t)r->nq, sizeof *unit), *none = unit + r->nv, *q = unit + 3 * r->nv;

	if (!unit)
		abort();
	for (int i = 0; i < r->nq; i++)
		q[i] = state[0][i];
	unit[j] = by == BY_Q;
	oracle_move(r, q, unit, none, h, to[0]);
	for (int i = 0; i < r->nv; i++) {
		to[1][i] = state[1][i] + (by == BY_QD && i == j ? h : 0);
		to[2][i] = state[2][i] + (by == BY_QDD && i == j ? h : 0);
	}
	free(unit);
}

/* Column j. */
static void difference(struct quad *x, const double *const *state, int by, int j, wide *const *room, wide *out)
{
	int nv = x->reference->nv;

	for (int side = 1; side >= -1; side -= 2) {
		move(x->reference, state, by, j, (wide)side * STEP, room);
		reference_rnea_wide(x->reference, room[0], room[1], room[2], x->out);
		for (int i = 0; i < nv; i++)
			out[i * nv + j] = (side > 0 ? x->out[i] : out[i * nv + j] - x->out[i]) / (side > 0 ? 1 : 2 * STEP);
	}
}

VISIBLE void quad_derivatives(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *dq,
	__float128 *dqd, __float128 *M)
{
	int nq = x->reference->nq, nv = x->reference->nv;
	wide *room = calloc((size_t)nq + 2 * (size_t)nv, sizeof *room);

	if (!room)
		abort();
	for (int j = 0; j < nv; j++)
		for (int by = BY_Q; by <= BY_QDD; by++)
			difference(x, (const double *[]){q, qd, qdd}, by, j, (wide *[]){room, room + nq, room + nq + nv},
				by == BY_Q ? dq : by == BY_QD ? dqd : M);
	free(room);
}

static wide *widened(const double *from, int n, size_t room)
{
	wide *x = calloc((size_t)n + room, sizeof *x);

	if (!x)
		abort();
	for (int i = 0; i < n; i++)
		x[i] = from[i];
	return x;
}

VISIBLE int quad_forward(struct quad *x, const double *q, const double *qd, const double *tau, __float128 *qdd)
{
	struct reference *r = x->reference;
	wide *p = widened(q, r->nq, 0), *v = widened(qd, r->nv, 0), *t = widened(tau, r->nv, (size_t)r->nv * (size_t)r->nv);
	int is_definite = reference_inverse(r, NULL, p, t + r->nv) > 0;

	if (is_definite)
		reference_forward(r, t + r->nv, p, v, t, qdd);
	free(p);
	free(v);
	free(t);
	return is_definite;
}

VISIBLE double quad_condition(struct quad *x, const double *q)
{
	struct reference *r = x->reference;
	wide *p = widened(q, r->nq, (size_t)r->nv * (size_t)r->nv);
	double condition;

	reference_mass(r, NULL, p, p + r->nq);
	condition = (double)reference_condition(r->nv, p + r->nq);
	free(p);
	return condition;
}
