/* States drawn at random, rates and drives at their ends: a first idea of how large values become. */
#define _XOPEN_SOURCE 700
#include "prove/crests/crests.h"
#include "dag/eval.h"
#include <math.h>
#include <stdlib.h>

enum { STATES = 300 };

static double draw(const struct peaks *p, const struct node *n, unsigned short seed[3])
{
	struct interval r = p->rows[n->arg[0].i][n->arg[1].i];
	double part = erand48(seed);

	if ((int)n->arg[0].i != p->position)
		part = part < 0.5 ? 0 : 1;
	return fmin(r.upper, r.lower + part * (r.upper - r.lower));
}

static void take(struct peaks *p, const double *v)
{
	for (size_t i = 0; i < p->count; i++) {
		struct peak *k = &p->list[i];
		double length = k->pair ? hypot(v[k->nodes[0]], v[k->nodes[1]]) : fabs(v[k->nodes[0]]);

		if (k->kind != PEAK_UNKNOWN && isfinite(length))
			k->found = fmax(k->found, length);
	}
}

int crests_sample(struct peaks *p)
{
	const struct dag *d = &p->x->d;
	int states = p->reads ? STATES : 0;
	double *v = calloc(d->count, sizeof *v);
	unsigned short seed[3] = {11, 3, 5};

	for (int s = 0; s < states && v; s++) {
		for (uint32_t i = 0; i < d->count; i++)
			v[i] = d->nodes[i].op == OP_INPUT ? draw(p, &d->nodes[i], seed) : eval_node(&d->nodes[i], v);
		take(p, v);
	}
	free(v);
	return v != NULL;
}
