/* The centre of mass, and the momentum about it in the world's axes, from the sums over subtrees of momentum.c. */
#include "kinematics/centroid.h"
#include "tree/lumps.h"

static const struct svec NOTHING;

int centroid_output(const struct kinematics *x, enum want_kind kind)
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

int centroid_own(const struct centroid *c, int body, struct inertia *I, struct parameters *p)
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
	c->has_matrix = centroid_output(x, WANT_MOMENTUM_MATRIX) >= 0;
	c->has_columns = c->has_matrix || centroid_output(x, WANT_COM_JACOBIAN) >= 0;
	find_mass(c);
	if (are_ratios_enough(x)) {
		c->unit = dag_number(x->d, &x->d->nodes[c->mass.i]);
		c->mass = dag_const(x->d, 1);
	}
	c->inverse = dag_div(x->d, dag_const(x->d, 1), c->mass);
	if (a->failed || (c->has_columns && !columns_begin(c))) {
		x->d->failed = 1;
		c->x = NULL;
	}
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
	centroid_own(c, body, &I, &p);
	load_move(x, body, &c->loads[x->t->bodies[body].parent + 1], to);
	to->mass = p.mass;
	to->H = p.h;
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
	has_numbers = centroid_own(c, body, &I, &p);
	load_add_own(x->d, own, k->number, &p, has_numbers ? &I : NULL);
	if (c->has_matrix)
		composite_add_body(x->d, &own->whole, &p, NOTHING);
	if (c->has_columns)
		columns_leave(c, body);
	if (body == x->hub)
		return;
	load_add_child(x, body, own, &c->loads[k->parent + 1]);
	if (c->has_matrix && k->parent >= 0)
		composite_add_child(x->d, &c->loads[k->parent + 1].whole, &own->whole, k, &x->bodies[body].pose, NULL);
}

/* ---- at the hub ---- */

/* From the hub's axes. */
static struct svec to_world(const struct kinematics *x, struct svec u)
{
	return x->hub < 0 ? u : smat_mul(x->d, &x->bodies[x->hub].R, u);
}

struct svec centroid_from_first(const struct kinematics *x)
{
	struct svec r = to_world(x, x->com);

	return x->hub < 0 ? r : svec_add(x->d, x->bodies[x->hub].p, r);
}

/* What the velocities (V0, V) of the hub's origin add to a momentum P that is relative to it: m A V0 + R (P + m V). */
static struct svec with_hub(const struct centroid *c, struct svec P, struct svec V0, struct svec V)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;

	P = to_world(x, svec_add(d, P, svec_scale(d, c->mass, V)));
	return x->hub < 0 ? P : svec_add(d, smat_mul(d, &x->bodies[x->hub].A, svec_scale(d, c->mass, V0)), P);
}

/* f + m g, which has no moment about the centre of mass. */
void kinematics_momentum_rate(const struct kinematics *x, struct svec f, struct svec n, struct svec g)
{
	struct dag *d = x->d;
	int argument = centroid_output(x, WANT_DMOMENTUM);

	dag_section(d, SECTION_CENTROID, 0);
	g = svec_scale(d, x->mass, g);
	output(x, argument, 0, svec_add(d, to_world(x, f), g));
	output(x, argument, 3, to_world(x, svec_sub(d, n, svec_cross(d, x->com, f))));
}

static void output_rate(const struct centroid *c, const struct load *all, const struct joint_rates *hub)
{
	const struct kinematics *x = c->x;
	struct svec n = svec_sub(x->d, all->N, svec_cross(x->d, x->com, all->F));

	if (x->gives_rate)
		return;
	output(x, centroid_output(x, WANT_DMOMENTUM), 0, with_hub(c, all->F, hub->dV0, hub->dV));
	output(x, centroid_output(x, WANT_DMOMENTUM), 3, to_world(x, n));
}

static void output_momentum(const struct centroid *c, const struct load *all, const struct joint_rates *hub)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;
	struct svec l = with_hub(c, all->P, hub->V0, hub->V),
		    k = to_world(x, svec_sub(d, all->K, svec_cross(d, x->com, all->P)));

	if (c->has_matrix) {
		l = c->times_qd.linear;
		k = c->times_qd.angular;
	}
	output(x, centroid_output(x, WANT_VCOM), 0, svec_scale(d, c->inverse, l));
	output(x, centroid_output(x, WANT_MOMENTUM), 0, l);
	output(x, centroid_output(x, WANT_MOMENTUM), 3, k);
}

void centroid_end(struct centroid *c)
{
	struct kinematics *x = c->x;
	const struct load *all;
	struct joint_rates hub = {.V = NOTHING};
	struct svec r;

	if (!x)
		return;
	dag_section(x->d, SECTION_CENTROID, 0);
	all = &c->loads[x->hub + 1];
	if (x->hub >= 0)
		hub = joint_move(x->d, &x->t->bodies[x->hub], x->in);
	if (!c->has_matrix)
		x->com = svec_scale(x->d, c->inverse, load_moment(x->d, all));
	x->mass = c->mass;
	r = centroid_from_first(x);
	output(x, centroid_output(x, WANT_COM), 0, x->hub >= 0 ? svec_add(x->d, x->bodies[x->hub].from, r) : r);
	if (c->has_columns)
		columns_end(c);
	output_momentum(c, all, &hub);
	output_rate(c, all, &hub);
}
