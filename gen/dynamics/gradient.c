/* Matrices of derivatives of the torques, column by column. */
#include "dag/derive.h"
#include "mechanics/tangent.h"
#include "tree/pattern.h"
#include "dynamics/want.h"
#include "dynamics/forward.h"
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

static void clear(struct gradient *g)
{
	memset(g->along[VARIED_Q], 0, (size_t)g->t->nq * sizeof(struct ref));
	memset(g->along[VARIED_QD], 0, (size_t)g->t->nv * sizeof(struct ref));
	memset(g->along[VARIED_QDD], 0, (size_t)g->t->nv * sizeof(struct ref));
	g->other = -1;
}

static int rows_of(const struct gradient *g)
{
	return contacts_found(g->r->context);
}

static struct ref along(struct gradient *g, int torque)
{
	return g->dot[g->x.roots[torque].i];
}

/* Column by column: d tau/d q or d tau/d qd, or what is solved with it, d qdd. */
static void output_matrix(struct gradient *g, enum varied varied, int is_solved, int argument)
{
	int nv = g->t->nv;
	struct pattern p;
	struct ref *unit = arena_alloc(g->d->arena, (size_t)rows_of(g), sizeof *unit);

	if (!unit || !pattern_make(&p, g->t, 0, g->r->request->dense, g->d->arena)) {
		g->d->failed = 1;
		return;
	}
	for (int j = 0; j < nv; j++) {
		dag_section(g->d, SECTION_BY, tree_joint_of_row(g->t, j)->body);
		clear(g);
		memset(unit, 0, (size_t)nv * sizeof *unit);
		unit[j] = dag_const(g->d, 1);
		if (varied == VARIED_Q)
			tangent_all(g->d, g->t, g->r->in, unit, g->along[VARIED_Q]);
		else
			g->along[varied][j] = unit[j];
		derive_forward(&g->x, seed, g, g->dot);
		for (int i = 0; i < rows_of(g); i++)
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
	struct ref *column = arena_alloc(g->d->arena, (size_t)rows_of(g), sizeof *column);
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
		for (int i = 0; i < rows_of(g); i++)
			column[i] = is_solved ? dag_neg(g->d, along(g, i)) : along(g, i);
		if (is_solved)
			forward_solve(g->forward, column);
		for (int i = 0; i < g->t->nv; i++)
			dag_output(g->d, argument, i * f->rows + j, column[i]);
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
	if (a->failed || !derive_begin(&g->x, g->d, ((const struct build *)r->context)->torques, rows_of(g)))
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
	default:
		output_by_freed(g, w, argument);
	}
}

void gradient_outputs(const struct tour *r, const struct forward *forward, const int *outputs, const char *done)
{
	const struct request *k = r->request;
	struct gradient g = {0};

	for (int i = 0; i < k->want_count && !r->d->failed; i++) {
		if (product_is_of_torques(r->context, i))
			product_output(r->context, r->in, i);
		if (!is_ours(k, i, done))
			continue;
		if (!g.d && (!r->tau || !begin(&g, r, forward)))
			r->d->failed = 1;
		else
			output(&g, &k->wants[i], outputs[i]);
	}
}
