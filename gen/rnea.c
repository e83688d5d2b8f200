/* Newton-Euler with 3-vectors in body frames: angular velocity w, its rate dw, and the classical acceleration a of the
   body's origin less gravity (Luh, Walker, Paul 1980; Craig, Introduction to Robotics, 6.45 to 6.53). Linear velocity
   is not needed for the torques; where nobody asks for it, it is dead code.

   The order is a tour of the tree: out to a body, through its children, back from it; what is alive at any time is
   bounded by the depth of the tree, not by the number of its bodies. */
#include "rnea.h"
#include "svec.h"

/* A body while the tour is beyond it. */
struct frame {
	struct svec v, w, dw, a; /* velocity of the origin, angular velocity, its rate, acceleration less gravity */
	struct smat U;           /* [dw]x + [w]x[w]x: U r is the acceleration of a point r fixed in the body */
	struct svec f, n;        /* force, and moment about the origin, through the body's joint */
	struct smat R;           /* constant turn of the joint's frame */
	struct svec p;           /* the body's origin in the parent's frame */
	struct ref s, c;         /* sine and cosine of a turning joint's angle */
	struct smat Q;           /* floating: the rotation that the quaternion gives */
};

struct tour {
	struct dag *d;
	const struct tree *t;
	struct frame *frames;
	struct ref *tau;
	int q, qd, qdd, f_in;         /* arguments; -1: not there */
	int v_out, a_out, f_out, tau_out;
};

static struct ref zero(void)
{
	return (struct ref){0};
}

static struct svec zero3(void)
{
	return (struct svec){{zero(), zero(), zero()}};
}

static struct ref input(const struct tour *r, int argument, int row)
{
	return argument >= 0 ? dag_input(r->d, argument, row) : zero();
}

/* A single-axis joint's own coordinate, rate or acceleration: multiplier and direction of the axis applied. */
static struct ref along_axis(const struct tour *r, const struct body *k, int argument, int row)
{
	return dag_mul(r->d, dag_const(r->d, k->sign * k->multiplier), input(r, argument, row));
}

static int turns(enum joint_type type)
{
	return type == JOINT_REVOLUTE || type == JOINT_CONTINUOUS || type == JOINT_PLANAR;
}

/* R = [1-2(yy+zz), 2(xy-zw), 2(xz+yw); 2(xy+zw), 1-2(xx+zz), 2(yz-xw); 2(xz-yw), 2(yz+xw), 1-2(xx+yy)] */
static struct smat quaternion_matrix(struct dag *d, struct svec u, struct ref w)
{
	struct ref two = dag_const(d, 2), one = dag_const(d, 1);
	struct svec u2 = svec_scale(d, two, u);
	struct smat Q;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct ref jk = dag_mul(d, u2.x[j], u.x[k]), iw = dag_mul(d, u2.x[i], w);

		Q.m[i][i] = dag_sub(
			d, one, dag_add(d, dag_mul(d, u2.x[j], u.x[j]), dag_mul(d, u2.x[k], u.x[k])));
		Q.m[j][k] = dag_sub(d, jk, iw);
		Q.m[k][j] = dag_add(d, jk, iw);
	}
	return Q;
}

/* U = [dw]x + [w]x[w]x */
static struct smat rate_matrix(struct dag *d, struct svec w, struct svec dw)
{
	struct smat U;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct ref jk = dag_mul(d, w.x[j], w.x[k]);

		U.m[i][i] = dag_neg(d, dag_add(d, dag_mul(d, w.x[j], w.x[j]), dag_mul(d, w.x[k], w.x[k])));
		U.m[j][k] = dag_sub(d, jk, dw.x[i]);
		U.m[k][j] = dag_add(d, jk, dw.x[i]);
	}
	return U;
}

/* The joint at q: its constant turn, where it puts the body's origin, and its variable turn. */
static void place(const struct tour *r, const struct body *k, struct frame *x)
{
	struct dag *d = r->d;
	struct svec slide = zero3();
	struct ref angle;

	x->R = smat_const(d, &k->X.R);
	if (k->type == JOINT_PRISMATIC) {
		slide.x[k->axis] = along_axis(r, k, r->q, k->iq);
	} else if (k->type == JOINT_PLANAR) {
		slide.x[0] = input(r, r->q, k->iq);
		slide.x[1] = input(r, r->q, k->iq + 1);
	} else if (k->type == JOINT_FLOATING) {
		slide = svec_input(d, r->q, k->iq);
		x->Q = quaternion_matrix(d, svec_input(d, r->q, k->iq + 3), input(r, r->q, k->iq + 6));
	}
	x->p = svec_add(d, svec_const(d, k->X.p), smat_mul(d, &x->R, slide));
	if (turns(k->type)) {
		angle = along_axis(r, k, r->q, k->type == JOINT_PLANAR ? k->iq + 2 : k->iq);
		x->s = dag_sin(d, angle);
		x->c = dag_cos(d, angle);
		dag_tag(d, x->s, "s", k->number, 0);
		dag_tag(d, x->c, "c", k->number, 0);
	}
}

/* From the joint's frame into the body's, and back: the variable turn. */
static struct svec into(const struct tour *r, const struct body *k, const struct frame *x, struct svec u)
{
	if (k->type == JOINT_FLOATING)
		return smat_mul_transposed(r->d, &x->Q, u);
	return turns(k->type) ? svec_turn_back(r->d, k->axis, x->s, x->c, u) : u;
}

static struct svec out_of(const struct tour *r, const struct body *k, const struct frame *x, struct svec u)
{
	if (k->type == JOINT_FLOATING)
		return smat_mul(r->d, &x->Q, u);
	return turns(k->type) ? svec_turn(r->d, k->axis, x->s, x->c, u) : u;
}

/* The joint's own motion: w += W, dw += dW + w x W, v += V, a += dV + 2 w x V, with W, V the rates along the joint's
   axes and w the parent's. Those in the joint's frame, before its turn, are V0, dV0. */
struct joint_motion {
	struct svec W, dW, V, dV, V0, dV0;
};

static struct joint_motion motion_of(const struct tour *r, const struct body *k)
{
	struct joint_motion m = {zero3(), zero3(), zero3(), zero3(), zero3(), zero3()};
	struct dag *d = r->d;

	if (k->type == JOINT_FLOATING) {
		m.V = svec_input(d, r->qd, k->iv);
		m.W = svec_input(d, r->qd, k->iv + 3);
		m.dW = svec_input(d, r->qdd, k->iv + 3);
		/* the classical acceleration of the origin from the spatial one */
		m.dV = svec_add(d, svec_input(d, r->qdd, k->iv), svec_cross(d, m.W, m.V));
	} else if (k->type == JOINT_PLANAR) {
		for (int i = 0; i < 2; i++) {
			m.V0.x[i] = input(r, r->qd, k->iv + i);
			m.dV0.x[i] = input(r, r->qdd, k->iv + i);
		}
		m.W.x[2] = input(r, r->qd, k->iv + 2);
		m.dW.x[2] = input(r, r->qdd, k->iv + 2);
	} else if (k->type == JOINT_PRISMATIC) {
		m.V0.x[k->axis] = along_axis(r, k, r->qd, k->iv);
		m.dV0.x[k->axis] = along_axis(r, k, r->qdd, k->iv);
	} else {
		m.W.x[k->axis] = along_axis(r, k, r->qd, k->iv);
		m.dW.x[k->axis] = along_axis(r, k, r->qdd, k->iv);
	}
	return m;
}

/* dV + 2 w x V, the acceleration that sliding at V adds in a frame that turns with w */
static struct svec slide_acceleration(struct dag *d, struct svec w, struct svec V, struct svec dV)
{
	return svec_add(d, dV, svec_scale(d, dag_const(d, 2), svec_cross(d, w, V)));
}

/* Velocities and accelerations of a body from its parent's (the world's: at rest, accelerating against gravity). */
static void move(const struct tour *r, const struct body *k, const struct frame *parent, struct frame *x)
{
	struct dag *d = r->d;
	struct joint_motion m = motion_of(r, k);
	struct svec w, dw, v, a;

	/* in the joint's frame */
	w = smat_mul_transposed(d, &x->R, parent->w);
	dw = smat_mul_transposed(d, &x->R, parent->dw);
	v = smat_mul_transposed(d, &x->R, svec_add(d, parent->v, svec_cross(d, parent->w, x->p)));
	a = smat_mul_transposed(d, &x->R, svec_add(d, parent->a, smat_mul(d, &parent->U, x->p)));
	v = svec_add(d, v, m.V0);
	a = svec_add(d, a, slide_acceleration(d, w, m.V0, m.dV0));
	/* in the body's frame */
	w = into(r, k, x, w);
	x->w = svec_add(d, w, m.W);
	x->dw = svec_add(d, into(r, k, x, dw), svec_add(d, m.dW, svec_cross(d, w, m.W)));
	x->v = svec_add(d, into(r, k, x, v), m.V);
	x->a = svec_add(d, into(r, k, x, a), slide_acceleration(d, w, m.V, m.dV));
	x->U = rate_matrix(d, x->w, x->dw);
	svec_tag(d, x->w, "w", k->number);
	svec_tag(d, x->dw, "dw", k->number);
	svec_tag(d, x->v, "v", k->number);
	svec_tag(d, x->a, "a", k->number);
}

/* n = I dw + w x I w, with the products of w that U has already:
   n_i = I_ii dw_i + (I_kk - I_jj) w_j w_k - I_ij U_ki + I_ik U_ji + I_jk (w_j^2 - w_k^2) */
static struct svec euler(struct dag *d, const struct inertia *I, const struct frame *x)
{
	struct svec n;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct sum spread = {0};
		struct ref squares = dag_sub(d, dag_mul(d, x->w.x[j], x->w.x[j]), dag_mul(d, x->w.x[k], x->w.x[k]));

		sum_add(&spread, I->I[inertia_index(k, k)]);
		sum_add(&spread, -I->I[inertia_index(j, j)]);
		n.x[i] = dag_add(d, dag_mul(d, dag_const(d, I->I[inertia_index(i, i)]), x->dw.x[i]),
			dag_mul(d, dag_const(d, sum_real(spread)), dag_mul(d, x->w.x[j], x->w.x[k])));
		n.x[i] = dag_sub(d, n.x[i], dag_mul(d, dag_const(d, I->I[inertia_index(i, j)]), x->U.m[k][i]));
		n.x[i] = dag_add(d, n.x[i], dag_mul(d, dag_const(d, I->I[inertia_index(i, k)]), x->U.m[j][i]));
		n.x[i] = dag_add(d, n.x[i], dag_mul(d, dag_const(d, I->I[inertia_index(j, k)]), squares));
	}
	return n;
}

/* The body's own wrench: f = m a + U h, n = I dw + w x I w + h x a, with h = m c. */
static void load(const struct tour *r, const struct body *k, struct frame *x)
{
	struct dag *d = r->d;
	struct svec h = svec_const(d, k->inertia.h);

	x->f = svec_add(d, svec_scale(d, dag_const(d, k->inertia.mass), x->a), smat_mul(d, &x->U, h));
	x->n = svec_add(d, euler(d, &k->inertia, x), svec_cross(d, h, x->a));
	svec_tag(d, x->f, "f", k->number);
	svec_tag(d, x->n, "n", k->number);
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
	struct svec a = svec_sub(r->d, x->a, svec_cross(r->d, x->w, x->v));

	output_svec(r, r->v_out, 6 * index, k, x->v);
	output_svec(r, r->v_out, 6 * index + 3, k, x->w);
	output_svec(r, r->a_out, 6 * index, k, a);
	output_svec(r, r->a_out, 6 * index + 3, k, x->dw);
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
	place(r, k, x);
	if (r->f_in >= 0) {
		input_wrench(r, index, k, x);
	} else {
		move(r, k, &r->frames[k->parent + 1], x);
		load(r, k, x);
	}
	if (r->f_out >= 0)
		output_passes(r, index, k, x);
}

static void add_torque(const struct tour *r, const struct body *k, int row, struct ref value)
{
	r->tau[k->iv + row] = dag_add(
		r->d, r->tau[k->iv + row], dag_mul(r->d, dag_const(r->d, k->sign * k->multiplier), value));
}

/* The torque is the part of the wrench along the joint's axes; f0 is the force in the joint's frame. */
static void project(const struct tour *r, const struct body *k, const struct frame *x, struct svec f0)
{
	switch (k->type) {
	case JOINT_PRISMATIC:
		add_torque(r, k, 0, x->f.x[k->axis]);
		break;
	case JOINT_PLANAR:
		add_torque(r, k, 0, f0.x[0]);
		add_torque(r, k, 1, f0.x[1]);
		add_torque(r, k, 2, x->n.x[2]);
		break;
	case JOINT_FLOATING:
		for (int i = 0; i < 3; i++) {
			add_torque(r, k, i, x->f.x[i]);
			add_torque(r, k, 3 + i, x->n.x[i]);
		}
		break;
	default:
		add_torque(r, k, 0, x->n.x[k->axis]);
	}
}

/* f_p += R f, n_p += R n + p x R f */
static void leave(const struct tour *r, int index)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[index];
	struct frame *x = &r->frames[index + 1], *parent = &r->frames[k->parent + 1];
	struct svec f, n;

	dag_section(d, SECTION_BACK, index);
	f = out_of(r, k, x, x->f);
	n = out_of(r, k, x, x->n);
	project(r, k, x, f);
	f = smat_mul(d, &x->R, f);
	n = smat_mul(d, &x->R, n);
	parent->f = svec_add(d, parent->f, f);
	parent->n = svec_add(d, parent->n, svec_add(d, n, svec_cross(d, x->p, f)));
	if (k->parent >= 0) {
		svec_tag(d, parent->f, "f", r->t->bodies[k->parent].number);
		svec_tag(d, parent->n, "n", r->t->bodies[k->parent].number);
	}
}

/* A driver's torque is complete when its followers' are added; all others when their body is left. */
static int torque_waits(const struct tree *t, int index)
{
	for (int i = 0; i < t->mimic_count; i++)
		if (t->bodies[t->mimics[i].body].iv == t->bodies[index].iv)
			return 1;
	return 0;
}

static void output_torques(const struct tour *r, int index)
{
	const struct body *k = &r->t->bodies[index];

	for (int i = 0; i < joint_nv(k->type); i++)
		dag_output(r->d, r->tau_out, k->iv + i, r->tau[k->iv + i]);
}

static void leave_and_output(const struct tour *r, int index)
{
	leave(r, index);
	if (!torque_waits(r->t, index))
		output_torques(r, index);
}

/* Bodies are numbered depth-first: before going out to the next, come back to its parent. */
static void tour(struct tour *r)
{
	const struct tree *t = r->t;
	int here = -1;

	for (int k = 0; k < t->body_count; k++) {
		for (; r->tau && here != t->bodies[k].parent; here = t->bodies[here].parent)
			leave_and_output(r, here);
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

static void tour_run(struct tour *r, int with_torques)
{
	struct dag *d = r->d;
	struct frame *world;
	struct ref none = {0};

	r->frames = arena_alloc(d->arena, (size_t)r->t->body_count + 1, sizeof *r->frames);
	r->tau = with_torques ? arena_alloc(d->arena, (size_t)r->t->nv, sizeof *r->tau) : NULL;
	if (!r->frames || (with_torques && !r->tau)) {
		d->failed = 1;
		return;
	}
	world = &r->frames[0];
	*world = (struct frame){.s = none};
	for (int i = 0; i < 3; i++)
		world->a.x[i] = dag_const(d, -r->t->gravity[i]);
	tour(r);
}

void rnea_full(struct dag *d, const struct tree *t)
{
	struct tour r = {.d = d, .t = t, .f_in = -1, .v_out = -1, .a_out = -1, .f_out = -1};

	r.q = dag_argument(d, "q", t->nq, 0);
	r.qd = dag_argument(d, "qd", t->nv, 0);
	r.qdd = dag_argument(d, "qdd", t->nv, 0);
	r.tau_out = dag_argument(d, "tau", t->nv, 1);
	tour_run(&r, 1);
}

void rnea_fpass(struct dag *d, const struct tree *t)
{
	struct tour r = {.d = d, .t = t, .f_in = -1, .tau_out = -1};

	r.q = dag_argument(d, "q", t->nq, 0);
	r.qd = dag_argument(d, "qd", t->nv, 0);
	r.qdd = dag_argument(d, "qdd", t->nv, 0);
	r.v_out = dag_argument(d, "v", t->body_count * 6, 1);
	r.a_out = dag_argument(d, "a", t->body_count * 6, 1);
	r.f_out = dag_argument(d, "f", t->body_count * 6, 1);
	tour_run(&r, 0);
}

void rnea_bpass(struct dag *d, const struct tree *t)
{
	struct tour r = {.d = d, .t = t, .qd = -1, .qdd = -1, .v_out = -1, .a_out = -1, .f_out = -1};

	r.q = dag_argument(d, "q", t->nq, 0);
	r.f_in = dag_argument(d, "f", t->body_count * 6, 0);
	r.tau_out = dag_argument(d, "tau", t->nv, 1);
	tour_run(&r, 1);
}
