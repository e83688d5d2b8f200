/* What joints take for themselves, beside the rigid bodies. */
#include "tour.h"
#include <math.h>

/* c v / sqrt(v^2 + width^2): friction c against sliding at v, smooth where it turns. */
static struct ref smooth_friction(struct dag *d, real c, struct ref v, real width)
{
	struct ref square = dag_add(d, dag_mul(d, v, v), dag_const(d, width * width));

	return dag_div(d, dag_mul(d, dag_const(d, c), v), dag_sqrt(d, square));
}

/* Rotor inertia and friction of the joint's own axis, whose coordinate is multiplier q: J qdd + d qd + c sign(qd), and the
   multiplier once more for the driver's torque. */
void own_terms(const struct tour *r, int body, struct ref *tau)
{
	const struct task *t = &r->t->task;
	const struct body *k = &r->t->bodies[body];
	struct dag *d = r->d;
	real square = k->multiplier * k->multiplier;

	if (joint_nv(k->type) != 1)
		return;
	tau[0] = dag_add(d, tau[0], dag_mul(d, dag_const(d, square * t->armature[body]), source_row(d, &r->in.qdd, k->iv)));
	tau[0] = dag_add(d, tau[0], dag_mul(d, dag_const(d, square * t->damping[body]), source_row(d, &r->in.qd, k->iv)));
	if (t->friction[body] != 0 && k->multiplier != 0)
		tau[0] = dag_add(d, tau[0], smooth_friction(d, fabsl(k->multiplier) * t->friction[body], source_row(d, &r->in.qd, k->iv),
			t->friction_width / fabsl(k->multiplier)));
}
