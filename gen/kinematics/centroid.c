/* Momentum about the centre of mass in the world's axes (Orin and Goswami, Centroidal momentum matrix of a humanoid robot, IROS 2008),
   from sums over subtrees: momentum.c has vectors, and a column of the matrix is the momentum of what lies beyond a joint, as one
   composite body, by the joint's unit twist (Z, Y): l = Z x C + m Y, and about the body's origin k = I Z + C x Y. */
#include "kinematics/centroid.h"
#include "tree/lumps.h"

static const struct svec NOTHING;

static int output_of(const struct kinematics *x, enum want_kind kind)
{
	for (int i = 0; i < x->k->want_count; i++)
		if (x->k->wants[i].kind == kind)
			return x->outputs[i];
	return -1;
}

static void output(const struct kinematics *x, int argument, int row, struct svec u)
{
	for (int i = 0; i < 3 && argument >= 0; i++)
		dag_output(x->d, argument, row + i, u.x[i]);
}

/* ---- masses ---- */

static int is_free(const struct kinematics *x, int body)
{
	return x->parameters && x->parameters[body];
}

/* What is held on the ground has no part in what moves. Numbers are summed first. */
static void find_mass(struct centroid *c)
{
	const struct kinematics *x = c->x;
	struct sum numbers = {0};

	for (int k = 0; k < x->t->body_count; k++)
		if (!is_free(x, k) && !lumps_is_held(x->t, k))
			sum_add(&numbers, x->t->bodies[k].inertia.mass);
	c->mass = dag_within(x->d, sum_total(numbers));
	for (int k = 0; k < x->t->body_count; k++)
		if (is_free(x, k) && !lumps_is_held(x->t, k))
			c->mass = dag_add(x->d, c->mass, x->parameters[k]->mass);
}

/* Does nothing tell masses apart from their ratios? */
static int are_ratios_enough(const struct kinematics *x)
{
	for (int k = 0; k < x->t->body_count; k++)
		if (is_free(x, k))
			return 0;
	for (int i = 0; i < x->k->want_count; i++) {
		enum want_kind kind = x->k->wants[i].kind;

		if (!want_is(kind, IS_MOTION) || kind == WANT_MOMENTUM || kind == WANT_MOMENTUM_MATRIX || kind == WANT_DMOMENTUM)
			return 0;
	}
	return 1;
}

/* The same in another unit of mass. */
static struct inertia in_unit(const struct inertia *I, struct within unit)
{
	struct inertia out = {.mass = within_div(I->mass, unit)};

	for (int i = 0; i < 3; i++)
		out.h[i] = within_div(I->h[i], unit);
	for (int i = 0; i < 6; i++)
		out.I[i] = within_div(I->I[i], unit);
	return out;
}

/* A body's own parameters. Returns 1 where these are numbers, *I. */
static int own_of(const struct centroid *c, int body, struct inertia *I, struct parameters *p)
{
	const struct kinematics *x = c->x;

	*I = (struct inertia){0};
	if (!lumps_is_held(x->t, body))
		*I = in_unit(&x->t->bodies[body].inertia, c->unit);
	*p = is_free(x, body) && !lumps_is_held(x->t, body) ? *x->parameters[body] : rigid_body_parameters(x->d, I);
	return !is_free(x, body);
}

/* ---- the tour ---- */

static int find_hub(const struct tree *t)
{
	for (int k = 1; k < t->body_count; k++)
		if (t->bodies[k].parent < 0)
			return -1;
	return 0;
}

void centroid_begin(struct centroid *c, struct kinematics *x)
{
	struct arena *a = x->d->arena;
	size_t bodies = (size_t)x->t->body_count;

	x->hub = find_hub(x->t);
	*c = (struct centroid){.unit = within_exact(1)};
	if (!request_wants_any(x->k, OF_MASSES))
		return;
	c->x = x;
	c->loads = arena_alloc(a, bodies + 1, sizeof *c->loads);
	c->columns = arena_alloc(a, bodies, sizeof *c->columns);
	c->is_shared = arena_alloc(a, (size_t)x->t->nv, 1);
	if (a->failed || !pattern_whole(&c->of_com, 3, x->t->nv, 0, a) || !pattern_momentum(&c->of_momentum, x->t, x->k->dense, a)) {
		x->d->failed = 1;
		c->x = NULL;
		return;
	}
	for (int i = 0; i < x->t->mimic_count; i++)
		c->is_shared[x->t->bodies[x->t->mimics[i].body].iv] = 1;
	c->has_matrix = output_of(x, WANT_MOMENTUM_MATRIX) >= 0;
	c->has_columns = c->has_matrix || output_of(x, WANT_COM_JACOBIAN) >= 0;
	find_mass(c);
	if (are_ratios_enough(x)) {
		c->unit = dag_number(x->d, &x->d->nodes[c->mass.i]);
		c->mass = dag_const(x->d, 1);
	}
	c->inverse = dag_div(x->d, dag_const(x->d, 1), c->mass);
}

void centroid_enter(struct centroid *c, int body)
{
	const struct kinematics *x = c->x;
	struct load *to;
	struct parameters p;
	struct inertia I;

	if (!x)
		return;
	to = &c->loads[body + 1];
	own_of(c, body, &I, &p);
	load_move(x, body, &c->loads[x->t->bodies[body].parent + 1], to);
	to->mass = p.mass;
	to->H = p.h;
}

/* ---- columns ---- */

/* Of a body with all that it carries: C where inertia is not asked for has fewer sums. */
static struct svec moment_of(const struct centroid *c, const struct load *of)
{
	return c->has_matrix ? of->whole.p.h : load_moment(c->x->d, of);
}

static void make_column(struct centroid *c, int body, int row)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;
	const struct load *of = &c->loads[body + 1];
	const struct smat *R = &x->bodies[body].R;
	struct momentum_column *to = &c->columns[body][row];
	struct svec Y, Z, C = moment_of(c, of), k;

	joint_unit_twist(d, &x->t->bodies[body], &x->bodies[body].pose, row, &Y, &Z);
	to->linear = svec_add(d, svec_cross(d, Z, C), svec_scale(d, of->mass, Y));
	k = svec_add(d, rigid_body_inertia_times(d, &of->whole.p, Z), svec_cross(d, C, Y));
	if (body == x->hub) /* all that slides with it has none about its centre */
		k = Z.x[0].i || Z.x[1].i || Z.x[2].i ? svec_sub(d, k, svec_cross(d, svec_scale(d, c->inverse, C), to->linear)) : NOTHING;
	to->linear = smat_mul(d, R, to->linear);
	to->angular = smat_mul(d, R, k);
}

static void write_column(const struct kinematics *x, const struct pattern *p, int argument, int first, int row, struct svec u)
{
	for (int i = 0; i < 3 && argument >= 0; i++)
		if (p->row[(first + i) * p->cols + row] >= 0)
			dag_output(x->d, argument, p->row[(first + i) * p->cols + row], u.x[i]);
}

/* What is complete of a column of both matrices: all but what several bodies add to, and but angular momentum. */
static void write_linear(const struct centroid *c, int row, struct svec l)
{
	const struct kinematics *x = c->x;

	write_column(x, &c->of_com, output_of(x, WANT_COM_JACOBIAN), 0, row, svec_scale(x->d, c->inverse, l));
	write_column(x, &c->of_momentum, output_of(x, WANT_MOMENTUM_MATRIX), 0, row, l);
}

static void make_columns(struct centroid *c, int body)
{
	const struct kinematics *x = c->x;
	const struct body *k = &x->t->bodies[body];

	for (int row = 0; row < joint_nv(k->type); row++) {
		make_column(c, body, row);
		if (!c->is_shared[k->iv])
			write_linear(c, k->iv + row, c->columns[body][row].linear);
	}
}

void centroid_leave(struct centroid *c, int body)
{
	const struct kinematics *x = c->x;
	const struct body *k;
	struct load *own;
	struct parameters p;
	struct inertia I;
	int has_numbers;

	if (!x)
		return;
	dag_section(x->d, SECTION_SUBTREE, body);
	k = &x->t->bodies[body];
	own = &c->loads[body + 1];
	has_numbers = own_of(c, body, &I, &p);
	load_add_own(x->d, own, k->number, &p, has_numbers ? &I : NULL);
	if (c->has_matrix)
		composite_add_body(x->d, &own->whole, &p, NOTHING);
	if (c->has_columns)
		make_columns(c, body);
	if (body == x->hub)
		return;
	load_add_child(x, body, own, &c->loads[k->parent + 1]);
	if (c->has_matrix && k->parent >= 0)
		composite_add_child(x->d, &c->loads[k->parent + 1].whole, &own->whole, k, &x->bodies[body].pose, NOTHING);
}

/* ---- at the hub ---- */

/* From the hub's axes into the world's. */
static struct svec to_world(const struct kinematics *x, struct svec u)
{
	return x->hub < 0 ? u : smat_mul(x->d, &x->bodies[x->hub].R, u);
}

/* What the velocities (V0, V) of the hub's origin add to a momentum P that is relative to it: m A V0 + R (P + m V). */
static struct svec with_hub(const struct centroid *c, struct svec P, struct svec V0, struct svec V)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;

	P = to_world(x, svec_add(d, P, svec_scale(d, c->mass, V)));
	return x->hub < 0 ? P : svec_add(d, smat_mul(d, &x->bodies[x->hub].A, svec_scale(d, c->mass, V0)), P);
}

/* Sums of rows of the matrix by qd. */
static void apply_matrix(const struct centroid *c, const struct momentum_column *of, struct svec *l, struct svec *k)
{
	struct dag *d = c->x->d;

	*l = *k = NOTHING;
	for (int i = 0; i < c->x->t->nv; i++) {
		struct ref rate = source_row(d, &c->x->in.qd, i);

		*l = svec_add(d, *l, svec_scale(d, rate, of[i].linear));
		*k = svec_add(d, *k, svec_scale(d, rate, of[i].angular));
	}
}

/* By rows of qd, about the centre of mass, which is at r where the hub's origin is at its p. */
static void gather_columns(const struct centroid *c, struct svec r, struct momentum_column *of)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;

	for (int body = 0; body < x->t->body_count; body++) {
		const struct body *k = &x->t->bodies[body];
		struct svec p = x->bodies[body].p, from;

		if (x->hub < 0)
			p = svec_add(d, x->bodies[body].from, p);
		from = svec_sub(d, p, r);
		for (int row = 0; row < joint_nv(k->type); row++) {
			const struct momentum_column *own = &c->columns[body][row];
			struct momentum_column *to = &of[k->iv + row];
			struct svec angular = own->angular;

			if (body != x->hub)
				angular = svec_add(d, angular, svec_cross(d, from, own->linear));
			to->linear = svec_add(d, to->linear, own->linear);
			to->angular = svec_add(d, to->angular, angular);
		}
	}
}

/* What is left of both matrices. */
static void output_columns(const struct centroid *c, const struct momentum_column *of)
{
	const struct kinematics *x = c->x;

	for (int row = 0; row < x->t->nv; row++) {
		if (c->is_shared[row])
			write_linear(c, row, of[row].linear);
		write_column(x, &c->of_momentum, output_of(x, WANT_MOMENTUM_MATRIX), 3, row, of[row].angular);
	}
}

/* f + m g, which has no moment about the centre of mass. */
void kinematics_momentum_rate(const struct kinematics *x, struct svec f, struct svec n, struct svec g)
{
	struct dag *d = x->d;
	int argument = output_of(x, WANT_DMOMENTUM);

	dag_section(d, SECTION_CENTROID, 0);
	output(x, argument, 0, svec_add(d, to_world(x, f), svec_scale(d, x->mass, g)));
	output(x, argument, 3, to_world(x, svec_sub(d, n, svec_cross(d, x->com, f))));
}

static void output_rate(const struct centroid *c, const struct load *all, const struct joint_rates *hub, struct svec com)
{
	const struct kinematics *x = c->x;
	struct svec n = svec_sub(x->d, all->N, svec_cross(x->d, com, all->F));

	if (x->gives_rate)
		return;
	output(x, output_of(x, WANT_DMOMENTUM), 0, with_hub(c, all->F, hub->dV0, hub->dV));
	output(x, output_of(x, WANT_DMOMENTUM), 3, to_world(x, n));
}

static void output_momentum(const struct centroid *c, const struct load *all, const struct joint_rates *hub, struct svec com,
	const struct momentum_column *of)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;
	struct svec l = with_hub(c, all->P, hub->V0, hub->V), k = to_world(x, svec_sub(d, all->K, svec_cross(d, com, all->P)));

	if (c->has_matrix)
		apply_matrix(c, of, &l, &k);
	output(x, output_of(x, WANT_VCOM), 0, svec_scale(d, c->inverse, l));
	output(x, output_of(x, WANT_MOMENTUM), 0, l);
	output(x, output_of(x, WANT_MOMENTUM), 3, k);
}

void centroid_end(struct centroid *c)
{
	const struct kinematics *x = c->x;
	const struct load *all;
	struct momentum_column *of;
	struct joint_rates hub = {.V = NOTHING};
	struct svec com, r;
	struct dag *d;

	if (!x)
		return;
	d = x->d;
	of = arena_alloc(d->arena, (size_t)x->t->nv, sizeof *of);
	if (!of) {
		d->failed = 1;
		return;
	}
	dag_section(d, SECTION_CENTROID, 0);
	all = &c->loads[x->hub + 1];
	if (x->hub >= 0)
		hub = joint_move(d, &x->t->bodies[x->hub], x->in);
	com = svec_scale(d, c->inverse, x->hub >= 0 ? moment_of(c, all) : load_moment(d, all));
	c->x->com = com;
	c->x->mass = c->mass;
	r = to_world(x, com);
	if (x->hub >= 0)
		r = svec_add(d, x->bodies[x->hub].p, r);
	output(x, output_of(x, WANT_COM), 0, x->hub >= 0 ? svec_add(d, x->bodies[x->hub].from, r) : r);
	if (c->has_columns) {
		gather_columns(c, r, of);
		output_columns(c, of);
	}
	output_momentum(c, all, &hub, com, of);
	output_rate(c, all, &hub, com);
}
