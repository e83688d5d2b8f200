#include "norms/norms_form.h"
#include "norms/adjoint.h"
#include "norms/matrix_norm.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TERMS = 24, BASES = 3, SIDE = NORMS_SET };

/* c a, or c a b. */
struct term {
	uint32_t a, b; /* b 0: it is of one */
	double c, off; /* c is off by at most this */
};

struct row {
	struct term terms[TERMS];
	int count, failed;
};

struct forming {
	const struct dag *d;
	const uint32_t *uses;
	struct row rows[NORMS_SET];
	int row_count;
	uint32_t bases[BASES], u[SIDE], v[SIDE];
	int base_count, u_count, v_count;
};

/* ---- terms ---- */

static int is_constant(const struct dag *d, uint32_t i)
{
	return d->nodes[i].op == OP_CONST;
}

static int is_trig(const struct dag *d, uint32_t i)
{
	return d->nodes[i].op == OP_SIN || d->nodes[i].op == OP_COS;
}

/* Of two values that vary, no sine among them. */
static int is_product(const struct dag *d, uint32_t i)
{
	const struct node *n = &d->nodes[dag_bare(d, i, NULL)];

	return n->op == OP_MUL && !is_constant(d, n->arg[0].i) && !is_constant(d, n->arg[1].i) && !is_trig(d, n->arg[0].i) &&
		!is_trig(d, n->arg[1].i);
}

/* Is it c x + s y, the sine and cosine those of one angle? */
static int is_rotated(const struct dag *d, uint32_t i)
{
	const struct node *n = &d->nodes[i];
	struct trig_term a, b;

	return (n->op == OP_ADD || n->op == OP_SUB) && trig_term(d, n->arg[0], &a) && trig_term(d, n->arg[1], &b) &&
	       a.angle == b.angle && a.is_sine != b.is_sine;
}

/* What others read too stays one value, but for products of rates. */
static int is_open(const struct forming *f, uint32_t i, int is_root)
{
	const struct node *n = &f->d->nodes[i];

	if ((n->op != OP_ADD && n->op != OP_SUB) || is_rotated(f->d, i))
		return 0;
	return is_root || f->uses[i] < 2 || is_product(f->d, n->arg[0].i) || is_product(f->d, n->arg[1].i);
}

static void add_term(struct row *r, uint32_t a, uint32_t b, double c, double off)
{
	for (int i = 0; i < r->count; i++)
		if (r->terms[i].a == a && r->terms[i].b == b) {
			r->terms[i].c += c;
			r->terms[i].off += off + 0x1p-52 * fabs(r->terms[i].c);
			return;
		}
	if (r->count == TERMS) {
		r->failed = 1;
		return;
	}
	r->terms[r->count++] = (struct term){a, b, c, off};
}

static void add_product(const struct forming *f, struct row *r, uint32_t a, uint32_t b, double c, double off)
{
	int sign = 1;

	a = dag_bare(f->d, a, &sign);
	b = dag_bare(f->d, b, &sign);
	add_term(r, a < b ? a : b, a < b ? b : a, sign * c, off);
}

static void expand(const struct forming *f, struct row *r, uint32_t i, double c, double off, int is_root)
{
	const struct node *n = &f->d->nodes[i];

	if (i == 0 || r->failed)
		return;
	if (n->op == OP_NEG) {
		expand(f, r, n->arg[0].i, -c, off, is_root);
	} else if (n->op == OP_MUL && (is_constant(f->d, n->arg[0].i) || is_constant(f->d, n->arg[1].i))) {
		int k = is_constant(f->d, n->arg[0].i);
		const struct node *by = &f->d->nodes[n->arg[!k].i];
		double x = (double)by->value, of = within_error(dag_number(f->d, by)) + 0x1p-52 * fabs(x);

		expand(f, r, n->arg[k].i, c * x, fabs(c) * of + off * (fabs(x) + of) + 0x1p-52 * fabs(c * x), 0);
	} else if (is_product(f->d, i)) {
		add_product(f, r, n->arg[0].i, n->arg[1].i, c, off);
	} else if (is_open(f, i, is_root)) {
		expand(f, r, n->arg[0].i, c, off, is_root);
		expand(f, r, n->arg[1].i, n->op == OP_SUB ? -c : c, off, is_root);
	} else {
		add_term(r, i, 0, c, off);
	}
}

/* ---- vectors ---- */

static int place(uint32_t *list, int *count, int most, uint32_t node)
{
	for (int i = 0; i < *count; i++)
		if (list[i] == node)
			return i;
	if (*count == most)
		return -1;
	list[*count] = node;
	return (*count)++;
}

/* Where the factors of all products are few enough for one vector, u = v has them. */
static int divide_into_one(struct forming *f)
{
	uint32_t all[SIDE];
	int count = 0;

	for (int i = 0; i < f->row_count; i++)
		for (int k = 0; k < f->rows[i].count; k++) {
			const struct term *t = &f->rows[i].terms[k];

			if (t->b && (place(all, &count, SIDE, t->a) < 0 || place(all, &count, SIDE, t->b) < 0))
				return 0;
		}
	f->u_count = f->v_count = count;
	memcpy(f->u, all, sizeof all);
	memcpy(f->v, all, sizeof all);
	return 1;
}

/* Each product whose factors are known on one side, or the first of all: one into u and one into v. Returns whether that placed
   any; -1: there is no room. */
static int divide_further(struct forming *f)
{
	int start = f->u_count + f->v_count;

	for (int i = 0; i < f->row_count; i++)
		for (int k = 0; k < f->rows[i].count; k++) {
			const struct term *t = &f->rows[i].terms[k];
			int is_first = f->u_count + f->v_count == 0, forth, back;

			if (!t->b)
				continue;
			forth = dag_place(f->u, f->u_count, t->a) >= 0 || dag_place(f->v, f->v_count, t->b) >= 0;
			back = dag_place(f->v, f->v_count, t->a) >= 0 || dag_place(f->u, f->u_count, t->b) >= 0;
			if (!is_first && !forth && !back)
				continue;
			if (place(back ? f->v : f->u, back ? &f->v_count : &f->u_count, SIDE, t->a) < 0 ||
				place(back ? f->u : f->v, back ? &f->u_count : &f->v_count, SIDE, t->b) < 0)
				return -1;
		}
	return f->u_count + f->v_count > start;
}

/* Has each product one factor of u and one of v, and nothing is of both? */
static int is_divided(const struct forming *f)
{
	for (int i = 0; i < f->row_count; i++)
		for (int k = 0; k < f->rows[i].count; k++) {
			const struct term *t = &f->rows[i].terms[k];
			int forth = dag_place(f->u, f->u_count, t->a) >= 0 && dag_place(f->v, f->v_count, t->b) >= 0;
			int back = dag_place(f->v, f->v_count, t->a) >= 0 && dag_place(f->u, f->u_count, t->b) >= 0;

			if (t->b && !forth && !back)
				return 0;
		}
	for (int i = 0; i < f->u_count; i++)
		if (dag_place(f->v, f->v_count, f->u[i]) >= 0)
			return 0;
	return 1;
}

/* Factors are of one vector, or each product has one of u and one of v. */
static int divide(struct forming *f)
{
	int placed = 1;

	if (divide_into_one(f))
		return 1;
	while (placed > 0)
		placed = divide_further(f);
	return placed == 0 && is_divided(f);
}

/* ---- matrices ---- */

static double off_of(const struct forming *f, int of_products)
{
	double sum = 0;

	for (int i = 0; i < f->row_count; i++)
		for (int k = 0; k < f->rows[i].count; k++)
			if ((f->rows[i].terms[k].b != 0) == of_products)
				sum += f->rows[i].terms[k].off;
	return sum;
}

static double tensor_at(const struct forming *f, int i, int j, int k)
{
	for (int t = 0; t < f->rows[i].count; t++) {
		const struct term *x = &f->rows[i].terms[t];

		if (!x->b)
			continue;
		if (dag_place(f->u, f->u_count, x->a) == j && dag_place(f->v, f->v_count, x->b) == k)
			return x->c;
		if (dag_place(f->v, f->v_count, x->a) == k && dag_place(f->u, f->u_count, x->b) == j)
			return x->c;
	}
	return 0;
}

/* c times some of u_y v_z - u_z v_y and so on, in any order and with any signs: then |c|. -1: it is not that. */
static double cross_factor(const struct forming *f, double t[NORMS_SET][SIDE][SIDE])
{
	int of[SIDE] = {-1, -1, -1, -1}, pairs = 0;
	double c = 0;

	for (int i = 0; i < f->row_count; i++) {
		int at[2][2], count = 0, mask;

		for (int j = 0; j < f->u_count; j++)
			for (int k = 0; k < f->v_count; k++)
				if (t[i][j][k] != 0) {
					if (count == 2)
						return -1;
					at[count][0] = j;
					at[count++][1] = k;
				}
		if (count != 2 || t[i][at[0][0]][at[0][1]] != -t[i][at[1][0]][at[1][1]] || at[0][0] == at[1][0])
			return -1;
		c = c == 0 ? fabs(t[i][at[0][0]][at[0][1]]) : c;
		mask = 1 << at[0][0] | 1 << at[1][0];
		if (fabs(t[i][at[0][0]][at[0][1]]) != c || at[0][0] > 2 || at[1][0] > 2 || pairs >> mask & 1)
			return -1;
		pairs |= 1 << mask;
		for (int s = 0; s < 2; s++) { /* v of the other one's index */
			int k = at[s][1], j = at[!s][0];

			if (of[k] >= 0 && of[k] != j)
				return -1;
			of[k] = j;
		}
	}
	for (int k = 0; k < SIDE; k++)
		for (int l = k + 1; l < SIDE; l++)
			if (of[k] >= 0 && of[k] == of[l])
				return -1;
	return c;
}

/* The least of three ways to lay T out as a matrix. */
static double tensor_norm(const struct forming *f)
{
	double t[NORMS_SET][SIDE][SIDE] = {{{0}}}, off = off_of(f, 1), best, cross;
	struct matrix a = {.rows = f->row_count * f->u_count, .columns = f->v_count, .off = off};
	struct matrix b = {.rows = f->row_count * f->v_count, .columns = f->u_count, .off = off};
	struct matrix c = {.rows = f->u_count * f->v_count, .columns = f->row_count, .off = off};
	int is_one = f->u_count == f->v_count && !memcmp(f->u, f->v, (size_t)f->u_count * sizeof *f->u);

	for (int i = 0; i < f->row_count; i++)
		for (int j = 0; j < f->u_count; j++)
			for (int k = 0; k < f->v_count; k++) {
				double x = (is_one && j != k ? 0.5 : 1) * tensor_at(f, i, j, k);

				t[i][j][k] = x;
				a.m[i * f->u_count + j][k] = b.m[i * f->v_count + k][j] = c.m[j * f->v_count + k][i] = x;
			}
	best = fmin(matrix_norm(&a), fmin(matrix_norm(&b), matrix_norm(&c)));
	cross = is_one ? -1 : cross_factor(f, t);
	return cross >= 0 ? fmin(best, (cross + off) * (1 + 0x1p-40)) : best;
}

static double group_norm(const struct forming *f, const uint32_t *nodes, int count)
{
	struct matrix a = {.rows = f->row_count, .columns = count, .off = off_of(f, 0)};

	for (int i = 0; i < f->row_count; i++)
		for (int t = 0; t < f->rows[i].count; t++) {
			int k = f->rows[i].terms[t].b ? -1 : dag_place(nodes, count, f->rows[i].terms[t].a);

			if (k >= 0)
				a.m[i][k] = f->rows[i].terms[t].c;
		}
	return matrix_norm(&a);
}

/* ---- forms ---- */

static int ascending(const void *a, const void *b)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

	return (x > y) - (x < y);
}

static int find_terms(struct forming *f, const uint32_t *nodes)
{
	int changes = 0;

	for (int i = 0; i < f->row_count; i++) {
		if (is_rotated(f->d, nodes[i]))
			return 0;
		expand(f, &f->rows[i], nodes[i], 1, 0, 1);
		if (f->rows[i].failed || f->rows[i].count == 0)
			return 0;
		changes |= f->rows[i].terms[0].a != nodes[i];
		for (int k = 0; k < f->rows[i].count; k++)
			if (!f->rows[i].terms[k].b && place(f->bases, &f->base_count, BASES, f->rows[i].terms[k].a) < 0)
				return 0;
	}
	qsort(f->bases, (size_t)f->base_count, sizeof *f->bases, ascending);
	return changes && divide(f);
}

const struct norms_form *norms_form_find(const struct dag *d, const uint32_t *uses, const uint32_t *nodes, int count,
	uint32_t (*set)(void *context, const uint32_t *nodes, int count), void *context, struct arena *a)
{
	struct forming f = {.d = d, .uses = uses, .row_count = count};
	struct norms_form form = {.x = 0}, *kept;
	if (!find_terms(&f, nodes))
		return NULL;
	if (f.base_count) {
		form.factor = group_norm(&f, f.bases, f.base_count);
		if (!(form.x = set(context, f.bases, f.base_count)))
			return NULL;
	}
	if (f.u_count) {
		form.product = tensor_norm(&f);
		form.u = set(context, f.u, f.u_count);
		form.v = set(context, f.v, f.v_count);
		if (!form.u || !form.v)
			return NULL;
	}
	if (!(kept = arena_alloc(a, 1, sizeof *kept)))
		return NULL;
	*kept = form;
	return kept;
}

double norms_form_bound(const struct norms_form *f, double x, double u, double v)
{
	double sum = (f->x ? f->factor * x : 0) + (f->u ? f->product * u * v : 0);

	return sum >= 0 ? sum * (1 + 0x1p-46) + DBL_MIN : (double)INFINITY;
}

void norms_form_lanes(const struct norms_form *f, size_t n, const double *x, double *norm)
{
	for (size_t i = 0; i < n; i++)
		norm[i] = norms_form_bound(&(struct norms_form){.x = f->x, .factor = f->factor}, x[i], 0, 0);
}
