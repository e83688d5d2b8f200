/* With errors e_a and e_b of the operands, u the unit roundoff and t more than underflow takes:
   a + b: e_a + e_b + u |x|;  a b: |a| e_b + (|b| + e_b) e_a + u |x| + t;  a/b: (e_a + |x| e_b + t)/(|b| - e_b) + u |x| + t;
   sqrt(a): e_a/x + u |x| + t;  sine and cosine: e_a + u' |x| + t.
   All is sums and products of what is not negative: rounding takes a factor 1 - u for each, which bound_factor makes good. |x| as
   computed stands for |x| as it is rounded elsewhere, which is a factor 1 + 3u. */
#include "dag/bound.h"
#include <math.h>

real bound_tiny(const struct eval_model *m)
{
	return (real)m->tiny / (real)m->mul;
}

real bound_factor(const struct eval_model *m, uint32_t way)
{
	real lost = (real)way * (real)m->mul;

	return lost <= 0.125L ? 1 + 2 * lost : 0;
}

/* unit |x| + more */
static struct ref rounding(const struct bound *x, double unit, uint32_t node, real more)
{
	struct dag *d = x->d;
	struct ref last = dag_const(d, more), size = dag_abs(d, (struct ref){node});

	return dag_add(d, dag_mul(d, dag_const(d, (real)unit), size), last);
}

/* What the text's constant is off, as a constant that is no smaller when it is rounded. */
static struct ref of_constant(const struct bound *x, const struct node *n)
{
	real e = fabsl(x->m->constant(n->value) - n->value) + (real)within_error(dag_number(x->d, n));

	return dag_const(x->d, e > 0 ? e * (1 + 1e-6L) + bound_tiny(x->m) : 0);
}

static struct ref of_sum(const struct bound *x, uint32_t i, struct ref of_a, struct ref of_b)
{
	struct ref inherited = dag_add(x->d, of_a, of_b);

	return dag_add(x->d, inherited, rounding(x, x->m->add, i, inherited.i ? 0 : bound_tiny(x->m)));
}

/* Is it twice or half of something, which is exact? */
static int is_scaled(const struct dag *d, const struct node *n)
{
	const struct node *c = &d->nodes[n->arg[0].i];

	return c->op == OP_CONST && !c->number && (c->value == 2 || c->value == 0.5L);
}

static struct ref of_product(const struct bound *x, uint32_t i, struct ref of_a, struct ref of_b)
{
	struct dag *d = x->d;
	const struct node n = d->nodes[i]; /* a copy: nodes move as they grow in number */
	struct ref e = is_scaled(d, &n) ? dag_const(d, of_b.i ? 0 : bound_tiny(x->m))
		: rounding(x, x->m->mul, i, bound_tiny(x->m));

	e = dag_add(d, e, dag_mul(d, dag_abs(d, n.arg[0]), of_b));
	return dag_add(d, e, dag_mul(d, dag_add(d, dag_abs(d, n.arg[1]), of_b), of_a));
}

/* 0 where x is below 0. */
static struct ref positive_part(struct dag *d, struct ref x)
{
	struct ref twice = dag_add(d, x, dag_abs(d, x));

	return dag_mul(d, dag_const(d, 0.5L), twice);
}

/* No divisor is below |b| - 5/4 e_b, even if e_b has lost a fifth; what is divided by 0 is infinite. */
static struct ref of_quotient(const struct bound *x, uint32_t i, struct ref of_a, struct ref of_b)
{
	struct dag *d = x->d;
	const struct node n = d->nodes[i];
	struct ref least = dag_abs(d, n.arg[1]), above = dag_add(d, of_a, dag_mul(d, dag_abs(d, (struct ref){i}), of_b));

	if (of_b.i)
		least = positive_part(d, dag_sub(d, least, dag_mul(d, dag_const(d, 1.5L), of_b)));
	if (above.i)
		above = dag_div(d, dag_add(d, above, dag_const(d, bound_tiny(x->m))), least);
	return dag_add(d, above, rounding(x, x->m->quotient, i, bound_tiny(x->m)));
}

static struct ref of_root(const struct bound *x, uint32_t i, struct ref of_a)
{
	const struct ref me = {i};
	struct ref inherited = of_a.i ? dag_div(x->d, of_a, me) : of_a;

	return dag_add(x->d, inherited, rounding(x, x->m->mul, i, bound_tiny(x->m)));
}

static struct ref of_angle(const struct bound *x, uint32_t i, enum op op, struct ref of_a)
{
	real more = (real)(op == OP_SIN ? x->m->sine : x->m->cosine) + bound_tiny(x->m);

	return dag_add(x->d, of_a, rounding(x, x->m->sincos, i, more));
}

static struct ref error_of(const struct bound *x, uint32_t i)
{
	const struct node n = x->d->nodes[i];
	struct ref e[2] = {{0}};

	for (int k = 0; k < op_arity[n.op] && k < 2; k++)
		e[k] = x->error[n.arg[k].i];
	switch (n.op) {
	case OP_CONST:
		return of_constant(x, &n);
	case OP_NEG:
	case OP_ABS:
	case OP_ANEW:
		return e[0];
	case OP_ADD:
	case OP_SUB:
		return of_sum(x, i, e[0], e[1]);
	case OP_MUL:
		return of_product(x, i, e[0], e[1]);
	case OP_DIV:
		return of_quotient(x, i, e[0], e[1]);
	case OP_SQRT:
		return of_root(x, i, e[0]);
	case OP_SIN:
	case OP_COS:
		return of_angle(x, i, n.op, e[0]);
	default:
		return e[0]; /* inputs are exact; products are not yet joined to sums */
	}
}

/* Products of errors add theirs up. */
static uint32_t way_of(const struct bound *x, uint32_t i)
{
	const struct node *n = &x->d->nodes[i];
	uint32_t a = op_arity[n->op] > 0 ? x->way[n->arg[0].i] : 0, b = op_arity[n->op] > 1 ? x->way[n->arg[1].i] : 0;

	if (op_arity[n->op] == 0 || n->op == OP_NEG || n->op == OP_ABS || n->op == OP_ANEW)
		return a;
	if (n->op == OP_MUL || n->op == OP_DIV)
		return a + b + 12;
	return (a > b ? a : b) + 8;
}

/* A value as it is stored and read again; a product may enter a sum before it is rounded. */
static struct ref error_of_given(const struct bound *x, struct ref given, struct ref made)
{
	const struct node *n = &x->d->nodes[made.i];

	n = n->op == OP_NEG ? &x->d->nodes[n->arg[0].i] : n;
	return n->op == OP_MUL ? rounding(x, x->m->mul, given.i, bound_tiny(x->m)) : (struct ref){0};
}

static void mark_live(struct dag *d, uint32_t count, unsigned char *live, const unsigned char *is_given)
{
	for (uint32_t i = count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && live[i] && !is_given[i]; k++)
			live[d->nodes[i].arg[k].i] = 1;
}

int bound_make(struct bound *x, struct dag *d, const struct eval_model *m, const struct ref *roots, int root_count,
	const struct ref *given, const struct ref *made, int given_count)
{
	unsigned char *live = arena_alloc(d->arena, d->count, 1), *is_given = arena_alloc(d->arena, d->count, 1);

	*x = (struct bound){.d = d, .m = m, .count = (uint32_t)d->count};
	x->error = arena_alloc(d->arena, d->count, sizeof *x->error);
	x->way = arena_alloc(d->arena, d->count, sizeof *x->way);
	if (!live || !is_given || !x->error || !x->way)
		return 0;
	for (int k = 0; k < root_count; k++)
		live[roots[k].i] = 1;
	for (int k = 0; k < given_count; k++)
		is_given[given[k].i] = 1;
	mark_live(d, x->count, live, is_given);
	for (int k = 0; k < given_count && !d->failed; k++) {
		x->error[given[k].i] = error_of_given(x, given[k], made[k]);
		x->way[given[k].i] = 8;
	}
	for (uint32_t i = 0; i < x->count && !d->failed; i++) {
		if (!live[i] || is_given[i])
			continue;
		x->error[i] = error_of(x, i);
		x->way[i] = way_of(x, i);
	}
	return !d->failed;
}
