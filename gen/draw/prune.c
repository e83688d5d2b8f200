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
	struct ref arg[3] = {{0}};

	for (int k = 0; k < op_arity[n->op]; k++) {
		arg[k] = p->map[n->arg[k].i];
		if (p->unfelt[i] >> k & 1)
			arg[k] = (struct ref){0};
	}
	if (!op_arity[n->op])
		return dag_copy_leaf(out, p->d, i);
	return dag_operation(out, n->op, arg[0], arg[1], arg[2]);
}

enum rneagen_code prune_terms(struct dag *out, struct proven *told, const struct dag *d, const struct tree *t,
	const struct request *k, double fraction, int is_sampled, struct rneagen_error *e)
{
	struct pruning p = {.d = d};
	struct arena spare;

	arena_init(&spare, &out->arena->allocator);
	p.map = arena_alloc(&spare, d->count, sizeof *p.map);
	if (p.map && !d->failed)
		p.unfelt = is_sampled ? felt_find(d, t, k, fraction, &spare) : proven_find(told, d, t, k, fraction, &spare, e);
	if (p.unfelt)
		dag_copy(out, d, p.map, copy, &p);
	arena_free(&spare);
	return e->code ? e->code : !p.unfelt || out->failed ? error_memory(e) : RNEAGEN_OK;
}
