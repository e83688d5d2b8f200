/* Derivatives of the torques that a scene asks for. A floating joint's coordinates are varied in the tangent space: by a
   twist in the body's frame, linear then angular, as Pinocchio does; the quaternion q as q (x) (d/2, 1). */
#include "dag/derive.h"
#include "tree/pattern.h"
#include "dynamics/forward.h"
#include "dynamics/tour.h"
#include <string.h>

enum varied { VARIED_Q, VARIED_QD, VARIED_QDD, VARIED_COUNT };

struct gradient {
	const struct tour *r;
	const struct forward *forward; /* NULL: qdd is an input */
	struct dag *d;
	const struct tree *t;
	struct derivable x;
	int arguments[VARIED_COUNT];   /* -1: no such input */
	struct ref *dot;
	/* the direction: of each row of q, in its own coordinates, of qd and of qdd; or of one row of another argument */
	struct ref *along[VARIED_COUNT];
	int other, other_row;
};

static struct ref seed(void *context, int argument, int row)
{
	const struct gradient *g = context;
	const struct ref zero = {0};

	for (int i = 0; i < VARIED_COUNT; i++)
		if (argument == g->arguments[i])
			return g->along[i][row];
	return argument == g->other && row == g->other_row ? dag_const(g->d, 1) : zero;
}

/* The rates of a floating joint's q for a twist (v, w) in the body's frame: dp = Q v; with the quaternion (u, s),
   du = (s w + u x w)/2, ds = -u.w/2. */
static void vary_floating(const struct gradient *g, const struct body *k, struct svec v, struct svec w)
{
	struct dag *d = g->d;
	struct joint_pose pose = joint_place(d, k, g->r->in);
	struct ref half = dag_const(d, 0.5L), s = source_row(d, &g->r->in.q, k->iq + 6), *q = g->along[VARIED_Q] + k->iq;
	struct svec p = smat_mul(d, &pose.Q, v), u, du;

	for (int i = 0; i < 3; i++)
		u.x[i] = source_row(d, &g->r->in.q, k->iq + 3 + i);
	du = svec_scale(d, half, svec_add(d, svec_scale(d, s, w), svec_cross(d, u, w)));
	for (int i = 0; i < 3; i++) {
		q[i] = p.x[i];
		q[3 + i] = du.x[i];
	}
	q[6] = dag_neg(d, dag_mul(d, half, svec_dot(d, u, w)));
}

/* A direction in the tangent space, nv rows, becomes one of q. */
static void vary_q(const struct gradient *g, const struct ref *by)
{
	for (int b = 0; b < g->t->body_count; b++) {
		const struct body *k = &g->t->bodies[b];
		const struct ref *row = by + k->iv;

		if (k->type == JOINT_FLOATING)
			vary_floating(g, k, (struct svec){{row[0], row[1], row[2]}}, (struct svec){{row[3], row[4], row[5]}});
		for (int i = 0; i < joint_nv(k->type) && k->type != JOINT_FLOATING; i++)
			g->along[VARIED_Q][k->iq + i] = row[i];
	}
}

static void clear(struct gradient *g)
{
	memset(g->along[VARIED_Q], 0, (size_t)g->t->nq * sizeof(struct ref));
	memset(g->along[VARIED_QD], 0, (size_t)g->t->nv * sizeof(struct ref));
	memset(g->along[VARIED_QDD], 0, (size_t)g->t->nv * sizeof(struct ref));
	g->other = -1;
}

static struct ref along(struct gradient *g, int torque)
{
	return g->dot[g->x.roots[torque].i];
}

/* The body whose row of qd this is. */
static int body_of_row(const struct tree *t, int row)
{
	for (int i = 0; i < t->joint_count; i++)
		if (row >= t->joints[i].iv && row < t->joints[i].iv + t->joints[i].nv)
			return t->joints[i].body;
	return 0;
}

/* Column by column: d tau/d q or d tau/d qd, or what is solved with it, d qdd. */
static void output_matrix(struct gradient *g, enum varied varied, int is_solved, int argument)
{
	int nv = g->t->nv;
	struct pattern p;
	struct ref *unit = arena_alloc(g->d->arena, (size_t)nv, sizeof *unit);

	if (!unit || !pattern_make(&p, g->t, 0, g->r->request->dense, g->d->arena)) {
		g->d->failed = 1;
		return;
	}
	for (int j = 0; j < nv; j++) {
		dag_section(g->d, SECTION_BY, body_of_row(g->t, j));
		clear(g);
		memset(unit, 0, (size_t)nv * sizeof *unit);
		unit[j] = dag_const(g->d, 1);
		if (varied == VARIED_Q)
			vary_q(g, unit);
		else
			g->along[varied][j] = unit[j];
		derive_forward(&g->x, seed, g, g->dot);
		for (int i = 0; i < nv; i++)
			unit[i] = along(g, i);
		if (is_solved)
			forward_column(g->forward, unit, j, argument);
		for (int i = 0; i < nv && !is_solved; i++)
			if (p.row[i * nv + j] >= 0)
				dag_output(g->d, argument, p.row[i * nv + j], unit[i]);
	}
}

/* [nv][rows] by the rows of a freed constant. */
static void output_by_freed(struct gradient *g, const struct want *w, int argument)
{
	const struct freed *f = &g->r->request->freed[w->body];
	struct ref *column = arena_alloc(g->d->arena, (size_t)g->t->nv, sizeof *column);
	int is_solved = w->kind == WANT_DQDD_DFREED;

	if (!column) {
		g->d->failed = 1;
		return;
	}
	dag_section(g->d, SECTION_PRODUCTS, 0);
	for (int j = 0; j < f->rows; j++) {
		clear(g);
		g->other = dag_find_argument(g->d, f->argument);
		g->other_row = j;
		derive_forward(&g->x, seed, g, g->dot);
		for (int i = 0; i < g->t->nv; i++)
			column[i] = is_solved ? dag_neg(g->d, along(g, i)) : along(g, i);
		if (is_solved)
			forward_solve(g->forward, column);
		for (int i = 0; i < g->t->nv; i++)
			dag_output(g->d, argument, i * f->rows + j, column[i]);
	}
}

/* M^-1 (v_tau - (d tau/d q) v_q - (d tau/d qd) v_qd), from what derive_forward made at the qdd found. */
static void solve_product(struct gradient *g, struct ref *v_tau, int argument)
{
	for (int i = 0; i < g->t->nv; i++)
		v_tau[i] = dag_sub(g->d, v_tau[i], along(g, i));
	forward_solve(g->forward, v_tau);
	for (int i = 0; i < g->t->nv; i++)
		dag_output(g->d, argument, i, v_tau[i]);
}

/* (d tau/d q) v_q + (d tau/d qd) v_qd + (d tau/d qdd) v_qdd for given v, in one go. */
static void output_jvp(struct gradient *g, int argument)
{
	int nv = g->t->nv, direction = dag_find_role(g->d, ROLE_TANGENT, 0);
	struct ref *v = arena_alloc(g->d->arena, 3 * (size_t)nv, sizeof *v);

	if (!v) {
		g->d->failed = 1;
		return;
	}
	dag_section(g->d, SECTION_PRODUCTS, 0);
	for (int i = 0; i < 3 * nv; i++)
		v[i] = dag_input(g->d, direction, i);
	clear(g);
	vary_q(g, v);
	memcpy(g->along[VARIED_QD], v + nv, (size_t)nv * sizeof *v);
	memcpy(g->along[VARIED_QDD], v + 2 * nv, (size_t)nv * sizeof *v);
	derive_forward(&g->x, seed, g, g->dot);
	if (g->forward) {
		solve_product(g, v + 2 * nv, argument);
		return;
	}
	for (int i = 0; i < nv; i++)
		dag_output(g->d, argument, i, along(g, i));
}

/* The derivative by a node of the input, after derive_backward. */
static struct ref bar_of(const struct gradient *g, const struct ref *bar, enum varied varied, int row)
{
	const struct ref none = {0};
	struct ref found = g->arguments[varied] < 0 ? none :
		dag_find(g->d, OP_INPUT, (struct ref){(uint32_t)g->arguments[varied]}, (struct ref){(uint32_t)row}, none, 0);

	return found.i && found.i < g->x.count ? bar[found.i] : none;
}

/* The transposed map of vary_q: from derivatives by q's rows to those by the tangent's. */
static struct ref tangent_bar(struct gradient *g, const struct ref *bar, int row)
{
	const struct body *k = &g->t->bodies[body_of_row(g->t, row)];
	struct ref sum = {0}, *unit = arena_alloc(g->d->arena, (size_t)g->t->nv, sizeof *unit);

	if (!unit) {
		g->d->failed = 1;
		return sum;
	}
	unit[row] = dag_const(g->d, 1);
	clear(g);
	vary_q(g, unit);
	for (int i = 0; i < joint_nq(k->type); i++)
		sum = dag_add(g->d, sum, dag_mul(g->d, bar_of(g, bar, VARIED_Q, k->iq + i), g->along[VARIED_Q][k->iq + i]));
	return sum;
}

/* lambda^T d tau/d(q, qd, qdd) for a given lambda, by one sweep back. Of qdd: with mu = M^-1 lambda, which is the derivative by
   tau, -mu^T d tau/d(q, qd) at the qdd found. */
static void output_vjp(struct gradient *g, int argument)
{
	int nv = g->t->nv, weights = dag_find_role(g->d, ROLE_COTANGENT, 0);
	struct ref *lambda = arena_alloc(g->d->arena, (size_t)nv, sizeof *lambda);

	if (!lambda) {
		g->d->failed = 1;
		return;
	}
	dag_section(g->d, SECTION_PRODUCTS, 0);
	for (int i = 0; i < nv; i++)
		lambda[i] = dag_input(g->d, weights, i);
	if (g->forward)
		forward_solve(g->forward, lambda);
	for (int i = 0; i < nv && g->forward; i++) {
		dag_output(g->d, argument, 2 * nv + i, lambda[i]);
		lambda[i] = dag_neg(g->d, lambda[i]);
	}
	derive_backward(&g->x, lambda, g->dot);
	for (int i = 0; i < nv; i++) {
		dag_output(g->d, argument, i, tangent_bar(g, g->dot, i));
		dag_output(g->d, argument, nv + i, bar_of(g, g->dot, VARIED_QD, i));
		if (!g->forward)
			dag_output(g->d, argument, 2 * nv + i, bar_of(g, g->dot, VARIED_QDD, i));
	}
}

static int begin(struct gradient *g, const struct tour *r, const struct forward *forward)
{
	struct arena *a = r->d->arena;
	const struct tree *t = r->t;

	*g = (struct gradient){.r = r, .forward = forward, .d = r->d, .t = t,
		.arguments = {r->in.q.argument, r->in.qd.argument, forward ? -1 : r->in.qdd.argument}, .other = -1};
	g->along[VARIED_Q] = arena_alloc(a, (size_t)t->nq, sizeof(struct ref));
	g->along[VARIED_QD] = arena_alloc(a, (size_t)t->nv, sizeof(struct ref));
	g->along[VARIED_QDD] = arena_alloc(a, (size_t)t->nv, sizeof(struct ref));
	if (a->failed || !derive_begin(&g->x, g->d, r->tau, t->nv))
		return 0;
	g->dot = arena_alloc(a, g->x.count, sizeof *g->dot);
	return g->dot != NULL;
}

/* Is it this file's? */
static int is_ours(const struct request *k, int i, const char *done)
{
	return !done[i] && want_is(k->wants[i].kind, IS_GRADIENT);
}

static void output(struct gradient *g, const struct want *w, int argument)
{
	switch (w->kind) {
	case WANT_DTAU_DQ:
	case WANT_DQDD_DQ:
		output_matrix(g, VARIED_Q, w->kind == WANT_DQDD_DQ, argument);
		break;
	case WANT_DTAU_DQD:
	case WANT_DQDD_DQD:
		output_matrix(g, VARIED_QD, w->kind == WANT_DQDD_DQD, argument);
		break;
	case WANT_JVP:
		output_jvp(g, argument);
		break;
	case WANT_VJP:
		output_vjp(g, argument);
		break;
	default:
		output_by_freed(g, w, argument);
	}
}

void gradient_outputs(const struct tour *r, const struct forward *forward, const int *outputs, const char *done)
{
	const struct request *k = r->request;
	struct gradient g = {0};

	for (int i = 0; i < k->want_count && !r->d->failed; i++) {
		if (!is_ours(k, i, done))
			continue;
		if (!g.d && (!r->tau || !begin(&g, r, forward)))
			r->d->failed = 1;
		else
			output(&g, &k->wants[i], outputs[i]);
	}
}
