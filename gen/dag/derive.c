#include "dag/derive.h"
#include <string.h>

int derive_begin(struct derivable *x, struct dag *d, const struct ref *roots, int root_count)
{
	*x = (struct derivable){.d = d, .count = (uint32_t)d->count, .roots = roots, .root_count = root_count};
	x->live = arena_alloc(d->arena, d->count, 1);
	if (!x->live)
		return 0;
	for (int k = 0; k < root_count; k++)
		x->live[roots[k].i] = 1;
	dag_mark_operands(d, x->count, x->live);
	return 1;
}

/* The derivative of node i by its operand k; d(a/b) = (da - a/b db)/b, d sqrt(a) = da/(2 sqrt(a)), d |a| = a/|a| da. */
static struct ref partial(struct dag *d, uint32_t i, int k)
{
	const struct node n = d->nodes[i]; /* a copy: nodes move as they grow in number */
	const struct ref me = {i};

	switch (n.op) {
	case OP_NEG:
		return dag_const(d, -1);
	case OP_SUB:
		return dag_const(d, k == 1 ? -1 : 1);
	case OP_MUL:
		return n.arg[!k];
	case OP_FMA:
		return k == 2 ? dag_const(d, 1) : n.arg[!k];
	case OP_DIV:
		return k == 0 ? dag_div(d, dag_const(d, 1), n.arg[1]) : dag_neg(d, dag_div(d, me, n.arg[1]));
	case OP_SQRT:
		return dag_div(d, dag_const(d, 0.5L), me);
	case OP_ABS:
		return dag_div(d, n.arg[0], me);
	case OP_SIN:
		return dag_cos(d, n.arg[0]);
	case OP_COS:
		return dag_neg(d, dag_sin(d, n.arg[0]));
	default:
		return dag_const(d, 1);
	}
}

void derive_forward(
	const struct derivable *x, struct ref (*seed)(void *context, int argument, int row), void *context, struct ref *dot)
{
	struct dag *d = x->d;

	memset(dot, 0, x->count * sizeof *dot);
	for (uint32_t i = 0; i < x->count && !d->failed; i++) {
		const struct node n = d->nodes[i];

		if (!x->live[i])
			continue;
		if (n.op == OP_INPUT)
			dot[i] = seed(context, (int)n.arg[0].i, (int)n.arg[1].i);
		for (int k = 0; k < op_arity[n.op]; k++)
			if (dot[n.arg[k].i].i) /* node 0 is zero */
				dot[i] = dag_add(d, dot[i], dag_mul(d, partial(d, i, k), dot[n.arg[k].i]));
	}
}

struct input {
	struct dag *d;
	int argument, row;
};

static struct ref unit(void *context, int argument, int row)
{
	const struct input *by = context;
	const struct ref zero = {0};

	return argument == by->argument && row == by->row ? dag_const(by->d, 1) : zero;
}

int derive_by(struct dag *d, struct ref *value, int argument, int row)
{
	struct input by = {d, argument, row};
	struct derivable x;
	struct ref *dot;

	if (!derive_begin(&x, d, value, 1) || !(dot = arena_alloc(d->arena, x.count, sizeof *dot)))
		return 0;
	derive_forward(&x, unit, &by, dot);
	*value = dot[value->i];
	return !d->failed;
}

void derive_backward(const struct derivable *x, const struct ref *weights, struct ref *bar)
{
	struct dag *d = x->d;

	memset(bar, 0, x->count * sizeof *bar);
	for (int k = 0; k < x->root_count; k++)
		bar[x->roots[k].i] = dag_add(d, bar[x->roots[k].i], weights[k]);
	for (uint32_t i = x->count; i-- > 0 && !d->failed;) {
		const struct node n = d->nodes[i];

		for (int k = 0; k < op_arity[n.op] && bar[i].i; k++)
			bar[n.arg[k].i] = dag_add(d, bar[n.arg[k].i], dag_mul(d, partial(d, i, k), bar[i]));
	}
}
