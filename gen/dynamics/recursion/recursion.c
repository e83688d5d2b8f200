/* Derivatives of the torques by a recursion of their own, as Carpentier and Mansard (Analytical derivatives of rigid body
   dynamics algorithms, RSS 2018) and Singh, Russell and Wensing (Efficient analytical derivatives of rigid-body dynamics using
   spatial vector algebra, RA-L 2022) have them, here with 3-vectors in body frames; by qdd it is the mass matrix, and the
   recursion that of Walker and Orin (1982).

   A coordinate moves the particles at p beyond its joint by the field Z x (p - o) + Y, its unit twist at the body's origin o.
   Seen from axes that move with them, their accelerations change by a field alpha x (p - o) + beta x (p' - o') + gamma, and
   the wrench on the composite body (m, h, I, P, K) beyond the joint by

       dF = alpha x h + beta x P + m gamma,   dN = I alpha + K beta + h x gamma.

   A joint further out, or the joint itself, with the unit twist (Z, Y) feels Z.dN + Y.dF = n2.alpha + n1.beta + f2.gamma: its
   row (n2, n1, f2) is carried back to the base and meets the fields of the joints on the way. A joint nearer to the base feels
   the wrench itself, which by q turns with the twist as well, (dF + Z x F, dN + Z x N + Y x F), and is carried back too.

   The Coriolis matrix is C = sum of J'(dJ/dt) over all particles, J of a particle's velocity, as M = sum of J'J: so
   dM/dt = C + C', and C qd is the bias less gravity. A column of dJ/dt is the field Z' x (p - o) + Z x (p' - o') + Y'. Where all
   coordinates are joint angles and slides, C has Christoffel's symbols, and is half of d tau/d qd (Echeandia and Wensing,
   Numerical methods to compute the Coriolis matrix and Christoffel symbols for rigid-body systems, 2021). */
#include "dynamics/recursion/recursion.h"
#include <string.h>

/* ---- what feels it ---- */

/* (Z x F, Z x N + Y x F) */
static struct wrench turned_by(struct dag *d, const struct frame *x, struct svec Z, struct svec Y)
{
	return (struct wrench){svec_cross(d, Z, x->f), svec_add_cross(d, svec_cross(d, Z, x->n), Y, x->f)};
}

struct wrench recursion_wrench_to_parent(const struct recursion *x, int body, struct wrench w)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[body];
	const struct joint_pose *at = recursion_pose(x, body);

	w.f = joint_to_parent(d, k, at, w.f);
	w.n = svec_add_cross(d, joint_to_parent(d, k, at, w.n), at->p, w.f);
	return w;
}

/* f2, n2 + p x f2, n1 + p' x f2 */
struct row_vectors recursion_row_to_parent(const struct recursion *x, int body, struct row_vectors s)
{
	struct dag *d = x->r->d;
	struct wrench w = recursion_wrench_to_parent(x, body, (struct wrench){s.f2, s.n2});

	s.n1 = joint_to_parent(d, &x->r->t->bodies[body], recursion_pose(x, body), s.n1);
	return (struct row_vectors){w.n, svec_add_cross(d, s.n1, tour_origin_rate(x->r, body), w.f), w.f};
}

/* What the joint's own terms add to its diagonal elements: the rotor by qdd, friction by qd. */
static void add_own(struct recursion *x, int body)
{
	const struct body *k = &x->r->t->bodies[body];

	if (joint_nv(k->type) != 1)
		return;
	recursion_add(x, BY_QDD, k->iv, k->iv, own_term(x->r, OWN_ARMATURE, body, within_mul(k->multiplier, k->multiplier)));
	recursion_add(x, BY_QD, k->iv, k->iv, own_rate(x->r, body));
}

int recursion_is_shifted(const struct recursion *x, int body)
{
	const struct body *k = &x->r->t->bodies[body];

	return k->type == JOINT_FLOATING && k->parent < 0;
}

/* A planar joint slides before it turns: by the turn, its slides feel the wrench turn. */
static void add_to_slides(struct recursion *x, int body, struct wrench turned)
{
	struct dag *d = x->r->d;
	int iv = x->r->t->bodies[body].iv;

	for (int i = 0; i < 2; i++) {
		struct svec Z, Y;

		recursion_unit_twist(x, body, i, &Z, &Y);
		recursion_add(x, BY_Q, iv + i, iv + 2, svec_dot(d, Y, turned.f));
	}
}

/* The row of M of one coordinate, back to the base. */
static void trace_mass(struct recursion *x, int body, int row)
{
	int i = x->r->t->bodies[body].iv + row;
	struct row_vectors s;
	struct svec Z, Y;

	recursion_unit_twist(x, body, row, &Z, &Y);
	s = field_row(x->r->d, &x->bodies[body], Z, Y);
	recursion_fill_mass(x, i, body, body, &s);
	if (x->is_in_lanes) {
		recursion_send(x, body, i, &s, NULL);
		return;
	}
	for (int b = body, parent; (parent = x->r->t->bodies[b].parent) >= 0; b = parent) {
		struct wrench w = recursion_wrench_to_parent(x, b, (struct wrench){s.f2, s.n2});

		s.f2 = w.f;
		s.n2 = w.n;
		recursion_fill_mass(x, i, body, parent, &s);
		recursion_write_between(x, i, parent);
	}
}

/* Back to the base: a row, columns of matrices `first` to `end` - 1, or both side by side. With the last matrix
   all is complete. */
static void carry(struct recursion *x, int body, int i, struct row_vectors *s, struct wrench *w, enum by first, enum by end)
{
	for (int b = body, parent; (parent = x->r->t->bodies[b].parent) >= 0; b = parent) {
		if (s)
			*s = recursion_row_to_parent(x, b, *s);
		for (enum by m = first; m < end; m++)
			w[m] = recursion_is_made(x, m) ? recursion_wrench_to_parent(x, b, w[m]) : w[m];
		if (s)
			recursion_fill_row(x, i, parent, s);
		for (enum by m = first; m < end; m++)
			recursion_fill_column(x, m, i, parent, w[m]);
		if (s)
			recursion_fill_mass(x, i, body, parent, s);
		if (end == BY_QDD)
			recursion_write_between(x, i, parent);
	}
}

/* The row and the column of one coordinate, back to the base. */
static void trace(struct recursion *x, int body, int row)
{
	struct dag *d = x->r->d;
	int i = x->r->t->bodies[body].iv + row;
	struct wrench w[BY_QDD], turned;
	struct field by[BY_QDD];
	struct row_vectors s;
	struct svec Z, Y;

	if (!x->has_gradients && !x->has_coriolis) {
		trace_mass(x, body, row);
		return;
	}
	recursion_unit_twist(x, body, row, &Z, &Y);
	recursion_fields(x, body, row, by);
	s = field_row(d, &x->bodies[body], Z, Y);
	for (enum by b = BY_Q; b < BY_QDD; b++)
		w[b] = recursion_is_made(x, b) ? field_load(d, &x->bodies[body], &by[b]) : (struct wrench){0};
	turned = turned_by(d, &x->r->frames[body + 1], Z, Y);
	w[BY_Q] = (struct wrench){svec_add(d, w[BY_Q].f, turned.f), svec_add(d, w[BY_Q].n, turned.n)};
	recursion_fill_row(x, i, body, &s);
	recursion_fill_mass(x, i, body, body, &s);
	if (x->r->t->bodies[body].type == JOINT_PLANAR && row == 2)
		add_to_slides(x, body, turned);
	if (x->is_in_lanes) {
		recursion_send(x, body, i, &s, w);
		return;
	}
	if (x->way) {
		recursion_set_out(x, body, i, &s, w);
		return;
	}
	if (!x->is_row_first) {
		carry(x, body, i, &s, w, BY_Q, BY_QDD);
		return;
	}
	carry(x, body, i, &s, w, BY_Q, BY_Q);
	for (enum by b = BY_Q; b < BY_QDD; b++)
		carry(x, body, i, NULL, w, b, b + 1);
}

/* ---- along with the tour ---- */

void recursion_leave(struct recursion *x, int body)
{
	const struct tour *r = x->r;
	const struct body *k = &r->t->bodies[body];
	struct parameters known = rigid_body_parameters(r->d, &k->inertia);
	const struct parameters *free = r->parameters ? r->parameters[body] : NULL;

	dag_section(r->d, SECTION_BY, body);
	composite_add_body(r->d, &x->bodies[body], free ? free : &known, r->frames[body + 1].motion.w);
	for (int row = 0; row < joint_nv(k->type); row++)
		trace(x, body, row);
	add_own(x, body);
	for (int row = 0; row < joint_nv(k->type); row++)
		recursion_write_between(x, k->iv + row, body);
	if (x->is_in_lanes)
		recursion_go_on(x, body);
	if (x->way)
		recursion_prepare(x, body);
	if (k->parent >= 0) {
		struct svec rate = tour_origin_rate(r, body);
		int has_rate = x->has_gradients || x->has_coriolis;

		composite_add_child(r->d, &x->bodies[k->parent], &x->bodies[body], k, recursion_pose(x, body), has_rate ? &rate : NULL);
	}
}

void recursion_end(struct recursion *x)
{
	for (enum by b = BY_Q; b < BY_COUNT; b++)
		for (int i = 0; i < x->r->t->nv; i++)
			for (int j = 0; j < x->r->t->nv; j++)
				recursion_write(x, b, i, j);
}

static int begin_matrix(struct by_matrix *m, const struct tour *r, int argument, int symmetric)
{
	struct arena *a = r->d->arena;
	size_t elements = (size_t)r->t->nv * (size_t)r->t->nv;

	m->argument = argument;
	m->element = arena_alloc(a, elements, sizeof *m->element);
	m->is_done = arena_alloc(a, elements, 1);
	m->apart = arena_alloc(a, elements, sizeof *m->apart);
	m->shift = arena_alloc(a, (size_t)r->t->nv, sizeof *m->shift);
	return m->element && m->is_done && m->apart && m->shift && pattern_make(&m->p, r->t, symmetric, r->request->dense, a);
}

void recursion_begin(struct recursion *x, const struct tour *r, const int *arguments)
{
	struct arena *a = r->d->arena;
	size_t bodies = (size_t)r->t->body_count;

	*x = (struct recursion){.r = r};
	x->bodies = arena_alloc(a, bodies, sizeof *x->bodies);
	x->travellers = arena_alloc(a, (size_t)r->t->nv, sizeof *x->travellers);
	x->is_shared = arena_alloc(a, (size_t)r->t->nv, 1);
	for (enum by b = BY_Q; b < BY_COUNT; b++)
		if (!begin_matrix(&x->by[b], r, arguments[b], b == BY_QDD))
			r->d->failed = 1;
	if (a->failed)
		r->d->failed = 1;
	for (int i = 0; i < r->t->mimic_count && !a->failed; i++)
		x->is_shared[r->t->bodies[r->t->mimics[i].body].iv] = 1;
}
