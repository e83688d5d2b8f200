/* Gravity alone. With every body at rest a, the acceleration less gravity, is one and the same vector, seen from each
   frame: the wrench through a joint is f = M a, n = C x a, where M is the mass beyond it and C = sum of m c its first
   moment about the body's origin. So masses and moments come back instead of forces and moments. */
#include "dynamics/tour.h"

void at_rest_enter(const struct tour *r, int body)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct parameters *p = r->parameters ? r->parameters[body] : NULL;
	struct frame *x = &r->frames[body + 1];

	dag_section(d, SECTION_OUT, body);
	x->pose = joint_place(d, k, r->in);
	x->motion.a = joint_into(d, k, &x->pose, smat_mul_transposed(d, &x->pose.R, r->frames[k->parent + 1].motion.a));
	x->mass = p ? p->mass : dag_within(d, k->inertia.mass);
	x->own = p ? p->h : svec_const(d, k->inertia.h);
	svec_tag(d, x->motion.a, "a", k->number);
}

struct svec at_rest_moment(struct dag *d, const struct frame *x)
{
	return svec_add(d, x->own, x->beyond);
}

/* M_p += M, C_p += R C + M p; the terms M p are constants where joints turn, and are summed by themselves */
void at_rest_leave(const struct tour *r, int body)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	struct frame *x = &r->frames[body + 1], *parent = &r->frames[k->parent + 1];
	struct svec f, n, C = at_rest_moment(d, x);
	struct ref tau[6];

	dag_section(d, SECTION_BACK, body);
	svec_tag(d, C, "mc", k->number);
	f = svec_scale(d, x->mass, x->motion.a);
	n = svec_cross(d, C, x->motion.a);
	joint_project(d, k, f, n, joint_out_of(d, k, &x->pose, f), tau);
	for (int i = 0; i < joint_nv(k->type); i++)
		r->tau[k->iv + i] = dag_add(d, r->tau[k->iv + i], tau[i]);
	C = joint_to_parent(d, k, &x->pose, C);
	parent->beyond = svec_add(d, parent->beyond, C);
	parent->own = svec_add(d, parent->own, svec_scale(d, x->mass, x->pose.p));
	parent->mass = dag_add(d, parent->mass, x->mass);
}
