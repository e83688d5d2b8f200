#include "draw/prune.h"
#include "draw/felt.h"

struct pruning {
	const struct dag *d;
	const unsigned char *unfelt;
	struct ref *map;
};

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct pruning *p = context;
	const struct node *n = &p->d->nodes[i];
	struct ref arg[3];

	for (int k = 0; k < op_arity[n->op]; k++) {
		arg[k] = p->map[n->arg[k].i];
		if (p->unfelt[i] >> k & 1)
			arg[k] = (struct ref){0};
	}
	switch (n->op) {
	case OP_CONST:
		return dag_within(out, dag_number(p->d, n));
	case OP_INPUT:
		return dag_input(out, (int)n->arg[0].i, (int)n->arg[1].i);
	case OP_NEG:
		return dag_neg(out, arg[0]);
	case OP_ADD:
		return dag_add(out, arg[0], arg[1]);
	case OP_SUB:
		return dag_sub(out, arg[0], arg[1]);
	case OP_MUL:
		return dag_mul(out, arg[0], arg[1]);
	case OP_DIV:
		return dag_div(out, arg[0], arg[1]);
	case OP_SQRT:
		return dag_sqrt(out, arg[0]);
	case OP_ANEW:
		return dag_anew(out, arg[0]);
	case OP_SIN:
		return dag_sin(out, arg[0]);
	case OP_COS:
		return dag_cos(out, arg[0]);
	case OP_WIDEN:
		return dag_widen(out, arg[0]);
	case OP_NARROW:
		return dag_narrow(out, arg[0]);
	default:
		return dag_fma(out, arg[0], arg[1], arg[2]);
	}
}

void prune_terms(struct dag *out, const struct dag *d, const struct tree *t, const struct request *k, double fraction)
{
	struct pruning p = {.d = d};
	struct arena spare;

	arena_init(&spare, &out->arena->allocator);
	p.map = arena_alloc(&spare, d->count, sizeof *p.map);
	p.unfelt = d->failed || !p.map ? NULL : felt_find(d, t, k, fraction, &spare);
	if (p.unfelt)
		dag_copy(out, d, p.map, copy, &p);
	else
		out->failed = 1;
	arena_free(&spare);
}
