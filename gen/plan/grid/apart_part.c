/* A part that shares nothing with others, and its rows. */
#include "plan/grid/again.h"
#include "plan/grid/apart.h"
#include "plan/grid/hands/turns.h"
#include "plan/grid/places.h"

/* Its bodies, from the first row on. */
static void name_bodies(struct part *p, const struct tree *t)
{
	struct stretch rows = {0};

	p->last = 0;
	for (size_t i = 0; i < p->function.dag.output_count; i++)
		stretch_widen(&rows, p->function.dag.outputs[i].row % t->nv);
	for (int k = t->body_count; k-- > 0;)
		if (t->bodies[k].iv >= rows.first && t->bodies[k].iv < rows.first + rows.rows) {
			p->first = k;
			p->last = p->last > k ? p->last : k;
		}
}

int apart_has_places(const struct parts_of *x)
{
	return x->options->layout == RNEAGEN_AOS && request_wants_derivative(x->request);
}

/* Torques keep the tour's order. */
static int build(struct part *p, struct share *share, int owner, const char *name, const char *doc, const struct parts_of *x,
	struct arena *a)
{
	if (again_serves(x))
		return again_build(p, share, owner, name, doc, x, a);
	if (!part_build_share(p, share, owner, owner + 1, name, doc, x, a))
		return 0;
	return (!x->request->is_forward && !request_wants_derivative(x->request)) || part_order(p, ORDERED_PART, x, a);
}

int apart_build(struct part *p, struct share *share, int owner, int number, const char *what, const struct parts_of *x,
	struct arena *a)
{
	const char *name = text_format(a, "%s_part%d", x->whole->algorithm->name, number);
	const char *doc = text_format(a, "Part %d of it: %s.", number, what);

	p->what = what;
	return build(p, share, owner, name, doc, x, a) && turns_delay_stores(&p->function.plan, a);
}

/* In soa a product's rows stand in the places of inputs (tiles/tiles.h) where the order of lines allows it. */
int apart_set_rows(struct part *p, make_stretches *make, int nv, const struct parts_of *x, struct arena *a)
{
	struct stretches *rows = arena_alloc(a, 1, sizeof *rows);
	int serves = 1;

	if (!rows)
		return 0;
	make(rows, &p->function.dag, nv);
	p->function.stretches = rows;
	name_bodies(p, x->tree);
	if (rows->period && !apart_has_places(x) && !places_serve(&serves, &p->function, rows, a))
		return 0;
	if (!serves)
		make(rows, &p->function.dag, 0);
	return 1;
}
