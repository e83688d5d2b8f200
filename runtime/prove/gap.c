#include "prove/gap.h"
#include <math.h>

struct prove_gap gap_of(const struct rules *r, uint32_t node, const struct eval_model *m)
{
	const struct node *n = &r->d->nodes[node];
	double size = rules_size(r, node, m), error = r->running[node];

	if ((n->op == OP_SIN || n->op == OP_COS) && !(rules_angle(r, n->arg[0].i, m) <= m->angle))
		return (struct prove_gap){PROVE_ANGLE, n->arg[0].i, rules_angle(r, n->arg[0].i, m), m->angle};
	if (!(size <= m->largest) || isfinite(error))
		return (struct prove_gap){PROVE_OVERFLOW, node, isfinite(error) ? size + error : size, m->largest};
	return (struct prove_gap){PROVE_OPERATION, node, size, m->largest};
}

double gap_note(struct prove_gap *gap, struct prove_gap found)
{
	*gap = gap->why ? *gap : found;
	return (double)INFINITY;
}
