#include "dag/eval.h"
#include "dag/eval_rounding.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#include <quadmath.h>
#endif

struct spread {
	double size, bound; /* magnitudes that were summed; running bound */
	double local;	    /* what this node adds to the error */
	int swept;	    /* the bound is as close as it gets */
	double left_out;    /* what its value is less beside that, which is known */
};

/* How far what a text reads is from what was meant: it has left_out less, and is at most `off` beside that. */
struct given {
	double off, left_out;
};

/* A DAG's values and what is known of them so far. */
struct survey {
	const struct dag *d;
	double *values, *slope; /* slope: for swept_bound */
	struct spread *spread;
};

/* An argument that is a node; an input's arguments are none. */
static size_t operand(const struct node *n, int k)
{
	return k < op_arity[n->op] ? n->arg[k].i : 0;
}

/* Sine and cosine take their angle as memory has it: an input as it is; what was computed, where arithmetic has other
   numbers than memory, rounded like a result. */
static int is_read(const struct survey *v, const struct node *n)
{
	return (n->op == OP_SIN || n->op == OP_COS) && v->d->nodes[n->arg[0].i].op == OP_INPUT;
}

static struct spread spread_of_angle(const struct survey *v, size_t i, const struct eval_model *m)
{
	const struct node *n = &v->d->nodes[i];
	double angle = v->values[operand(n, 0)], inherited = is_read(v, n) ? 0 : v->spread[operand(n, 0)].bound, left_out;
	double local = m->input > 0 && !is_read(v, n) ? m->store * (fabs(angle) + inherited) : 0, error = inherited + local;

	local += error * error / 2 + rounding_of_turn(m, n->op == OP_SIN, (struct known){angle, error}, v->values[i], &left_out);
	return (struct spread){fabs(v->values[i]), inherited + local + fabs(left_out), local, 0, left_out};
}

/* Of the type that a node is of. */
static const struct eval_model *model_of(const struct node *n, const struct eval_model *m)
{
	return n->is_wide && m->wide ? m->wide : m;
}

/* Of a b + c: the products of errors, the product's own rounding, unless it is rounded with the sum, and the sum's. */
static double local_of_joined(
	const struct eval_model *m, struct known a, struct known b, struct known c, double value, double *left_out)
{
	double product = fabs(a.x) * b.e + fabs(b.x) * a.e, local = a.e * b.e;
	struct known p = {a.x * b.x, product + local};

	local += m->fused ? 0 : rounding_of_product(m, a, b, p, left_out);
	p.x -= *left_out;
	p.e = product + local;
	return local + rounding_of_sum(m, p, c, (struct known){value, p.e + c.e});
}

/* Magnitudes and error of a node from those of its operands x, y, z, whose values are a, b, c (roundings: eval_rounding.h):
   |fl(a+b) - (a'+b')| <= e_a + e_b + its rounding,  |fl(ab) - a'b'| <= |a| e_b + |b| e_a + e_a e_b + its rounding. */
static struct spread spread_of(const struct survey *v, size_t i, struct given given, const struct eval_model *m)
{
	const struct node *n = &v->d->nodes[i];
	const struct spread *x = &v->spread[operand(n, 0)], *y = &v->spread[operand(n, 1)], *z = &v->spread[operand(n, 2)];
	const struct known a = {v->values[operand(n, 0)], x->bound}, b = {v->values[operand(n, 1)], y->bound};
	double left_out = 0, value = v->values[i], local, sum = a.e + b.e, square = a.e * b.e,
	       product = fabs(a.x) * b.e + fabs(b.x) * a.e;

	switch (n->op) {
	case OP_CONST:
	case OP_INPUT:
		return (struct spread){fabs(value), given.off + fabs(given.left_out), given.off, 1, given.left_out};
	case OP_NEG:
	case OP_ABS:
	case OP_ANEW:
	case OP_WIDEN:
		return (struct spread){x->size, x->bound, 0, x->swept, 0};
	case OP_NARROW:
		local = m->wide ? rounding_of_result(m, m->add, (struct known){value, x->bound}) : 0;
		if (m->wide && m->wide->terms > 0) /* a pair's first float may miss the nearest by its last roundings */
			local += 5 * 0x1p-48 * (fabs(value) + x->bound);
		return (struct spread){x->size, x->bound + local, local, 0, 0};
	case OP_ADD:
	case OP_SUB:
		local = rounding_of_sum(m, a, n->op == OP_SUB ? (struct known){-b.x, b.e} : b, (struct known){value, sum});
		return (struct spread){x->size + y->size, sum + local, local, 0, 0};
	case OP_MUL:
		local = square + rounding_of_product(m, a, b, (struct known){value, product + square}, &left_out);
		return (struct spread){x->size * y->size, product + local + fabs(left_out), local, 0, left_out};
	case OP_FMA:
		local = local_of_joined(m, a, b, (struct known){v->values[operand(n, 2)], z->bound}, value, &left_out);
		return (struct spread){x->size * y->size + z->size, product + z->bound + local + fabs(left_out), local, 0, left_out};
	case OP_DIV:
		sum = (a.e + fabs(value) * b.e) / fabs(b.x);
		local = rest_of_quotient(value, b.x, a.e, b.e);
		local += (m->quotient + m->own) * (fabs(value) + sum + local) + m->tiny;
		return (struct spread){x->size / fabs(b.x), sum + local, local, 0, 0};
	case OP_SQRT:
		sum = a.e > 0 ? a.e / (2 * value) : 0;
		local = rest_of_root(value, a.x, a.e);
		local += rounding_of_result(m, m->mul, (struct known){value, sum + local});
		return (struct spread){fabs(value), sum + local, local, 0, 0};
	default:
		return spread_of_angle(v, i, m);
	}
}

/* A bound's own rounding; nothing is known of what overflowed. */
static double bound_closed(double bound)
{
	return isfinite(bound) ? bound * (1 + 1e-14) : (double)INFINITY;
}

/* The error of a value is the sum of what each node adds, times the value's derivative by the node, where products of
   errors count to the node that multiplies them: unlike the running bound this sees what cancels on different ways. */
static double swept_bound(const struct survey *x, size_t root)
{
	double sum = 0, left_out = 0, all = 0, by[3];

	memset(x->slope, 0, (root + 1) * sizeof *x->slope);
	x->slope[root] = 1;
	for (size_t i = root + 1; i-- > 0;) {
		const struct node *n = &x->d->nodes[i];

		if (x->slope[i] == 0)
			continue;
		sum += fabs(x->slope[i]) * x->spread[i].local;
		left_out += x->slope[i] * x->spread[i].left_out;
		all += fabs(x->slope[i] * x->spread[i].left_out);
		eval_partials(n, x->values, by);
		for (int k = 0; k < op_arity[n->op] && !is_read(x, n); k++)
			x->slope[n->arg[k].i] += x->slope[i] * by[k];
	}
	return bound_closed((sum + fabs(left_out)) * (1 + 1e-6) + 1e-9 * all);
}

/* The lesser of the running bound, which grows without need along a chain, and the swept one, which takes time. */
static void sweep(const struct survey *x, size_t i)
{
	struct spread *s = &x->spread[i];

	if (!s->swept && isfinite(x->values[i]))
		s->bound = fmin(s->bound, swept_bound(x, i));
	s->swept = 1;
}

/* Of a node's error what is not linear in those of its operands, about. */
static double rest_of(const struct survey *x, const struct node *n, double value)
{
	size_t a = operand(n, 0), b = operand(n, op_arity[n->op] > 1);
	double of_a = x->spread[a].bound, of_b = x->spread[b].bound;

	switch (n->op) {
	case OP_MUL:
	case OP_FMA:
	case OP_SIN:
	case OP_COS:
		return of_a * of_b;
	case OP_DIV:
		return rest_of_quotient(value, x->values[b], of_a, of_b);
	case OP_SQRT:
		return rest_of_root(value, x->values[a], of_a);
	default:
		return 0;
	}
}

/* Where that is more than the rounding of the node, closer bounds of the operands pay. */
static void survey_node(const struct survey *x, size_t i, struct given given, const struct eval_model *m)
{
	const struct node *n = &x->d->nodes[i];
	size_t a = operand(n, 0), b = operand(n, op_arity[n->op] > 1);
	double value = x->values[i], product = 0;

	if (rest_of(x, n, value) > m->mul * fabs(value) + m->tiny) {
		sweep(x, a);
		sweep(x, b);
	}
	x->spread[i] = spread_of(x, i, given, m);
	x->spread[i].bound = bound_closed(x->spread[i].bound);
	if (n->op == OP_FMA)
		product = size_of_product(
			m, (struct known){x->values[a], x->spread[a].bound}, (struct known){x->values[b], x->spread[b].bound});
	if (!(fabs(value) + x->spread[i].bound <= m->largest))
		sweep(x, i);
	if (!(fabs(value) + x->spread[i].bound <= m->largest && product <= m->largest)) /* it may overflow */
		x->spread[i].bound = x->spread[i].local = (double)INFINITY;
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

static struct survey survey_new(const struct dag *d)
{
	return (struct survey){
		d, malloc(d->count * sizeof(double)), malloc(d->count * sizeof(double)), calloc(d->count, sizeof(struct spread))};
}

static int survey_is_made(const struct survey *x)
{
	return x->values && x->slope && x->spread;
}

static void survey_free(struct survey *x)
{
	free(x->values);
	free(x->slope);
	free(x->spread);
}

/* What rounding takes from a constant, and how far that is from what the file's decimals give. */
static struct given constant_error(const struct dag *d, const struct node *n, real rounded, double tiny)
{
	double error = within_error(dag_number(d, n));

	if (n->op != OP_CONST || (rounded == n->value && error == 0))
		return (struct given){0, 0};
	return (struct given){(double)fabsl(rounded - n->value) * (1 + DBL_EPSILON) + error + 2 * tiny, 0};
}

#define T double
#define EVAL(name) name##_f64
#define UNIT 0x1p-53
#define TINY 0x1p-1072
#define LARGEST DBL_MAX
#define T_FMA fma
#define T_SIN sin
#define T_COS cos
#define T_SQRT sqrt
#include "dag/eval.inc"

#define T float
#define EVAL(name) name##_f32
#define T_WIDE double
#define EVAL_WIDE(name) name##_f64
#define UNIT 0x1p-24
#define TINY 0x1p-150
#define LARGEST (double)FLT_MAX
#define T_FMA fmaf
#define T_SIN sinf
#define T_COS cosf
#define T_SQRT sqrtf
#include "dag/eval.inc"

#define T real
#define EVAL(name) name##_real
#define UNIT ((double)LDBL_EPSILON / 2)
#define TINY 0x1p-1072
#define LARGEST DBL_MAX
#define T_FMA fmal
#define T_SIN sinl
#define T_COS cosl
#define T_SQRT sqrtl
#include "dag/eval.inc"

/* The text's operations, and those in extended precision that stand for the exact ones: what the two may differ by adds
   up, since the analysis is linear in the errors of operations but for products of them, which only gain. */
static struct eval_model with_own(const struct eval_model *m)
{
	struct eval_model both = *m;

	both.own = 2 * (double)LDBL_EPSILON;
	return both;
}

/* Rounding on the way to memory; nothing is known of what is too large for it, and what is 0 for certain stays 0. */
static double stored_bound(const struct eval_model *m, double value, double bound)
{
	double most = fabs(value) + bound;

	if (!(most <= m->store_largest))
		return (double)INFINITY;
	return m->store == 0 || most == 0 ? bound
		: bound_closed(bound + rounding_of_result(m, m->store, (struct known){value, bound}) + m->store_tiny);
}

/* No less than they are already. */
static void put_bounds(const struct survey *x, const struct eval_model *m, double *const *bound)
{
	for (size_t i = 0; i < x->d->output_count; i++) {
		const struct output *o = &x->d->outputs[i];

		sweep(x, o->value.i);
		bound[o->argument][o->row] =
			fmax(bound[o->argument][o->row], stored_bound(m, x->values[o->value.i], x->spread[o->value.i].bound));
	}
}

double eval_node(const struct node *n, const double *v)
{
	return node_f64(n, v, NULL);
}

double eval_operation(enum op op, double a, double b, double c)
{
	return operation_f64(op, a, b, c);
}

/* Values in extended precision by node; inputs are exact in it. */
static void evaluate_node(const struct dag *d, size_t i, const double *const *in, real *v)
{
	const struct node *n = &d->nodes[i];

	v[i] = 0;
	v[i] = n->op == OP_INPUT ? (real)in[n->arg[0].i][n->arg[1].i] : node_real(n, v, NULL);
}

/* How far what the text reads is from what was meant: constants and, where arithmetic has fewer bits than memory, inputs. */
static struct given given_error(const struct dag *d, const struct node *n, double value, const struct eval_model *m)
{
	struct given given = {0, 0};

	if (n->op == OP_CONST)
		return constant_error(d, n, m->constant(n->value), m->tiny);
	if (n->op == OP_INPUT)
		given.off = rounding_of_input(m, value, &given.left_out);
	return given;
}

static int bound_by(const struct dag *d, const struct eval_model *m, const double *const *in, double *const *bound)
{
	struct eval_model both = with_own(m), wide = with_own(m->wide ? m->wide : m);
	struct survey x = survey_new(d);
	real *v = malloc(d->count * sizeof *v);
	int done = v && survey_is_made(&x);

	both.wide = m->wide ? &wide : NULL;
	for (size_t i = 0; done && i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		evaluate_node(d, i, in, v);
		x.values[i] = (double)v[i];
		survey_node(&x, i, given_error(d, n, x.values[i], model_of(n, m)), model_of(n, &both));
	}
	if (done)
		put_bounds(&x, m, bound);
	survey_free(&x);
	free(v);
	return done;
}

/* As if all products of pairs were made one way. */
static int bound_by_products(
	const struct dag *d, const struct eval_model *m, enum pair_products by, const double *const *in, double *const *bound)
{
	struct eval_model own = *m, wide = m->wide ? *m->wide : *m;

	own.products = wide.products = by;
	own.wide = m->wide ? &wide : NULL;
	return bound_by(d, &own, in, bound);
}

int eval_bound(const struct dag *d, const struct eval_model *m, const double *const *in, double *const *bound)
{
	const struct eval_model *pairs = m->wide ? m->wide : m;

	for (size_t i = 0; i < d->output_count; i++)
		bound[d->outputs[i].argument][d->outputs[i].row] = 0;
	if (pairs->terms > 0 && pairs->products == PAIRS_EITHER)
		return bound_by_products(d, m, PAIRS_FUSED, in, bound) && bound_by_products(d, m, PAIRS_BY_HALVES, in, bound);
	return bound_by(d, m, in, bound);
}

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#define T __float128
#define EVAL(name) name##_quad
#define UNIT 0x1p-113
#define TINY 0x1p-1072
#define LARGEST DBL_MAX
#define T_FMA fmaq
#define T_SIN sinq
#define T_COS cosq
#define T_SQRT sqrtq
#include "dag/eval.inc"
#endif
