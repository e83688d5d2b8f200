#include "relax/quadric.h"
#include <math.h>

/* Where the product of two of x y z w stands. */
static int pair(int a, int b)
{
	static const int at[4][4] = {{5, 6, 7, 8}, {6, 9, 10, 11}, {7, 10, 12, 13}, {8, 11, 13, 14}};

	return at[a][b];
}

struct quadric quadric_const(real c)
{
	return (struct quadric){{c}};
}

struct quadric quadric_input(int which)
{
	struct quadric q = {{0}};

	q.c[1 + which] = 1;
	return q;
}

struct quadric quadric_add(struct quadric a, struct quadric b, real sign)
{
	for (int i = 0; i < QUADRIC_TERMS; i++)
		a.c[i] += sign * b.c[i];
	return a;
}

static int degree(const struct quadric *a)
{
	int most = 0;

	for (int i = 0; i < QUADRIC_TERMS; i++)
		if (a->c[i] != 0)
			most = i < 1 ? most : i < 5 ? (most < 1 ? 1 : most) : 2;
	return most;
}

int quadric_mul(struct quadric *out, struct quadric a, struct quadric b)
{
	*out = (struct quadric){{0}};
	if (degree(&a) + degree(&b) > 2)
		return 0;
	for (int i = 0; i < QUADRIC_TERMS; i++)
		out->c[i] = a.c[0] * b.c[i] + (i ? a.c[i] * b.c[0] : 0);
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 4; k++)
			out->c[pair(i, k)] += a.c[1 + i] * b.c[1 + k];
	return 1;
}

/* Into r what m (R_jk or 1) adds. */
static void put(struct rotated *r, int j, int k, real m)
{
	r->w[j][k] += m;
}

/* As R_ii = 1 - 2 (q_j^2 + q_k^2), R_jk = 2 (q_j q_k - q_i w) and R_kj = 2 (q_j q_k + q_i w):
   q_j q_k = (R_jk + R_kj)/4, q_i w = (R_kj - R_jk)/4, q_i^2 = (1 + R_ii - R_jj - R_kk)/4. */
int quadric_rotated(const struct quadric *q, struct rotated *r)
{
	*r = (struct rotated){.c = q->c[0]};
	for (int i = 0; i < 4; i++)
		if (q->c[1 + i] != 0)
			return 0;
	if (q->c[pair(3, 3)] != 0)
		return 0;
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		real jk = q->c[pair(j, k)] / 4, iw = q->c[pair(i, 3)] / 4, ii = q->c[pair(i, i)] / 4;

		put(r, j, k, jk - iw);
		put(r, k, j, jk + iw);
		r->c += ii;
		put(r, i, i, ii);
		put(r, j, j, -ii);
		put(r, k, k, -ii);
	}
	return 1;
}

/* Rows of R are of length 1, and columns. */
double rotated_size(const struct rotated *r)
{
	real rows = 0, columns = 0;

	for (int i = 0; i < 3; i++) {
		rows += sqrtl(r->w[i][0] * r->w[i][0] + r->w[i][1] * r->w[i][1] + r->w[i][2] * r->w[i][2]);
		columns += sqrtl(r->w[0][i] * r->w[0][i] + r->w[1][i] * r->w[1][i] + r->w[2][i] * r->w[2][i]);
	}
	return (double)(fabsl(r->c) + (rows < columns ? rows : columns)) * (1 + 0x1p-40);
}

int rotated_is_row(const struct rotated *r, int *row, real g[3])
{
	real all = fabsl(r->c);
	int columns = 0;

	for (int k = 0; k < 3; k++) {
		real size = fabsl(r->w[0][k]) + fabsl(r->w[1][k]) + fabsl(r->w[2][k]);

		all += size;
		if (size > 0)
			*row = k;
	}
	for (int k = 0; k < 3; k++)
		columns += fabsl(r->w[0][k]) + fabsl(r->w[1][k]) + fabsl(r->w[2][k]) > 0;
	for (int j = 0; j < 3; j++)
		g[j] = r->w[j][*row];
	return columns == 1 && r->c == 0 && all > 0;
}
