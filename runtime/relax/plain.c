#include "relax/plain.h"
#include "relax/friction.h"
#include <math.h>

static const struct interval ALL = {-(double)INFINITY, (double)INFINITY};

static struct interval quotient(struct interval a, struct interval b)
{
	if (!(b.lower > 0))
		return ALL;
	return interval_mul(a, (struct interval){round_down(1 / b.upper), round_up(1 / b.lower)});
}

static struct interval root(struct interval a)
{
	return (struct interval){round_down(sqrt(fmax(0, a.lower))), round_up(sqrt(fmax(0, a.upper)))};
}

static struct interval range_of(const struct dag *d, uint32_t i, struct interval *const *rows, const struct interval *v)
{
	const struct node *n = &d->nodes[i];
	struct interval a = v[op_arity[n->op] > 0 ? n->arg[0].i : 0], b = v[op_arity[n->op] > 1 ? n->arg[1].i : 0];
	struct friction f;

	switch (n->op) {
	case OP_CONST:
		return interval_around(n->value, within_error(dag_number(d, n)));
	case OP_INPUT:
		return rows[n->arg[0].i][n->arg[1].i];
	case OP_NEG:
		return interval_neg(a);
	case OP_ANEW:
		return a;
	case OP_ADD:
		return interval_add(a, b);
	case OP_SUB:
		return interval_sub(a, b);
	case OP_MUL:
		return interval_mul(a, b);
	case OP_FMA:
		return interval_add(interval_mul(a, b), v[n->arg[2].i]);
	case OP_SIN:
		return interval_sin(a);
	case OP_COS:
		return interval_cos(a);
	case OP_SQRT:
		return root(a);
	case OP_DIV:
		return friction_of(d, i, &f) ? friction_range(d, &f, v[f.rate]) : quotient(a, b);
	default:
		return ALL;
	}
}

void plain_ranges(struct interval *v, const struct dag *d, struct interval *const *rows, const uint32_t *uses)
{
	for (uint32_t i = 0; i < d->count; i++)
		if (!i || uses[i])
			v[i] = range_of(d, i, rows, v);
}
