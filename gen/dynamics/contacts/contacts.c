/* Links that stand. Their forces f make them so (Featherstone 2008, section 8.3):

       M qdd - J' f = tau - bias,   J qdd + dJ/dt qd = 0

   With M = L' D L, L' Y = J' and S = J M^-1 J' = Y' D^-1 Y, any right side b, c of M x - J' f = b, J x = c is solved by
   L' y = b;  S n = Y' D^-1 y - c, f = -n;  L x = D^-1 (y - Y n), and Y has no rows but those of a link's chain. Here x is what
   qdd lacks, and c is -a, the links' acceleration so far. The same solves for derivatives, of both at once. */
#include "dynamics/contacts/contacts.h"
#include "dynamics/want.h"
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

/* What the force of a contact, its rows, pulls at the body with, in the body's frame and about its origin. */
static void wrench_of(const struct build *b, const struct frame *x, const struct contact *c, const struct ref *of, struct svec *f,
	struct svec *n)
{
	int in_world = b->k->frame != FRAME_LINK;

	*f = want_turn(b->d, x, &c->X, in_world, (struct svec){{of[0], of[1], of[2]}});
	*n = svec_cross(b->d, svec_const(b->d, c->X.p), *f);
	if (c->rows == 6)
		*n = svec_add(b->d, *n, want_turn(b->d, x, &c->X, in_world, (struct svec){{of[3], of[4], of[5]}}));
}

void contacts_pull(const struct tour *r, int body)
{
	const struct build *b = r->context;
	struct frame *x = &r->frames[body + 1];

	for (int i = 0; i < b->k->contact_count; i++) {
		struct svec f, n;

		if (b->k->contacts[i].body != body)
			continue;
		wrench_of(b, x, &b->k->contacts[i], b->forces + b->k->contacts[i].first, &f, &n);
		x->f = svec_sub(r->d, x->f, f);
		x->n = svec_sub(r->d, x->n, n);
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

/* Rows of joints that hang on the base never join S before it is factored (schur.h): they are those of most contacts. */
static void join(const struct forward *x, int body)
{
	const struct body *k = &x->b->t->bodies[body];

	for (int i = k->iv + joint_nv(k->type); i-- > k->iv && k->parent >= 0 && !k->follower;)
		schur_join(x->S, i);
}

/* The rows of J of a contact, [6][nv]. */
static void make_rows(const struct build *b, const struct contact *c, struct ref *J)
{
	const struct want of = {.body = c->body, .X = c->X};

	memset(J, 0, 6 * (size_t)b->t->nv * sizeof *J);
	jacobian_columns(&b->places, &of, J);
}

/* By factors of M, L' Y = J', when these are made. */
static void reduce_by_factors(struct forward *x)
{
	const struct build *b = x->b;
	int nv = b->t->nv;
	struct ref *J = arena_alloc(b->d->arena, 6 * (size_t)nv, sizeof *J);

	for (int i = 0; i < b->k->contact_count && J; i++) {
		const struct contact *c = &b->k->contacts[i];

		make_rows(b, c, J);
		for (int row = 0; row < c->rows; row++) {
			factor_reduce(&x->M, J + row * nv);
			for (int k = 0; k < nv; k++)
				x->S->Y[k * x->S->n + c->first + row] = J[row * nv + k];
		}
	}
	for (int i = 0; i < x->M.n; i++)
		x->S->inverse[x->M.row[i]] = x->M.inverse[i];
	for (int i = b->t->body_count; i-- > 0 && J;)
		join(x, i);
	b->d->failed |= !J;
}

/* Unit forces on a contact, in its body's frame and about that body's origin. */
static void begin_units(struct forward *x, const struct contact *c)
{
	for (int row = 0; row < c->rows; row++) {
		struct ref unit[6] = {{0}};

		unit[row] = dag_const(x->b->d, 1);
		wrench_of(x->b, &x->tour.frames[c->body + 1], c, unit, &x->unit_f[c->first + row], &x->unit_n[c->first + row]);
	}
}

/* Is the body on the way from the contact to the base? Parents have smaller numbers. */
static int is_on_chain(const struct tree *t, int body, const struct contact *c)
{
	int k = c->body;

	while (k > body)
		k = t->bodies[k].parent;
	return k == body;
}

/* The part that the body's joint takes of unit forces on a contact. */
static void reduce_units(struct forward *x, const struct contact *c, int body)
{
	const struct body *k = &x->b->t->bodies[body];

	for (int row = c->first; row < c->first + c->rows; row++) {
		struct ref y[6] = {{0}};

		articulated_reduce(&x->bodies, body, &x->unit_f[row], &x->unit_n[row], y);
		for (int i = 0; i < joint_nv(k->type); i++)
			x->S->Y[(k->iv + i) * x->S->n + row] = y[i];
	}
}

void contacts_left(struct forward *x, int body)
{
	const struct tree *t = x->b->t;
	const struct request *k = x->b->k;
	int iv = t->bodies[body].iv;

	for (int i = 0; i < k->contact_count; i++) {
		if (k->contacts[i].body == body)
			begin_units(x, &k->contacts[i]);
		if (is_on_chain(t, body, &k->contacts[i]))
			reduce_units(x, &k->contacts[i], body);
	}
	for (int i = iv; i < iv + joint_nv(t->bodies[body].type) && !x->b->d->failed; i++)
		x->S->inverse[i] = x->bodies.bodies[body].D.inverse[i - iv];
	if (!x->b->d->failed)
		join(x, body);
}

void contacts_begin(struct forward *x)
{
	struct dag *d = x->b->d;
	size_t rows = (size_t)x->b->k->contact_rows;

	x->S = arena_alloc(d->arena, 1, sizeof *x->S);
	if (x->b->ways.dynamics == DYNAMICS_ARTICULATED) {
		x->unit_f = arena_alloc(d->arena, rows, sizeof *x->unit_f);
		x->unit_n = arena_alloc(d->arena, rows, sizeof *x->unit_n);
	}
	d->failed |= d->arena->failed;
	if (x->S)
		schur_begin(x->S, d, (int)rows, x->b->t->nv);
}

/* When it is first solved with: then what it is solved for is there before it, and leaves nothing of Y to wait. */
static void factor(const struct forward *x)
{
	struct dag *d = x->b->d;
	int singular = schur_factor(x->S);

	if (singular < 0)
		return;
	d->failed = 1;
	d->singular = contacts_singular(x->b->k, singular);
}

void contacts_factor(struct forward *x, struct joint_inputs in)
{
	struct build *b = x->b;

	if (b->ways.dynamics != DYNAMICS_ARTICULATED)
		want_places(b, in);
	dag_section(b->d, SECTION_CONTACTS, 0);
	if (b->ways.dynamics != DYNAMICS_ARTICULATED && !b->d->failed)
		reduce_by_factors(x);
}

/* L x = D^-1 (y - Y n), in place of y. */
static void expand_by_factors(const struct forward *x, struct ref *y, const struct ref *n)
{
	schur_take(x->S, y, n);
	factor_expand(&x->M, y);
}

/* M x = b - J' n, in place of b. */
static void expand_by_bodies(const struct forward *x, struct ref *rhs, const struct ref *forces)
{
	const struct build *b = x->b;
	size_t bodies = (size_t)b->t->body_count;
	struct svec *f = arena_alloc(b->d->arena, bodies, sizeof *f), *n = arena_alloc(b->d->arena, bodies, sizeof *n);

	for (int i = 0; i < b->k->contact_count && f && n; i++) {
		const struct contact *c = &b->k->contacts[i];
		struct svec of, about;

		wrench_of(b, &x->tour.frames[c->body + 1], c, forces + c->first, &of, &about);
		f[c->body] = svec_add(b->d, f[c->body], of);
		n[c->body] = svec_add(b->d, n[c->body], about);
	}
	if (f && n)
		articulated_solve(&x->bodies, rhs, f, n);
	else
		b->d->failed = 1;
}

/* b - J' n in place of b. */
static void pull_rows(const struct build *b, struct ref *rhs, const struct ref *n)
{
	struct dag *d = b->d;
	int nv = b->t->nv;
	struct ref *J = arena_alloc(d->arena, 6 * (size_t)nv, sizeof *J);

	for (int i = 0; i < b->k->contact_count && J; i++) {
		const struct contact *c = &b->k->contacts[i];

		make_rows(b, c, J);
		for (int row = 0; row < c->rows; row++)
			for (int k = 0; k < nv; k++)
				rhs[k] = dag_sub(d, rhs[k], dag_mul(d, J[row * nv + k], n[c->first + row]));
	}
	d->failed |= !J;
}

void contacts_solve_pulled(const struct forward *x, struct joint_inputs in, struct ref *rhs, const struct ref *n)
{
	struct build *b = x->b;

	if (b->ways.dynamics == DYNAMICS_ARTICULATED) {
		expand_by_bodies(x, rhs, n);
		return;
	}
	want_places(b, in);
	pull_rows(b, rhs, n);
	factor_solve(&x->M, rhs);
}

void contacts_solve(const struct forward *x, struct ref *rhs)
{
	struct dag *d = x->b->d;
	int rows = x->b->k->contact_rows, nv = x->b->t->nv, by_bodies = x->b->ways.dynamics == DYNAMICS_ARTICULATED;
	struct ref *n = arena_alloc(d->arena, (size_t)(rows + nv), sizeof *n), *y = by_bodies ? n + rows : rhs;

	if (!n) {
		d->failed = 1;
		return;
	}
	if (by_bodies)
		articulated_halve(&x->bodies, rhs, y);
	else
		factor_reduce(&x->M, rhs);
	schur_project(x->S, y, n);
	for (int c = 0; c < rows; c++)
		n[c] = dag_sub(d, n[c], rhs[nv + c]);
	factor(x);
	schur_solve(x->S, n);
	(by_bodies ? expand_by_bodies : expand_by_factors)(x, rhs, n);
	for (int c = 0; c < rows; c++)
		rhs[nv + c] = dag_neg(d, n[c]);
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
	if (!x->stands || x->b->d->failed)
		return;
	factor(x);
	for (int i = 0; i < x->b->k->contact_count && !x->b->d->failed; i++) {
		const struct contact *c = &x->b->k->contacts[i];

		for (int row = c->first; row < c->first + c->rows; row++) {
			pairs[2 * row] = x->S->left[row * x->S->n + row];
			pairs[2 * row + 1] = schur_trace(x->S, row < c->first + 3 ? c->first : c->first + 3, 3);
		}
	}
}

struct singular contacts_singular(const struct request *k, int row)
{
	int i = 0;

	while (k->contacts[i].first + k->contacts[i].rows <= row)
		i++;
	return (struct singular){SINGULAR_CONTACT, i};
}
