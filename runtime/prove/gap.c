#include "prove/gap.h"
#include <math.h>

struct prove_gap gap_of(const struct dag *d, uint32_t node, const double sizes[2], double error, const struct eval_model *m)
{
	const struct node *n = &d->nodes[node];

	if ((n->op == OP_SIN || n->op == OP_COS) && !(sizes[1] <= m->angle))
		return (struct prove_gap){PROVE_ANGLE, n->arg[0].i, sizes[1], m->angle};
	if (!(sizes[0] <= m->largest) || isfinite(error))
		return (struct prove_gap){PROVE_OVERFLOW, node, sizes[0] + error, m->largest};
	return (struct prove_gap){PROVE_OPERATION, node, sizes[0], m->largest};
}

double gap_note(struct prove_gap *gap, struct prove_gap found)
{
	*gap = gap->why ? *gap : found;
	return (double)INFINITY;
}
