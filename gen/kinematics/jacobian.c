/* Geometric Jacobians: the twist of a link by unit rates of the joints on its chain. */
#include "kinematics/kinematics.h"

/* Axes of a body, and of its joint before it turns, in the axes in which the Jacobian is; the vector from its origin to the point
   whose velocity is told. */
struct seen {
	struct smat A, R;
	struct svec r;
};

/* v = A V0 + R V + w x r, w = R W of a unit rate of each row of the joint */
static void add_columns(const struct kinematics *x, const struct body *k, const struct seen *s, struct ref *J)
{
	struct dag *d = x->d;
	int nv = x->t->nv;

	for (int row = 0; row < joint_nv(k->type); row++) {
		struct joint_rates unit = joint_unit(d, k, row);
		struct svec w = smat_mul(d, &s->R, unit.W);
		struct svec v = smat_mul(d, &s->R, unit.V);

		v = svec_add(d, smat_mul(d, &s->A, unit.V0), v);
		v = svec_add(d, v, svec_cross(d, w, s->r));
		for (int i = 0; i < 3; i++) {
			struct ref *linear = &J[i * nv + k->iv + row], *angular = &J[(3 + i) * nv + k->iv + row];

			*linear = dag_add(d, *linear, v.x[i]);
			*angular = dag_add(d, *angular, w.x[i]);
		}
	}
}

/* In the world's axes, from the poses. */
static void columns_in_world(const struct kinematics *x, const struct want *w, struct ref *J)
{
	struct dag *d = x->d;
	struct smat R;
	struct svec p;

	kinematics_frame(x, w->body, &w->X, &R, &p);
	for (int k = w->body; k >= 0; k = x->t->bodies[k].parent) {
		const struct placed *at = &x->bodies[k];
		struct seen s = {.A = at->A, .R = at->R};

		if (x->k->frame == FRAME_WORLD_ALIGNED)
			s.r = svec_sub(d, p, at->point);
		else
			s.r = svec_sub(d, (struct svec){{{0}, {0}, {0}}}, svec_add(d, at->from, at->point));
		add_columns(x, &x->t->bodies[k], &s, J);
	}
}

/* A X', A row by row in a frame that X turns */
static struct smat turned_back(struct dag *d, const struct smat *A, const struct smat *X)
{
	struct smat out;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out.m[i][j] = svec_dot(d, smat_row(A, i), smat_row(X, j));
	return out;
}

/* Back to the joint's axes before it turns. */
static void turn_back(const struct kinematics *x, int body, struct seen *s)
{
	const struct body *k = &x->t->bodies[body];
	const struct joint_pose *at = &x->bodies[body].pose;

	if (k->type == JOINT_FLOATING)
		s->A = turned_back(x->d, &s->R, &at->Q);
	for (int i = 0; i < 3 && k->type != JOINT_FLOATING; i++)
		smat_set_row(&s->A, i, joint_out_of(x->d, k, at, smat_row(&s->R, i)));
}

/* In the link's axes, from the link back to the world: no pose is needed. At the end *s has the world's axes, and the vector from
   where the chain begins. J: NULL: not wanted. */
static void columns_in_link(const struct kinematics *x, const struct want *w, struct ref *J, struct seen *s)
{
	struct dag *d = x->d;
	const struct rotation back = rotation_transpose(&w->X.R);

	*s = (struct seen){.R = smat_const(d, &back)};
	s->r = smat_mul(d, &s->R, kinematics_from_point(x, w->body, w->X.p));
	for (int k = w->body; k >= 0; k = x->t->bodies[k].parent) {
		turn_back(x, k, s);
		if (J)
			add_columns(x, &x->t->bodies[k], s, J);
		s->R = turned_back(d, &s->A, &x->bodies[k].pose.R);
		if (x->t->bodies[k].parent >= 0)
			s->r = svec_add(d, s->r, smat_mul(d, &s->R, x->bodies[k].step));
	}
}

void jacobian_frame(const struct kinematics *x, const struct want *w, struct smat *R, struct svec *p)
{
	struct seen s;

	columns_in_link(x, w, NULL, &s);
	*R = smat_transposed(&s.R);
	*p = smat_mul(x->d, R, s.r);
}

void jacobian_columns(const struct kinematics *x, const struct want *w, struct ref *J)
{
	struct seen s;

	if (x->k->frame == FRAME_LINK)
		columns_in_link(x, w, J, &s);
	else
		columns_in_world(x, w, J);
}

static void output(const struct kinematics *x, int argument, struct svec linear, struct svec angular)
{
	for (int i = 0; i < 3; i++) {
		dag_output(x->d, argument, i, linear.x[i]);
		dag_output(x->d, argument, 3 + i, angular.x[i]);
	}
}

/* At the frame's origin r in the body, in the body's axes: classical, a + dw x r + w x (w x r); spatial, a - w x v + dw x r,
   which is 0 of a link that is one with a floating base. In the world's frame the spatial one is seen from the world's origin. */
static struct svec rate_at(const struct kinematics *x, const struct carried_motion *m, struct svec r)
{
	struct dag *d = x->d;
	struct smat U = motion_rate_matrix(d, m->w, m->dw);

	if (x->k->frame == FRAME_WORLD_ALIGNED)
		return svec_add(d, m->a, smat_mul(d, &U, r));
	r = svec_cross(d, m->dw, r);
	return svec_add(d, svec_sub(d, m->a, svec_cross(d, m->w, m->v)), r);
}

static void output_rate(const struct kinematics *x, const struct want *w, const struct carried_motion *m, int argument)
{
	struct dag *d = x->d;
	struct svec a = rate_at(x, m, svec_const(d, w->X.p)), dw = m->dw;
	struct smat R = smat_const(d, &w->X.R);

	if (x->k->frame == FRAME_LINK) {
		dw = smat_mul_transposed(d, &R, dw);
		output(x, argument, smat_mul_transposed(d, &R, a), dw);
		return;
	}
	a = smat_mul(d, &x->bodies[w->body].R, a);
	dw = smat_mul(d, &x->bodies[w->body].R, dw);
	if (x->k->frame == FRAME_WORLD) {
		struct svec p;

		kinematics_frame(x, w->body, &w->X, &R, &p);
		a = svec_add(d, a, svec_cross(d, svec_add(d, x->bodies[w->body].from, p), dw));
	}
	output(x, argument, a, dw);
}

void kinematics_rate(const struct kinematics *x, int body, const struct carried_motion *m)
{
	for (int i = 0; i < x->k->want_count; i++)
		if (x->k->wants[i].kind == WANT_DJACOBIAN && x->k->wants[i].body == body)
			output_rate(x, &x->k->wants[i], m, x->outputs[i]);
}
