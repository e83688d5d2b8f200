/* What joints take for themselves, beside the rigid bodies. */
#include "dag/derive.h"
#include "dynamics/tour.h"

/* c v / sqrt(v^2 + width^2): friction c against sliding at v, smooth where it turns. */
static struct ref smooth_friction(struct dag *d, struct ref c, struct ref v, struct within width)
{
	struct ref square = dag_within(d, within_mul(width, width)), root = dag_sqrt(d, dag_add(d, dag_mul(d, v, v), square));

	return dag_div(d, dag_mul(d, c, v), root);
}

struct ref own_term(const struct tour *r, enum own_term term, int body, struct within factor)
{
	struct ref input = r->own ? r->own[term][body] : (struct ref){0};

	if (input.i)
		return dag_mul(r->d, dag_within(r->d, factor), input);
	return dag_within(r->d, within_mul(factor, r->request->own[term][body]));
}

/* The term times the joint's rate or acceleration. */
static struct ref own_product(const struct tour *r, enum own_term term, int body, struct within factor, const struct source *s)
{
	struct ref row = source_row(r->d, s, r->t->bodies[body].iv);

	return dag_mul(r->d, own_term(r, term, body, factor), row);
}

/* Rotor inertia and friction of the joint's own axis, whose coordinate is multiplier q: J qdd + d qd + c sign(qd), and the
   multiplier once more for the driver's torque. */
void own_terms(const struct tour *r, int body, struct ref *tau)
{
	const struct body *k = &r->t->bodies[body];
	struct dag *d = r->d;
	struct within square = within_mul(k->multiplier, k->multiplier), size = k->multiplier;
	struct ref friction;

	if (joint_nv(k->type) != 1)
		return;
	tau[0] = dag_add(d, tau[0], own_product(r, OWN_ARMATURE, body, square, &r->in.qdd));
	tau[0] = dag_add(d, tau[0], own_product(r, OWN_DAMPING, body, square, &r->in.qd));
	if (size.x < 0)
		size = within_neg(size);
	friction = own_term(r, OWN_FRICTION, body, size);
	if (friction.i)
		tau[0] = dag_add(d, tau[0], smooth_friction(d, friction, source_row(d, &r->in.qd, k->iv),
			within_div(r->request->friction_width, size)));
}

struct ref own_rate(const struct tour *r, int body)
{
	struct ref tau = {0};

	own_terms(r, body, &tau);
	if (tau.i && !derive_by(r->d, &tau, r->in.qd.argument, r->t->bodies[body].iv))
		r->d->failed = 1;
	return tau;
}
