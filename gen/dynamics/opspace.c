/* The inertia that is felt at a link (Khatib, A unified approach for motion and force control of robot manipulators: the
   operational space formulation, 1987): its inverse is J M^-1 J^T, of any chain, and it is no number where the link cannot move
   in all six directions. With M = L^T D L and L^T Y = J^T it is Y^T D^-1 Y, and Y has no rows but those of the link's chain.
   Where bodies are articulated, J^T is not made: unit wrenches on the link are carried back to the base, and each joint takes its
   part. */
#include "dynamics/want.h"

struct opspace {
	struct build *b;
	const struct forward *M;
	const struct want *w;
	struct ref (*Y)[6], *inverse; /* by row of the chain's joints; 1/D */
	int rows;
	struct ref X[36];
};

/* ---- the chain's rows ---- */

static void reduce_by_factors(struct opspace *x)
{
	struct dag *d = x->b->d;
	int nv = x->b->t->nv;
	struct ref *J = arena_alloc(d->arena, 6 * (size_t)nv, sizeof *J);

	if (!J) {
		d->failed = 1;
		return;
	}
	jacobian_columns(&x->b->places, x->w, J);
	for (int c = 0; c < 6; c++)
		factor_reduce(&x->M->M, J + c * nv);
	for (x->rows = 0; x->rows < nv; x->rows++) {
		x->inverse[x->rows] = x->M->M.inverse[x->rows];
		for (int c = 0; c < 6; c++)
			x->Y[x->rows][c] = J[c * nv + x->M->M.row[x->rows]];
	}
}

/* The point whose velocity is told, from the body's origin, in the body's axes. */
static struct svec point_of(const struct opspace *x)
{
	struct dag *d = x->b->d;
	const struct placed *at = &x->b->places.bodies[x->w->body];

	if (x->b->k->frame != FRAME_WORLD)
		return svec_const(d, x->w->X.p);
	return smat_mul_transposed(d, &at->R, svec_sub(d, (struct svec){{{0}, {0}, {0}}}, svec_add(d, at->from, at->p)));
}

/* A unit force or moment along an axis of the frame that the request says, on the body. */
static void unit_wrench(const struct opspace *x, int row, struct svec *f, struct svec *n)
{
	struct dag *d = x->b->d;
	const struct smat *world = &x->b->places.bodies[x->w->body].R;
	struct svec *to = row < 3 ? f : n, e = {{{0}, {0}, {0}}};
	struct smat link = smat_const(d, &x->w->X.R);

	*f = *n = e;
	e.x[row % 3] = dag_const(d, 1);
	*to = x->b->k->frame == FRAME_LINK ? smat_mul(d, &link, e) : smat_mul_transposed(d, world, e);
	*n = svec_add(d, *n, svec_cross(d, point_of(x), *f));
}

static void reduce_by_bodies(struct opspace *x)
{
	const struct tree *t = x->b->t;
	struct svec f[6], n[6];

	for (int c = 0; c < 6; c++)
		unit_wrench(x, c, &f[c], &n[c]);
	x->rows = 0;
	for (int k = x->w->body; k >= 0; k = t->bodies[k].parent) {
		int rows = joint_nv(t->bodies[k].type);

		for (int c = 0; c < 6; c++) {
			struct ref y[6] = {{0}};

			articulated_reduce(&x->M->bodies, k, &f[c], &n[c], y);
			for (int i = 0; i < rows; i++)
				x->Y[x->rows + i][c] = y[i];
		}
		for (int i = 0; i < rows; i++)
			x->inverse[x->rows + i] = x->M->bodies.bodies[k].D.inverse[i];
		x->rows += rows;
	}
}

/* ---- matrices ---- */

static void multiply(struct opspace *x)
{
	for (int i = 0; i < x->rows; i++)
		factor_add_felt(x->b->d, 6, x->Y[i], x->inverse[i], x->X);
	for (int c = 0; c < 6; c++)
		for (int e = 0; e < c; e++)
			x->X[6 * e + c] = x->X[6 * c + e];
}

static void factor(const struct opspace *x, struct factor *f)
{
	struct dag *d = x->b->d;
	int singular = -1;

	if (d->failed || factor_make(f, d, 6, NULL, x->X, &singular))
		return;
	d->failed = 1;
	if (singular >= 0)
		d->singular = (struct singular){SINGULAR_WANT, (int)(x->w - x->b->k->wants)};
}

static void output(const struct opspace *x, int argument)
{
	struct dag *d = x->b->d;
	struct pattern p;

	if (d->failed || !request_pattern(&p, x->b->t, x->w, x->b->k->dense, d->arena)) {
		d->failed = 1;
		return;
	}
	for (int e = 0; e < 36; e++)
		if (p.row[e] >= 0)
			dag_output(d, argument, p.row[e], x->X[e]);
}

/* J M^-1 J^T */
static struct opspace make_inverse(struct build *b, const struct forward *M, int want)
{
	struct arena *a = b->d->arena;
	size_t rows = (size_t)b->t->nv;
	struct opspace x = {.b = b, .M = M, .w = &b->k->wants[want], .Y = arena_alloc(a, rows, sizeof *x.Y),
		.inverse = arena_alloc(a, rows, sizeof *x.inverse)};

	if (a->failed || b->d->failed) {
		b->d->failed = 1;
		return x;
	}
	dag_section(b->d, SECTION_OPSPACE, x.w->body);
	if (b->ways.dynamics == DYNAMICS_ARTICULATED)
		reduce_by_bodies(&x);
	else
		reduce_by_factors(&x);
	if (!b->d->failed)
		multiply(&x);
	return x;
}

void opspace_pivots(struct build *b, int want, struct ref *pairs)
{
	struct opspace x = make_inverse(b, b->factored, want);
	struct factor f;

	factor(&x, &f);
	for (int i = 0; i < 6 && !b->d->failed; i++) {
		int first = i < 3 ? 0 : 3;

		pairs[2 * i] = f.D[i];
		for (int c = first; c < first + 3; c++)
			pairs[2 * i + 1] = dag_add(b->d, pairs[2 * i + 1], x.X[7 * c]);
	}
}

static void make(struct build *b, int want)
{
	struct opspace x = make_inverse(b, b->factored, want);
	struct factor f;

	if (x.w->kind == WANT_OPSPACE) {
		factor(&x, &f);
		if (!b->d->failed)
			factor_inverse(&f, x.X);
	}
	output(&x, b->outputs[want]);
}

void opspace_outputs(struct build *b, struct joint_inputs in)
{
	const struct request *k = b->k;
	struct forward alone = {.b = b};

	if (!request_wants_any(k, IS_OPSPACE) || b->d->failed)
		return;
	if (!b->forward) {
		in.qd = (struct source){.argument = -1};
		forward_factor(&alone, b, in);
	}
	for (int i = 0; i < k->want_count; i++)
		if (want_is(k->wants[i].kind, IS_OPSPACE))
			make(b, i);
}
