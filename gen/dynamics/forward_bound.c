/* How far qdd may be off, whatever made it (Rump, Verification methods: rigorous results using floating-point arithmetic, Acta
   Numerica 19, 2010, section 10). With M the exact mass matrix, X near its inverse and r = tau - ID(q, qd, qdd), the exact qdd
   is qdd + M^-1 r, and M^-1 = (I - F)^-1 X with F = I - X M. So where |F| <= E and E y <= k y, k < 1, for y = |X| |r| > 0, all
   of (I - E)^-1 y = y + E y + E^2 y + ... is at most y/(1 - k). y is the scale in which E is judged: it has the units of each
   joint's acceleration, and what E carries from a row to another is compared with what that row has of its own. */
#include "dag/bound.h"
#include "dynamics/forward.h"
#include "dynamics/want.h"
#include <math.h>

struct forward_bound {
	struct dag *d;
	const struct eval_model *m;
	int n;
	struct ref *r, *M, *X; /* [n], [n][n], [n][n] */
	struct ref *qdd;       /* [n]: where it is held */
	struct bound of;       /* r and M */
	uint32_t way;
};

/* Where qdd = c x is put for what holds its place, m qdd would become (m c) x, which is not what the stored c x gives. */
void forward_part(struct dag *d, struct ref *values, int count)
{
	for (int i = 0; i < count && !d->failed; i++) {
		int is_negated = d->nodes[values[i].i].op == OP_NEG;
		const struct node n = is_negated ? d->nodes[d->nodes[values[i].i].arg[0].i] : d->nodes[values[i].i];

		if (n.op != OP_MUL || d->nodes[n.arg[0].i].op != OP_CONST)
			continue;
		values[i] = dag_div(d, n.arg[1], dag_div(d, dag_const(d, 1), n.arg[0]));
		values[i] = is_negated ? dag_neg(d, values[i]) : values[i];
	}
}

/* ID(q, qd, qdd) at the qdd that was found. */
static void residual(struct forward_bound *y, const struct forward *x, struct joint_inputs in)
{
	struct tour t = want_tour(x->b, in);

	dag_section(y->d, SECTION_RESIDUAL, 0);
	t.comes_back = 1;
	t.world = want_world;
	t.entered = forward_enter;
	t.own_terms = own_terms;
	tour_run(&t);
	for (int i = 0; i < y->n && !y->d->failed; i++)
		y->r[i] = dag_sub(y->d, source_row(y->d, &x->torques, i), t.tau[i]);
}

/* Errors of r, which stands before M in the array. */
static void bound_all(struct forward_bound *y, const struct forward *x)
{
	int n = y->n;

	if (y->d->failed || !bound_make(&y->of, y->d, y->m, y->r, n + n * n, y->qdd, x->qdd, n)) {
		y->d->failed = 1;
		return;
	}
	for (int i = 0; i < n + n * n; i++)
		y->way = y->of.way[y->r[i].i] > y->way ? y->of.way[y->r[i].i] : y->way;
}

static struct ref error(const struct forward_bound *y, struct ref a)
{
	return y->of.error[a.i];
}

static struct ref plus_product(struct dag *d, struct ref sum, struct ref a, struct ref b)
{
	return dag_add(d, sum, dag_mul(d, a, b));
}

/* to = |A| v */
static void apply(struct dag *d, int n, const struct ref *A, const struct ref *v, struct ref *to)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			to[i] = plus_product(d, to[i], dag_abs(d, A[i * n + j]), v[j]);
}

/* I - X M, as it is computed. */
static void identity_less_product(const struct forward_bound *y, struct ref *P)
{
	struct dag *d = y->d;
	int n = y->n;

	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			struct ref sum = dag_const(d, i == j);

			for (int k = 0; k < n; k++)
				sum = dag_sub(d, sum, dag_mul(d, y->X[i * n + k], y->M[k * n + j]));
			P[i * n + j] = sum;
		}
}

/* What n products and sums after each other are off, of the sum of their magnitudes. */
static struct ref rounding(const struct forward_bound *y)
{
	return dag_const(y->d, (y->n + 3) * ((real)y->m->add + (real)y->m->mul));
}

/* E y: |I - X M| as computed, and what rounding takes from it: e of M's elements, and that of the product. */
static void apply_error(const struct forward_bound *x, const struct ref *y, struct ref *to)
{
	struct dag *d = x->d;
	int n = x->n;
	struct ref *P = arena_alloc(d->arena, (size_t)(n * n), sizeof *P), *G = arena_alloc(d->arena, (size_t)(n * n), sizeof *G);
	struct ref *z = arena_alloc(d->arena, (size_t)n, sizeof *z), all = {0}, unit;

	if (!P || !G || !z) {
		d->failed = 1;
		return;
	}
	identity_less_product(x, P);
	for (int i = 0; i < n * n; i++) {
		struct ref size = dag_abs(d, x->M[i]);

		G[i] = dag_add(d, error(x, x->M[i]), dag_mul(d, rounding(x), size));
	}
	apply(d, n, G, y, z);
	for (int i = 0; i < n; i++)
		all = dag_add(d, all, y[i]);
	unit = rounding(x);
	for (int i = 0; i < n; i++)
		to[i] = plus_product(d, dag_mul(d, dag_const(d, n * bound_tiny(x->m)), all), unit, y[i]);
	apply(d, n, P, y, to);
	apply(d, n, x->X, z, to);
}

/* The larger: (a + b + |a - b|)/2, not a number where one is none. */
static struct ref larger(struct dag *d, struct ref a, struct ref b)
{
	struct ref apart = dag_abs(d, dag_sub(d, a, b)), sum = dag_add(d, dag_add(d, a, b), apart);

	return dag_mul(d, dag_const(d, 0.5L), sum);
}

/* factor/(1 - k), infinite where k is 1 or more */
static struct ref scale(const struct forward_bound *x, const struct ref *y, const struct ref *Ey, real factor)
{
	struct dag *d = x->d;
	struct ref k = {0}, rest;

	for (int i = 0; i < x->n; i++)
		k = i ? larger(d, k, dag_div(d, Ey[i], y[i])) : dag_div(d, Ey[i], y[i]);
	rest = dag_mul(d, dag_const(d, factor), k);
	rest = dag_sub(d, dag_const(d, 1), rest);
	rest = larger(d, rest, dag_const(d, 0));
	return dag_div(d, dag_const(d, factor), rest);
}

/* What is constant has no residual. */
static struct ref with_constant(const struct forward_bound *x, struct ref qdd, struct ref bound)
{
	const struct node *n = &x->d->nodes[qdd.i];
	real e = n->op == OP_CONST ? fabsl(x->m->constant(n->value) - n->value) + (real)within_error(dag_number(x->d, n)) : 0;

	return dag_add(x->d, bound, dag_const(x->d, e * (1 + 1e-6L)));
}

/* Where memory rounds it: what qdd takes by that, and the bound. Nothing is known of what is too large. */
static struct ref stored(const struct forward_bound *x, struct ref qdd, struct ref bound)
{
	struct dag *d = x->d;
	struct ref size = dag_abs(d, qdd), more, huge;

	if (x->m->store == 0)
		return bound;
	more = dag_const(d, 4 * (real)x->m->store_tiny);
	more = dag_add(d, dag_mul(d, dag_const(d, (real)x->m->store), size), more);
	huge = dag_const(d, 1);
	huge = dag_add(d, dag_mul(d, dag_const(d, 0x1p1023L / (real)x->m->store_largest), size), huge);
	huge = dag_add(d, huge, huge);
	huge = dag_mul(d, dag_const(d, 0x1p-1000L), huge);
	more = dag_add(d, dag_add(d, bound, huge), more);
	return dag_mul(d, dag_const(d, 1 + 4 * (real)x->m->store), more);
}

/* y = |X| (|r| + d) and what follows. */
static void output_bound(const struct forward_bound *x, const struct ref *qdd, int argument)
{
	struct dag *d = x->d;
	int n = x->n;
	real factor = bound_factor(x->m, 2 * x->way + 12 * (uint32_t)n + 60);
	struct ref *g = arena_alloc(d->arena, (size_t)n, sizeof *g), *y = arena_alloc(d->arena, (size_t)n, sizeof *y), by;
	struct ref *Ey = arena_alloc(d->arena, (size_t)n, sizeof *Ey);

	if (!g || !y || !Ey || factor == 0) {
		d->failed = 1;
		return;
	}
	for (int i = 0; i < n; i++) {
		g[i] = dag_add(d, dag_abs(d, x->r[i]), error(x, x->r[i]));
		y[i] = dag_const(d, n * bound_tiny(x->m));
	}
	apply(d, n, x->X, g, y);
	apply_error(x, y, Ey);
	if (d->failed)
		return;
	by = scale(x, y, Ey, factor);
	for (int i = 0; i < n; i++)
		dag_output(d, argument, i, stored(x, qdd[i], with_constant(x, qdd[i], dag_mul(d, y[i], by))));
}

void forward_bound(const struct forward *x, struct joint_inputs in, int argument)
{
	struct dag *d = x->b->d;
	struct forward_bound y = {.d = d, .m = x->b->k->arithmetic, .n = x->b->t->nv};
	size_t n = (size_t)y.n;

	if (argument < 0 || d->failed)
		return;
	y.r = arena_alloc(d->arena, 2 * n + 2 * n * n, sizeof *y.r);
	if (!y.r) {
		d->failed = 1;
		return;
	}
	y.M = y.r + n;
	y.X = y.M + n * n;
	y.qdd = y.X + n * n;
	for (int i = 0; i < y.n; i++)
		y.qdd[i] = source_row(d, &in.qdd, i);
	residual(&y, x, in);
	for (size_t i = 0; i < n * n && !d->failed; i++)
		y.M[i] = x->mass.by[BY_QDD].element[i];
	dag_section(d, SECTION_BOUND, 0);
	bound_all(&y, x);
	if (!d->failed)
		forward_inverse(x, y.X);
	if (!d->failed)
		output_bound(&y, x->qdd, argument);
}
