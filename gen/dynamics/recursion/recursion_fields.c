/* The field of a coordinate: how it changes the accelerations of what it moves. */
#include "dynamics/recursion/recursion.h"
#include <string.h>

static struct svec twice(struct dag *d, struct svec u)
{
	return svec_scale(d, dag_const(d, 2), u);
}

const struct joint_pose *recursion_pose(const struct recursion *x, int body)
{
	return &x->r->frames[body + 1].pose;
}

void recursion_unit_twist(const struct recursion *x, int body, int row, struct svec *Z, struct svec *Y)
{
	joint_unit_twist(x->r->d, &x->r->t->bodies[body], recursion_pose(x, body), row, Y, Z);
}

/* Axes that move with the body: Z' = w x Z, Z'' = U Z, and Y alike. By q alpha = Z'', beta = 2 Z', gamma = Y'' + a x Z, where a
   is the acceleration of o less gravity; by qd, since d p''/d qd = 2 d p'/d q, alpha = 2 Z', beta = 2 Z, gamma = 2 Y'. */
static void joint_fields(const struct recursion *x, int body, struct svec Z, struct svec Y, struct field *by)
{
	struct dag *d = x->r->d;
	const struct motion *m = &x->r->frames[body + 1].motion;
	struct svec rate = twice(d, svec_cross(d, m->w, Z));

	by[BY_Q] = (struct field){smat_mul(d, &m->U, Z), rate, svec_cross(d, m->a, Z)};
	by[BY_Q].gamma = svec_add(d, smat_mul(d, &m->U, Y), by[BY_Q].gamma);
	by[BY_QD] = (struct field){rate, twice(d, Z), twice(d, svec_cross(d, m->w, Y))};
}

/* The parent's u, in the frame of a body. */
static struct svec from_parent(const struct recursion *x, int body, struct svec u)
{
	struct dag *d = x->r->d;
	const struct joint_pose *at = recursion_pose(x, body);

	return joint_into(d, &x->r->t->bodies[body], at, smat_mul_transposed(d, &at->R, u));
}

/* A planar joint's slides, along axes of the parent's: Y' = w_p x Y, Y'' = w_p' x Y + w_p x Y'. */
static void slide_fields(const struct recursion *x, int body, struct svec Y, struct field *by)
{
	struct dag *d = x->r->d;
	const struct motion *from = &x->r->frames[x->r->t->bodies[body].parent + 1].motion;
	struct svec w = from_parent(x, body, from->w), rate = svec_cross(d, w, Y);

	by[BY_Q].gamma = svec_cross(d, w, rate);
	by[BY_Q].gamma = svec_add(d, svec_cross(d, from_parent(x, body, from->dw), Y), by[BY_Q].gamma);
	by[BY_QD].gamma = twice(d, rate);
}

/* The twist (V, W) of a floating base is counted along its own axes. When these turn, it stays what it is, and gravity alone
   is another one to the body: d(Q^T g) = s.s R^T g x Z for a quaternion of norm s, whose Q is (1 - s.s) 1 + s.s R. By the twist
   dV + W x V and W x (W x r) change. */
static void floating_fields(const struct recursion *x, int body, struct svec Z, struct svec Y, struct field *by)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[body];
	const struct joint_rates m = joint_move(d, k, x->r->in);
	struct svec up = x->r->frames[k->parent + 1].motion.a, more;
	struct ref excess = dag_const(d, -1);

	for (int i = 3; i < 7; i++) {
		struct ref e = source_row(d, &x->r->in.q, k->iq + i);

		excess = dag_add(d, dag_mul(d, e, e), excess);
	}
	more = svec_scale(d, excess, up);
	by[BY_Q].gamma = svec_cross(d, svec_add(d, from_parent(x, body, up), more), Z);
	by[BY_QD] = (struct field){svec_cross(d, m.W, Z), twice(d, Z), svec_cross(d, Z, m.V)};
	by[BY_QD].gamma = svec_add(d, svec_cross(d, m.W, Y), by[BY_QD].gamma);
}

/* (Z', Z, Y'): a slide of a planar joint is along the parent's axes, all else along the body's. */
static struct field column_rate(const struct recursion *x, int body, int is_slide, struct svec Z, struct svec Y)
{
	struct dag *d = x->r->d;
	const struct tour *r = x->r;
	struct svec w = r->frames[body + 1].motion.w;

	if (is_slide)
		w = from_parent(x, body, r->frames[r->t->bodies[body].parent + 1].motion.w);
	return (struct field){svec_cross(d, w, Z), Z, svec_cross(d, w, Y)};
}

void recursion_fields(const struct recursion *x, int body, int row, struct field *by)
{
	enum joint_type type = x->r->t->bodies[body].type;
	struct svec Z, Y;

	memset(by, 0, BY_QDD * sizeof *by);
	recursion_unit_twist(x, body, row, &Z, &Y);
	if (x->has_coriolis)
		by[BY_CORIOLIS] = column_rate(x, body, type == JOINT_PLANAR && row < 2, Z, Y);
	if (!x->has_gradients)
		return;
	if (type == JOINT_FLOATING)
		floating_fields(x, body, Z, Y, by);
	else if (type == JOINT_PLANAR && row < 2)
		slide_fields(x, body, Y, by);
	else
		joint_fields(x, body, Z, Y, by);
}
