#include "mechanics/schur.h"
#include "mechanics/factor.h"

void schur_begin(struct schur *x, struct dag *d, int n, int nv)
{
	size_t rows = (size_t)n, all = (size_t)nv;

	*x = (struct schur){.d = d, .n = n, .nv = nv, .Y = arena_alloc(d->arena, all * rows, sizeof *x->Y),
		.inverse = arena_alloc(d->arena, all, sizeof *x->inverse), .S = arena_alloc(d->arena, rows * rows, sizeof *x->S),
		.joined = arena_alloc(d->arena, all, 1), .over = arena_alloc(d->arena, rows, sizeof *x->over)};
	d->failed |= d->arena->failed;
}

void schur_join(struct schur *x, int i)
{
	factor_add_felt(x->d, x->n, x->Y + i * x->n, x->inverse[i], x->S);
	x->joined[i] = 1;
}

void schur_project(const struct schur *x, const struct ref *y, struct ref *n)
{
	struct dag *d = x->d;

	for (int c = 0; c < x->n; c++) {
		n[c] = (struct ref){0};
		for (int i = x->nv; i-- > 0;)
			n[c] = dag_add(d, n[c], dag_mul(d, dag_mul(d, y[i], x->inverse[i]), x->Y[i * x->n + c]));
	}
}

void schur_take(const struct schur *x, struct ref *y, const struct ref *n)
{
	for (int i = 0; i < x->nv; i++)
		for (int c = 0; c < x->n; c++)
			y[i] = dag_sub(x->d, y[i], dag_mul(x->d, x->Y[i * x->n + c], n[c]));
}

/* What rows of Y that have not joined add to an element. */
static struct ref join_late(const struct schur *x, int k, int j)
{
	struct dag *d = x->d;
	struct ref sum = x->S[k * x->n + j];

	for (int i = x->nv; i-- > 0;)
		if (!x->joined[i])
			sum = dag_add(d, sum, dag_mul(d, dag_mul(d, x->Y[i * x->n + k], x->inverse[i]), x->Y[i * x->n + j]));
	return sum;
}

/* Row k of S, less what the rows after it eliminate: row k of d l. */
static void make_row(struct schur *x, int k)
{
	struct dag *d = x->d;
	int n = x->n;

	for (int j = k; j >= 0; j--) {
		struct ref left = x->S[k * n + j] = join_late(x, k, j);

		for (int m = n; m-- > k + 1;)
			left = dag_sub(d, left, dag_mul(d, dag_mul(d, x->row[m * n + k], x->over[m]), x->row[m * n + j]));
		x->row[k * n + j] = left;
	}
}

int schur_factor(struct schur *x)
{
	struct dag *d = x->d;

	if (x->row || d->failed)
		return -1;
	x->row = arena_alloc(d->arena, (size_t)x->n * (size_t)x->n, sizeof *x->row);
	d->failed |= !x->row;
	for (int k = x->n; k-- > 0 && !d->failed;) {
		make_row(x, k);
		if (!x->row[k * x->n + k].i)
			return k;
		x->over[k] = dag_div(d, dag_const(d, 1), x->row[k * x->n + k]);
	}
	return -1;
}

/* l^T y = b, z = d^-1 y, and n = z - d^-1 (d l - d) n. */
void schur_solve(const struct schur *x, struct ref *b)
{
	struct dag *d = x->d;

	if (d->failed)
		return;
	for (int i = x->n; i-- > 0;) {
		b[i] = dag_mul(d, b[i], x->over[i]);
		for (int j = 0; j < i; j++)
			b[j] = dag_sub(d, b[j], dag_mul(d, x->row[i * x->n + j], b[i]));
	}
	for (int i = 1; i < x->n; i++) {
		struct ref sum = {0};

		for (int j = 0; j < i; j++)
			sum = dag_add(d, sum, dag_mul(d, x->row[i * x->n + j], b[j]));
		b[i] = dag_sub(d, b[i], dag_mul(d, x->over[i], sum));
	}
}
