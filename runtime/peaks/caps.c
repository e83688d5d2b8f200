#define _POSIX_C_SOURCE 200809L
#include "peaks/caps.h"
#include "core/seconds.h"
#include <math.h>

enum { PARTS = 48 };

struct capping {
	const struct norms *x;
	struct norms_values *v;
	double *most, *most_norm; /* so far */
	double *value, *norm;	  /* the largest in the parts that were looked at */
};

/* What is unknown in a part is unknown in all of them. */
static void take_larger(double *most, double x)
{
	if (!(x <= *most))
		*most = x > *most ? x : (double)INFINITY;
}

static void look(struct capping *h, const struct interval *const *rows)
{
	norms_evaluate(h->x, rows, h->v);
	for (size_t i = 0; i < h->x->d->count; i++)
		take_larger(&h->value[i], h->v->size[i]);
	for (uint32_t k = 0; k < h->x->set_count; k++)
		take_larger(&h->norm[k], h->v->norm[h->x->set_at[k]]);
}

static void take_all(struct capping *h)
{
	for (size_t i = 0; i < h->x->d->count; i++)
		h->most[i] = interval_least(h->value[i], h->most[i]);
	for (uint32_t k = 0; k < h->x->set_count; k++)
		h->most_norm[k] = interval_least(h->norm[k], h->most_norm[k]);
}

/* All parts by one row, or none counts. */
static void cut_by(struct capping *h, const struct caps *c, int row)
{
	const struct interval whole = c->q[row];
	int part = 0;

	for (size_t i = 0; i < h->x->d->count; i++)
		h->value[i] = 0;
	for (uint32_t k = 0; k < h->x->set_count; k++)
		h->norm[k] = 0;
	for (double from = whole.lower; part < PARTS && seconds_now() < c->deadline; part++) {
		double to =
			part + 1 < PARTS ? whole.lower + (whole.upper - whole.lower) * (part + 1) / PARTS : whole.upper;

		c->q[row] = (struct interval){from, to};
		look(h, (const struct interval *const *)c->rows);
		from = to;
	}
	c->q[row] = whole;
	if (part == PARTS)
		take_all(h);
}

int caps_find(const struct caps *c, const struct norms *x, struct norms_values *v, struct arena *arena)
{
	struct capping h = {x, v, v->most ? v->most : norms_unknown(x->d->count, arena),
		v->most_norm ? v->most_norm : norms_unknown(x->set_count, arena), norms_unknown(x->d->count, arena),
		norms_unknown(x->set_count, arena)};

	if (arena->failed)
		return 0;
	v->most = h.most;
	v->most_norm = h.most_norm;
	for (int k = 0; k < c->dim_count; k++)
		cut_by(&h, c, c->dims[k]);
	return 1;
}
