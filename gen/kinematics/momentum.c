/* Sums over subtrees on the way back, each about the origin o of the body that carries the subtree, in that body's
   axes, of what its particles m at r do relative to o: mass, first moment C = sum m r, momentum P = sum m r' and
   K = sum r x m r', and their rates F = sum m r'', N = sum r x m r''. So no velocity of an origin is carried out.
   With D = R C + m p, a child at p adds

       to C: D,   to P: R P + m p',   to K: R K + p x R P + D x p',   to F: R F + m p'',   to N: R N + p x R F + D x p''.

   What m p is of C, a constant where the joint turns, is summed by itself in H, with the body's own first moment: in
   m p' and m p'' it moves as that does, P has w x H, and F has U H. */
#include "kinematics/centroid.h"

/* Of the body's origin along the joint's own axes: velocity and acceleration, in the parent's axes. */
static void slide(const struct kinematics *x, int body, struct svec w, struct svec *rate, struct svec *second)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[body];
	const struct joint_pose *at = &x->bodies[body].pose;
	struct joint_rates m = joint_move(d, k, x->in);

	w = smat_mul_transposed(d, &at->R, w);
	*rate = smat_mul(d, &at->R, svec_add(d, m.V0, joint_out_of(d, k, at, m.V)));
	*second = joint_out_of(d, k, at, motion_slide(d, joint_into(d, k, at, w), m.V, m.dV));
	*second = svec_add(d, motion_slide(d, w, m.V0, m.dV0), *second);
	*second = smat_mul(d, &at->R, *second);
}

/* w = E w_p + W,  dw = E dw_p + dW + E w_p x W */
void load_move(const struct kinematics *x, int body, const struct load *parent, struct load *to)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[body];
	const struct joint_pose *at = &x->bodies[body].pose;
	struct joint_rates m = joint_move(d, k, x->in);
	struct svec w = joint_into(d, k, at, smat_mul_transposed(d, &at->R, parent->motion.w));
	struct svec dw = joint_into(d, k, at, smat_mul_transposed(d, &at->R, parent->motion.dw));

	to->motion.w = svec_add(d, w, m.W);
	to->motion.dw = svec_add(d, dw, svec_add(d, m.dW, svec_cross(d, w, m.W)));
	to->motion.U = motion_rate_matrix(d, to->motion.w, to->motion.dw);
	svec_tag(d, to->motion.w, "w", k->number);
	svec_tag(d, to->motion.dw, "dw", k->number);
}

struct svec load_moment(struct dag *d, const struct load *x)
{
	return svec_add(d, x->H, x->beyond);
}

/* K: I w, N: I dw + w x I w */
void load_add_own(struct dag *d, struct load *x, int number, const struct parameters *p, const struct inertia *numbers)
{
	struct svec Iw = rigid_body_inertia_times(d, p, x->motion.w), n;

	if (numbers) {
		n = rigid_body_moment(d, numbers, &x->motion);
	} else {
		n = svec_cross(d, x->motion.w, Iw);
		n = svec_add(d, rigid_body_inertia_times(d, p, x->motion.dw), n);
	}
	x->P = svec_add(d, x->P, svec_cross(d, x->motion.w, x->H));
	x->K = svec_add(d, x->K, Iw);
	x->F = svec_add(d, x->F, smat_mul(d, &x->motion.U, x->H));
	x->N = svec_add(d, x->N, n);
	svec_tag(d, x->P, "P", number);
	svec_tag(d, x->K, "K", number);
	svec_tag(d, x->F, "F", number);
	svec_tag(d, x->N, "N", number);
}

void load_add_child(const struct kinematics *x, int child, const struct load *c, struct load *to)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[child];
	const struct joint_pose *at = &x->bodies[child].pose;
	struct svec moment = load_moment(d, c), C = joint_to_parent(d, k, at, moment);
	struct svec P = joint_to_parent(d, k, at, c->P), F = joint_to_parent(d, k, at, c->F);
	struct svec mp = svec_scale(d, c->mass, at->p), D = svec_add(d, C, mp), rate, second;

	svec_tag(d, moment, "mc", k->number);
	slide(x, child, to->motion.w, &rate, &second);
	to->mass = dag_add(d, to->mass, c->mass);
	to->H = svec_add(d, to->H, mp);
	to->beyond = svec_add(d, to->beyond, C);
	to->P = svec_add(d, to->P, svec_add(d, P, svec_scale(d, c->mass, rate)));
	to->F = svec_add(d, to->F, svec_add(d, F, svec_scale(d, c->mass, second)));
	rate = svec_add(d, svec_cross(d, to->motion.w, at->p), rate);
	second = svec_add(d, smat_mul(d, &to->motion.U, at->p), second);
	rate = svec_cross(d, D, rate);
	P = svec_add(d, svec_cross(d, at->p, P), rate);
	second = svec_cross(d, D, second);
	F = svec_add(d, svec_cross(d, at->p, F), second);
	to->K = svec_add(d, to->K, svec_add(d, joint_to_parent(d, k, at, c->K), P));
	to->N = svec_add(d, to->N, svec_add(d, joint_to_parent(d, k, at, c->N), F));
}
