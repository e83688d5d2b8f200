#include "mechanics/joint.h"

static struct svec zero3(void)
{
	const struct ref zero = {0};

	return (struct svec){{zero, zero, zero}};
}

static int turns(const struct body *k)
{
	return k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS || k->type == JOINT_PLANAR || k->turn.x != 0;
}

struct ref source_row(struct dag *d, const struct source *s, int row)
{
	const struct ref zero = {0};

	if (s->given && s->given[row].is_given)
		return dag_within(d, s->given[row].value);
	if (s->found)
		return s->found[row];
	return s->argument >= 0 ? dag_input(d, s->argument, row) : zero;
}

static struct svec source_rows(struct dag *d, const struct source *s, int row)
{
	return (struct svec){{source_row(d, s, row), source_row(d, s, row + 1), source_row(d, s, row + 2)}};
}

/* A row of q with what is added to it. */
static struct ref coordinate(struct dag *d, const struct joint_inputs *in, int row)
{
	struct ref q = source_row(d, &in->q, row);

	return in->offset ? dag_add(d, q, in->offset[row]) : q;
}

/* A number along a single axis: the joint's, its follower's multiple, and in the axis's direction. */
static struct ref directed(struct dag *d, const struct body *k, struct ref a)
{
	return dag_mul(d, dag_within(d, k->sign < 0 ? within_neg(k->multiplier) : k->multiplier), a);
}

/* The angle about the joint's axis. */
static struct ref angle_of(struct dag *d, const struct body *k, struct joint_inputs in)
{
	return directed(d, k, coordinate(d, &in, k->type == JOINT_PLANAR ? k->iq + 2 : k->iq));
}

/* R = [1-2(yy+zz), 2(xy-zw), 2(xz+yw); 2(xy+zw), 1-2(xx+zz), 2(yz-xw); 2(xz-yw), 2(yz+xw), 1-2(xx+yy)] */
struct smat quaternion_matrix(struct dag *d, const struct ref *q)
{
	const struct svec u = {{q[0], q[1], q[2]}};
	struct ref one = dag_const(d, 1);
	struct svec u2 = svec_scale(d, dag_const(d, 2), u);
	struct smat Q;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct ref jk = dag_mul(d, u2.x[j], u.x[k]), iw = dag_mul(d, u2.x[i], q[3]);
		struct ref jj = dag_mul(d, u2.x[j], u.x[j]), kk = dag_mul(d, u2.x[k], u.x[k]);

		Q.m[i][i] = dag_sub(d, one, dag_add(d, jj, kk));
		Q.m[j][k] = dag_sub(d, jk, iw);
		Q.m[k][j] = dag_add(d, jk, iw);
	}
	return Q;
}

/* s' = s cos b + c sin b, c' = c cos b - s sin b: no angle is added to q, where it would be rounded with it. */
static void turn_ahead(struct dag *d, const struct body *k, struct joint_pose *x)
{
	struct ref sine = dag_within(d, k->ahead.s), cosine = dag_within(d, k->ahead.c), s = x->s, c = x->c;

	if (!body_is_ahead(k) && !k->ahead.s.limb && !k->ahead.c.limb) /* nor is a limb's twin */
		return;
	x->s = dag_add_products(d, cosine, s, sine, c);
	x->c = dag_sub_products(d, cosine, c, sine, s);
	dag_tag(d, x->s, "sa", k->number, 0);
	dag_tag(d, x->c, "ca", k->number, 0);
}

/* Of half the angle: sin a = 2 sin(a/2) cos(a/2), cos a = 1 - 2 sin(a/2)^2 */
static void sine_of(struct dag *d, const struct joint_inputs *in, struct ref angle, struct ref *s, struct ref *c)
{
	struct ref half, sine, twice;

	if (!in->by_halves) {
		*s = dag_sin(d, angle);
		*c = dag_cos(d, angle);
		return;
	}
	half = dag_mul(d, dag_const(d, 0.5L), angle);
	sine = dag_sin(d, half);
	twice = dag_mul(d, dag_const(d, 2), sine);
	*s = dag_mul(d, twice, dag_cos(d, half));
	*c = dag_mul(d, twice, sine);
	*c = dag_sub(d, dag_const(d, 1), *c);
}

struct joint_pose joint_place(struct dag *d, const struct body *k, struct joint_inputs in)
{
	struct joint_pose x = {.R = smat_const(d, &k->X.R)};
	struct svec slide = zero3();
	struct ref q[4];

	if (k->type == JOINT_PRISMATIC) {
		slide.x[k->axis] = directed(d, k, coordinate(d, &in, k->iq));
	} else if (k->type == JOINT_PLANAR) {
		slide.x[0] = source_row(d, &in.q, k->iq);
		slide.x[1] = source_row(d, &in.q, k->iq + 1);
	} else if (k->type == JOINT_FLOATING) {
		slide = source_rows(d, &in.q, k->iq);
		q[3] = source_row(d, &in.q, k->iq + 6);
		for (int i = 0; i < 3; i++)
			q[i] = source_row(d, &in.q, k->iq + 3 + i);
		x.Q = quaternion_matrix(d, q);
		for (int i = 0; i < 9 && in.is_again; i++)
			x.Q.m[i / 3][i % 3] = dag_anew(d, x.Q.m[i / 3][i % 3]);
	}
	x.slide = smat_mul(d, &x.R, slide);
	x.p = svec_add(d, svec_const(d, k->X.p), x.slide);
	if (k->turn.x != 0) {
		struct within s, c;

		angle_sincos(k->turn, &s, &c);
		x.s = dag_within(d, s);
		x.c = dag_within(d, c);
	} else if (turns(k)) {
		struct ref angle = angle_of(d, k, in);

		sine_of(d, &in, angle, &x.s, &x.c);
		dag_tag(d, x.s, "s", k->number, 0);
		dag_tag(d, x.c, "c", k->number, 0);
		turn_ahead(d, k, &x);
		if (in.is_again) {
			x.s = dag_anew(d, x.s);
			x.c = dag_anew(d, x.c);
		}
	}
	return x;
}

/* Half of the angle that is added ahead, by its sine and cosine: tan(b/2) = sin b/(1 + cos b). */
static void half_ahead(const struct body *k, struct within *s, struct within *c)
{
	const struct within half = within_exact(0.5L), one = within_exact(1);

	*s = within_exact(0);
	*c = one;
	if (!body_is_ahead(k))
		return;
	if (k->ahead.c.x >= 0) {
		*c = within_sqrt(within_mul(half, within_add(one, k->ahead.c)));
		*s = within_div(within_mul(half, k->ahead.s), *c);
	} else {
		*s = within_sqrt(within_mul(half, within_sub(one, k->ahead.c)));
		*c = within_div(within_mul(half, k->ahead.s), *s);
	}
}

void joint_half_turn(struct dag *d, const struct body *k, struct joint_inputs in, struct ref *s, struct ref *c)
{
	struct ref half = dag_const(d, 0.5L), sine = {0}, cosine = dag_const(d, 1), ahead_s, ahead_c;
	struct within sa, ca;

	if (k->turn.x != 0) {
		angle_sincos(within_mul(within_exact(0.5L), k->turn), &sa, &ca);
		*s = dag_within(d, sa);
		*c = dag_within(d, ca);
		return;
	}
	if (turns(k)) {
		sine = dag_sin(d, dag_mul(d, half, angle_of(d, k, in)));
		cosine = dag_cos(d, dag_mul(d, half, angle_of(d, k, in)));
	}
	half_ahead(k, &sa, &ca);
	ahead_s = dag_within(d, sa);
	ahead_c = dag_within(d, ca);
	*s = dag_add_products(d, ahead_c, sine, ahead_s, cosine);
	*c = dag_sub_products(d, ahead_c, cosine, ahead_s, sine);
}

struct joint_rates joint_move(struct dag *d, const struct body *k, struct joint_inputs in)
{
	struct joint_rates m = {zero3(), zero3(), zero3(), zero3(), zero3(), zero3()};

	switch (k->type) {
	case JOINT_FLOATING:
		m.V = source_rows(d, &in.qd, k->iv);
		m.W = source_rows(d, &in.qd, k->iv + 3);
		m.dW = source_rows(d, &in.qdd, k->iv + 3);
		/* qdd is spatial: the classical acceleration of the origin is a + w x v */
		m.dV = svec_cross(d, m.W, m.V);
		m.dV = svec_add(d, source_rows(d, &in.qdd, k->iv), m.dV);
		break;
	case JOINT_PLANAR:
		for (int i = 0; i < 2; i++) {
			m.V0.x[i] = source_row(d, &in.qd, k->iv + i);
			m.dV0.x[i] = source_row(d, &in.qdd, k->iv + i);
		}
		m.W.x[2] = source_row(d, &in.qd, k->iv + 2);
		m.dW.x[2] = source_row(d, &in.qdd, k->iv + 2);
		break;
	case JOINT_FIXED:
		break;
	case JOINT_PRISMATIC:
		m.V0.x[k->axis] = directed(d, k, source_row(d, &in.qd, k->iv));
		m.dV0.x[k->axis] = directed(d, k, source_row(d, &in.qdd, k->iv));
		break;
	default:
		m.W.x[k->axis] = directed(d, k, source_row(d, &in.qd, k->iv));
		m.dW.x[k->axis] = directed(d, k, source_row(d, &in.qdd, k->iv));
	}
	return m;
}

struct joint_rates joint_unit(struct dag *d, const struct body *k, int row)
{
	struct joint_rates m = {zero3(), zero3(), zero3(), zero3(), zero3(), zero3()};
	struct ref one = dag_const(d, 1);

	if (k->type == JOINT_FLOATING)
		(row < 3 ? &m.V : &m.W)->x[row % 3] = one;
	else if (k->type == JOINT_PLANAR)
		(row < 2 ? &m.V0 : &m.W)->x[row] = one;
	else
		(k->type == JOINT_PRISMATIC ? &m.V0 : &m.W)->x[k->axis] = directed(d, k, one);
	return m;
}

struct svec joint_into(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec u)
{
	if (k->type == JOINT_FLOATING)
		return smat_mul_transposed(d, &x->Q, u);
	return turns(k) ? svec_turn_back(d, k->axis, x->s, x->c, u) : u;
}

struct svec joint_out_of(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec u)
{
	if (k->type == JOINT_FLOATING)
		return smat_mul(d, &x->Q, u);
	return turns(k) ? svec_turn(d, k->axis, x->s, x->c, u) : u;
}

void joint_unit_twist(struct dag *d, const struct body *k, const struct joint_pose *x, int row, struct svec *V, struct svec *W)
{
	struct joint_rates unit = joint_unit(d, k, row);

	*W = unit.W;
	*V = svec_add(d, joint_into(d, k, x, unit.V0), unit.V);
}

struct svec joint_to_parent(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec u)
{
	return smat_mul(d, &x->R, joint_out_of(d, k, x, u));
}

/* A T A^T column by column, then row by row. */
static struct smat turn_constant(struct dag *d, const struct smat *A, const struct smat *T)
{
	struct smat B = smat_product(d, A, T), out;

	for (int i = 0; i < 3; i++)
		smat_set_row(&out, i, smat_mul(d, A, smat_row(&B, i)));
	return out;
}

static struct ref spread(struct dag *d, int i, const struct smat *T)
{
	int j = (i + 1) % 3, k = (i + 2) % 3;

	return dag_sub(d, T->m[j][j], T->m[k][k]);
}

/* About the axis i, with x = s (T_jj - T_kk) + c (T_jk + T_kj): T_jj - s x, T_kk + s x, c x - T_kj, c x - T_jk; the others turn
   as vectors. */
static struct smat turn_about(struct dag *d, int i, const struct joint_pose *at, const struct smat *T, struct ref spread)
{
	int j = (i + 1) % 3, k = (i + 2) % 3;
	struct svec row = svec_turn(d, i, at->s, at->c, smat_row(T, i));
	struct svec column = svec_turn(d, i, at->s, at->c, smat_column(T, i));
	struct ref across = T->m[j][k].i == T->m[k][j].i ? dag_mul(d, dag_const(d, 2), T->m[j][k])
		: dag_add(d, T->m[j][k], T->m[k][j]);
	struct ref x = dag_add_products(d, at->s, spread, at->c, across);
	struct ref sx = dag_mul(d, at->s, x), cx = dag_mul(d, at->c, x);
	struct smat out = *T;

	out.m[j][j] = dag_sub(d, T->m[j][j], sx);
	out.m[k][k] = dag_add(d, T->m[k][k], sx);
	out.m[j][k] = dag_sub(d, cx, T->m[k][j]);
	out.m[k][j] = dag_sub(d, cx, T->m[j][k]);
	out.m[i][j] = row.x[j];
	out.m[i][k] = row.x[k];
	out.m[j][i] = column.x[j];
	out.m[k][i] = column.x[k];
	return out;
}

struct smat joint_turn(struct dag *d, const struct body *k, const struct joint_pose *x, const struct smat *T)
{
	struct smat turned = *T;

	if (k->type == JOINT_FLOATING)
		turned = turn_constant(d, &x->Q, T);
	else if (turns(k))
		turned = turn_about(d, k->axis, x, T, spread(d, k->axis, T));
	return turn_constant(d, &x->R, &turned);
}

static void hand_over(struct dag *d, struct ref *from, struct ref *to)
{
	*to = dag_add(d, *from, *to);
	*from = (struct ref){0};
}

/* Of a vector: what is not along the axis. */
void joint_to_parent_apart(struct dag *d, const struct body *k, const struct joint_pose *x, struct svec *constant,
	struct svec *varied)
{
	for (int i = 0; i < 3; i++)
		if (k->type == JOINT_FLOATING || (turns(k) && i != k->axis))
			hand_over(d, &constant->x[i], &varied->x[i]);
	*constant = smat_mul(d, &x->R, *constant);
	*varied = joint_to_parent(d, k, x, *varied);
}

/* Of a matrix what is along the axis alone. The rest of the diagonal, T_jj - s x and T_kk + s x, has a constant of its own only
   where T_jj and T_kk are constants: with others it would be a large number less another one. */
void joint_turn_apart(struct dag *d, const struct body *k, const struct joint_pose *x, struct smat *constant, struct smat *varied)
{
	int j = (k->axis + 1) % 3, l = (k->axis + 2) % 3, varies = varied->m[j][j].i || varied->m[l][l].i;

	for (int i = 0; i < 9; i++)
		if (k->type == JOINT_FLOATING || (turns(k) && (i % 4 || (varies && i / 4 != k->axis))))
			hand_over(d, &constant->m[i / 3][i % 3], &varied->m[i / 3][i % 3]);
	if (k->type == JOINT_FLOATING)
		*varied = turn_constant(d, &x->Q, varied);
	else if (turns(k)) {
		struct ref varies_by = spread(d, k->axis, varied);

		*varied = turn_about(d, k->axis, x, varied, dag_add(d, spread(d, k->axis, constant), varies_by));
	}
	*varied = turn_constant(d, &x->R, varied);
	*constant = turn_constant(d, &x->R, constant);
}

void joint_project(struct dag *d, const struct body *k, struct svec f, struct svec n, struct svec f0, struct ref *tau)
{
	switch (k->type) {
	case JOINT_PRISMATIC:
		tau[0] = directed(d, k, f.x[k->axis]);
		break;
	case JOINT_PLANAR:
		tau[0] = f0.x[0];
		tau[1] = f0.x[1];
		tau[2] = n.x[2];
		break;
	case JOINT_FIXED:
		break;
	case JOINT_FLOATING:
		for (int i = 0; i < 3; i++) {
			tau[i] = f.x[i];
			tau[3 + i] = n.x[i];
		}
		break;
	default:
		tau[0] = directed(d, k, n.x[k->axis]);
	}
}
