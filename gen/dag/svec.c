#include "dag/svec.h"

struct ref dag_add_products(struct dag *d, struct ref a, struct ref b, struct ref c, struct ref e)
{
	struct ref last = dag_mul(d, c, e);

	return dag_add(d, dag_mul(d, a, b), last);
}

struct ref dag_sub_products(struct dag *d, struct ref a, struct ref b, struct ref c, struct ref e)
{
	struct ref last = dag_mul(d, c, e);

	return dag_sub(d, dag_mul(d, a, b), last);
}

struct svec svec_const(struct dag *d, const struct within v[3])
{
	return (struct svec){{dag_within(d, v[0]), dag_within(d, v[1]), dag_within(d, v[2])}};
}

struct svec svec_input(struct dag *d, int argument, int row)
{
	struct svec v;

	for (int i = 0; i < 3; i++)
		v.x[i] = dag_input(d, argument, row + i);
	return v;
}

struct svec svec_add(struct dag *d, struct svec a, struct svec b)
{
	for (int i = 0; i < 3; i++)
		a.x[i] = dag_add(d, a.x[i], b.x[i]);
	return a;
}

struct svec svec_sub(struct dag *d, struct svec a, struct svec b)
{
	for (int i = 0; i < 3; i++)
		a.x[i] = dag_sub(d, a.x[i], b.x[i]);
	return a;
}

struct svec svec_scale(struct dag *d, struct ref s, struct svec a)
{
	for (int i = 0; i < 3; i++)
		a.x[i] = dag_mul(d, s, a.x[i]);
	return a;
}

/* (a x b)_i = a_j b_k - a_k b_j */
struct svec svec_cross(struct dag *d, struct svec a, struct svec b)
{
	struct svec c;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		c.x[i] = dag_sub_products(d, a.x[j], b.x[k], a.x[k], b.x[j]);
	}
	return c;
}

struct svec svec_add_cross(struct dag *d, struct svec c, struct svec a, struct svec b)
{
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct ref less = dag_mul(d, a.x[k], b.x[j]);

		c.x[i] = dag_sub(d, dag_add(d, c.x[i], dag_mul(d, a.x[j], b.x[k])), less);
	}
	return c;
}

struct ref svec_add_dot(struct dag *d, struct ref sum, struct svec a, struct svec b)
{
	for (int i = 0; i < 3; i++)
		sum = dag_add(d, sum, dag_mul(d, a.x[i], b.x[i]));
	return sum;
}

struct ref svec_dot(struct dag *d, struct svec a, struct svec b)
{
	return svec_add_dot(d, (struct ref){0}, a, b);
}

struct svec smat_row(const struct smat *m, int i)
{
	return (struct svec){{m->m[i][0], m->m[i][1], m->m[i][2]}};
}

struct svec smat_column(const struct smat *m, int j)
{
	return (struct svec){{m->m[0][j], m->m[1][j], m->m[2][j]}};
}

void smat_set_row(struct smat *m, int i, struct svec u)
{
	for (int j = 0; j < 3; j++)
		m->m[i][j] = u.x[j];
}

void smat_set_column(struct smat *m, int j, struct svec u)
{
	for (int i = 0; i < 3; i++)
		m->m[i][j] = u.x[i];
}

struct smat smat_transposed(const struct smat *m)
{
	struct smat out;

	for (int i = 0; i < 3; i++)
		smat_set_row(&out, i, smat_column(m, i));
	return out;
}

struct svec smat_add_mul(struct dag *d, struct svec w, const struct smat *m, struct svec v)
{
	for (int i = 0; i < 3; i++)
		w.x[i] = svec_add_dot(d, w.x[i], smat_row(m, i), v);
	return w;
}

struct svec smat_mul(struct dag *d, const struct smat *m, struct svec v)
{
	return smat_add_mul(d, (struct svec){{{0}, {0}, {0}}}, m, v);
}

struct svec smat_mul_transposed(struct dag *d, const struct smat *m, struct svec v)
{
	struct smat t = smat_transposed(m);

	return smat_mul(d, &t, v);
}

struct smat smat_product(struct dag *d, const struct smat *a, const struct smat *b)
{
	struct smat out;

	for (int j = 0; j < 3; j++)
		smat_set_column(&out, j, smat_mul(d, a, smat_column(b, j)));
	return out;
}

struct smat smat_const(struct dag *d, const struct rotation *r)
{
	struct smat s;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			s.m[i][j] = dag_within(d, r->m[i][j]);
	return s;
}

/* v_j' = c v_j - s v_k, v_k' = s v_j + c v_k */
struct svec svec_turn(struct dag *d, int axis, struct ref s, struct ref c, struct svec v)
{
	int j = (axis + 1) % 3, k = (axis + 2) % 3;
	struct svec w = v;

	w.x[j] = dag_sub_products(d, c, v.x[j], s, v.x[k]);
	w.x[k] = dag_add_products(d, s, v.x[j], c, v.x[k]);
	return w;
}

struct svec svec_turn_back(struct dag *d, int axis, struct ref s, struct ref c, struct svec v)
{
	return svec_turn(d, axis, dag_neg(d, s), c, v);
}

void svec_tag(struct dag *d, struct svec a, const char *quantity, int body)
{
	for (int i = 0; i < 3; i++)
		dag_tag(d, a.x[i], quantity, body, "xyz"[i]);
}
