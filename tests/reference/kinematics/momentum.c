#include "reference/kinematics/momentum.h"

#include <stdlib.h>
#include <string.h>

#include "reference/forward.h"
#include "reference/read.h"

static bool moves(const struct reference *r, const char *held, int entry)
{
	for (int i = entry; i >= 0; i = r->joints[i].parent) {
		const struct reference_joint *j = &r->joints[i];

		if (j->type != REFERENCE_FIXED && !(held && held[r->joints[j->driver].iv]))
			return true;
	}
	return false;
}

// A frame at the centre of mass of a link, and its inertia about that.
struct lump {
	wide mass, inertia[3][3];
	struct reference_frame centre;
};

static struct lump lump_of(const struct reference *r, int entry)
{
	struct lump l = {.centre = {entry, reference_shift(0, 0, 0)}};
	wide p[10], c[3] = {0}, square = 0;

	reference_inertia(r, entry, p);
	l.mass = p[0];
	for (int i = 0; i < 3 && p[0] != 0; i++) {
		c[i] = p[1 + i] / p[0];
		square += c[i] * c[i];
	}
	const wide about[3][3] = {{p[4], p[5], p[6]}, {p[5], p[7], p[8]}, {p[6], p[8], p[9]}};

	for (int i = 0; i < 9; i++)
		l.inertia[i / 3][i % 3] = about[i / 3][i % 3] - p[0] * ((i / 3 == i % 3 ? square : 0) - c[i / 3] * c[i % 3]);
	l.centre.at = reference_shift(c[0], c[1], c[2]);
	return l;
}

wide reference_com(const struct reference *r, const char *held, const wide *q, wide c[3])
{
	wide mass = 0, sum[3] = {0};

	for (int i = 0; i < r->nj; i++) {
		const struct lump l = lump_of(r, i);
		const struct reference_pose t = reference_pose(r, &l.centre, q);

		if (!moves(r, held, i))
			continue;
		mass += l.mass;
		for (int k = 0; k < 3; k++)
			sum[k] += l.mass * t.m[k][3];
	}
	for (int k = 0; k < 3 && mass > 0; k++)
		c[k] = sum[k] / mass;
	return mass;
}

static void cross(const wide *a, const wide *b, wide *out)
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

// One link and one column of its Jacobian (v, w): (m v, R I R^T w + m (p - c) x v).
static void add_link(const struct lump *l, const struct reference_pose *t, const wide *c, const wide *J, int nv, wide *A)
{
	wide v[3], arm[3], moment[3], local[3] = {0}, turned[3] = {0};

	for (int i = 0; i < 3; i++) {
		v[i] = J[i * nv];
		arm[i] = l->mass * (t->m[i][3] - c[i]);
		for (int k = 0; k < 3; k++)
			local[i] += t->m[k][i] * J[(3 + k) * nv];
	}
	for (int i = 0; i < 9; i++)
		turned[i / 3] += l->inertia[i / 3][i % 3] * local[i % 3];
	cross(arm, v, moment);
	for (int i = 0; i < 3; i++) {
		A[i * nv] += l->mass * v[i];
		A[(3 + i) * nv] += moment[i] + t->m[i][0] * turned[0] + t->m[i][1] * turned[1] + t->m[i][2] * turned[2];
	}
}

void reference_momentum_matrix(const struct reference *r, const char *held, const wide *q, wide *A)
{
	wide *J = raw_memory(NULL, 6 * (size_t)r->nv, sizeof *J), c[3] = {0};

	reference_com(r, held, q, c);
	memset(A, 0, 6 * (size_t)r->nv * sizeof *A);
	for (int i = 0; i < r->nj; i++) {
		const struct lump l = lump_of(r, i);
		const struct reference_pose t = reference_pose(r, &l.centre, q);

		if (!moves(r, held, i))
			continue;
		reference_jacobian(r, &l.centre, REFERENCE_ALIGNED, q, J);
		for (int k = 0; k < r->nv; k++)
			if (!held || !held[k])
				add_link(&l, &t, c, J + k, r->nv, A + k);
	}
	free(J);
}

void reference_com_jacobian(const struct reference *r, const char *held, const wide *q, wide *J)
{
	wide *A = raw_memory(NULL, 6 * (size_t)r->nv, sizeof *A), c[3], mass = reference_com(r, held, q, c);

	reference_momentum_matrix(r, held, q, A);
	for (int k = 0; k < 3 * r->nv; k++)
		J[k] = A[k] / mass;
	free(A);
}

// ---- rates ----

struct moving {
	struct reference *r;
	const struct reference *seen;
	const char *held;
	wide *A;
};

static void momentum(void *context, const wide *q, const wide *qd, wide *out)
{
	const struct moving *m = context;

	reference_momentum_matrix(m->seen, m->held, q, m->A);
	for (int i = 0; i < 6; i++) {
		out[i] = 0;
		for (int k = 0; k < m->seen->nv; k++)
			out[i] += m->A[i * m->seen->nv + k] * qd[k];
	}
}

void reference_momentum_rate(const struct reference *r, const char *held, const wide *q, const wide *qd, const wide *qdd,
                             wide out[6])
{
	struct moving m = {.seen = r, .held = held, .A = raw_memory(NULL, 6 * (size_t)r->nv, sizeof(wide))};

	reference_rate(r, q, qd, qdd, momentum, &m, 6, out);
	free(m.A);
}

static void mass(void *context, const wide *q, const wide *qd, wide *out)
{
	const struct moving *m = context;

	(void)qd;
	reference_mass(m->r, m->held, q, out);
}

void reference_mass_rate(struct reference *r, const char *held, const wide *q, const wide *qd, wide *out)
{
	struct moving m = {.r = r, .held = held};
	wide *none = raw_memory(NULL, (size_t)r->nv, sizeof *none);

	memset(none, 0, (size_t)r->nv * sizeof *none);
	reference_rate(r, q, qd, none, mass, &m, r->nv * r->nv, out);
	free(none);
}
