#include "mechanics/factor.h"

static struct ref minus_product(struct dag *d, struct ref a, struct ref b, struct ref c)
{
	return dag_sub(d, a, dag_mul(d, b, c));
}

/* Row k, in place: what is left of M is less that of the rows before it. */
static void eliminate(struct factor *f, int k)
{
	struct ref *M = f->L, *row = M + k * f->n;

	for (int i = k - 1; i >= 0; i--) {
		struct ref a = dag_mul(f->d, row[i], f->inverse[k]);

		for (int j = i; j >= 0 && a.i; j--)
			M[i * f->n + j] = minus_product(f->d, M[i * f->n + j], a, row[j]);
		row[i] = a;
	}
}

int factor_make(struct factor *f, struct dag *d, int n, const int *order, const struct ref *M, int *singular)
{
	size_t rows = (size_t)n;

	*singular = -1;
	*f = (struct factor){.d = d, .n = n, .row = arena_alloc(d->arena, rows, sizeof *f->row),
		.L = arena_alloc(d->arena, rows * rows, sizeof *f->L), .D = arena_alloc(d->arena, rows, sizeof *f->D),
		.inverse = arena_alloc(d->arena, rows, sizeof *f->inverse)};
	if (!f->row || !f->L || !f->D || !f->inverse)
		return 0;
	for (int i = 0; i < n; i++)
		f->row[i] = order ? order[i] : i;
	for (int i = 0; i < f->n; i++)
		for (int j = 0; j <= i; j++)
			f->L[i * f->n + j] = M[f->row[i] * f->n + f->row[j]];
	for (int k = f->n - 1; k >= 0; k--) {
		f->D[k] = f->L[k * f->n + k];
		if (!f->D[k].i) {
			*singular = f->row[k];
			return 0;
		}
		f->inverse[k] = dag_div(d, dag_const(d, 1), f->D[k]);
		eliminate(f, k);
	}
	return 1;
}

/* L^T y = b from the last row on. */
void factor_reduce(const struct factor *f, struct ref *x)
{
	for (int i = f->n - 1; i >= 0; i--)
		for (int j = 0; j < i; j++)
			x[f->row[j]] = minus_product(f->d, x[f->row[j]], f->L[i * f->n + j], x[f->row[i]]);
}

void factor_solve(const struct factor *f, struct ref *x)
{
	factor_reduce(f, x);
	factor_expand(f, x);
}

/* z = D^-1 y, L x = z from the first row on. */
void factor_expand(const struct factor *f, struct ref *x)
{
	for (int i = 0; i < f->n; i++)
		x[f->row[i]] = dag_mul(f->d, x[f->row[i]], f->inverse[i]);
	for (int i = 0; i < f->n; i++)
		for (int j = 0; j < i; j++)
			x[f->row[i]] = minus_product(f->d, x[f->row[i]], f->L[i * f->n + j], x[f->row[j]]);
}

void factor_add_felt(struct dag *d, int n, const struct ref *y, struct ref inverse, struct ref *X)
{
	for (int c = 0; c < n; c++) {
		struct ref over = dag_mul(d, y[c], inverse);

		for (int e = 0; e <= c; e++)
			X[c * n + e] = dag_add(d, X[c * n + e], dag_mul(d, over, y[e]));
	}
}

/* L X = D^-1 L^-T, whose right side is 0 below its diagonal, D^-1: column by column, with what is above it by symmetry. */
void factor_inverse(const struct factor *f, struct ref *X)
{
	for (int j = 0; j < f->n; j++)
		for (int i = j; i < f->n; i++) {
			struct ref sum = i == j ? f->inverse[j] : (struct ref){0};

			for (int m = 0; m < i; m++)
				sum = minus_product(f->d, sum, f->L[i * f->n + m], X[f->row[m] * f->n + f->row[j]]);
			X[f->row[i] * f->n + f->row[j]] = X[f->row[j] * f->n + f->row[i]] = sum;
		}
}
