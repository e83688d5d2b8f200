/* Newton-Euler with 3-vectors in body frames: angular velocity w, its rate dw, and the classical acceleration a of the
   body's origin less gravity (Luh, Walker, Paul 1980; Craig, Introduction to Robotics, 6.45 to 6.53). Linear velocity
   is not needed for the torques; where nobody asks for it, it is dead code.

   The order is a tour of the tree: out to a body, through its children, back from it; what is alive at any time is
   bounded by the depth of the tree, not by the number of its bodies. */
#include "dynamics/registry.h"
#include "dynamics/tour.h"
#include "tree/lumps.h"

/* A driver's torque is complete when its followers' are added; all others when their body is left. */
static int torque_waits(const struct tree *t, int index)
{
	for (int i = 0; i < t->mimic_count; i++)
		if (t->bodies[t->mimics[i].body].iv == t->bodies[index].iv)
			return 1;
	return 0;
}

/* The joint's own acceleration takes off what else turns the body about its axis. */
static void ease(const struct tour *r, int index, struct svec *dw)
{
	const struct body *k = &r->t->bodies[index];
	int turns = k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS;
	struct ref *along = &dw->x[k->axis];
	const struct ref zero = {0};

	if (!r->eased || !turns || k->follower || torque_waits(r->t, index))
		return;
	r->eased[k->iv] = k->sign < 0 ? *along : dag_neg(r->d, *along);
	*along = zero;
}

/* Velocities and accelerations of a body from its parent's (the world's: at rest, accelerating against gravity):
   w = E w_p + W,  dw = E dw_p + dW + E w_p x W,  v = E (v_p + w_p x p) + V,  a = E (a_p + U_p p) + dV + 2 w x V. */
static void move(const struct tour *r, int index, const struct frame *parent, struct frame *x)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[index];
	const struct joint_pose *at = &x->pose;
	const struct motion *from = &parent->motion;
	struct motion *to = &x->motion;
	struct joint_rates m = joint_move(d, k, r->in);
	struct svec w, dw, v, a;

	/* into the joint's frame */
	w = smat_mul_transposed(d, &at->R, from->w);
	dw = smat_mul_transposed(d, &at->R, from->dw);
	v = smat_mul_transposed(d, &at->R, svec_add(d, from->v, svec_cross(d, from->w, at->p)));
	a = smat_mul_transposed(d, &at->R, svec_add(d, from->a, smat_mul(d, &from->U, at->p)));
	v = svec_add(d, v, m.V0);
	a = svec_add(d, a, motion_slide(d, w, m.V0, m.dV0));
	/* into the body's */
	w = joint_into(d, k, at, w);
	to->w = svec_add(d, w, m.W);
	to->dw = svec_add(d, m.dW, svec_cross(d, w, m.W));
	to->dw = svec_add(d, joint_into(d, k, at, dw), to->dw);
	to->v = svec_add(d, joint_into(d, k, at, v), m.V);
	to->a = motion_slide(d, w, m.V, m.dV);
	to->a = svec_add(d, joint_into(d, k, at, a), to->a);
	ease(r, index, &to->dw);
	to->U = motion_rate_matrix(d, to->w, to->dw);
	svec_tag(d, to->w, "w", k->number);
	svec_tag(d, to->dw, "dw", k->number);
	svec_tag(d, to->v, "v", k->number);
	svec_tag(d, to->a, "a", k->number);
}

struct svec tour_acceleration(const struct tour *r, int body, struct svec from)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct joint_pose *at = &r->frames[body + 1].pose;
	const struct motion *parent = &r->frames[k->parent + 1].motion;
	struct joint_rates m = joint_move(d, k, r->in);
	struct svec w = smat_mul_transposed(d, &at->R, parent->w);
	struct svec a = smat_mul_transposed(d, &at->R, svec_add(d, from, smat_mul(d, &parent->U, at->p)));

	a = svec_add(d, a, motion_slide(d, w, m.V0, m.dV0));
	w = motion_slide(d, joint_into(d, k, at, w), m.V, m.dV);
	return svec_add(d, joint_into(d, k, at, a), w);
}

struct svec tour_origin_rate(const struct tour *r, int body)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct joint_pose *at = &r->frames[body + 1].pose;
	struct joint_rates m = joint_move(d, k, r->in);
	struct svec slide = svec_add(d, m.V0, joint_out_of(d, k, at, m.V));

	slide = smat_mul(d, &at->R, slide);
	return svec_add(d, svec_cross(d, r->frames[k->parent + 1].motion.w, at->p), slide);
}

/* The body's own wrench. */
static void own_wrench(const struct tour *r, int index, struct frame *x)
{
	const struct body *k = &r->t->bodies[index];

	if (r->parameters && r->parameters[index])
		rigid_body_wrench_free(r->d, r->parameters[index], &x->motion, &x->f, &x->n);
	else
		rigid_body_wrench(r->d, k, &x->motion, &x->f, &x->n);
	svec_tag(r->d, x->f, "f", k->number);
	svec_tag(r->d, x->n, "n", k->number);
}

static void output_svec(const struct tour *r, int argument, int row, const struct body *k, struct svec u)
{
	struct smat A = smat_const(r->d, &k->frame);

	u = smat_mul(r->d, &A, u);
	for (int i = 0; i < 3; i++)
		dag_output(r->d, argument, row + i, u.x[i]);
}

/* fpass: [v; w], the spatial acceleration [a - w x v; dw] and the wrench [f; n], in the URDF's frame. */
static void output_passes(const struct tour *r, int index, const struct body *k, const struct frame *x)
{
	const struct motion *m = &x->motion;
	struct svec a = svec_sub(r->d, m->a, svec_cross(r->d, m->w, m->v));

	output_svec(r, r->v_out, 6 * index, k, m->v);
	output_svec(r, r->v_out, 6 * index + 3, k, m->w);
	output_svec(r, r->a_out, 6 * index, k, a);
	output_svec(r, r->a_out, 6 * index + 3, k, m->dw);
	output_svec(r, r->f_out, 6 * index, k, x->f);
	output_svec(r, r->f_out, 6 * index + 3, k, x->n);
}

/* bpass: the wrench that fpass wrote, from the URDF's frame into the body's. */
static void input_wrench(const struct tour *r, int index, const struct body *k, struct frame *x)
{
	struct smat A = smat_const(r->d, &k->frame);

	x->f = smat_mul_transposed(r->d, &A, svec_input(r->d, r->f_in, 6 * index));
	x->n = smat_mul_transposed(r->d, &A, svec_input(r->d, r->f_in, 6 * index + 3));
}

static void enter(const struct tour *r, int index)
{
	const struct body *k = &r->t->bodies[index];
	struct frame *x = &r->frames[index + 1];

	dag_section(r->d, SECTION_OUT, index);
	x->pose = joint_place(r->d, k, r->in);
	if (r->f_in >= 0) {
		input_wrench(r, index, k, x);
	} else {
		move(r, index, &r->frames[k->parent + 1], x);
		own_wrench(r, index, x);
	}
	if (r->f_out >= 0)
		output_passes(r, index, k, x);
	if (r->entered)
		r->entered(r, index);
}

/* f_p += R f, n_p += R n + p x R f; the joint feels its part, a follower's goes to its driver. */
static void leave(const struct tour *r, int index)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[index];
	struct frame *x = &r->frames[index + 1], *parent = &r->frames[k->parent + 1];
	struct svec f, n;
	struct ref tau[6];

	dag_section(d, SECTION_BACK, index);
	if (r->leaving)
		r->leaving(r, index);
	f = joint_out_of(d, k, &x->pose, x->f);
	n = joint_out_of(d, k, &x->pose, x->n);
	joint_project(d, k, x->f, x->n, f, tau);
	if (r->own_terms)
		r->own_terms(r, index, tau);
	for (int i = 0; i < joint_nv(k->type); i++)
		r->tau[k->iv + i] = dag_add(d, r->tau[k->iv + i], tau[i]);
	f = smat_mul(d, &x->pose.R, f);
	n = smat_mul(d, &x->pose.R, n);
	parent->f = svec_add(d, parent->f, f);
	parent->n = svec_add(d, parent->n, svec_add(d, n, svec_cross(d, x->pose.p, f)));
	if (k->parent >= 0) {
		svec_tag(d, parent->f, "f", r->t->bodies[k->parent].number);
		svec_tag(d, parent->n, "n", r->t->bodies[k->parent].number);
	}
}

/* ---- where nothing moves ---- */

/* Gravity alone. With every body at rest a, the acceleration less gravity, is one and the same vector, seen from each
   frame: the wrench through a joint is f = M a, n = C x a, where M is the mass beyond it and C = sum of m c its first
   moment about the body's origin. So masses and moments come back instead of forces and moments. */
static void at_rest_enter(const struct tour *r, int body)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct parameters *p = r->parameters ? r->parameters[body] : NULL;
	struct frame *x = &r->frames[body + 1];

	dag_section(d, SECTION_OUT, body);
	x->pose = joint_place(d, k, r->in);
	x->motion.a = joint_into(d, k, &x->pose, smat_mul_transposed(d, &x->pose.R, r->frames[k->parent + 1].motion.a));
	if (!lumps_is_held(r->t, body)) { /* else no torque feels it, and it is no part of what moves */
		x->mass = p ? p->mass : dag_within(d, k->inertia.mass);
		x->own = p ? p->h : svec_const(d, k->inertia.h);
	}
	svec_tag(d, x->motion.a, "a", k->number);
}

struct svec at_rest_moment(struct dag *d, const struct frame *x)
{
	return svec_add(d, x->own, x->beyond);
}

/* M_p += M, C_p += R C + M p; the terms M p are constants where joints turn, and are summed by themselves */
static void at_rest_leave(const struct tour *r, int body)
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

/* ---- the tour ---- */

static void output_torques(const struct tour *r, int index)
{
	const struct body *k = &r->t->bodies[index];

	for (int i = 0; i < joint_nv(k->type) && r->tau_out >= 0; i++)
		dag_output(r->d, r->tau_out, k->iv + i, r->tau[k->iv + i]);
}

static void leave_and_output(const struct tour *r, int index)
{
	if (r->at_rest)
		at_rest_leave(r, index);
	else
		leave(r, index);
	if (!torque_waits(r->t, index))
		output_torques(r, index);
	if (r->left)
		r->left(r, index);
}

/* Bodies are numbered depth-first: before going out to the next, come back to its parent. */
static void go(struct tour *r)
{
	const struct tree *t = r->t;
	int here = -1;

	for (int k = 0; k < t->body_count; k++) {
		for (; r->tau && here != t->bodies[k].parent; here = t->bodies[here].parent)
			leave_and_output(r, here);
		if (r->at_rest)
			at_rest_enter(r, k);
		else
			enter(r, k);
		here = k;
	}
	for (; r->tau && here >= 0; here = t->bodies[here].parent)
		leave_and_output(r, here);
	dag_section(r->d, SECTION_END, 0);
	for (int k = 0; r->tau && k < t->body_count; k++)
		if (!t->bodies[k].follower && torque_waits(t, k))
			output_torques(r, k);
}

void tour_run(struct tour *r)
{
	struct dag *d = r->d;

	r->frames = arena_alloc(d->arena, (size_t)r->t->body_count + 1, sizeof *r->frames);
	if (r->tau_out >= 0 || r->comes_back)
		r->tau = arena_alloc(d->arena, (size_t)r->t->nv, sizeof *r->tau);
	if (d->arena->failed) {
		d->failed = 1;
		return;
	}
	if (r->world)
		r->world(r);
	for (int i = 0; i < 3; i++) /* all else of the world is node 0, zero */
		r->frames[0].motion.a.x[i] = dag_neg(d, r->gravity ? r->gravity[i] : dag_within(d, r->t->gravity[i]));
	go(r);
}

/* The algorithm's own arrays; what is not among them is zero, or not written. */
static void build_plain(struct dag *d, const struct tree *t, const struct request *k, const struct algorithm *x)
{
	struct tour r = {.d = d, .t = t, .request = k};

	algorithm_declare(x, d, t);
	r.in.q.argument = dag_find_role(d, ROLE_JOINT_POSITION, 0);
	r.in.qd.argument = dag_find_role(d, ROLE_JOINT_VELOCITY, 0);
	r.in.qdd.argument = dag_find_role(d, ROLE_JOINT_ACCELERATION, 0);
	r.f_in = dag_find_role(d, ROLE_BODY_WRENCHES, 0);
	r.v_out = dag_find_role(d, ROLE_BODY_TWISTS, 1);
	r.a_out = dag_find_role(d, ROLE_BODY_ACCELERATIONS, 1);
	r.f_out = dag_find_role(d, ROLE_BODY_WRENCHES, 1);
	r.tau_out = dag_find_role(d, ROLE_JOINT_TORQUE, 1);
	tour_run(&r);
}

static void build_rnea(struct dag *d, const struct tree *t, const struct request *k)
{
	if (k->is_plain)
		build_plain(d, t, k, &algorithm_rnea);
	else
		want_build(d, t, k);
}

static void build_fpass(struct dag *d, const struct tree *t, const struct request *k)
{
	build_plain(d, t, k, &algorithm_fpass);
}

static void build_bpass(struct dag *d, const struct tree *t, const struct request *k)
{
	build_plain(d, t, k, &algorithm_bpass);
}

static int is_inverse(const struct request *k)
{
	return !k->is_forward && !k->is_motion;
}

static int is_plain(const struct request *k)
{
	return k->is_plain;
}

#define STATE {"q", ROLE_JOINT_POSITION, 0}, {"qd", ROLE_JOINT_VELOCITY, 0}, {"qdd", ROLE_JOINT_ACCELERATION, 0}

const struct algorithm algorithm_rnea = {.name = "rnea",
	.doc = "tau = ID(q, qd, qdd)",
	.brief = "tau = ID(q, qd, qdd) of one sample.",
	.arrays = {STATE, {"tau", ROLE_JOINT_TORQUE, 1}},
	.what = "Inverse dynamics",
	.how = "by the recursive Newton-Euler algorithm",
	.is_made_for = is_inverse,
	.build = build_rnea};

/* Each linear then angular, at the origin and in the URDF frame of the body's link; a is the spatial acceleration with
   a(world) = -gravity, f = I a + v x* I v the body's own wrench. */
const struct algorithm algorithm_fpass = {.name = "fpass",
	.doc = "Out from the base: velocity v, acceleration a and own wrench f = I a + v x* I v of each body.",
	.brief = "The way out alone: velocities, accelerations and own wrenches of the bodies, [nb][6] each.",
	.note = "fpass writes v, a, f as [nb][6], linear then angular, in the URDF frames of the links; a is spatial.",
	.arrays = {STATE, {"v", ROLE_BODY_TWISTS, 1}, {"a", ROLE_BODY_ACCELERATIONS, 1}, {"f", ROLE_BODY_WRENCHES, 1}},
	.is_made_for = is_plain,
	.build = build_fpass};

const struct algorithm algorithm_bpass = {.name = "bpass",
	.doc = "Back to the base: torques tau from the wrenches f.",
	.brief = "The way back alone: torques from q and fpass's wrenches.",
	.arrays = {{"q", ROLE_JOINT_POSITION, 0}, {"f", ROLE_BODY_WRENCHES, 0}, {"tau", ROLE_JOINT_TORQUE, 1}},
	.is_made_for = is_plain,
	.build = build_bpass};

static int is_motion(const struct request *k)
{
	return k->is_motion;
}

const struct algorithm algorithm_kin = {.name = "kin",
	.doc = "where links are, and how they move",
	.brief = "Where links are, and how they move, of one sample.",
	.arrays = {{"q", ROLE_JOINT_POSITION, 0}, {"com", ROLE_CENTER_OF_MASS, 1}},
	.what = "Kinematics",
	.how = "by the recursion out to the links",
	.is_made_for = is_motion,
	.build = want_build};
