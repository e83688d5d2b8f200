/* Orientation as a quaternion: the product of those of the joints on the way, which have half of their angles. No sign is chosen
   by what the result is, so it is continuous in q; that of a floating base is q's own, with its norm. */
#include "kinematics/kinematics.h"

/* a b, of x y z w: (a_w b_v + b_w a_v + a_v x b_v, a_w b_w - a_v.b_v) */
static void multiply(struct dag *d, const struct ref *a, const struct ref *b, struct ref *out)
{
	const struct svec u = {{a[0], a[1], a[2]}}, v = {{b[0], b[1], b[2]}};
	struct svec w = svec_add(d, svec_scale(d, a[3], v), svec_scale(d, b[3], u));

	w = svec_add(d, w, svec_cross(d, u, v));
	for (int i = 0; i < 3; i++)
		out[i] = w.x[i];
	out[3] = dag_sub(d, dag_mul(d, a[3], b[3]), svec_dot(d, u, v));
}

/* Of a constant rotation: the largest of the four first, 2 sqrt of 1 and the diagonal with its signs, the others from sums and
   differences of elements across (Shepperd 1978). */
static void of_rotation(struct dag *d, const struct rotation *R, struct ref *out)
{
	const struct within one = within_exact(1), quarter = within_exact(0.25L);
	struct within square[4], root;
	int most = 3;

	for (int i = 0; i < 3; i++)
		square[i] = within_sub(within_sub(within_add(one, R->m[i][i]), R->m[(i + 1) % 3][(i + 1) % 3]), R->m[(i + 2) % 3][(i + 2) % 3]);
	square[3] = within_add(within_add(one, R->m[0][0]), within_add(R->m[1][1], R->m[2][2]));
	for (int i = 0; i < 3; i++)
		most = square[i].x > square[most].x ? i : most;
	root = within_sqrt(within_mul(quarter, square[most]));
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct within across = most == 3 ? within_sub(R->m[k][j], R->m[j][k]) : most == i ? within_sub(R->m[k][j], R->m[j][k]) :
			within_add(R->m[i][most], R->m[most][i]);

		out[i] = most == i ? dag_within(d, root) : dag_within(d, within_div(within_mul(quarter, across), root));
		if (most == i)
			out[3] = dag_within(d, within_div(within_mul(quarter, across), root));
	}
	if (most == 3)
		out[3] = dag_within(d, root);
}

/* Of the joint: its constant turn, then its variable one. */
static void of_joint(const struct kinematics *x, const struct body *k, struct ref *out)
{
	struct dag *d = x->d;
	struct ref constant[4], variable[4] = {{0}, {0}, {0}, dag_const(d, 1)};

	of_rotation(d, &k->X.R, constant);
	if (k->type == JOINT_FLOATING) {
		for (int i = 0; i < 4; i++)
			variable[i] = source_row(d, &x->in.q, k->iq + 3 + i);
	} else {
		joint_half_turn(d, k, x->in, &variable[k->axis], &variable[3]);
	}
	multiply(d, constant, variable, out);
}

void quaternion_place(const struct kinematics *x, int body)
{
	const struct body *k = &x->t->bodies[body];
	struct placed *to = &x->bodies[body];
	struct ref own[4];

	of_joint(x, k, k->parent >= 0 ? own : to->quaternion);
	if (k->parent >= 0)
		multiply(x->d, x->bodies[k->parent].quaternion, own, to->quaternion);
}

void quaternion_of(const struct kinematics *x, int body, const struct placement *X, struct ref *quaternion)
{
	struct ref constant[4];

	of_rotation(x->d, &X->R, constant);
	multiply(x->d, x->bodies[body].quaternion, constant, quaternion);
}
