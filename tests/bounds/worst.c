#include "worst.h"
#include "templates/f32x2.h"
#include <quadmath.h>
#include <stdlib.h>

/* Half units in the last place, `unit` for one of 1: of the power of two at or below |value|. */
static __float128 off(struct rng *rng, __float128 value, double unit, double absolute)
{
	double sign = rng_uniform(rng, -1, 1) < 0 ? -1 : 1;
	__float128 place = value == 0 ? 0 : scalbnq(1, ilogbq(value));

	return value + (__float128)sign * ((__float128)unit * place + (__float128)absolute);
}

/* A given power of two, or 0, as a factor leaves all bits. */
static int is_scale(const struct dag *d, uint32_t i, __float128 value)
{
	while (d->nodes[i].op == OP_NEG || d->nodes[i].op == OP_ABS || d->nodes[i].op == OP_ANEW)
		i = d->nodes[i].arg[0].i;
	return op_arity[d->nodes[i].op] == 0 && (value == 0 || fabsq(value) == scalbnq(1, ilogbq(value)));
}

static __float128 product(
	const struct dag *d, const struct node *n, const struct eval_model *m, struct rng *rng, const __float128 *v)
{
	__float128 a = v[n->arg[0].i], b = v[n->arg[1].i];

	return is_scale(d, n->arg[0].i, a) || is_scale(d, n->arg[1].i, b) ? a * b : off(rng, a * b, m->mul, m->tiny);
}

/* ---- pairs of floats, as they are ---- */

static __float128 pair(__float128 x)
{
	float hi = (float)x;

	return (__float128)hi + (__float128)(float)(x - (__float128)hi);
}

/* An operation of templates/arithmetic/f32x2.in, with a fused multiply-add or without. */
static __float128 by_pairs(const struct f32x2 *f, const struct node *n, const __float128 *v)
{
	float x[3][2], out[2];

	for (int k = 0; k < op_arity[n->op]; k++) {
		x[k][0] = (float)v[n->arg[k].i];
		x[k][1] = (float)(v[n->arg[k].i] - (__float128)x[k][0]);
	}
	if (n->op == OP_SUB) {
		x[1][0] = -x[1][0];
		x[1][1] = -x[1][1];
	}
	if (n->op == OP_FMA)
		f->fma(x[0], x[1], x[2], out);
	else
		(n->op == OP_MUL ? f->mul : f->add)(x[0], x[1], out);
	return (__float128)out[0] + (__float128)out[1];
}

/* Its sine reads all of an angle that is an input. */
static __float128 turn_by_pairs(
	const struct f32x2 *f, const struct dag *d, const struct node *n, const double *const *in, __float128 angle)
{
	const struct node *of = &d->nodes[n->arg[0].i];
	float sine[2], cosine[2];
	const float *x = n->op == OP_SIN ? sine : cosine;

	f->sincos(of->op == OP_INPUT ? in[of->arg[0].i][of->arg[1].i] : (double)angle, sine, cosine);
	return (__float128)x[0] + (__float128)x[1];
}

static int is_of_pairs(const struct eval_model *m, enum op op)
{
	return m->terms > 0 && (op == OP_ADD || op == OP_SUB || op == OP_MUL || op == OP_FMA);
}

static __float128 worst_node(const struct dag *d, const struct node *n, const struct eval_model *m, const struct f32x2 *pairs,
	struct rng *rng, const double *const *in, const __float128 *v)
{
	__float128 a = op_arity[n->op] > 0 ? v[n->arg[0].i] : 0, b = op_arity[n->op] > 1 ? v[n->arg[1].i] : 0;

	if (is_of_pairs(m, n->op))
		return by_pairs(pairs, n, v);
	switch (n->op) {
	case OP_CONST:
		return (__float128)m->constant(n->value);
	case OP_INPUT:
		return m->terms > 0 ? pair((__float128)in[n->arg[0].i][n->arg[1].i]) : (__float128)in[n->arg[0].i][n->arg[1].i];
	case OP_NEG:
		return -a;
	case OP_ADD:
		return off(rng, a + b, m->add, 0);
	case OP_SUB:
		return off(rng, a - b, m->add, 0);
	case OP_MUL:
		return product(d, n, m, rng, v);
	case OP_FMA:
		a = m->fused ? a * b : product(d, n, m, rng, v);
		return off(rng, a + v[n->arg[2].i], m->add, m->tiny);
	case OP_DIV:
		return off(rng, a / b, m->mul, m->tiny);
	case OP_SQRT:
		return off(rng, sqrtq(a), m->mul, m->tiny);
	case OP_ABS:
		return fabsq(a);
	case OP_SIN:
		return m->terms > 0 ? turn_by_pairs(pairs, d, n, in, a) : off(rng, sinq(a), m->sincos, m->sine);
	default:
		return m->terms > 0 ? turn_by_pairs(pairs, d, n, in, a) : off(rng, cosq(a), m->sincos, m->cosine);
	}
}

void worst_evaluate(const struct dag *d, const struct eval_model *m, struct rng *rng, const double *const *in, double *const *out)
{
	__float128 *v = calloc(d->count, sizeof *v);
	const struct f32x2 *pairs = m->terms > 0 && rng_chance(rng, 0.5) ? &f32x2_fma : &f32x2_plain; /* of one machine */

	if (!v)
		abort();
	for (size_t i = 0; i < d->count; i++)
		v[i] = worst_node(d, &d->nodes[i], m, pairs, rng, in, v);
	for (size_t i = 0; i < d->output_count; i++) {
		const struct output *o = &d->outputs[i];
		const __float128 x = v[o->value.i];

		out[o->argument][o->row] = x == 0 ? 0 : (double)off(rng, x, m->store, m->store_tiny); /* what is 0 is stored as 0 */
	}
	free(v);
}
