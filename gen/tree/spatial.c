#include "tree/spatial.h"
#include <math.h>

/* As initialisers */
#define ZERO {0, 0, 0, 0, 0}
#define ONE {1, 1, 0, 0, 0}
#define MINUS_ONE {-1, -1, 0, 0, 0}

const struct rotation ROTATION_IDENTITY = {{{ONE, ZERO, ZERO}, {ZERO, ONE, ZERO}, {ZERO, ZERO, ONE}}};

static struct within product(struct within a, struct within b, struct within c)
{
	return within_mul(within_mul(a, b), c);
}

void sum_add(struct sum *s, struct within term)
{
	s->value = within_add(s->value, term);
	s->size += fabsl(term.x);
}

struct sum sum_from(struct within term)
{
	struct sum s = {0};

	sum_add(&s, term);
	return s;
}

struct within sum_total(struct sum s)
{
	struct within zero = {.limb = s.value.limb, .kind = s.value.kind};

	return fabsl(s.value.x) <= 4 * 0x1p-53L * s.size ? zero : s.value;
}

struct rotation rotation_by(int axis, struct turn angle)
{
	struct rotation r = ROTATION_IDENTITY;
	int j = (axis + 1) % 3, k = (axis + 2) % 3;

	r.m[j][j] = angle.c;
	r.m[j][k] = within_neg(angle.s);
	r.m[k][j] = angle.s;
	r.m[k][k] = angle.c;
	return r;
}

struct rotation rotation_about(int axis, struct within angle)
{
	struct turn by;

	angle_sincos(angle, &by.s, &by.c);
	return rotation_by(axis, by);
}

struct rotation rotation_rpy(const struct within rpy[3])
{
	struct rotation x = rotation_about(0, rpy[0]), y = rotation_about(1, rpy[1]), z = rotation_about(2, rpy[2]);
	struct rotation zy = rotation_mul(&z, &y);

	return rotation_mul(&zy, &x);
}

/* Columns x, n cross x, n for a unit vector x normal to n. */
static struct rotation rotation_from_x_and_z(const struct within x[3], const struct within n[3])
{
	struct rotation r;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct sum y = {0};

		sum_add(&y, within_mul(n[j], x[k]));
		sum_add(&y, within_neg(within_mul(n[k], x[j])));
		r.m[i][0] = x[i];
		r.m[i][1] = sum_total(y);
		r.m[i][2] = n[i];
	}
	return r;
}

const struct turn TURN_NONE = {ZERO, ONE};

struct turn turn_add(struct turn a, struct turn b)
{
	struct sum s = {0}, c = {0};

	sum_add(&s, within_mul(a.s, b.c));
	sum_add(&s, within_mul(a.c, b.s));
	sum_add(&c, within_mul(a.c, b.c));
	sum_add(&c, within_neg(within_mul(a.s, b.s)));
	return turn_of(c, s);
}

struct turn turn_sub(struct turn a, struct turn b)
{
	return turn_add(a, (struct turn){within_neg(b.s), b.c});
}

int turn_is_none(struct turn a)
{
	return a.s.x == 0 && a.c.x > 0;
}

static struct within length(struct within a, struct within b)
{
	return within_sqrt(within_add(within_mul(a, a), within_mul(b, b)));
}

struct turn turn_of(struct sum x, struct sum y)
{
	struct within c = sum_total(x), s = sum_total(y);

	if (s.x == 0 || c.x == 0)
		return (struct turn){within_exact((s.x > 0) - (s.x < 0)), within_exact(s.x == 0 ? (c.x < 0 ? -1 : 1) : 0)};
	return (struct turn){within_div(s, length(c, s)), within_div(c, length(c, s))};
}

struct rotation rotation_to_axis(const struct within n[3])
{
	struct within x[3] = {0};
	int e = 0;

	for (int i = 1; i < 3; i++)
		if (fabsl(n[i].x) < fabsl(n[e].x))
			e = i;
	if (n[e].x == 0) {
		x[e] = within_exact(1); /* n lies in the plane normal to e: turning about e suffices */
	} else {
		int j = (e + 1) % 3, k = (e + 2) % 3;

		x[j] = within_neg(within_div(n[k], length(n[j], n[k]))); /* e cross n: a zero at e */
		x[k] = within_div(n[j], length(n[j], n[k]));
	}
	return rotation_from_x_and_z(x, n);
}

/* Rodrigues' formula for axis z cross n = (-ny, nx, 0) with cosine nz, where c = 1/(1+nz), which near -z cancels and is
   (1-nz)/(nx nx + ny ny) there:
   R = [1 - c nx nx, -c nx ny, nx; -c nx ny, 1 - c ny ny, ny; -nx, -ny, nz] */
struct rotation rotation_shortest(const struct within n[3])
{
	const struct within one = within_exact(1);
	struct within square = within_add(within_mul(n[0], n[0]), within_mul(n[1], n[1])), c, xy;

	if (square.x == 0 && n[2].x < 0)
		return (struct rotation){{{ONE, ZERO, ZERO}, {ZERO, MINUS_ONE, ZERO}, {ZERO, ZERO, MINUS_ONE}}};
	c = n[2].x < 0 ? within_div(within_sub(one, n[2]), square) : within_div(one, within_add(one, n[2]));
	xy = within_neg(product(c, n[0], n[1]));
	return (struct rotation){{
		{within_sub(one, product(c, n[0], n[0])), xy, n[0]},
		{xy, within_sub(one, product(c, n[1], n[1])), n[1]},
		{within_neg(n[0]), within_neg(n[1]), n[2]},
	}};
}

/* 1 - 2 (u_j^2 + u_k^2) on the diagonal, 2 (u_j u_k -+ u_i w) beside it */
struct rotation rotation_quaternion(const struct within q[4])
{
	const struct within two = within_exact(2);
	struct within square = {0}, u[4];
	struct rotation R;

	for (int i = 0; i < 4; i++)
		square = within_add(square, within_mul(q[i], q[i]));
	for (int i = 0; i < 4; i++)
		u[i] = within_div(q[i], within_sqrt(square));
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct within squares = within_add(within_mul(u[j], u[j]), within_mul(u[k], u[k]));
		struct within jk = within_mul(u[j], u[k]), iw = within_mul(u[i], u[3]);

		R.m[i][i] = within_sub(within_exact(1), within_mul(two, squares));
		R.m[j][k] = within_mul(two, within_sub(jk, iw));
		R.m[k][j] = within_mul(two, within_add(jk, iw));
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
				sum_add(&s, within_mul(a->m[i][k], b->m[k][j]));
			r.m[i][j] = sum_total(s);
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

void rotation_apply(const struct rotation *r, const struct within v[3], struct within out[3])
{
	struct within w[3];

	for (int i = 0; i < 3; i++) {
		struct sum s = {0};

		for (int k = 0; k < 3; k++)
			sum_add(&s, within_mul(r->m[i][k], v[k]));
		w[i] = sum_total(s);
	}
	for (int i = 0; i < 3; i++)
		out[i] = w[i];
}

struct placement placement_mul(const struct placement *a, const struct placement *b)
{
	struct placement c = {.R = rotation_mul(&a->R, &b->R)};

	for (int i = 0; i < 3; i++) {
		struct sum s = {0};

		for (int k = 0; k < 3; k++)
			sum_add(&s, within_mul(a->R.m[i][k], b->p[k]));
		sum_add(&s, a->p[i]);
		c.p[i] = sum_total(s);
	}
	return c;
}

struct placement placement_inverse(const struct placement *a)
{
	struct placement back = {.R = rotation_transpose(&a->R)};

	rotation_apply(&back.R, a->p, back.p);
	for (int i = 0; i < 3; i++)
		back.p[i] = within_neg(back.p[i]);
	return back;
}

int inertia_index(int i, int j)
{
	static const int index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

	return index[i][j];
}

/* One element of m (c.c 1 - c c^T). */
static void add_parallel_axis(struct sum *s, int i, int j, struct within mass, const struct within c[3])
{
	if (i != j) {
		sum_add(s, within_neg(product(mass, c[i], c[j])));
		return;
	}
	for (int k = 0; k < 3; k++)
		if (k != i)
			sum_add(s, product(mass, c[k], c[k]));
}

void inertia_add(struct inertia_sum *s, const struct placement *X, struct within mass, const struct within com[3],
	const struct within rpy[3], const struct within inertia[6])
{
	struct placement local = {.R = rotation_rpy(rpy), .p = {com[0], com[1], com[2]}};
	struct placement at = placement_mul(X, &local);

	sum_add(&s->mass, mass);
	for (int i = 0; i < 3; i++) {
		sum_add(&s->h[i], within_mul(mass, at.p[i]));
		for (int j = i; j < 3; j++) {
			struct sum *e = &s->I[inertia_index(i, j)];

			for (int k = 0; k < 3; k++)
				for (int l = 0; l < 3; l++)
					sum_add(e, product(at.R.m[i][k], at.R.m[j][l], inertia[inertia_index(k, l)]));
			add_parallel_axis(e, i, j, mass, at.p);
		}
	}
}

static int is_nothing(struct within a)
{
	return a.x == 0 && a.near == 0 && a.e == 0;
}

/* Most are nothing. */
static void sum_add_product(struct sum *s, struct within a, struct within b, struct within c)
{
	if (!is_nothing(a) && !is_nothing(b) && !is_nothing(c))
		sum_add(s, product(a, b, c));
}

/* One element of R I R^T + 2 (p . u) 1 - u p^T - p u^T, with u = R h. */
static void add_turned(struct sum *s, int i, int j, const struct placement *X, const struct inertia *I, const struct within u[3])
{
	const struct within two = within_exact(2), *p = X->p;

	for (int k = 0; k < 3; k++)
		for (int l = 0; l < 3; l++)
			sum_add_product(s, X->R.m[i][k], X->R.m[j][l], I->I[inertia_index(k, l)]);
	for (int k = 0; k < 3 && i == j; k++)
		if (k != i)
			sum_add_product(s, two, p[k], u[k]);
	if (i != j) {
		sum_add_product(s, within_exact(-1), u[i], p[j]);
		sum_add_product(s, within_exact(-1), p[i], u[j]);
	}
}

void inertia_add_from(struct inertia_sum *s, const struct placement *X, const struct inertia *I)
{
	struct within u[3];

	rotation_apply(&X->R, I->h, u);
	sum_add(&s->mass, I->mass);
	for (int i = 0; i < 3; i++) {
		sum_add(&s->h[i], u[i]);
		sum_add_product(&s->h[i], within_exact(1), I->mass, X->p[i]);
		for (int j = i; j < 3; j++) {
			struct sum *e = &s->I[inertia_index(i, j)];

			add_turned(e, i, j, X, I, u);
			if (I->mass.x != 0)
				add_parallel_axis(e, i, j, I->mass, X->p);
		}
	}
}

struct inertia inertia_total(const struct inertia_sum *s)
{
	struct inertia t = {.mass = sum_total(s->mass)};

	for (int i = 0; i < 3; i++)
		t.h[i] = sum_total(s->h[i]);
	for (int i = 0; i < 6; i++)
		t.I[i] = sum_total(s->I[i]);
	return t;
}
