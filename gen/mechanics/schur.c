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

/* An element of S, with what rows of Y that have not joined add. */
static struct ref join_late(const struct schur *x, int j, int k)
{
	struct dag *d = x->d;
	struct ref sum = x->S[j * x->n + k];

	for (int i = x->nv; i-- > 0;)
		if (!x->joined[i])
			sum = dag_add(d, sum, dag_mul(d, dag_mul(d, x->Y[i * x->n + k], x->inverse[i]), x->Y[i * x->n + j]));
	return sum;
}

/* Column k of S, less what the columns before it eliminate: column k of l d. */
static void make_column(struct schur *x, int k)
{
	struct dag *d = x->d;
	int n = x->n;

	for (int j = k; j < n; j++) {
		struct ref left = x->S[j * n + k] = join_late(x, j, k);

		for (int m = 0; m < k; m++)
			left = dag_sub(d, left, dag_mul(d, dag_mul(d, x->left[k * n + m], x->over[m]), x->left[j * n + m]));
		x->left[j * n + k] = left;
	}
}

/* So that a sum of what has joined is made when it may be, and not when the rest of the element is. */
static void name_joined(const struct schur *x)
{
	for (int j = 0; j < x->n && !x->d->failed; j++)
		for (int k = 0; k <= j; k++)
			dag_tag(x->d, x->S[j * x->n + k], "S", j, 0);
}

int schur_factor(struct schur *x)
{
	struct dag *d = x->d;

	if (x->left || d->failed)
		return -1;
	x->left = arena_alloc(d->arena, (size_t)x->n * (size_t)x->n, sizeof *x->left);
	d->failed |= !x->left;
	name_joined(x);
	for (int k = 0; k < x->n && !d->failed; k++) {
		make_column(x, k);
		if (!x->left[k * x->n + k].i)
			return k;
		x->over[k] = dag_div(d, dag_const(d, 1), x->left[k * x->n + k]);
	}
	return -1;
}

/* l y = b, z = d^-1 y, and n = z - d^-1 (l d - d)^T n. */
void schur_solve(const struct schur *x, struct ref *b)
{
	struct dag *d = x->d;
	int n = x->n;

	if (d->failed)
		return;
	for (int k = 0; k < n; k++) {
		b[k] = dag_mul(d, b[k], x->over[k]);
		for (int j = k + 1; j < n; j++)
			b[j] = dag_sub(d, b[j], dag_mul(d, x->left[j * n + k], b[k]));
	}
	for (int k = n - 1; k-- > 0;) {
		struct ref sum = {0};

		for (int j = n; j-- > k + 1;)
			sum = dag_add(d, sum, dag_mul(d, x->left[j * n + k], b[j]));
		b[k] = dag_sub(d, b[k], dag_mul(d, x->over[k], sum));
	}
}

struct ref schur_trace(const struct schur *x, int first, int count)
{
	struct ref sum = {0};

	for (int i = first; i < first + count; i++)
		sum = dag_add(x->d, sum, x->S[i * x->n + i]);
	return sum;
}
