/* The momentum and the velocity of the centre of mass as matrices times qd (Orin and Goswami, Centroidal momentum
   matrix of a humanoid robot, IROS 2008). A column is the momentum of what lies beyond a joint, as one composite body,
   by the joint's unit twist (Z, Y): l = Z x C + m Y, and about the body's origin k = I Z + C x Y; about the centre of
   mass, k + p x l with p from there to the origin. So that no column waits, the centre of mass is found first. */
#include "kinematics/centroid.h"
#include <string.h>

static const struct svec NOTHING;

/* Of what a body carries: mass, and first moment, by the two sums of at_rest_moment (../dynamics/rnea.c). Composite bodies sum it
   in another order: what would be shared with them would wait from here to there. */
struct moment {
	struct ref mass;
	struct svec own, beyond;
};

static void leave_moment(const struct centroid *c, struct moment *of, int body)
{
	const struct kinematics *x = c->x;
	const struct body *k = &x->t->bodies[body];
	struct dag *d = x->d;
	struct joint_pose at = joint_place(d, k, x->in);
	struct moment *own = &of[body + 1], *to = &of[k->parent + 1];
	struct parameters p;
	struct inertia I;

	centroid_own(c, body, &I, &p);
	own->own = svec_add(d, own->own, p.h);
	own->mass = dag_add(d, own->mass, p.mass);
	if (body == x->hub)
		return;
	to->beyond = svec_add(d, to->beyond, joint_to_parent(d, k, &at, svec_add(d, own->own, own->beyond)));
	to->own = svec_add(d, to->own, svec_scale(d, own->mass, at.p));
	to->mass = dag_add(d, to->mass, own->mass);
}

/* x->com */
static int find_com(const struct centroid *c)
{
	struct kinematics *x = c->x;
	const struct body *bodies = x->t->bodies;
	struct moment *of = arena_alloc(x->d->arena, (size_t)x->t->body_count + 1, sizeof *of);
	int here = -1;

	if (!of)
		return 0;
	dag_section(x->d, SECTION_CENTROID, 0);
	for (int k = 0; k < x->t->body_count; here = k++)
		for (; here != bodies[k].parent; here = bodies[here].parent)
			leave_moment(c, of, here);
	for (; here >= 0; here = bodies[here].parent)
		leave_moment(c, of, here);
	x->com = svec_scale(x->d, c->inverse, svec_add(x->d, of[x->hub + 1].own, of[x->hub + 1].beyond));
	return 1;
}

int columns_begin(struct centroid *c)
{
	const struct kinematics *x = c->x;
	struct arena *a = x->d->arena;
	size_t rows = (size_t)x->t->nv;

	c->shared = arena_alloc(a, rows, sizeof *c->shared);
	c->is_shared = arena_alloc(a, rows, 1);
	if (a->failed || !pattern_whole(&c->of_com, 3, x->t->nv, 0, a) ||
		!pattern_momentum(&c->of_momentum, x->t, x->k->dense, a))
		return 0;
	for (int i = 0; i < x->t->mimic_count; i++)
		c->is_shared[x->t->bodies[x->t->mimics[i].body].iv] = 1;
	return !c->has_matrix || find_com(c);
}

/* ---- a column ---- */

/* All that slides with the hub has no angular momentum about its centre. */
static struct svec angular_of_hub(const struct centroid *c, struct svec Z, struct svec k, struct svec l)
{
	const struct kinematics *x = c->x;
	int turns = Z.x[0].i || Z.x[1].i || Z.x[2].i;

	return turns ? smat_mul(x->d, &x->bodies[x->hub].R, svec_sub(x->d, k, svec_cross(x->d, x->com, l))) : NOTHING;
}

static struct momentum_column column_of(const struct centroid *c, int body, int row)
{
	const struct kinematics *x = c->x;
	struct dag *d = x->d;
	const struct load *of = &c->loads[body + 1];
	const struct placed *at = &x->bodies[body];
	struct svec C = c->has_matrix ? of->whole.p.h : load_moment(d, of), Y, Z, l, k, p = at->p;
	struct momentum_column to;

	joint_unit_twist(d, &x->t->bodies[body], &at->pose, row, &Y, &Z);
	l = svec_scale(d, of->mass, Y);
	l = svec_add(d, svec_cross(d, Z, C), l);
	k = svec_cross(d, C, Y);
	k = svec_add(d, rigid_body_inertia_times(d, &of->whole.p, Z), k);
	to.linear = smat_mul(d, &at->R, l);
	if (body == x->hub) {
		to.angular = angular_of_hub(c, Z, k, l);
		return to;
	}
	if (x->hub < 0)
		p = svec_add(d, at->from, p);
	p = svec_sub(d, p, centroid_from_first(x));
	to.angular = svec_cross(d, p, to.linear);
	to.angular = svec_add(d, smat_mul(d, &at->R, k), to.angular);
	return to;
}

static void write(const struct kinematics *x, const struct pattern *p, int argument, int first, int row, struct svec u)
{
	for (int i = 0; i < 3 && argument >= 0; i++)
		if (p->row[(first + i) * p->cols + row] >= 0)
			dag_output(x->d, argument, p->row[(first + i) * p->cols + row], u.x[i]);
}

static void add_times(struct dag *d, struct svec *sum, struct ref rate, struct svec u)
{
	*sum = svec_add(d, *sum, svec_scale(d, rate, u));
}

/* Into both matrices, and into the momentum. */
static void take(struct centroid *c, int row, const struct momentum_column *of)
{
	const struct kinematics *x = c->x;
	struct ref rate = source_row(x->d, &x->in.qd, row);

	write(x, &c->of_com, centroid_output(x, WANT_COM_JACOBIAN), 0, row, svec_scale(x->d, c->inverse, of->linear));
	write(x, &c->of_momentum, centroid_output(x, WANT_MOMENTUM_MATRIX), 0, row, of->linear);
	write(x, &c->of_momentum, centroid_output(x, WANT_MOMENTUM_MATRIX), 3, row, of->angular);
	add_times(x->d, &c->times_qd.linear, rate, of->linear);
	add_times(x->d, &c->times_qd.angular, rate, of->angular);
}

/* What several bodies add to waits for all of them. */
void columns_leave(struct centroid *c, int body)
{
	const struct kinematics *x = c->x;
	const struct body *k = &x->t->bodies[body];

	for (int row = k->iv; row < k->iv + joint_nv(k->type); row++) {
		struct momentum_column of = column_of(c, body, row - k->iv), *to = &c->shared[row];

		if (!c->is_shared[k->iv]) {
			take(c, row, &of);
			continue;
		}
		to->linear = svec_add(x->d, to->linear, of.linear);
		to->angular = svec_add(x->d, to->angular, of.angular);
	}
}

void columns_end(struct centroid *c)
{
	for (int row = 0; row < c->x->t->nv; row++)
		if (c->is_shared[row])
			take(c, row, &c->shared[row]);
}
