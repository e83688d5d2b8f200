/* Forces on what stands, in rows of the output on their way from one kernel to the next (plan/grid/found/found.h). A force f is
   there for qdd, and for what its kernels make of that; so are, of a vjp with the weights w, the forces g of M mu - J' g = w,
   J mu = 0. */
#include "dynamics/contacts/contacts.h"
#include "dynamics/want.h"

/* A row of qd that is free, of the contact's chain, those nearest to it first, or else of any joint: the part that reads the
   force has these rows. The base's come last: a kernel may write these before the joints' (plan/grid/base_first.h). */
static int free_row(const struct tree *t, const struct contact *c, unsigned char *taken)
{
	for (int k = c->body; k >= 0 && t->bodies[k].type != JOINT_FLOATING; k = t->bodies[k].parent)
		for (int i = t->bodies[k].iv + joint_nv(t->bodies[k].type); i-- > t->bodies[k].iv;)
			if (!taken[i])
				return i;
	for (int i = t->nv; i-- > 0;)
		if (!taken[i])
			return i;
	return -1; /* more rows than coordinates are refused before (singular.c) */
}

/* In which rows of qd forces stand, by row of contacts. */
static int place(const struct build *b, unsigned char *taken, int *row)
{
	for (int i = 0; i < b->k->contact_count; i++) {
		const struct contact *c = &b->k->contacts[i];

		for (int f = c->first; f < c->first + c->rows; f++) {
			row[f] = free_row(b->t, c, taken);
			if (row[f] < 0)
				return 0;
			taken[row[f]] = 1;
		}
	}
	return 1;
}

/* By row of contacts, then, of a vjp, once more for those of weights. */
static int *places(const struct build *b)
{
	struct arena *a = b->d->arena;
	int rows = b->k->contact_rows, nv = b->t->nv, is_product = request_wants(b->k, WANT_VJP);
	int fit = contacts_weights_fit(b->t, b->k);
	unsigned char *taken = arena_alloc(a, 2 * (size_t)nv + 1, 1);
	int *row = arena_alloc(a, 2 * (size_t)rows, sizeof *row);

	if (!taken || !row || !place(b, taken, row))
		return NULL;
	if (is_product && !place(b, fit ? taken : taken + nv, row + rows))
		return NULL;
	for (int i = 0; i < rows && is_product; i++) {
		row[i] += nv;
		row[rows + i] += fit ? nv : 2 * nv;
	}
	return row;
}

int contacts_weights_fit(const struct tree *t, const struct request *k)
{
	return 2 * k->contact_rows <= t->nv;
}

static void hand_on(const struct forward *x, const int *row, const struct ref *forces)
{
	for (int i = 0; i < x->b->k->contact_rows && !x->b->d->failed; i++)
		dag_output(x->b->d, x->b->outputs[0], row[i], forces[i]);
}

void contacts_hand_on(const struct forward *x)
{
	const struct build *b = x->b;
	int nv = b->t->nv, weights = dag_find_role(b->d, ROLE_COTANGENT, 0), *row = places(b);
	struct ref *mu = arena_alloc(b->d->arena, (size_t)contacts_found(b), sizeof *mu);

	b->d->failed |= !row || !mu;
	if (b->d->failed)
		return;
	hand_on(x, row, x->qdd + nv);
	if (weights < 0)
		return;
	for (int i = 0; i < nv; i++)
		mu[i] = dag_input(b->d, weights, i);
	contacts_solve(x, mu);
	hand_on(x, row + b->k->contact_rows, mu + nv);
}

void contacts_hold(struct build *b)
{
	int rows = b->k->contact_rows, *row = b->ways.handed && rows ? places(b) : NULL;

	b->d->failed |= b->ways.handed && rows && !row;
	for (int i = 0; i < rows && !b->d->failed; i++) {
		b->forces[i] = row ? dag_input(b->d, b->outputs[0], row[i]) : dag_input(b->d, DAG_HELD, b->t->nv + i);
		if (row && request_wants(b->k, WANT_VJP))
			b->weights[i] = dag_input(b->d, b->outputs[0], row[rows + i]);
	}
}
