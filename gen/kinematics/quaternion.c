/* Orientation as a quaternion: the product of those of the joints on the way, which have half of their angles. No sign is chosen
   by what the result is, so it is continuous in q; that of a floating base is q's own, with its norm. The sign of all is chosen
   where q is zero. */
#include "dag/eval.h"
#include "kinematics/kinematics.h"
#include <math.h>

/* a b, of x y z w: (a_w b_v + b_w a_v + a_v x b_v, a_w b_w - a_v.b_v) */
static void multiply(struct dag *d, const struct ref *a, const struct ref *b, struct ref *out)
{
	const struct svec u = {{a[0], a[1], a[2]}}, v = {{b[0], b[1], b[2]}};
	struct svec w = svec_scale(d, b[3], u);

	w = svec_add(d, svec_scale(d, a[3], v), w);
	w = svec_add(d, w, svec_cross(d, u, v));
	for (int i = 0; i < 3; i++)
		out[i] = w.x[i];
	out[3] = svec_dot(d, u, v);
	out[3] = dag_sub(d, dag_mul(d, a[3], b[3]), out[3]);
}

/* Of a constant rotation: the largest of the four first, 2 sqrt of 1 and the diagonal with its signs, the others from sums and
   differences of elements across (Shepperd 1978). */
static void of_rotation(struct dag *d, const struct rotation *R, struct ref *out)
{
	const struct within one = within_exact(1), quarter = within_exact(0.25L);
	struct within square[4], root;
	int most = 3;

	for (int i = 0; i < 3; i++)
		square[i] = within_sub(within_sub(within_add(one, R->m[i][i]), R->m[(i + 1) % 3][(i + 1) % 3]),
			R->m[(i + 2) % 3][(i + 2) % 3]);
	square[3] = within_add(within_add(one, R->m[0][0]), within_add(R->m[1][1], R->m[2][2]));
	for (int i = 0; i < 3; i++)
		most = square[i].x > square[most].x ? i : most;
	root = within_sqrt(within_mul(quarter, square[most]));
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct within across = most == 3 ? within_sub(R->m[k][j], R->m[j][k]) : most == i
			? within_sub(R->m[k][j], R->m[j][k]) :
			within_add(R->m[i][most], R->m[most][i]);

		out[i] = most == i ? dag_within(d, root) : dag_within(d, within_div(within_mul(quarter, across), root));
		if (most == i)
			out[3] = dag_within(d, within_div(within_mul(quarter, across), root));
	}
	if (most == 3)
		out[3] = dag_within(d, root);
}

/* The coordinate axis along which a joint's lies behind the constant turn C, and its sign; -1: not all of C is right angles. */
static int axis_behind(const struct rotation *C, int axis, int *sign)
{
	int found = -1, nonzero = 0;

	for (int i = 0; i < 9; i++)
		nonzero += C->m[i / 3][i % 3].x != 0;
	for (int i = 0; i < 3; i++)
		if (C->m[i][axis].x != 0)
			found = i;
	*sign = C->m[found][axis].x < 0 ? -1 : 1;
	return nonzero == 3 ? found : -1;
}

/* C is taken into the quaternion, and is none from here on. */
static void take_in(const struct kinematics *x, struct placed *at)
{
	struct ref constant[4], turned[4];

	of_rotation(x->d, &at->C, constant);
	multiply(x->d, at->quaternion, constant, turned);
	for (int i = 0; i < 4; i++)
		at->quaternion[i] = turned[i];
	at->C = ROTATION_IDENTITY;
}

/* The orientation is the quaternion's, then C: R_x(pi/2) R_z(q) = R_-y(q) R_x(pi/2), so that right angles between axes cost
   nothing. */
void quaternion_place(const struct kinematics *x, int body)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[body];
	struct placed *to = &x->bodies[body];
	const struct placed *from = k->parent >= 0 ? &x->bodies[k->parent] : NULL;
	struct ref before[4], turn[4] = {{0}, {0}, {0}, dag_const(d, 1)};
	int sign, axis;

	for (int i = 0; i < 4; i++)
		to->quaternion[i] = from ? from->quaternion[i] : turn[i];
	to->C = from ? rotation_mul(&from->C, &k->X.R) : k->X.R;
	axis = axis_behind(&to->C, k->axis, &sign);
	if (k->type == JOINT_FLOATING || axis < 0)
		take_in(x, to);
	if (axis < 0 || k->type == JOINT_FLOATING) {
		axis = k->axis;
		sign = 1;
	}
	if (k->type == JOINT_FLOATING) {
		for (int i = 0; i < 4; i++)
			turn[i] = source_row(d, &x->in.q, k->iq + 3 + i);
	} else {
		joint_half_turn(d, k, x->in, &turn[axis], &turn[3]);
		turn[axis] = sign < 0 ? dag_neg(d, turn[axis]) : turn[axis];
	}
	for (int i = 0; i < 4; i++)
		before[i] = to->quaternion[i];
	multiply(d, before, turn, to->quaternion);
}

struct smat quaternion_turn(const struct kinematics *x, int body)
{
	const struct placed *at = &x->bodies[body];
	struct smat R = quaternion_matrix(x->d, at->quaternion), C = smat_const(x->d, &at->C);

	return smat_product(x->d, &R, &C);
}

/* Is it w of a floating body's q? */
static int is_upright(const struct kinematics *x, const struct node *input)
{
	int argument = (int)input->arg[0].i;
	int is_q = argument < x->d->argument_count && x->d->arguments[argument].role == ROLE_JOINT_POSITION;

	for (int i = 0; i < x->t->body_count && is_q; i++)
		if (x->t->bodies[i].type == JOINT_FLOATING && x->t->bodies[i].iq + 6 == (int)input->arg[1].i)
			return 1;
	return 0;
}

/* Of each node where all inputs are zero, and floating bodies stand along their parents' axes. NULL when memory runs out. */
static double *values_at_zero(const struct kinematics *x)
{
	size_t count = x->d->count;
	double *v = arena_alloc(x->d->arena, count, sizeof *v);

	for (size_t i = 0; i < count && v; i++) {
		const struct node *n = &x->d->nodes[i];

		if (n->op == OP_CONST || n->op == OP_INPUT)
			v[i] = n->op == OP_CONST ? (double)n->value : is_upright(x, n);
		else
			v[i] = eval_node(n, v);
	}
	return v;
}

/* The sign of w, or of the first of x, y and z that is not zero, where w is: however the frames on the way are turned. */
static int is_negative(const struct kinematics *x, const struct ref *quaternion)
{
	static const int order[] = {3, 0, 1, 2};
	static const double least = 1e-6; /* far above rounding */
	const double *v = values_at_zero(x);

	for (int k = 0; k < 4 && v; k++)
		if (fabs(v[quaternion[order[k]].i]) > least)
			return v[quaternion[order[k]].i] < 0;
	return 0;
}

void quaternion_of(const struct kinematics *x, int body, const struct placement *X, struct ref *quaternion)
{
	const struct rotation C = rotation_mul(&x->bodies[body].C, &X->R);
	struct ref constant[4];

	of_rotation(x->d, &C, constant);
	multiply(x->d, x->bodies[body].quaternion, constant, quaternion);
	if (!is_negative(x, quaternion))
		return;
	for (int i = 0; i < 4; i++)
		constant[i] = dag_neg(x->d, constant[i]);
	multiply(x->d, x->bodies[body].quaternion, constant, quaternion);
}
