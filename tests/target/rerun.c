/* Compiled without contraction. */
#include "target/rerun.h"
#include <check.h>
#include <math.h>
#include <stdlib.h>

/* A sum or product of two floats, rounded to double and then to float, is as if rounded once. */
static double rounded(const struct target *t, double x)
{
	return t->f32_inside ? (double)(float)x : x;
}

/* What memory has of a result. */
static double stored(const struct target *t, double x)
{
	return t->f32 ? (double)(float)x : x;
}

static double multiply_add(const struct target *t, int fused, double a, double b, double c)
{
	if (!fused)
		return rounded(t, rounded(t, a * b) + c);
	return t->f32_inside ? (double)fmaf((float)a, (float)b, (float)c) : fma(a, b, c);
}

static double sine_or_cosine(const struct target *t, enum op op, double x)
{
	double s, c;

	target_sincos(t, x, &s, &c);
	return op == OP_SIN ? s : c;
}

static double node_value(const struct node *n, const struct target *t, int fused, const double *v)
{
	double a = v[n->arg[0].i], b = v[n->arg[1].i], c = v[n->arg[2].i];

	switch (n->op) {
	case OP_CONST:
		return t->f32_inside ? (double)(float)n->value : (double)n->value;
	case OP_NEG:
		return -a;
	case OP_ADD:
		return rounded(t, a + b);
	case OP_SUB:
		return rounded(t, a - b);
	case OP_MUL:
		return rounded(t, a * b);
	case OP_FMA:
		return multiply_add(t, fused, a, b, c);
	default:
		return sine_or_cosine(t, n->op, a);
	}
}

void rerun(const struct dag *d, const struct target *t, int fused, const double *const *in, double *const *out)
{
	double *v = calloc(d->count, sizeof *v);

	ck_assert_ptr_nonnull(v);
	for (size_t i = 0; i < d->count; i++)
		if (d->nodes[i].op == OP_INPUT) /* its operands are no nodes */
			v[i] = in[d->nodes[i].arg[0].i][d->nodes[i].arg[1].i];
		else
			v[i] = node_value(&d->nodes[i], t, fused, v);
	for (size_t i = 0; i < d->output_count; i++)
		out[d->outputs[i].argument][d->outputs[i].row] = stored(t, v[d->outputs[i].value.i]);
	free(v);
}
