#include "relax/friction.h"

static int is_positive(const struct dag *d, uint32_t i)
{
	return d->nodes[i].op == OP_CONST && d->nodes[i].value > 0;
}

/* v v + w, in one operation or in two */
static int sum_of(const struct dag *d, uint32_t i, struct friction *f)
{
	const struct node *n = &d->nodes[i];
	int first = n->op == OP_ADD && is_positive(d, n->arg[0].i);
	const struct node *square = n->op == OP_ADD ? &d->nodes[n->arg[first].i] : n;

	f->sum = i;
	f->rate = square->arg[0].i;
	f->square = n->op == OP_ADD ? n->arg[!first].i : n->arg[2].i;
	return (n->op == OP_FMA || (n->op == OP_ADD && square->op == OP_MUL)) && square->arg[1].i == f->rate &&
	       is_positive(d, f->square);
}

/* c v, or v */
static int product_of(const struct dag *d, uint32_t i, struct friction *f)
{
	const struct node *n = &d->nodes[i];

	f->product = i;
	f->slope = 0;
	if (i == f->rate)
		return 1;
	for (int k = 0; k < 2 && n->op == OP_MUL; k++)
		if (dag_bare(d, n->arg[k].i, &f->sign) == f->rate && d->nodes[n->arg[!k].i].op == OP_CONST) {
			f->slope = n->arg[!k].i;
			return 1;
		}
	return 0;
}

int friction_of(const struct dag *d, uint32_t i, struct friction *f)
{
	const struct node *n = &d->nodes[i];

	*f = (struct friction){.sign = 1};
	if (n->op != OP_DIV || d->nodes[n->arg[1].i].op != OP_SQRT)
		return 0;
	f->root = n->arg[1].i;
	return sum_of(d, d->nodes[f->root].arg[0].i, f) && product_of(d, dag_bare(d, n->arg[0].i, &f->sign), f);
}

/* Extended precision is far closer than 2^-48. */
static double at(real c, real w, double v)
{
	return (double)(c * (real)v / sqrtl((real)v * (real)v + w));
}

struct interval friction_range(const struct dag *d, const struct friction *f, struct interval rate)
{
	real c = (real)f->sign * (f->slope ? d->nodes[f->slope].value : 1), w = d->nodes[f->square].value;
	double a = at(c, w, rate.lower), b = at(c, w, rate.upper), wider = 0x1p-48 * fabs((double)c) + 0x1p-1000;

	return (struct interval){interval_least(a, b) - wider, interval_most(a, b) + wider};
}
