#include "eval.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#include <quadmath.h>
#endif

/* Sine and cosine are taken to be good to this many units of rounding of their value: the text's own to 0.85 units in
   the last place, which is at most 1.7 of them, and the C library's here. */
enum { SINCOS_UNITS = 2 };

struct spread {
	double size, bound; /* magnitudes that were summed; running bound */
	double local;	    /* what this node adds to the error */
	int swept;	    /* the bound is as close as it gets */
};

/* A DAG's values and what is known of them so far. */
struct survey {
	const struct dag *d;
	double *values, *slope; /* slope: for swept_bound */
	struct spread *spread;
};

/* Half an ulp of 1; half the smallest number of a type, or enough for the underflow of the bound itself. */
struct grain {
	double unit, tiny;
};

/* |fl(x) - x| <= u |fl(x)| + tiny; the computed value stands in for the exact one */
static double rounding(struct grain g, double value)
{
	return g.unit * fabs(value) + g.tiny;
}

/* Magnitudes and error of a node from those of its operands x, y, z, whose computed values are a, b, c:
   |fl(a+b) - (a'+b')| <= e_a + e_b + u |fl(a+b)|,  |fl(ab) - a'b'| <= |a| e_b + |b| e_a + e_a e_b + u |fl(ab)| + tiny,
   with a second rounding where a product joined to a sum is rounded twice. */
static struct spread spread_of(const struct node *n, const struct spread *s, double value, double a, double b,
	double constant_error, struct grain g)
{
	const struct spread *x = &s[n->arg[0].i], *y = &s[n->arg[1].i], *z = &s[n->arg[2].i];
	double local, linear = fabs(a) * y->bound + fabs(b) * x->bound;

	switch (n->op) {
	case OP_CONST:
		return (struct spread){fabs(value), constant_error, constant_error, 1};
	case OP_INPUT:
		return (struct spread){fabs(value), 0, 0, 1};
	case OP_NEG:
		return (struct spread){x->size, x->bound, 0, x->swept};
	case OP_ADD:
	case OP_SUB:
		local = rounding(g, value);
		return (struct spread){x->size + y->size, x->bound + y->bound + local, local, 0};
	case OP_MUL:
		local = x->bound * y->bound + rounding(g, value);
		return (struct spread){x->size * y->size, linear + local, local, 0};
	case OP_FMA:
		local = x->bound * y->bound + rounding(g, a * b) + rounding(g, value);
		return (struct spread){x->size * y->size + z->size, linear + z->bound + local, local, 0};
	default:
		local = x->bound * x->bound / 2 + SINCOS_UNITS * rounding(g, value);
		return (struct spread){fabs(value), x->bound + local, local, 0};
	}
}

/* A bound's own rounding; nothing is known of what overflowed. */
static double bound_closed(double bound)
{
	return isfinite(bound) ? bound * (1 + 1e-14) : (double)INFINITY;
}

/* The value's derivatives by its operands; sine and cosine by their angle. */
static void derivatives(const struct node *n, const double *v, double *out)
{
	double a = v[n->arg[0].i], b = v[n->arg[1].i];

	switch (n->op) {
	case OP_MUL:
	case OP_FMA:
		out[0] = b;
		out[1] = a;
		out[2] = 1;
		break;
	case OP_SIN:
		out[0] = cos(a);
		break;
	case OP_COS:
		out[0] = -sin(a);
		break;
	default:
		out[0] = n->op == OP_NEG ? -1 : 1;
		out[1] = n->op == OP_SUB ? -1 : 1;
	}
}

/* The error of a value is the sum of what each node adds, times the value's derivative by the node, where products of
   errors count to the node that multiplies them: unlike the running bound this sees what cancels on different ways. */
static double swept_bound(const struct survey *x, size_t root)
{
	double sum = 0, by[3];

	memset(x->slope, 0, (root + 1) * sizeof *x->slope);
	x->slope[root] = 1;
	for (size_t i = root + 1; i-- > 0;) {
		const struct node *n = &x->d->nodes[i];

		if (x->slope[i] == 0)
			continue;
		sum += fabs(x->slope[i]) * x->spread[i].local;
		derivatives(n, x->values, by);
		for (int k = 0; k < op_arity[n->op]; k++)
			x->slope[n->arg[k].i] += x->slope[i] * by[k];
	}
	return bound_closed(sum * (1 + 1e-6));
}

/* The lesser of the running bound, which grows without need along a chain, and the swept one, which takes time. */
static void sweep(const struct survey *x, size_t i)
{
	struct spread *s = &x->spread[i];

	if (!s->swept && isfinite(x->values[i]))
		s->bound = fmin(s->bound, swept_bound(x, i));
	s->swept = 1;
}

/* Where a product of two running bounds is more than the rounding of the node, closer bounds pay. */
static void survey_node(const struct survey *x, size_t i, double constant_error, struct grain g)
{
	const struct node *n = &x->d->nodes[i];
	size_t a = n->arg[0].i, b = n->arg[op_arity[n->op] > 1].i;
	int multiplies = n->op != OP_INPUT && n->op != OP_CONST && n->op != OP_NEG && n->op != OP_ADD && n->op != OP_SUB;
	double value = x->values[i];

	if (multiplies && x->spread[a].bound * x->spread[b].bound > rounding(g, value)) {
		sweep(x, a);
		sweep(x, b);
	}
	x->spread[i] = spread_of(n, x->spread, value, x->values[a], x->values[b], constant_error, g);
	x->spread[i].bound = isfinite(value) ? bound_closed(x->spread[i].bound) : (double)INFINITY;
}

/* Of the outputs. */
static void survey_outputs(const struct survey *x, const struct eval_terms *terms)
{
	for (size_t i = 0; i < x->d->output_count; i++) {
		size_t root = x->d->outputs[i].value.i;

		if (terms->size)
			terms->size[i] = x->spread[root].size;
		if (!terms->bound)
			continue;
		sweep(x, root);
		terms->bound[i] = x->spread[root].bound;
	}
}

#define T float
#define EVAL(name) name##_f32
#define GRAIN ((struct grain){0x1p-24, 0x1p-150})
#define T_FMA fmaf
#define T_SIN sinf
#define T_COS cosf
#include "eval.inc"
#undef T
#undef EVAL
#undef GRAIN
#undef T_FMA
#undef T_SIN
#undef T_COS

#define T double
#define EVAL(name) name##_f64
#define GRAIN ((struct grain){0x1p-53, 0x1p-1072})
#define T_FMA fma
#define T_SIN sin
#define T_COS cos
#include "eval.inc"
#undef T
#undef EVAL
#undef GRAIN
#undef T_FMA
#undef T_SIN
#undef T_COS

#define T real
#define EVAL(name) name##_real
#define GRAIN ((struct grain){0x1p-64, 0x1p-1072})
#define T_FMA fmal
#define T_SIN sinl
#define T_COS cosl
#include "eval.inc"
#undef T
#undef EVAL
#undef GRAIN
#undef T_FMA
#undef T_SIN
#undef T_COS

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#define T __float128
#define EVAL(name) name##_quad
#define GRAIN ((struct grain){0x1p-113, 0x1p-1072})
#define T_FMA fmaq
#define T_SIN sinq
#define T_COS cosq
#include "eval.inc"
#endif
