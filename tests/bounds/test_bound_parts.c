/* Each ingredient of gen/eval's bounds by itself, in expressions of one to three operations computed as a text computes
   them: no error exceeds its bound, and the worst of many operands comes close to it, so that an ingredient left out, or
   too small by more than the share that is asked for, is seen. */
#include "dag/eval.h"
#include "emit/number_type.h"
#include "support/expression.h"
#include "templates/f32x2.h"
#include "support/rng.h"
#include "templates/sincos.h"
#include "support/suite.h"
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <string.h>

enum { SEED = 8, SAMPLES = 20000, NODES = 32 };

enum draw {
	DRAW_ANY,    /* magnitudes from 1/4 to 4 */
	DRAW_CANCEL, /* z is -x y, rounded; where there is no z, x and y are the float below 0.3's */
	DRAW_ANGLE,  /* up to 10 */
	DRAW_FAR,    /* up to 9000 */
	DRAW_TINY,   /* products are subnormal */
	DRAW_PAIRS   /* sums of two floats, next to each other's negative or not */
};

#define OPTIONS(p, t, s) {.precision = RNEAGEN_##p, .trig = RNEAGEN_##t, .strict = s}

static const struct part {
	const char *what, *expression;
	struct rneagen_options options;
	enum draw draw;
	double least; /* share of the bound that the worst error reaches */
} PARTS[] = {
	{"sum", "+ x y", OPTIONS(F32, ACCURATE, 0), DRAW_ANY, 0.95},
	{"sum", "- x y", OPTIONS(F64, ACCURATE, 0), DRAW_ANY, 0.95},
	{"product", "* x y", OPTIONS(F32, ACCURATE, 0), DRAW_ANY, 0.95},
	{"product", "* x y", OPTIONS(F64, ACCURATE, 0), DRAW_ANY, 0.95},
	{"product that underflows", "* x y", OPTIONS(F32, ACCURATE, 0), DRAW_TINY, 0.95},
	{"joined, rounded twice", "f x y z", OPTIONS(F32, ACCURATE, 0), DRAW_CANCEL, 0.95},
	{"joined, rounded twice", "f x y z", OPTIONS(F64, ACCURATE, 0), DRAW_CANCEL, 0.95},
	{"joined, rounded once", "f x y z", OPTIONS(F32, ACCURATE, 1), DRAW_ANY, 0.95},
	{"constant", "0.1", OPTIONS(F32, ACCURATE, 0), DRAW_ANY, 0.99},
	{"constant", "0.1", OPTIONS(F64, ACCURATE, 0), DRAW_ANY, 0.95},
	{"errors of operands", "* 0.1 x", OPTIONS(F32, ACCURATE, 0), DRAW_ANY, 0.5},
	{"product of errors", "* - x 0.3 - y 0.3", OPTIONS(F32, ACCURATE, 0), DRAW_CANCEL, 0.95},
	{"sine", "s x", OPTIONS(F32, ACCURATE, 0), DRAW_ANGLE, 0.6},
	{"cosine", "c x", OPTIONS(F32, BOUNDED, 0), DRAW_FAR, 0.6},
	{"sine", "s x", OPTIONS(F64, ACCURATE, 0), DRAW_ANGLE, 0.6},
	{"cosine", "c x", OPTIONS(F64, BOUNDED, 0), DRAW_FAR, 0.6},
	{"sine of a product", "s * 0.1 x", OPTIONS(F32, ACCURATE, 0), DRAW_FAR, 0.5},
	{"result as a float", "* x y", OPTIONS(MIXED, ACCURATE, 0), DRAW_ANY, 0.95},
	{"result that underflows", "* x y", OPTIONS(MIXED, ACCURATE, 0), DRAW_TINY, 0.95},
	{"input as a pair", "n x", OPTIONS(F32X2, ACCURATE, 0), DRAW_ANY, 0.8},
	{"constant as a pair", "0.1", OPTIONS(F32X2, ACCURATE, 0), DRAW_ANY, 0.6},
	{"sum of pairs", "+ x y", OPTIONS(F32X2, ACCURATE, 0), DRAW_PAIRS, 0.95},
	{"product of pairs", "* x y", OPTIONS(F32X2, ACCURATE, 0), DRAW_PAIRS, 0.85},
	{"pairs of many operations", "+ * x + x y - * 0.1 y * z + z w", OPTIONS(F32X2, ACCURATE, 0), DRAW_PAIRS, 0.7},
	{"pairs that cancel", "- * x x * + x * 0.1 y - x * 0.1 y", OPTIONS(F32X2, ACCURATE, 0), DRAW_PAIRS, 0.55},
	{"sine by pairs", "s x", OPTIONS(F32X2, ACCURATE, 0), DRAW_FAR, 0.9},
};
enum { PART_COUNT = sizeof PARTS / sizeof *PARTS };

/* ---- operands ---- */

static double any(struct rng *r)
{
	double x = ldexp(rng_uniform(r, 1, 2), rng_below(r, 4) - 2);

	return rng_chance(r, 0.5) ? -x : x;
}

static double draw_pair(struct rng *r)
{
	double hi = (double)(float)any(r);

	return hi + (double)(float)(hi * rng_uniform(r, -1, 1) * 0x1p-24);
}

/* What the text is given; floats where it has floats in memory. */
static void draw(const struct part *p, struct rng *r, double *in)
{
	int f32 = p->options.precision == RNEAGEN_F32 || p->options.precision == RNEAGEN_MIXED;
	double far = p->draw == DRAW_FAR ? 9000 : 10, product;

	for (int i = 0; i < 4; i++) {
		in[i] = p->draw == DRAW_PAIRS ? draw_pair(r) : p->draw == DRAW_ANGLE || p->draw == DRAW_FAR
			? rng_uniform(r, -far, far) : any(r);
		if (p->draw == DRAW_TINY)
			in[i] = ldexp(in[i], -72);
		in[i] = f32 ? (double)(float)in[i] : in[i];
	}
	if (p->draw != DRAW_CANCEL)
		return;
	if (strchr(p->expression, 'z')) {
		product = in[0] * in[1];
		in[2] = f32 ? -(double)(float)product : -product;
		return;
	}
	in[0] = in[1] = (double)nextafterf(0.3f, 0); /* off by 0.6 units in the last place, and 0.3f by 0.4 */
}

/* ---- as a text computes it ---- */

static void compute_f32(const struct dag *d, const double *in, int fused, double *out)
{
	float v[NODES], cosine;

	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		float a = n->op == OP_INPUT ? 0 : v[n->arg[0].i], b = n->op == OP_INPUT ? 0 : v[n->arg[1].i];
		volatile float product = a * b;

		v[i] = n->op == OP_CONST ? (float)n->value : n->op == OP_INPUT ? (float)in[n->arg[1].i] : n->op == OP_NEG ? -a :
		       n->op == OP_ADD ? a + b : n->op == OP_SUB ? a - b : n->op == OP_MUL ? product : 0;
		if (n->op == OP_FMA)
			v[i] = fused ? fmaf(a, b, v[n->arg[2].i]) : product + v[n->arg[2].i];
		if (n->op == OP_SIN)
			sincos_plain.accurate32(&a, &v[i], &cosine, 1);
		if (n->op == OP_COS)
			sincos_plain.bounded32(&a, &cosine, &v[i], 1);
	}
	*out = (double)v[d->outputs[0].value.i];
}

static void compute_f64(const struct dag *d, const double *in, int fused, double *out)
{
	double v[NODES], cosine;

	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		double a = n->op == OP_INPUT ? 0 : v[n->arg[0].i], b = n->op == OP_INPUT ? 0 : v[n->arg[1].i];
		volatile double product = a * b;

		v[i] = n->op == OP_CONST ? (double)n->value : n->op == OP_INPUT ? in[n->arg[1].i] : n->op == OP_NEG ? -a :
		       n->op == OP_ADD ? a + b : n->op == OP_SUB ? a - b : n->op == OP_MUL ? product : 0;
		if (n->op == OP_FMA)
			v[i] = fused ? fma(a, b, v[n->arg[2].i]) : product + v[n->arg[2].i];
		if (n->op == OP_SIN)
			sincos_plain.accurate64(&a, &v[i], &cosine, 1);
		if (n->op == OP_COS)
			sincos_plain.bounded64(&a, &cosine, &v[i], 1);
	}
	*out = v[d->outputs[0].value.i];
}

static void compute_pair(const struct f32x2 *f, enum op op, const float *a, const float *b, float *out)
{
	const float minus[2] = {-b[0], -b[1]};

	(op == OP_MUL ? f->mul : f->add)(a, op == OP_SUB ? minus : b, out);
}

/* A sine is taken of an input. */
static void compute_pairs(const struct dag *d, const double *in, double *out)
{
	const struct f32x2 *f = &f32x2_fma;
	float v[NODES][2], cosine[2];

	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		size_t a = n->op == OP_INPUT ? 0 : n->arg[0].i, b = n->op == OP_INPUT ? 0 : n->arg[1].i;

		if (n->op == OP_CONST) {
			v[i][0] = (float)n->value;
			v[i][1] = (float)(n->value - (real)v[i][0]);
		} else if (n->op == OP_INPUT) {
			f->split(in[n->arg[1].i], v[i]);
		} else if (n->op == OP_NEG) {
			v[i][0] = -v[a][0];
			v[i][1] = -v[a][1];
		} else if (n->op == OP_SIN) {
			f->sincos(in[d->nodes[a].arg[1].i], v[i], cosine);
		} else {
			compute_pair(f, n->op, v[a], v[b], v[i]);
		}
	}
	*out = f->join(v[d->outputs[0].value.i]);
}

static double compute(const struct part *p, const struct eval_model *m, const struct dag *d, const double *in)
{
	double out = 0;

	if (p->options.precision == RNEAGEN_F32)
		compute_f32(d, in, m->fused, &out);
	else if (p->options.precision == RNEAGEN_F32X2)
		compute_pairs(d, in, &out);
	else
		compute_f64(d, in, m->fused, &out);
	return p->options.precision == RNEAGEN_MIXED ? (double)(float)out : out;
}

/* ---- as it is ---- */

static __float128 exact(const struct dag *d, struct ref r, const double *in)
{
	const struct node *n = &d->nodes[r.i];
	__float128 x[3] = {0};

	if (n->op == OP_INPUT)
		return (__float128)in[n->arg[1].i];
	for (int k = 0; k < op_arity[n->op]; k++)
		x[k] = exact(d, n->arg[k], in);
	switch (n->op) {
	case OP_CONST:
		return (__float128)n->value;
	case OP_NEG:
		return -x[0];
	case OP_ADD:
		return x[0] + x[1];
	case OP_SUB:
		return x[0] - x[1];
	case OP_MUL:
		return x[0] * x[1];
	case OP_FMA:
		return x[0] * x[1] + x[2];
	case OP_SIN:
		return sinq(x[0]);
	default:
		return cosq(x[0]);
	}
}

START_TEST(parts)
{
	const struct part *p = &PARTS[_i];
	struct eval_model m = eval_model_of(&p->options, 0);
	struct rng r = rng_seed(SEED);
	struct arena arena;
	struct dag d;
	double in[4], bound = 0, share = 0;

	arena_init(&arena, NULL);
	expression_init(&d, &arena);
	expression_build(&d, p->expression);
	ck_assert_uint_le(d.count, NODES);
	for (int i = 0; i < SAMPLES; i++) {
		draw(p, &r, in);
		ck_assert(eval_bound(&d, &m, (const double *[]){in, NULL}, (double *[]){NULL, &bound}));
		share = fmax(share, (double)fabsq((__float128)compute(p, &m, &d, in) - exact(&d, d.outputs[0].value, in)) /
			bound);
		ck_assert_msg(share <= 1, "%s, %s: %g of the bound %g at x = %a, y = %a, z = %a", p->what, p->expression, share,
			bound, in[0], in[1], in[2]);
	}
	printf("%-24s %-26s %.2f of the bound\n", p->what, p->expression, share);
	ck_assert_msg(share >= p->least, "%s, %s: %g of the bound at most", p->what, p->expression, share);
	arena_free(&arena);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bound_parts");
	TCase *c = tcase_create("parts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("%d samples a part, seed %d\n", SAMPLES, SEED);
	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, parts, 0, PART_COUNT);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
