#include "eval.h"
#include <math.h>
#include <stdlib.h>
#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#include <quadmath.h>
#endif

/* Sine and cosine are taken to be good to this many units of rounding of their value: the text's own to 0.85 units in
   the last place, which is at most 1.7 of them, and the C library's here. */
enum { SINCOS_UNITS = 2 };

struct spread {
	double size, bound;
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

/* Magnitudes and error of a node from those of its operands a, b, c, whose computed values are a, b:
   |fl(a+b) - (a'+b')| <= e_a + e_b + u |fl(a+b)|,  |fl(ab) - a'b'| <= |a| e_b + |b| e_a + e_a e_b + u |fl(ab)| + tiny,
   with a second rounding where a product joined to a sum is rounded twice. */
static struct spread spread_of(const struct node *n, const struct spread *s, double value, double a, double b,
	double constant_error, struct grain g)
{
	const struct spread *x = &s[n->arg[0].i], *y = &s[n->arg[1].i], *z = &s[n->arg[2].i];
	double product;

	switch (n->op) {
	case OP_CONST:
		return (struct spread){fabs(value), constant_error};
	case OP_INPUT:
		return (struct spread){fabs(value), 0};
	case OP_NEG:
		return *x;
	case OP_ADD:
	case OP_SUB:
		return (struct spread){x->size + y->size, x->bound + y->bound + rounding(g, value)};
	case OP_MUL:
	case OP_FMA:
		product = fabs(a) * y->bound + fabs(b) * x->bound + x->bound * y->bound;
		if (n->op == OP_MUL)
			return (struct spread){x->size * y->size, product + rounding(g, value)};
		return (struct spread){x->size * y->size + z->size,
			product + rounding(g, a * b) + z->bound + rounding(g, value)};
	default:
		return (struct spread){fabs(value), x->bound + SINCOS_UNITS * rounding(g, value)};
	}
}

/* The bound's own rounding; nothing is known of what overflowed. */
static double bound_closed(double bound, double value)
{
	return isfinite(value) && isfinite(bound) ? bound * (1 + 1e-14) : (double)INFINITY;
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
