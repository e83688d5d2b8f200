#include "prove/weights.h"
#include <string.h>

/* What weighs less than this part of the mean is left out. */
#define LEAST 1e-3

struct weighing {
	struct peaks *p;
	const struct view *view;
	uint32_t *of_node, *of_pair; /* 1 + peak */
};

static void add_node(struct weighing *w, uint32_t node, double weight)
{
	struct peaks *p = w->p;

	if (!node)
		return;
	if (!w->of_node[node]) {
		p->list[p->count++] = (struct peak){.nodes = {node, node}, .most = p->values->size[node]};
		w->of_node[node] = (uint32_t)p->count;
	}
	p->list[w->of_node[node] - 1].weight += weight;
}

static void add_pair(struct weighing *w, uint32_t pair, double weight)
{
	struct peaks *p = w->p;
	const struct norms_set *s = pair ? &p->norms->sets[pair - 1] : NULL;

	if (!pair || s->count != 2)
		return;
	if (!w->of_pair[pair]) {
		p->list[p->count++] = (struct peak){.nodes = {s->nodes[0], s->nodes[1]},
			.pair = pair,
			.most = norms_of_pair(p->norms, p->values, pair)};
		w->of_pair[pair] = (uint32_t)p->count;
	}
	p->list[w->of_pair[pair] - 1].weight += weight;
}

static void add_twins(struct weighing *w, const struct twins *twins, size_t count, const double *terms)
{
	for (size_t i = 0; i < count; i++) {
		const struct twins *t = &twins[i];
		double weight = terms[t->one] + terms[t->other], sum = 0;

		add_pair(w, t->values, weight);
		add_pair(w, t->slopes, weight);
		for (size_t k = 0; k < t->shares.count; k++)
			sum += shares_of(&t->shares.list[k], &w->view->norms, &w->view->values);
		for (size_t k = 0; k < t->shares.count && sum > 0; k++) {
			const struct share *s = &t->shares.list[k];
			double part = weight * shares_of(s, &w->view->norms, &w->view->values) / sum;

			add_pair(w, s->values, part);
			add_pair(w, s->slopes, part);
			add_node(w, s->values ? 0 : s->x, part);
			add_node(w, s->slopes ? 0 : s->slope, part);
		}
	}
}

static void drop_small(struct peaks *p)
{
	double sum = 0;

	for (size_t i = 0; i < p->count; i++)
		sum += p->list[i].weight;
	for (size_t i = 0; i < p->count; i++)
		if (!(p->list[i].weight >= LEAST * sum / (double)p->count))
			p->list[i].weight = 0;
}

int weights_find(struct peaks *p, const struct view *v, const double *terms)
{
	size_t nodes = p->x->d.count, sets = v->norms.set_count;
	struct weighing w = {p, v, arena_alloc(p->arena, nodes, sizeof *w.of_node),
		arena_alloc(p->arena, sets + 1, sizeof *w.of_pair)};

	p->count = 0;
	p->list = arena_alloc(p->arena, nodes + sets + 1, sizeof *p->list);
	if (p->arena->failed)
		return 0;
	for (uint32_t i = 0; i < p->x->count; i++)
		if (p->x->slope[i].i && terms[i] > 0) {
			add_node(&w, p->x->value[i].i, terms[i]);
			add_node(&w, p->x->slope[i].i, terms[i]);
		}
	add_twins(&w, v->products, v->product_count, terms);
	add_twins(&w, v->sums, v->sum_count, terms);
	add_twins(&w, v->angles, v->angle_count, terms);
	drop_small(p);
	return 1;
}
