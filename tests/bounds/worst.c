#include "worst.h"
#include <quadmath.h>
#include <stdlib.h>

static __float128 off(struct rng *rng, __float128 value, double relative, double absolute)
{
	double sign = rng_uniform(rng, -1, 1) < 0 ? -1 : 1;

	return value + (__float128)sign * ((__float128)relative * fabsq(value) + (__float128)absolute);
}

static __float128 worst_node(
	const struct node *n, const struct eval_model *m, struct rng *rng, const double *const *in, const __float128 *v)
{
	__float128 a = op_arity[n->op] > 0 ? v[n->arg[0].i] : 0, b = op_arity[n->op] > 1 ? v[n->arg[1].i] : 0;

	switch (n->op) {
	case OP_CONST:
		return (__float128)m->constant(n->value);
	case OP_INPUT:
		return (__float128)in[n->arg[0].i][n->arg[1].i];
	case OP_NEG:
		return -a;
	case OP_ADD:
		return off(rng, a + b, m->add, 0);
	case OP_SUB:
		return off(rng, a - b, m->add, 0);
	case OP_MUL:
		return off(rng, a * b, m->mul, m->tiny);
	case OP_FMA:
		a = m->fused ? a * b : off(rng, a * b, m->mul, m->tiny);
		return off(rng, a + v[n->arg[2].i], m->add, m->tiny);
	case OP_DIV:
		return off(rng, a / b, m->mul, m->tiny);
	case OP_SQRT:
		return off(rng, sqrtq(a), m->mul, m->tiny);
	case OP_ABS:
		return fabsq(a);
	case OP_SIN:
		return off(rng, sinq(a), m->sincos, m->sine);
	default:
		return off(rng, cosq(a), m->sincos, m->cosine);
	}
}

void worst_evaluate(const struct dag *d, const struct eval_model *m, struct rng *rng, const double *const *in, double *const *out)
{
	__float128 *v = calloc(d->count, sizeof *v);

	if (!v)
		abort();
	for (size_t i = 0; i < d->count; i++)
		v[i] = worst_node(&d->nodes[i], m, rng, in, v);
	for (size_t i = 0; i < d->output_count; i++) {
		const struct output *o = &d->outputs[i];

		out[o->argument][o->row] = (double)off(rng, v[o->value.i], m->store, m->store_tiny);
	}
	free(v);
}
