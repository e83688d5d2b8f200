#include "prove/gap.h"
#include <math.h>

/* The first node of an output's whose error is not known; the output's own where all are. */
static uint32_t find_first(const struct coarse *c, const struct dag *d, uint32_t root, int model, struct arena *a)
{
	char *is_part = arena_alloc(a, (size_t)root + 1, 1);

	if (!is_part)
		return root;
	is_part[root] = 1;
	for (uint32_t i = root + 1; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && is_part[i]; k++)
			is_part[d->nodes[i].arg[k].i] = 1;
	for (uint32_t i = 0; i < root; i++)
		if (is_part[i] && !isfinite(c->running[model][i]))
			return i;
	return root;
}

struct prove_gap gap_find(const struct coarse *c, const struct dag *d, size_t output, int model, const struct eval_model *m, struct arena *a)
{
	uint32_t i = find_first(c, d, d->outputs[output].value.i, model, a);
	const struct node *n = &d->nodes[i];

	if (isfinite(c->running[model][i]))
		return (struct prove_gap){PROVE_STORED, i, c->size[i], m->store_largest};
	if ((n->op == OP_SIN || n->op == OP_COS) && !(c->size[n->arg[0].i] <= m->angle))
		return (struct prove_gap){PROVE_ANGLE, n->arg[0].i, c->size[n->arg[0].i], m->angle};
	return (struct prove_gap){c->size[i] <= 0.5 * m->largest ? PROVE_OPERATION : PROVE_OVERFLOW, i, c->size[i], m->largest};
}
