#include "solved.h"
#include "reference/read.h"
#include "support/numbers.h"
#include <check.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

/* The file's friction, as it is read for the reference too. */
static void read_friction(struct solved *x, const char *urdf)
{
	struct raw_robot raw;
	char message[256];

	ck_assert(raw_read(&raw, urdf, strlen(urdf), true, message, sizeof message));
	for (int j = 0; j < x->table->nj; j++)
		for (int k = 0; k < raw.njoints && x->table->joints[j].nv == 1; k++)
			if (!strcmp(raw.joints[k].name, x->table->joints[j].name))
				x->friction[x->table->joints[j].iv] = (__float128)raw.joints[k].friction;
	raw_free(&raw);
}

void solved_open(struct solved *x, const char *urdf, int floating, __float128 width, __float128 armature, const char *what)
{
	struct reference_options o = {.floating = floating, .decimals = true};
	char message[256];

	*x = (struct solved){.width = width};
	x->table = reference_open(urdf, strlen(urdf), &o, message, sizeof message);
	ck_assert_msg(x->table != NULL, "%s: %s", what, message);
	x->quad = quad_open(urdf, strlen(urdf), floating, 0, QUAD_DECIMALS, (double[]){0, 0, -9.81}, NULL,
		message, sizeof message);
	ck_assert_msg(x->quad != NULL, "%s: %s", what, message);
	quad_set_gravity(x->quad, (__float128[]){0, 0, -9.81Q});
	x->nq = x->table->nq;
	x->nv = x->table->nv;
	x->M = numbers_new(x->nv * x->nv, sizeof(__float128));
	x->rhs = numbers_new(x->nv, sizeof(__float128));
	x->unit = numbers_new(x->nv, sizeof(__float128));
	x->bias = numbers_new(x->nv, sizeof(__float128));
	x->friction = numbers_new(x->nv, sizeof(__float128));
	x->armature = numbers_new(x->nv, sizeof(__float128));
	for (int i = 0; i < 3; i++)
		x->wide[i] = numbers_new(x->nq, sizeof(__float128));
	if (width > 0)
		read_friction(x, urdf);
	for (int j = 0; j < x->table->nj; j++)
		if (x->table->joints[j].nv == 1)
			x->armature[x->table->joints[j].iv] = armature;
}

void solved_close(struct solved *x)
{
	__float128 *all[] = {x->M, x->rhs, x->unit, x->bias, x->friction, x->armature, x->wide[0], x->wide[1], x->wide[2]};

	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
	quad_close(x->quad);
	reference_close(x->table);
}

void solved_draw(const struct solved *x, struct rng *rng, double *q, double *qd, double *qdd)
{
	reference_sample(x->table, rng, true, q, qd, qdd);
	for (int j = 0; j < x->table->nj; j++)
		for (int i = 3; i < 7 && x->table->joints[j].type == REFERENCE_FLOATING; i++)
			q[x->table->joints[j].iq + i] = rng_chance(rng, 0.5) ? 0.5 : -0.5;
}

/* What joints take beside the links. */
static __float128 own(const struct solved *x, int row, __float128 v, __float128 a)
{
	__float128 rotor = x->armature[row] * a;

	return x->width > 0 ? rotor + x->friction[row] * v / sqrtq(v * v + x->width * x->width) : rotor;
}

static void torques(struct solved *x, const double *q, const double *qd, const __float128 *qdd, __float128 *tau)
{
	for (int i = 0; i < x->nq; i++)
		x->wide[0][i] = (__float128)q[i];
	for (int i = 0; i < x->nv; i++)
		x->wide[1][i] = (__float128)qd[i];
	quad_rnea_wide(x->quad, x->wide[0], x->wide[1], qdd, tau);
	for (int i = 0; i < x->nv; i++)
		tau[i] += own(x, i, (__float128)qd[i], qdd[i]);
}

void solved_torques(struct solved *x, const double *q, const double *qd, const double *qdd, __float128 *tau)
{
	for (int i = 0; i < x->nv; i++)
		x->wide[2][i] = (__float128)qdd[i];
	torques(x, q, qd, x->wide[2], tau);
}

/* M is positive definite: no rows change places. */
static void eliminate(int n, __float128 *M, __float128 *b)
{
	for (int k = 0; k < n; k++)
		for (int i = k + 1; i < n; i++) {
			__float128 by = M[i * n + k] / M[k * n + k];

			for (int j = k; j < n; j++)
				M[i * n + j] -= by * M[k * n + j];
			b[i] -= by * b[k];
		}
	for (int k = n; k-- > 0;) {
		for (int j = k + 1; j < n; j++)
			b[k] -= M[k * n + j] * b[j];
		b[k] /= M[k * n + k];
	}
}

void solved_accelerations(struct solved *x, const double *q, const double *qd, const double *tau, __float128 *qdd)
{
	int n = x->nv;

	memset(x->unit, 0, (size_t)n * sizeof *x->unit);
	torques(x, q, qd, x->unit, x->bias);
	for (int j = 0; j < n; j++) {
		x->unit[j] = 1;
		torques(x, q, qd, x->unit, x->rhs);
		x->unit[j] = 0;
		for (int i = 0; i < n; i++)
			x->M[i * n + j] = x->rhs[i] - x->bias[i];
	}
	for (int i = 0; i < n; i++)
		qdd[i] = (__float128)tau[i] - x->bias[i];
	eliminate(n, x->M, qdd);
}
