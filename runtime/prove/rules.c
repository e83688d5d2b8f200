#include "prove/rules.h"
#include "dag/eval_rounding.h"
#include <float.h>
#include <math.h>

static double rounded(double unit, double tiny, double size)
{
	return unit * size + tiny;
}

/* What rounding takes from exact values up to this size, where the text's are `off` by so much at most: half a unit in
   the last place; that beside `rounded` of what they are off. */
static double rounded_exact(const struct eval_model *m, double unit, double size, double off)
{
	return unit * (m->terms > 0 ? size : fmin(size, rounding_place(size * (1 + DBL_EPSILON) + off)));
}

/* How far what the text reads is from what was meant. */
static double given(const struct rules *r, uint32_t i, const struct eval_model *m)
{
	const struct node *n = &r->d->nodes[i];
	real off;

	if (n->op == OP_INPUT && r->leaf && r->leaf[i] >= 0)
		return r->leaf[i];
	if (n->op == OP_INPUT)
		return m->input > 0 ? rounded(m->input, m->tiny, r->size[i]) : 0;
	off = fabsl((m->constant ? m->constant(n->value) : (real)(double)n->value) - n->value) +
	      (real)within_error(dag_number(r->d, n));
	return off > 0 ? (double)off * (1 + 0x1p-40) + 2 * m->tiny : 0;
}

/* How far the angle of a sine is off: an input as memory has it is exact; what was computed is rounded to memory where
   arithmetic has other numbers. */
static double off_angle(const struct rules *r, uint32_t a, const struct eval_model *m)
{
	int is_leaf = r->leaf && r->leaf[a] >= 0;

	if (r->d->nodes[a].op == OP_INPUT && !is_leaf)
		return 0;
	return r->running[a] + (m->input > 0 ? rounded(m->store, m->store_tiny + m->tiny, r->size[a] + r->running[a]) : 0);
}

double rules_angle(const struct rules *r, uint32_t a, const struct eval_model *m)
{
	return r->size[a] + off_angle(r, a, m);
}

/* A sine or cosine is off by no more than its angle is, and by its own error. */
static double rest_of_angle(struct rules *r, uint32_t i, const struct eval_model *m)
{
	const struct node *n = &r->d->nodes[i];
	double off = off_angle(r, n->arg[0].i, m);

	if (!(rules_angle(r, n->arg[0].i, m) <= m->angle))
		return (double)INFINITY;
	r->of_sum[i] = rounded_exact(m, m->sincos, r->size[i], off);
	return m->tiny + (n->op == OP_SIN ? m->sine : m->cosine) + off + m->sincos * off;
}

/* In *inherited what is linear in the errors of its operands. What roundings take from exact values is apart. */
static double rest_of(struct rules *r, uint32_t i, const struct eval_model *m, double *inherited)
{
	const struct node *n = &r->d->nodes[i];
	uint32_t a = op_arity[n->op] > 0 ? n->arg[0].i : 0, b = op_arity[n->op] > 1 ? n->arg[1].i : 0,
		 c = op_arity[n->op] > 2 ? n->arg[2].i : 0;
	double A = r->size[a], B = r->size[b], ea = r->running[a], eb = r->running[b], value = r->size[i],
	       product = A * eb + B * ea;
	double rest;

	switch (n->op) {
	case OP_CONST:
	case OP_INPUT:
		return given(r, i, m);
	case OP_NEG:
	case OP_ANEW:
		*inherited = ea;
		return 0;
	case OP_ADD:
	case OP_SUB:
		*inherited = ea + eb;
		r->of_sum[i] = rounded_exact(m, m->add, value, ea + eb);
		rest = m->terms * (A + B + ea + eb);
		return rest + rounded(m->add, m->tiny, ea + eb + rest);
	case OP_MUL:
		*inherited = product;
		r->of_product[i] = rounded_exact(m, m->mul, value, product + ea * eb);
		return ea * eb + rounded(m->mul, m->tiny, product + ea * eb);
	case OP_FMA:
		*inherited = product + r->running[c];
		r->of_product[i] = m->fused ? 0 : rounded_exact(m, m->mul, A * B, product + ea * eb);
		rest = ea * eb + (m->fused ? 0 : rounded(m->mul, m->tiny, product + ea * eb));
		rest += m->terms * (A * B + r->size[c] + *inherited + r->of_product[i] + rest);
		r->of_sum[i] = rounded_exact(m, m->add, value, *inherited + r->of_product[i] + rest);
		return rest + rounded(m->add, m->tiny, *inherited + r->of_product[i] + rest);
	case OP_SIN:
	case OP_COS:
		return rest_of_angle(r, i, m);
	default:
		return (double)INFINITY;
	}
}

double rules_size(const struct rules *r, uint32_t i, const struct eval_model *m)
{
	const struct node *n = &r->d->nodes[i];
	uint32_t a = n->arg[0].i, b = n->arg[1].i;
	double product = 0;

	if (n->op == OP_FMA)
		product = size_of_product(m, (struct known){r->size[a], r->running[a]}, (struct known){r->size[b], r->running[b]});
	return product <= r->size[i] ? r->size[i] : product;
}

double rules_node(struct rules *r, uint32_t i, const struct eval_model *m)
{
	double inherited = 0, rest;

	r->of_product[i] = r->of_sum[i] = 0;
	rest = rest_of(r, i, m, &inherited);
	rest = (rest + r->of_product[i] + r->of_sum[i]) * (1 + 0x1p-47);
	r->running[i] = (inherited + rest) * (1 + 0x1p-48);
	return rules_size(r, i, m) + r->running[i] <= m->largest ? rest : (double)INFINITY;
}
