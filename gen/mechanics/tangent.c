#include "mechanics/tangent.h"

/* dp = Q v; with the quaternion (u, s), du = (s w + u x w)/2, ds = -u.w/2. */
static void rates_floating(struct dag *d, const struct body *k, struct joint_inputs in, struct svec v, struct svec w,
	struct ref *rates)
{
	struct joint_pose pose = joint_place(d, k, in);
	struct ref half = dag_const(d, 0.5L), s = source_row(d, &in.q, k->iq + 6);
	struct svec p = smat_mul(d, &pose.Q, v), u, du;

	for (int i = 0; i < 3; i++)
		u.x[i] = source_row(d, &in.q, k->iq + 3 + i);
	du = svec_cross(d, u, w);
	du = svec_scale(d, half, svec_add(d, svec_scale(d, s, w), du));
	for (int i = 0; i < 3; i++) {
		rates[i] = p.x[i];
		rates[3 + i] = du.x[i];
	}
	rates[6] = dag_neg(d, dag_mul(d, half, svec_dot(d, u, w)));
}

/* The rates of a body's joint_nq rows of q for `v`, its joint_nv rows of the tangent. */
static void body_rates(struct dag *d, const struct body *k, struct joint_inputs in, const struct ref *v, struct ref *rates)
{
	if (k->type == JOINT_FLOATING)
		rates_floating(d, k, in, (struct svec){{v[0], v[1], v[2]}}, (struct svec){{v[3], v[4], v[5]}}, rates);
	for (int i = 0; i < joint_nv(k->type) && k->type != JOINT_FLOATING; i++)
		rates[i] = v[i];
}

void tangent_all(struct dag *d, const struct tree *t, struct joint_inputs in, const struct ref *v, struct ref *rates)
{
	for (int b = 0; b < t->body_count; b++)
		body_rates(d, &t->bodies[b], in, v + t->bodies[b].iv, rates + t->bodies[b].iq);
}

struct ref tangent_transposed(struct dag *d, const struct tree *t, struct joint_inputs in, const struct ref *by_q, int row)
{
	const struct body *k = &t->bodies[tree_joint_of_row(t, row)->body];
	struct ref unit[6] = {{0}}, rates[7] = {{0}}, sum = {0};

	unit[row - k->iv] = dag_const(d, 1);
	body_rates(d, k, in, unit, rates);
	for (int i = 0; i < joint_nq(k->type); i++)
		sum = dag_add(d, sum, dag_mul(d, by_q[k->iq + i], rates[i]));
	return sum;
}
