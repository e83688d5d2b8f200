#include "prove/coarse.h"
#include "prove/gap.h"
#include "prove/rules.h"
#include "relax/friction.h"
#include "relax/plain.h"
#include <math.h>

static double relative(const struct rules *r, uint32_t i)
{
	return r->running[i] / fabs((double)r->d->nodes[i].value) * (1 + 0x1p-40);
}

/* |sqrt(a) - sqrt(a')| <= e / sqrt(least of a) */
static double rest_of_root(const struct rules *r, uint32_t i, double least, const struct eval_model *m)
{
	double off = r->running[r->d->nodes[i].arg[0].i];

	return off < least ? off / sqrt(least) * (1 + 0x1p-40) * (1 + m->mul) + m->mul * r->size[i] + m->tiny : (double)INFINITY;
}

/* c v / sqrt(v^2 + w), w > 0, all in factors: v, c, their product, half of the sum's, root, quotient. |v d/dv| of it is
   at most itself. What underflows is at most tiny over the root of w. The sum of these factors is far below 2^-8, so
   that its square adds less than 2^-8 of it. */
static double rest_of_friction(const struct rules *r, uint32_t i, const struct friction *f, const struct interval *v,
	const struct eval_model *m)
{
	const struct node *rate = &r->d->nodes[f->rate];
	double c = f->slope ? fabs((double)r->d->nodes[f->slope].value) : 1, w = (double)r->d->nodes[f->square].value,
	       width = sqrt(w);
	double factor = m->input + (f->slope ? relative(r, f->slope) + m->mul : 0) + m->mul + m->add + m->terms +
			relative(r, f->square) + m->mul + m->quotient;
	double tiny = 4 * m->tiny * (1 + (1 + c) / width + c / w + c / (w * width));

	if (rate->op == OP_MUL)
		for (int k = 0; k < 2; k++)
			factor += r->d->nodes[rate->arg[k].i].op == OP_CONST ? relative(r, rate->arg[k].i) + m->mul : 0;
	else if (rate->op != OP_INPUT)
		return (double)INFINITY;
	if (!(factor < 0x1p-8) || !(v[f->rate].upper < 1e15 && v[f->rate].lower > -1e15))
		return (double)INFINITY;
	return factor * (1 + 0x1p-6) * r->size[i] + tiny;
}

static int is_known(const struct rules *r, uint32_t i, const struct interval *v, const struct eval_model *m, double *rest)
{
	struct friction f;

	if (r->d->nodes[i].op == OP_SQRT)
		*rest = rest_of_root(r, i, v[r->d->nodes[i].arg[0].i].lower, m);
	else if (friction_of(r->d, i, &f))
		*rest = rest_of_friction(r, i, &f, v, m);
	else
		return 0;
	return 1;
}

/* The first of those that it is made of, or its own. */
static struct prove_gap gap_first(const struct rules *r, uint32_t i, const struct eval_model *m, const struct prove_gap *gaps)
{
	const struct node *n = &r->d->nodes[i];

	for (int k = 0; k < op_arity[n->op]; k++)
		if (gaps[n->arg[k].i].why)
			return gaps[n->arg[k].i];
	return gap_of(r, i, m);
}

static void take_model(struct rules *r, const uint32_t *uses, const struct interval *v, const struct eval_model *m,
	struct prove_gap *gaps)
{
	for (uint32_t i = 0; i < r->d->count; i++) {
		double rest;

		if (i && !uses[i])
			continue;
		if (is_known(r, i, v, m, &rest))
			r->running[i] = rest * (1 + 0x1p-40);
		else
			rules_node(r, i, m);
		if (r->size[i] + r->running[i] <= m->largest)
			continue;
		gaps[i] = gap_first(r, i, m, gaps);
		r->running[i] = (double)INFINITY;
	}
}

int coarse_find(struct coarse *c, const struct dag *d, const struct box *b, const struct eval_model *models, int count,
	struct arena *a)
{
	struct interval *v = arena_alloc(a, d->count, sizeof *v);
	uint32_t *uses = arena_alloc(a, d->count, sizeof *uses);
	struct rules r = {.d = d,
		.of_product = arena_alloc(a, d->count, sizeof(double)),
		.of_sum = arena_alloc(a, d->count, sizeof(double))};

	*c = (struct coarse){.size = arena_alloc(a, d->count, sizeof *c->size)};
	for (int m = 0; m < count; m++) {
		c->running[m] = arena_alloc(a, d->count, sizeof *c->running[m]);
		c->gaps[m] = arena_alloc(a, d->count, sizeof *c->gaps[m]);
	}
	if (a->failed)
		return 0;
	dag_uses(d, uses);
	plain_ranges(v, d, b->rows, uses);
	for (uint32_t i = 0; i < d->count; i++)
		c->size[i] = interval_size(v[i]);
	r.size = c->size;
	for (int m = 0; m < count; m++) {
		r.running = c->running[m];
		take_model(&r, uses, v, &models[m], c->gaps[m]);
	}
	return 1;
}

double coarse_stored(const struct eval_model *m, double size, double error)
{
	double most = size + error;

	if (!(most <= m->store_largest))
		return (double)INFINITY;
	return m->store > 0 ? (error + m->store * most + m->store_tiny) * (1 + 0x1p-30) : error;
}

double coarse_output(const struct coarse *c, const struct dag *d, size_t output, int model, const struct eval_model *m,
	struct prove_gap *gap)
{
	uint32_t i = d->outputs[output].value.i;
	double error = c->running[model][i] * (1 + 0x1p-30), stored = coarse_stored(m, c->size[i], error);

	*gap = c->gaps[model][i];
	if (!isfinite(stored))
		gap_note(gap, (struct prove_gap){PROVE_STORED, i, c->size[i] + error, m->store_largest});
	return stored;
}
