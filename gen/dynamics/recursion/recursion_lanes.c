/* Coordinates on their way back to the base, four of them in the lanes of vectors. What is done to them on
   their way is the same for each; a lane of what a joint feels is an element of its own. */
#include "dynamics/recursion/recursion.h"
#include <string.h>

void recursion_send(struct recursion *x, int body, int i, const struct row_vectors *s, const struct wrench *w)
{
	struct traveller *to = &x->travellers[x->traveller_count++];

	*to = (struct traveller){.count = 1, .rows = {i}, .at = body, .s = *s};
	if (w)
		memcpy(to->w, w, sizeof to->w);
}

/* Each of the numbers that are carried; NULL: there are no more. */
static struct ref *carried(struct traveller *x, int i)
{
	struct svec *const vectors[] = {&x->s.n2, &x->s.n1, &x->s.f2, &x->w[BY_Q].f, &x->w[BY_Q].n, &x->w[BY_QD].f, &x->w[BY_QD].n,
		&x->w[BY_CORIOLIS].f, &x->w[BY_CORIOLIS].n};

	return i < 3 * (int)(sizeof vectors / sizeof *vectors) ? &vectors[i / 3]->x[i % 3] : NULL;
}

/* Not at any body: it goes on with another one. */
enum { JOINED = -2 };

/* Four that have come to the same body go on together. Returns whether there were as many. */
static int join(struct recursion *x, int body)
{
	struct traveller *found[DAG_LANES];
	struct ref each[DAG_LANES];
	int count = 0;

	for (int k = 0; k < x->traveller_count && count < DAG_LANES; k++)
		if (x->travellers[k].at == body && x->travellers[k].count == 1)
			found[count++] = &x->travellers[k];
	if (count < DAG_LANES)
		return 0;
	for (int i = 0; carried(found[0], i); i++) {
		for (int k = 0; k < DAG_LANES; k++)
			each[k] = *carried(found[k], i);
		*carried(found[0], i) = dag_pack(x->r->d, each);
	}
	for (int k = 1; k < DAG_LANES; k++) {
		found[0]->rows[k] = found[k]->rows[0];
		found[k]->at = JOINED;
	}
	found[0]->count = DAG_LANES;
	return 1;
}

/* From a body to its parent. */
static void step(struct recursion *x, struct traveller *one, int parent)
{
	int body = one->at, has_rows = x->has_gradients || x->has_coriolis;
	struct wrench w;

	one->at = parent;
	if (parent < 0)
		return;
	if (has_rows) {
		one->s = recursion_row_to_parent(x, body, one->s);
	} else {
		w = recursion_wrench_to_parent(x, body, (struct wrench){one->s.f2, one->s.n2});
		one->s.f2 = w.f;
		one->s.n2 = w.n;
	}
	for (enum by b = BY_Q; b < BY_QDD; b++)
		one->w[b] = recursion_is_made(x, b) ? recursion_wrench_to_parent(x, body, one->w[b]) : one->w[b];
	x->now = one;
	if (has_rows)
		recursion_fill_row(x, one->rows[0], parent, &one->s);
	for (enum by b = BY_Q; b < BY_QDD; b++)
		recursion_fill_column(x, b, one->rows[0], parent, one->w[b]);
	recursion_fill_mass(x, one->rows[0], body, parent, &one->s);
	x->now = NULL;
	for (int k = 0; k < one->count; k++)
		recursion_write_between(x, one->rows[k], parent);
}

void recursion_go_on(struct recursion *x, int body)
{
	while (join(x, body))
		;
	for (int k = 0; k < x->traveller_count; k++)
		if (x->travellers[k].at == body)
			step(x, &x->travellers[k], x->r->t->bodies[body].parent);
}
