#include "reference/dense6.h"

struct d3_mat d3_identity(void)
{
	return (struct d3_mat){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

struct d3_mat d3_mul(struct d3_mat a, struct d3_mat b)
{
	struct d3_mat c = {0};

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				c.m[i][j] += a.m[i][k] * b.m[k][j];
	return c;
}

struct d3_mat d3_transpose(struct d3_mat a)
{
	struct d3_mat t;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			t.m[j][i] = a.m[i][j];
	return t;
}

struct d3_vec d3_apply(struct d3_mat a, struct d3_vec b)
{
	struct d3_vec c = {0};

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			c.x[i] += a.m[i][k] * b.x[k];
	return c;
}

struct d3_mat d3_cross(struct d3_vec v)
{
	return (struct d3_mat){{{0, -v.x[2], v.x[1]}, {v.x[2], 0, -v.x[0]}, {-v.x[1], v.x[0], 0}}};
}

struct d3_mat d3_about(struct d3_vec axis, wide s, wide c)
{
	struct d3_mat n = d3_cross(axis), n2 = d3_mul(n, n), r = d3_identity();

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			r.m[i][j] += s * n.m[i][j] + (1 - c) * n2.m[i][j];
	return r;
}

static void sincos_snapped(wide angle, wide *s, wide *c)
{
	static const int sines[4] = {0, 1, 0, -1};
	wide right = WIDE_PI / 2, k = wide_round(angle / right);

	if (wide_abs(k) < WIDE_C(1e15) && wide_abs(angle - k * right) <= WIDE_C(5e-15)) {
		unsigned quarter = (unsigned)(long long)k & 3;

		*s = sines[quarter];
		*c = sines[(quarter + 1) & 3];
	} else {
		*s = wide_sin(angle);
		*c = wide_cos(angle);
	}
}

struct d3_mat d3_rpy(const wide rpy[3])
{
	wide s[3], c[3];

	for (int i = 0; i < 3; i++)
		sincos_snapped(rpy[i], &s[i], &c[i]);
	struct d3_mat x = {{{1, 0, 0}, {0, c[0], -s[0]}, {0, s[0], c[0]}}};
	struct d3_mat y = {{{c[1], 0, s[1]}, {0, 1, 0}, {-s[1], 0, c[1]}}};
	struct d3_mat z = {{{c[2], -s[2], 0}, {s[2], c[2], 0}, {0, 0, 1}}};

	return d3_mul(z, d3_mul(y, x));
}

struct d3_mat d3_quaternion(const wide q[4])
{
	wide x = q[0], y = q[1], z = q[2], w = q[3];

	return (struct d3_mat){{
		{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
		{2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
		{2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
	}};
}

struct d6_mat d6_identity(void)
{
	struct d6_mat a = {0};

	for (int i = 0; i < 6; i++)
		a.m[i][i] = 1;
	return a;
}

struct d6_mat d6_mul(struct d6_mat a, struct d6_mat b)
{
	struct d6_mat c = {0};

	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			for (int k = 0; k < 6; k++)
				c.m[i][j] += a.m[i][k] * b.m[k][j];
	return c;
}

struct d6_vec d6_apply(struct d6_mat a, struct d6_vec b)
{
	struct d6_vec c = {0};

	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++)
			c.x[i] += a.m[i][k] * b.x[k];
	return c;
}

struct d6_vec d6_apply_transpose(struct d6_mat a, struct d6_vec b)
{
	struct d6_vec c = {0};

	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++)
			c.x[i] += a.m[k][i] * b.x[k];
	return c;
}

struct d6_vec d6_add(struct d6_vec a, struct d6_vec b)
{
	for (int i = 0; i < 6; i++)
		a.x[i] += b.x[i];
	return a;
}

struct d6_mat d6_abs(struct d6_mat a)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			a.m[i][j] = wide_abs(a.m[i][j]);
	return a;
}

struct d6_vec d6_abs_vec(struct d6_vec a)
{
	for (int i = 0; i < 6; i++)
		a.x[i] = wide_abs(a.x[i]);
	return a;
}

static void block(struct d6_mat *a, int row, int column, struct d3_mat b, wide factor)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			a->m[row + i][column + j] += factor * b.m[i][j];
}

struct d6_mat d6_transform(struct d3_mat r, struct d3_vec p)
{
	struct d3_mat e = d3_transpose(r);
	struct d6_mat x = {0};

	block(&x, 0, 0, e, 1);
	block(&x, 0, 3, d3_mul(e, d3_cross(p)), -1);
	block(&x, 3, 3, e, 1);
	return x;
}

struct d6_mat d6_cross(struct d6_vec v)
{
	struct d3_mat linear = d3_cross((struct d3_vec){{v.x[0], v.x[1], v.x[2]}});
	struct d3_mat angular = d3_cross((struct d3_vec){{v.x[3], v.x[4], v.x[5]}});
	struct d6_mat x = {0};

	block(&x, 0, 0, angular, 1);
	block(&x, 0, 3, linear, 1);
	block(&x, 3, 3, angular, 1);
	return x;
}

struct d6_mat d6_inertia(wide mass, struct d3_vec c, struct d3_mat ic)
{
	struct d3_mat cross = d3_cross(c);
	struct d6_mat inertia = {0};

	block(&inertia, 0, 0, d3_identity(), mass);
	block(&inertia, 0, 3, cross, -mass);
	block(&inertia, 3, 0, cross, mass);
	block(&inertia, 3, 3, ic, 1);
	block(&inertia, 3, 3, d3_mul(cross, cross), -mass);
	return inertia;
}
