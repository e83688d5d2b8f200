#include "spatial.h"
#include <math.h>

#define PI_HALF 1.57079632679489661923132169163975144L

const struct rotation ROTATION_IDENTITY = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

void sum_add(struct sum *s, real term)
{
	s->value += term;
	s->size += fabsl(term);
}

real sum_real(struct sum s)
{
	return fabsl(s.value) <= 4 * 0x1p-53L * s.size ? 0 : s.value;
}

void angle_sincos(real angle, real *s, real *c)
{
	static const real quarter_sin[4] = {0, 1, 0, -1};
	real turns = roundl(angle / PI_HALF);

	if (fabsl(angle - turns * PI_HALF) <= 5e-15L) {
		int quarter = (int)(fmodl(turns, 4) + 4) % 4;
		*s = quarter_sin[quarter];
		*c = quarter_sin[(quarter + 1) % 4];
	} else {
		*s = sinl(angle);
		*c = cosl(angle);
	}
}

struct rotation rotation_about(int axis, real angle)
{
	struct rotation r = ROTATION_IDENTITY;
	int j = (axis + 1) % 3, k = (axis + 2) % 3;
	real s, c;

	angle_sincos(angle, &s, &c);
	r.m[j][j] = c;
	r.m[j][k] = -s;
	r.m[k][j] = s;
	r.m[k][k] = c;
	return r;
}

struct rotation rotation_rpy(const double rpy[3])
{
	struct rotation x = rotation_about(0, rpy[0]), y = rotation_about(1, rpy[1]), z = rotation_about(2, rpy[2]);
	struct rotation zy = rotation_mul(&z, &y);

	return rotation_mul(&zy, &x);
}

/* Columns x, n cross x, n for a unit vector x normal to n. */
static struct rotation rotation_from_x_and_z(const real x[3], const real n[3])
{
	struct rotation r;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct sum y = {0};

		sum_add(&y, n[j] * x[k]);
		sum_add(&y, -n[k] * x[j]);
		r.m[i][0] = x[i];
		r.m[i][1] = sum_real(y);
		r.m[i][2] = n[i];
	}
	return r;
}

struct rotation rotation_to_axis(const real n[3])
{
	real x[3] = {0, 0, 0};
	int e = 0;

	for (int i = 1; i < 3; i++)
		if (fabsl(n[i]) < fabsl(n[e]))
			e = i;
	if (n[e] == 0) {
		x[e] = 1; /* n lies in the plane normal to e: turning about e suffices */
	} else {
		int j = (e + 1) % 3, k = (e + 2) % 3;
		real length = sqrtl(n[j] * n[j] + n[k] * n[k]);

		x[j] = -n[k] / length; /* e cross n: a zero at e */
		x[k] = n[j] / length;
	}
	return rotation_from_x_and_z(x, n);
}

/* Rodrigues' formula for axis z cross n = (-ny, nx, 0) with cosine nz, where c = 1/(1+nz), which near -z cancels and is
   (1-nz)/(nx nx + ny ny) there:
   R = [1 - c nx nx, -c nx ny, nx; -c nx ny, 1 - c ny ny, ny; -nx, -ny, nz] */
struct rotation rotation_shortest(const real n[3])
{
	real square = n[0] * n[0] + n[1] * n[1];
	real c = n[2] < 0 ? (1 - n[2]) / square : 1 / (1 + n[2]);

	if (square == 0 && n[2] < 0)
		return (struct rotation){{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
	return (struct rotation){{
		{1 - c * n[0] * n[0], -c * n[0] * n[1], n[0]},
		{-c * n[0] * n[1], 1 - c * n[1] * n[1], n[1]},
		{-n[0], -n[1], n[2]},
	}};
}

/* 1 - 2 (u_j^2 + u_k^2) on the diagonal, 2 (u_j u_k -+ u_i w) beside it */
struct rotation rotation_quaternion(const real q[4])
{
	real norm = sqrtl(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), u[4];
	struct rotation R;

	for (int i = 0; i < 4; i++)
		u[i] = q[i] / norm;
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		R.m[i][i] = 1 - 2 * (u[j] * u[j] + u[k] * u[k]);
		R.m[j][k] = 2 * (u[j] * u[k] - u[i] * u[3]);
		R.m[k][j] = 2 * (u[j] * u[k] + u[i] * u[3]);
	}
	return R;
}

struct rotation rotation_mul(const struct rotation *a, const struct rotation *b)
{
	struct rotation r;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			struct sum s = {0};

			for (int k = 0; k < 3; k++)
				sum_add(&s, a->m[i][k] * b->m[k][j]);
			r.m[i][j] = sum_real(s);
		}
	return r;
}

struct rotation rotation_transpose(const struct rotation *a)
{
	struct rotation r;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			r.m[i][j] = a->m[j][i];
	return r;
}

void rotation_apply(const struct rotation *r, const real v[3], real out[3])
{
	real w[3];

	for (int i = 0; i < 3; i++) {
		struct sum s = {0};

		for (int k = 0; k < 3; k++)
			sum_add(&s, r->m[i][k] * v[k]);
		w[i] = sum_real(s);
	}
	for (int i = 0; i < 3; i++)
		out[i] = w[i];
}

int rotation_is_identity(const struct rotation *r)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (r->m[i][j] != (i == j))
				return 0;
	return 1;
}

struct placement placement_mul(const struct placement *a, const struct placement *b)
{
	struct placement c = {.R = rotation_mul(&a->R, &b->R)};

	for (int i = 0; i < 3; i++) {
		struct sum s = {0};

		for (int k = 0; k < 3; k++)
			sum_add(&s, a->R.m[i][k] * b->p[k]);
		sum_add(&s, a->p[i]);
		c.p[i] = sum_real(s);
	}
	return c;
}

int inertia_index(int i, int j)
{
	static const int index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

	return index[i][j];
}

/* One element of m (c.c 1 - c c^T). */
static void add_parallel_axis(struct sum *s, int i, int j, real mass, const real c[3])
{
	if (i != j) {
		sum_add(s, -mass * c[i] * c[j]);
		return;
	}
	for (int k = 0; k < 3; k++)
		if (k != i)
			sum_add(s, mass * c[k] * c[k]);
}

void inertia_add(struct inertia_sum *s, const struct placement *X, double mass, const double com[3],
	const double rpy[3], const double inertia[6])
{
	struct placement local = {.R = rotation_rpy(rpy), .p = {com[0], com[1], com[2]}};
	struct placement at = placement_mul(X, &local);

	sum_add(&s->mass, mass);
	for (int i = 0; i < 3; i++) {
		sum_add(&s->h[i], (real)mass * at.p[i]);
		for (int j = i; j < 3; j++) {
			struct sum *e = &s->I[inertia_index(i, j)];

			for (int k = 0; k < 3; k++)
				for (int l = 0; l < 3; l++)
					sum_add(e, at.R.m[i][k] * at.R.m[j][l] * (real)inertia[inertia_index(k, l)]);
			add_parallel_axis(e, i, j, mass, at.p);
		}
	}
}

struct inertia inertia_total(const struct inertia_sum *s)
{
	struct inertia t = {.mass = sum_real(s->mass)};

	for (int i = 0; i < 3; i++)
		t.h[i] = sum_real(s->h[i]);
	for (int i = 0; i < 6; i++)
		t.I[i] = sum_real(s->I[i]);
	return t;
}
