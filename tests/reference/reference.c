#include "reference/reference.h"

#include <stdlib.h>

#include "reference/read.h"
#include "reference/tree.h"

// One joint's rows, factor * x + offset.
static void gather(const wide *x, int first, int n, wide factor, wide offset, wide *out)
{
	for (int k = 0; k < n; k++)
		out[k] = factor * x[first + k] + offset;
}

static struct d3_vec scaled(struct d3_vec v, wide factor)
{
	return (struct d3_vec){{factor * v.x[0], factor * v.x[1], factor * v.x[2]}};
}

static void column(struct d6_mat *s, int k, int row, struct d3_vec v)
{
	for (int i = 0; i < 3; i++)
		s->m[row + i][k] = v.x[i];
}

// Table 4.1: the joint's own transform and its motion subspace in the child's axes.
static struct d6_mat one_axis_joint(struct reference_link *l, bool prismatic, wide q)
{
	column(&l->s, 0, prismatic ? 0 : 3, l->axis);
	if (prismatic)
		return d6_transform(d3_identity(), scaled(l->axis, q));
	return d6_transform(d3_about(l->axis, wide_sin(q), wide_cos(q)), (struct d3_vec){{0}});
}

static struct d6_mat floating_joint(struct reference_link *l, const wide *q)
{
	l->s = d6_identity();
	return d6_transform(d3_quaternion(q + 3), (struct d3_vec){{q[0], q[1], q[2]}});
}

// q = (x, y, theta). With E = R^T the columns are E x, E y, axis; E turns, dE/dt = -theta' [axis] E, so the drift is
// -theta' axis x E (x' ex + y' ey).
static struct d6_mat planar_joint(struct reference_link *l, const wide *q, const wide *qd)
{
	struct d3_mat r = d3_about(l->axis, wide_sin(q[2]), wide_cos(q[2])), e = d3_transpose(r);
	struct d3_vec ex = d3_apply(e, l->plane[0]), ey = d3_apply(e, l->plane[1]), p, velocity, turned;

	for (int i = 0; i < 3; i++) {
		p.x[i] = q[0] * l->plane[0].x[i] + q[1] * l->plane[1].x[i];
		velocity.x[i] = qd[0] * ex.x[i] + qd[1] * ey.x[i];
	}
	column(&l->s, 0, 0, ex);
	column(&l->s, 1, 0, ey);
	column(&l->s, 2, 3, l->axis);
	turned = d3_apply(d3_cross(l->axis), velocity);
	for (int i = 0; i < 3; i++)
		l->drift.x[i] = -qd[2] * turned.x[i];
	return d6_transform(r, p);
}

static struct d6_mat joint_transform(const struct reference_joint *j, struct reference_link *l, const wide *q,
                                     const wide *qd)
{
	l->s = (struct d6_mat){0};
	l->drift = (struct d6_vec){0};
	switch (j->type) {
	case REFERENCE_REVOLUTE:
	case REFERENCE_CONTINUOUS:
	case REFERENCE_PRISMATIC:
		return one_axis_joint(l, j->type == REFERENCE_PRISMATIC, q[0]);
	case REFERENCE_FLOATING:
		return floating_joint(l, q);
	case REFERENCE_PLANAR:
		return planar_joint(l, q, qd);
	case REFERENCE_FIXED:
		break;
	}
	return d6_identity();
}

// v x* f = -(v x)^T f.
static struct d6_vec cross_force(struct d6_mat cross, struct d6_vec f)
{
	struct d6_vec c = d6_apply_transpose(cross, f);

	for (int i = 0; i < 6; i++)
		c.x[i] = -c.x[i];
	return c;
}

// v = X vp + S qd, a = X ap + S qdd + dS/dt qd + v x S qd, net = I a + v x* I v.
static void move(struct reference_link *l, struct d6_mat joint, struct d6_vec qd, struct d6_vec qdd, struct d6_vec vp,
                 struct d6_vec ap)
{
	struct d6_vec vj = d6_apply(l->s, qd);

	l->x = d6_mul(joint, l->tree);
	l->v = d6_add(d6_apply(l->x, vp), vj);
	l->a = d6_add(d6_apply(l->x, ap), d6_apply(l->s, qdd));
	l->a = d6_add(d6_add(l->a, l->drift), d6_apply(d6_cross(l->v), vj));
	l->net = d6_add(d6_apply(l->inertia, l->a), cross_force(d6_cross(l->v), d6_apply(l->inertia, l->v)));
}

// The same with magnitudes: no difference can cancel.
static void move_magnitudes(struct reference_link *l, struct d6_mat joint, struct d6_vec qd, struct d6_vec qdd,
                            struct d6_vec vp, struct d6_vec ap)
{
	struct d6_mat inertia = d6_abs(l->inertia), cross;
	struct d6_vec vj;

	l->s = d6_abs(l->s);
	vj = d6_apply(l->s, d6_abs_vec(qd));
	l->x = d6_mul(d6_abs(joint), d6_abs(l->tree));
	l->v = d6_add(d6_apply(l->x, vp), vj);
	cross = d6_abs(d6_cross(l->v));
	l->a = d6_add(d6_apply(l->x, ap), d6_apply(l->s, d6_abs_vec(qdd)));
	l->a = d6_add(d6_add(l->a, d6_abs_vec(l->drift)), d6_apply(cross, vj));
	l->net = d6_add(d6_apply(inertia, l->a), d6_apply_transpose(cross, d6_apply(inertia, l->v)));
}

static struct d6_vec ground(const struct reference *r, bool magnitudes)
{
	struct d6_vec a = {{-r->gravity[0], -r->gravity[1], -r->gravity[2], 0, 0, 0}};

	return magnitudes ? d6_abs_vec(a) : a;
}

static struct d3_mat rotation(struct d6_mat x)
{
	struct d3_mat e;

	for (int i = 0; i < 9; i++)
		e.m[i / 3][i % 3] = x.m[i / 3][i % 3];
	return e;
}

// The link's axes in the ground, and f = net less the wrench from outside.
static void push(struct reference_link *l, const struct reference_link *parent, bool magnitudes)
{
	struct d6_vec w = l->push;

	l->turn = parent ? d3_mul(rotation(l->x), parent->turn) : rotation(l->x);
	for (int k = 0; k < 6 && l->push_in_world; k += 3) {
		struct d3_vec part = d3_apply(l->turn, (struct d3_vec){{l->push.x[k], l->push.x[k + 1], l->push.x[k + 2]}});

		for (int i = 0; i < 3; i++)
			w.x[k + i] = part.x[i];
	}
	for (int k = 0; k < 6; k++)
		l->f.x[k] = l->net.x[k] + (magnitudes ? wide_abs(w.x[k]) : -w.x[k]);
}

static wide own_torque(const struct reference_own *o, wide v, wide a, bool magnitudes)
{
	wide inertial = o->armature * a, viscous = o->damping * v, coulomb = 0;

	if (o->friction != 0)
		coulomb = o->friction * v / wide_sqrt(v * v + o->width * o->width);
	return magnitudes ? wide_abs(inertial) + wide_abs(viscous) + wide_abs(coulomb) : inertial + viscous + coulomb;
}

static void outward(struct reference *r, const wide *q, const wide *qd, const wide *qdd, bool magnitudes)
{
	for (int i = 0; i < r->nj; i++) {
		const struct reference_joint *j = &r->joints[i], *d = &r->joints[j->driver];
		struct reference_link *l = &r->links[i], *parent = i ? &r->links[j->parent] : NULL;
		struct d6_vec v = {0}, a = {0}, vp = parent ? parent->v : v;
		struct d6_vec ap = parent ? parent->a : ground(r, magnitudes);
		struct d6_mat x;
		wide position[7];

		gather(q, d->iq, d->nq, j->multiplier, j->offset, position);
		gather(qd, d->iv, d->nv, j->multiplier, 0, v.x);
		gather(qdd, d->iv, d->nv, j->multiplier, 0, a.x);
		x = joint_transform(j, l, position, v.x);
		(magnitudes ? move_magnitudes : move)(l, x, v, a, vp, ap);
		push(l, parent, magnitudes);
		l->own = own_torque(&l->terms, v.x[0], a.x[0], magnitudes);
	}
}

// tau = S^T f, f of the parent += X^T f; a follower's torque goes to its driver.
static void inward(struct reference *r, wide *tau, bool magnitudes)
{
	for (int k = 0; k < r->nv; k++)
		tau[k] = 0;
	for (int i = r->nj - 1; i >= 0; i--) {
		const struct reference_joint *j = &r->joints[i], *d = &r->joints[j->driver];
		struct reference_link *l = &r->links[i];
		struct d6_vec torque = d6_apply_transpose(l->s, l->f);

		torque.x[0] += l->own;
		for (int k = 0; k < d->nv; k++)
			tau[d->iv + k] += (magnitudes ? wide_abs(j->multiplier) : j->multiplier) * torque.x[k];
		if (i)
			r->links[j->parent].f = d6_add(r->links[j->parent].f, d6_apply_transpose(l->x, l->f));
	}
}

void reference_rnea_wide(struct reference *r, const wide *q, const wide *qd, const wide *qdd, wide *tau)
{
	outward(r, q, qd, qdd, false);
	inward(r, tau, false);
}

// The three inputs widened, one after the other; the caller frees.
static wide *widened(const struct reference *r, const double *q, const double *qd, const double *qdd)
{
	wide *all = raw_memory(NULL, (size_t)(r->nq + 2 * r->nv), sizeof *all), *out = all;

	for (int i = 0; i < r->nq; i++)
		*out++ = (wide)q[i];
	for (int i = 0; i < r->nv; i++)
		*out++ = (wide)qd[i];
	for (int i = 0; i < r->nv; i++)
		*out++ = (wide)qdd[i];
	return all;
}

void reference_rnea(struct reference *r, const double *q, const double *qd, const double *qdd, wide *tau)
{
	wide *all = widened(r, q, qd, qdd);

	reference_rnea_wide(r, all, all + r->nq, all + r->nq + r->nv, tau);
	free(all);
}

void reference_magnitude(struct reference *r, const double *q, const double *qd, const double *qdd, wide *s)
{
	wide *all = widened(r, q, qd, qdd);

	outward(r, all, all + r->nq, all + r->nq + r->nv, true);
	inward(r, s, true);
	free(all);
}

static void copy_vec(wide (*out)[6], int body, struct d6_vec v)
{
	for (int k = 0; out && k < 6; k++)
		out[body][k] = v.x[k];
}

void reference_passes(struct reference *r, const double *q, const double *qd, const double *qdd, wide (*v)[6],
                      wide (*a)[6], wide (*f)[6])
{
	wide *all = widened(r, q, qd, qdd);

	outward(r, all, all + r->nq, all + r->nq + r->nv, false);
	free(all);
	for (int i = r->nj - 1; i >= 0; i--) {
		const struct reference_joint *j = &r->joints[i];
		struct reference_link *l = &r->links[i];

		if (j->body < 0)
			continue;
		if (j->type == REFERENCE_FIXED) {
			r->links[j->parent].net = d6_add(r->links[j->parent].net, d6_apply_transpose(l->x, l->net));
			continue;
		}
		copy_vec(v, j->body, l->v);
		copy_vec(a, j->body, l->a);
		copy_vec(f, j->body, l->net);
	}
}
