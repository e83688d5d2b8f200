/* Links that stand. Their forces f make them so (Featherstone 2008, section 8.3; Todorov 2014, section II):

       M qdd - J' f = tau - bias,   J qdd + dJ/dt qd = 0

   With M = L' D L, L' Y = J' and S = J M^-1 J' = Y' D^-1 Y, any right side b, c of M x + J' n = b, J x = c is solved by
   L' y = b;  S n = Y' D^-1 y - c;  L x = D^-1 (y - Y n), and Y has no rows but those of a link's chain. Here n is -f, x is
   what qdd lacks, and c is -a, the links' acceleration so far. The same solves for derivatives, of both at once. */
#include "dynamics/contacts.h"
#include <string.h>

int contacts_found(const struct build *b)
{
	return b->t->nv + b->k->contact_rows;
}

/* ---- in a tour ---- */

static struct svec in_frame(const struct build *b, const struct frame *x, const struct contact *c, struct svec u)
{
	struct dag *d = b->d;
	struct smat R = smat_const(d, &c->X.R);

	return b->k->frame == FRAME_LINK ? smat_mul_transposed(d, &R, u) : smat_mul(d, &x->R0, u);
}

static struct svec out_of_frame(const struct build *b, const struct frame *x, const struct contact *c, struct svec u)
{
	struct dag *d = b->d;
	struct smat R = smat_const(d, &c->X.R);

	return b->k->frame == FRAME_LINK ? smat_mul(d, &R, u) : smat_mul_transposed(d, &x->R0, u);
}

/* a + dw x p + w x (w x p) of its origin p, and dw, less what they are to be. */
static void accelerate(const struct tour *r, const struct contact *c)
{
	const struct build *b = r->context;
	const struct frame *x = &r->frames[c->body + 1];
	const struct motion *m = &x->motion;
	struct smat U = motion_rate_matrix(r->d, m->w, m->dw);
	struct svec a = svec_add(r->d, x->free_a, smat_mul(r->d, &U, svec_const(r->d, c->X.p)));

	a = in_frame(b, x, c, a);
	for (int i = 0; i < 3; i++)
		b->accelerated[c->first + i] = dag_sub(r->d, a.x[i], b->demanded[c->first + i]);
	if (c->rows < 6)
		return;
	a = in_frame(b, x, c, m->dw);
	for (int i = 0; i < 3; i++)
		b->accelerated[c->first + 3 + i] = dag_sub(r->d, a.x[i], b->demanded[c->first + 3 + i]);
}

void contacts_entered(const struct tour *r, int body)
{
	const struct build *b = r->context;

	for (int i = 0; i < b->k->contact_count; i++)
		if (b->k->contacts[i].body == body)
			accelerate(r, &b->k->contacts[i]);
}

static struct svec force(const struct build *b, int row)
{
	const struct ref *f = b->forces + row;

	return (struct svec){{f[0], f[1], f[2]}};
}

void contacts_pull(const struct tour *r, int body)
{
	const struct build *b = r->context;
	struct frame *x = &r->frames[body + 1];

	for (int i = 0; i < b->k->contact_count; i++) {
		const struct contact *c = &b->k->contacts[i];
		struct svec n = {{{0}}};

		if (c->body != body)
			continue;
		if (c->rows == 6)
			n = out_of_frame(b, x, c, force(b, c->first + 3));
		want_pull_at(r, body, c->X.p, out_of_frame(b, x, c, force(b, c->first)), n);
	}
}

struct ref *contacts_join(const struct build *b, struct ref *torques)
{
	size_t nv = (size_t)b->t->nv, rows = (size_t)b->k->contact_rows;
	struct ref *all;

	if (!torques || !rows)
		return torques;
	all = arena_alloc(b->d->arena, nv + rows, sizeof *all);
	if (!all) {
		b->d->failed = 1;
		return NULL;
	}
	memcpy(all, torques, nv * sizeof *all);
	memcpy(all + nv, b->accelerated, rows * sizeof *all);
	return all;
}

/* ---- forces ---- */

/* L' Y = J', in place of J, whose columns are rows of qd. */
static void reduce(struct forward *x)
{
	struct build *b = x->b;
	struct dag *d = b->d;
	size_t nv = (size_t)b->t->nv;
	struct ref *J = arena_alloc(d->arena, 6 * nv, sizeof *J);

	for (int i = 0; i < b->k->contact_count && J; i++) {
		const struct contact *c = &b->k->contacts[i];
		const struct want of = {.body = c->body, .X = c->X};

		memset(J, 0, 6 * nv * sizeof *J);
		jacobian_columns(&b->places, &of, J);
		for (int row = 0; row < c->rows; row++) {
			factor_reduce(&x->M, J + (size_t)row * nv);
			memcpy(x->Y + (size_t)(c->first + row) * nv, J + (size_t)row * nv, nv * sizeof *J);
		}
	}
}

/* The sum of y D^-1 Y, by rows of qd. */
static struct ref over(const struct forward *x, const struct ref *y, int row)
{
	struct dag *d = x->b->d;
	struct ref sum = {0};

	for (int i = 0; i < x->M.n; i++) {
		int of = x->M.row[i];

		sum = dag_add(d, sum, dag_mul(d, dag_mul(d, y[of], x->M.inverse[i]), x->Y[row * x->M.n + of]));
	}
	return sum;
}

void contacts_factor(struct forward *x, struct joint_inputs in)
{
	struct build *b = x->b;
	struct dag *d = b->d;
	int rows = b->k->contact_rows, nv = b->t->nv, singular = -1;
	struct ref *S = arena_alloc(d->arena, (size_t)(rows * rows), sizeof *S);

	x->Y = arena_alloc(d->arena, (size_t)(rows * nv), sizeof *x->Y);
	if (!S || !x->Y) {
		d->failed = 1;
		return;
	}
	want_places(b, in);
	dag_section(d, SECTION_CONTACTS, 0);
	reduce(x);
	for (int i = 0; i < rows; i++)
		for (int j = 0; j <= i; j++)
			S[i * rows + j] = over(x, x->Y + i * nv, j);
	if (d->failed || factor_make(&x->S, d, rows, NULL, S, &singular))
		return;
	d->failed = 1;
	if (singular >= 0)
		d->singular = contacts_singular(b->k, singular);
}

void contacts_solve(const struct forward *x, struct ref *rhs)
{
	struct dag *d = x->b->d;
	int rows = x->b->k->contact_rows, nv = x->b->t->nv;
	struct ref *n = arena_alloc(d->arena, (size_t)rows, sizeof *n);

	if (!n) {
		d->failed = 1;
		return;
	}
	factor_reduce(&x->M, rhs);
	for (int c = 0; c < rows; c++)
		n[c] = dag_sub(d, over(x, rhs, c), rhs[nv + c]);
	factor_solve(&x->S, n);
	for (int i = 0; i < nv; i++)
		for (int c = 0; c < rows; c++)
			rhs[i] = dag_sub(d, rhs[i], dag_mul(d, x->Y[c * nv + i], n[c]));
	factor_expand(&x->M, rhs);
	memcpy(rhs + nv, n, (size_t)rows * sizeof *n);
}

/* ---- what is wanted ---- */

void contacts_outputs(const struct forward *x)
{
	const struct build *b = x->b;

	for (int i = 0; i < b->k->want_count && !b->d->failed; i++) {
		const struct contact *c = request_contact_of(b->k, &b->k->wants[i]);

		for (int row = 0; c && row < c->rows; row++)
			dag_output(b->d, b->outputs[i], row, x->qdd[b->t->nv + c->first + row]);
	}
}

void contacts_pivots(const struct forward *x, struct ref *pairs)
{
	for (int i = 0; i < x->S.n; i++) {
		pairs[2 * i] = x->S.D[i];
		pairs[2 * i + 1] = over(x, x->Y + i * x->M.n, i);
	}
}

int contacts_singular(const struct request *k, int row)
{
	int i = 0;

	while (k->contacts[i].first + k->contacts[i].rows <= row)
		i++;
	return -1 - k->want_count - i;
}
