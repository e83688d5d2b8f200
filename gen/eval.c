#include "eval.h"
#include <math.h>
#include <stdlib.h>
#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#include <quadmath.h>
#endif

/* Sine and cosine are taken to be good to this many units of rounding. */
enum { SINCOS_UNITS = 4 };

struct spread {
	double size, bound;
};

/* Magnitudes and error of a node from those of its operands a, b, c, whose computed values are a, b:
   |fl(a+b) - (a'+b')| <= e_a + e_b + u |fl(a+b)|,  |fl(ab) - a'b'| <= |a| e_b + |b| e_a + e_a e_b + u |fl(ab)| */
static struct spread spread_of(
	const struct node *n, const struct spread *s, double value, double a, double b, int exact, double unit)
{
	const struct spread *x = &s[n->arg[0].i], *y = &s[n->arg[1].i], *z = &s[n->arg[2].i];
	double rounding = unit * fabs(value) * 1.0001; /* the computed value stands in for the exact one */
	double product;

	switch (n->op) {
	case OP_CONST:
		return (struct spread){fabs(value), exact ? 0 : rounding};
	case OP_INPUT:
		return (struct spread){fabs(value), 0};
	case OP_NEG:
		return *x;
	case OP_ADD:
	case OP_SUB:
		return (struct spread){x->size + y->size, (x->bound + y->bound + rounding) * 1.0001};
	case OP_MUL:
	case OP_FMA:
		product = fabs(a) * y->bound + fabs(b) * x->bound + x->bound * y->bound;
		if (n->op == OP_MUL)
			return (struct spread){x->size * y->size, (product + rounding) * 1.0001};
		return (struct spread){x->size * y->size + z->size, (product + z->bound + rounding) * 1.0001};
	default:
		return (struct spread){fabs(value), x->bound + SINCOS_UNITS * unit};
	}
}

#define T float
#define EVAL(name) name##_f32
#define UNIT 0x1p-24
#define T_FMA fmaf
#define T_SIN sinf
#define T_COS cosf
#include "eval.inc"
#undef T
#undef EVAL
#undef UNIT
#undef T_FMA
#undef T_SIN
#undef T_COS

#define T double
#define EVAL(name) name##_f64
#define UNIT 0x1p-53
#define T_FMA fma
#define T_SIN sin
#define T_COS cos
#include "eval.inc"
#undef T
#undef EVAL
#undef UNIT
#undef T_FMA
#undef T_SIN
#undef T_COS

#define T real
#define EVAL(name) name##_real
#define UNIT 0x1p-64
#define T_FMA fmal
#define T_SIN sinl
#define T_COS cosl
#include "eval.inc"
#undef T
#undef EVAL
#undef UNIT
#undef T_FMA
#undef T_SIN
#undef T_COS

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#define T __float128
#define EVAL(name) name##_quad
#define UNIT 0x1p-113
#define T_FMA fmaq
#define T_SIN sinq
#define T_COS cosq
#include "eval.inc"
#endif
