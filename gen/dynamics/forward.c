#include "dynamics/forward.h"
#include "dynamics/registry.h"
#include "dynamics/want.h"
#include "mechanics/tangent.h"
#include <string.h>

void forward_enter(const struct tour *r, int body)
{
	const struct build *b = r->context;

	want_pull(r, body);
	if (!b->factored->stands) {
		contacts_pull(r, body);
		return;
	}
	want_free(r, body);
	contacts_entered(r, body);
}

/* M itself, for its factors or to bound an error with. */
static int takes_mass(const struct build *b)
{
	return b->ways.dynamics != DYNAMICS_ARTICULATED || b->ways.pivots_alone || request_wants(b->k, WANT_QDD_BOUND);
}

static void left(const struct tour *r, int body)
{
	struct build *b = r->context;
	struct forward *x = b->factored;

	if (b->ways.dynamics == DYNAMICS_ARTICULATED)
		articulated_leave(&x->bodies, body, &x->singular);
	if (b->ways.dynamics == DYNAMICS_ARTICULATED && x->stands && x->singular < 0 && !r->d->failed)
		contacts_left(x, body);
	if (takes_mass(b))
		recursion_leave(&x->mass, body);
}

/* Rows of qd, each body's after those of what carries it; a follower's are its driver's. */
static int *tree_order(const struct tree *t, struct arena *a)
{
	int *order = arena_alloc(a, (size_t)t->nv, sizeof *order), n = 0;

	for (int b = 0; b < t->body_count && order; b++)
		for (int i = 0; i < joint_nv(t->bodies[b].type) && !t->bodies[b].follower; i++)
			order[n++] = t->bodies[b].iv + i;
	return order;
}

/* Of joints with one row. */
static void tag_rows(const struct forward *x, const char *quantity, const struct ref *rows)
{
	struct dag *d = x->b->d;

	for (int i = 0; i < x->b->t->body_count && !d->failed; i++) {
		const struct body *k = &x->b->t->bodies[i];

		if (joint_nv(k->type) == 1 && !k->follower)
			dag_tag(d, rows[k->iv], quantity, k->number, 0);
	}
}

static void factor(struct forward *x, struct dag *d)
{
	int *order = tree_order(x->tour.t, d->arena), n = x->tour.t->nv;
	struct ref *rows = arena_alloc(d->arena, (size_t)n, sizeof *rows);

	if (!order || !rows || !factor_make(&x->M, d, n, order, x->mass.by[BY_QDD].element, &x->singular)) {
		d->failed = 1;
		return;
	}
	for (int i = 0; i < n; i++)
		rows[x->M.row[i]] = x->M.inverse[i];
	tag_rows(x, "iD", rows);
}

void forward_factor(struct forward *x, struct build *b, struct joint_inputs in)
{
	static const int nowhere[BY_COUNT] = {-1, -1, -1, -1};
	struct dag *d = b->d;

	*x = (struct forward){.b = b, .torques = x->torques, .stands = x->stands, .tour = want_tour(b, in),
		.singular = -1};
	b->factored = x;
	x->tour.eased = arena_alloc(d->arena, (size_t)b->t->nv, sizeof *x->tour.eased);
	if (!x->tour.eased)
		d->failed = 1;
	x->tour.in.qdd = (struct source){.argument = -1, .found = x->tour.eased};
	x->tour.comes_back = 1;
	x->tour.world = want_world;
	x->tour.entered = forward_enter;
	x->tour.left = left;
	x->tour.own_terms = own_terms;
	if (x->stands)
		contacts_begin(x);
	if (b->ways.dynamics == DYNAMICS_ARTICULATED)
		articulated_begin(&x->bodies, &x->tour);
	if (takes_mass(b))
		recursion_begin(&x->mass, &x->tour, nowhere);
	x->mass.is_in_lanes = b->ways.loops && b->ways.loops->is_in_lanes;
	if (d->failed || !pattern_coupled(&x->coupled, b->t, 0, b->k->dense, d->arena)) {
		d->failed = 1;
		return;
	}
	tour_run(&x->tour);
	dag_section(d, !b->k->is_forward ? SECTION_FACTORED : b->ways.dynamics == DYNAMICS_ARTICULATED ? SECTION_ARTICULATED
		: SECTION_FACTORS, 0);
	if (b->ways.dynamics != DYNAMICS_ARTICULATED && !d->failed)
		factor(x, d);
	if (x->singular >= 0) {
		d->failed = 1;
		d->singular = (struct singular){SINGULAR_ROW, x->singular};
	}
	if (x->stands && !d->failed)
		contacts_factor(x, in);
}

void forward_find(struct forward *x, struct build *b, struct joint_inputs in)
{
	struct dag *d = b->d;
	int nv = b->t->nv, found = x->stands ? contacts_found(b) : nv;

	forward_factor(x, b, in);
	b->forward = x;
	x->qdd = arena_alloc(d->arena, (size_t)contacts_found(b), sizeof *x->qdd);
	x->looped = b->ways.loops ? arena_alloc(d->arena, DAG_ARGUMENTS * (size_t)nv, 1) : NULL;
	if (!x->qdd || (b->ways.loops && !x->looped))
		d->failed = 1;
	for (int i = 0; i < nv && !d->failed; i++)
		x->qdd[i] = dag_sub(d, source_row(d, &x->torques, i), x->tour.tau[i]);
	for (int i = nv; i < found && !d->failed; i++)
		x->qdd[i] = dag_neg(d, b->accelerated[i - nv]);
	forward_solve(x, x->qdd);
	for (int i = 0; i < nv && !d->failed; i++)
		x->qdd[i] = dag_add(d, x->tour.eased[i], x->qdd[i]);
	if (request_wants(b->k, WANT_QDD_BOUND))
		forward_part(d, x->qdd, nv);
	tag_rows(x, "qdd", x->qdd);
	for (int step = 0; step < b->k->refine_steps && !d->failed; step++) {
		refine_step(x, in);
		tag_rows(x, "qdd", x->qdd);
	}
}

int forward_pivot_count(const struct tree *t, const struct request *k)
{
	int count = t->nv + k->contact_rows;

	for (int i = 0; i < k->want_count; i++)
		count += k->wants[i].kind == WANT_OPSPACE ? 6 : 0;
	return count;
}

void forward_pivots(const struct forward *x, struct joint_inputs in)
{
	struct build *b = x->b;
	struct dag *d = b->d;
	int nv = b->t->nv, count = forward_pivot_count(b->t, b->k), at = 2 * nv;
	struct ref *pairs = arena_alloc(d->arena, 2 * (size_t)count, sizeof *pairs);
	int argument = dag_argument(d, "pivots", 2 * count, 1);

	if (!pairs)
		d->failed = 1;
	for (int i = 0; i < nv && !d->failed; i++) {
		int is_articulated = b->ways.dynamics == DYNAMICS_ARTICULATED, row = is_articulated ? i : x->M.row[i];
		const struct tree_joint *j = tree_joint_of_row(b->t, row);

		pairs[2 * row] = is_articulated ? x->bodies.bodies[j->body].D.D[row - j->iv] : x->M.D[i];
		pairs[2 * row + 1] = x->mass.by[BY_QDD].element[row * nv + row];
	}
	want_places(b, in);
	contacts_pivots(x, pairs + at);
	at += 2 * b->k->contact_rows;
	for (int i = 0; i < b->k->want_count && !d->failed; i++)
		if (b->k->wants[i].kind == WANT_OPSPACE) {
			opspace_pivots(b, i, pairs + at);
			at += 12;
		}
	for (int i = 0; i < 2 * count && !d->failed; i++)
		dag_output(d, argument, i, pairs[i]);
}

void forward_solve(const struct forward *x, struct ref *rhs)
{
	if (x->b->d->failed)
		return;
	if (x->stands)
		contacts_solve(x, rhs);
	else if (x->b->ways.dynamics == DYNAMICS_ARTICULATED)
		articulated_solve(&x->bodies, rhs, NULL, NULL);
	else
		factor_solve(&x->M, rhs);
}

void forward_inverse(const struct forward *x, struct ref *X)
{
	struct dag *d = x->b->d;
	int nv = x->b->t->nv;

	if (x->b->ways.dynamics != DYNAMICS_ARTICULATED) {
		factor_inverse(&x->M, X);
		return;
	}
	for (int j = 0; j < nv; j++) {
		X[j * nv + j] = dag_const(d, 1);
		articulated_solve(&x->bodies, X + j * nv, NULL, NULL); /* a row is a column */
		for (int i = 0; i < j; i++)
			X[j * nv + i] = X[i * nv + j];
	}
}

/* All that is not always zero; of what is left to a loop, what it reads. */
static void output_column(const struct forward *x, const struct ref *column, int j, int argument, int is_left)
{
	int nv = x->b->t->nv;

	for (int i = 0; i < nv; i++)
		if (x->coupled.row[i * nv + j] >= 0 && (!is_left || loops_read(x->b->ways.loops, nv, i, j)) &&
			!(x->b->ways.way && way_back_makes(x->b->t, i, j)))
			dag_output(x->b->d, argument, x->coupled.row[i * nv + j], column[i]);
}

/* -column, or -M^-1 column. */
static void negate_column(const struct forward *x, struct ref *column, int j, int is_solved)
{
	struct dag *d = x->b->d;

	dag_section(d, SECTION_BY, tree_joint_of_row(x->b->t, j)->body);
	for (int i = 0; i < contacts_found(x->b); i++)
		column[i] = dag_neg(d, column[i]);
	if (is_solved)
		forward_solve(x, column);
}

static int is_zero(const struct ref *column, int n)
{
	for (int i = 0; i < n; i++)
		if (column[i].i)
			return 0;
	return 1;
}

static int is_looped(const struct forward *x, int j)
{
	return x->looped && x->b->ways.loops->first[j] >= 0;
}

void forward_column(const struct forward *x, struct ref *column, int j, int argument)
{
	int is_left = is_looped(x, j) && (x->b->ways.way || !is_zero(column, x->b->t->nv));

	if (is_left && x->b->ways.loops->rooms) {
		dag_section(x->b->d, SECTION_BY, tree_joint_of_row(x->b->t, j)->body);
		forward_leave_column(x, column, j, argument);
	} else {
		negate_column(x, column, j, !is_left);
		output_column(x, column, j, argument, is_left);
	}
	if (is_left)
		x->looped[argument * x->b->t->nv + j] = 1;
}

/* What shifts the accelerations of all particles alike is M's own columns by the base's slides: M^-1 of it is the shift. */
static void shift_base(const struct recursion *by, int body, struct svec shift, struct ref *column)
{
	const struct tour *r = by->r;
	const struct body *k = &r->t->bodies[body];
	struct svec Y, Z;

	for (int i = 0; i < 3; i++) {
		joint_unit_twist(r->d, k, &r->frames[body + 1].pose, i, &Y, &Z);
		column[k->iv + i] = dag_sub(r->d, column[k->iv + i], svec_dot(r->d, Y, shift));
	}
}

/* Where d tau is beside a shift. In a loop a column that is more than the shift has it among the others. */
static int is_apart(const struct forward *x, const struct recursion *by, int body, int j, const struct ref *apart)
{
	return recursion_is_shifted(by, body) && (!is_looped(x, j) || is_zero(apart, x->b->t->nv));
}

static void by_column(const struct forward *x, const struct recursion *by, int body, enum by b, int j, struct ref *column,
	int argument)
{
	const struct by_matrix *m = &by->by[b];
	int nv = x->b->t->nv;

	for (int i = 0; i < nv; i++)
		column[i] = m->apart[i * nv + j];
	if (is_apart(x, by, body, j, column)) {
		negate_column(x, column, j, 1);
		shift_base(by, body, m->shift[j], column);
		output_column(x, column, j, argument, 0);
		return;
	}
	for (int i = 0; i < nv; i++)
		column[i] = m->element[i * nv + j];
	forward_column(x, column, j, argument);
}

void forward_by_body(const struct forward *x, const struct recursion *by, int body, const int *arguments)
{
	const struct tree *t = x->b->t;
	int iv = t->bodies[body].iv, end = iv + joint_nv(t->bodies[body].type);
	struct ref *column = arena_alloc(x->b->d->arena, (size_t)t->nv, sizeof *column);

	for (enum by b = BY_Q; b <= BY_QD && column; b++)
		for (int j = iv; j < end && arguments[b] >= 0; j++)
			by_column(x, by, body, b, j, column, arguments[b]);
	if (!column)
		x->b->d->failed = 1;
}

void forward_outputs(const struct forward *x, int qdd_out, int inverse_out)
{
	struct dag *d = x->b->d;
	int nv = x->b->t->nv;
	struct ref *X = arena_alloc(d->arena, (size_t)nv * (size_t)nv, sizeof *X);
	struct pattern p;

	if (!X || !pattern_coupled(&p, x->b->t, 1, x->b->k->dense, d->arena))
		d->failed = 1;
	if (d->failed)
		return;
	for (int i = 0; i < nv && qdd_out >= 0; i++)
		dag_output(d, qdd_out, i, x->qdd[i]);
	contacts_outputs(x);
	if (inverse_out < 0)
		return;
	dag_section(d, SECTION_INVERSE, 0);
	forward_inverse(x, X);
	for (int i = 0; i < nv * nv; i++)
		if (p.row[i] >= 0)
			dag_output(d, inverse_out, p.row[i], X[i]);
}

static int is_forward(const struct request *k)
{
	return k->is_forward;
}

const struct algorithm algorithm_fd = {.name = "fd",
	.doc = "qdd = FD(q, qd, tau)",
	.brief = "qdd = FD(q, qd, tau) of one sample.",
	.what = "Forward dynamics",
	.how = "from M qdd = tau - bias",
	.arrays = {{"q", ROLE_JOINT_POSITION, 0}, {"qd", ROLE_JOINT_VELOCITY, 0}, {"tau", ROLE_JOINT_TORQUE, 0},
		{"qdd", ROLE_JOINT_ACCELERATION, 1}},
	.is_made_for = is_forward,
	.build = want_build};
