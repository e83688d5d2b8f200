/* Where bodies are, the wrenches that pull at them, and what is asked of their motions and joints: what joins a tour on its
   way out and back. */
#include "dynamics/want.h"
#include "tree/lumps.h"

static int needs_pose(const struct request *k)
{
	return (k->push_count && k->in_world) || (k->contact_count && k->frame == FRAME_WORLD_ALIGNED);
}

/* The world's frame; gravity is not subtracted from free_a. */
void want_world(const struct tour *r)
{
	for (int i = 0; i < 3; i++)
		r->frames[0].R0.m[i][i] = dag_const(r->d, 1);
}

/* R0 = R0_p R(q), column by column */
static void place(const struct tour *r, const struct body *k, const struct frame *parent, struct frame *x)
{
	struct dag *d = r->d;

	for (int j = 0; j < 3; j++) {
		struct svec e = {{{0}, {0}, {0}}};

		e.x[j] = dag_const(d, 1);
		e = joint_to_parent(d, k, &x->pose, e);
		smat_set_column(&x->R0, j, smat_mul(d, &parent->R0, e));
	}
}

/* ---- on the way out ---- */

static void output_motion(struct dag *d, int argument, const struct placement *X, struct svec linear, struct svec angular)
{
	struct smat R = smat_const(d, &X->R);

	linear = svec_add(d, linear, svec_cross(d, angular, svec_const(d, X->p)));
	linear = smat_mul_transposed(d, &R, linear);
	angular = smat_mul_transposed(d, &R, angular);
	for (int i = 0; i < 3; i++) {
		dag_output(d, argument, i, linear.x[i]);
		dag_output(d, argument, 3 + i, angular.x[i]);
	}
}

/* Twist [v; w] and spatial acceleration [a - w x v; dw] at a link's origin, in its frame. */
static void output_links(const struct tour *r, int body)
{
	const struct build *b = r->context;
	const struct frame *x = &r->frames[body + 1];
	const struct motion *m = &x->motion;

	for (int i = 0; i < b->k->want_count; i++) {
		const struct want *w = &b->k->wants[i];

		if (w->body != body)
			continue;
		if (w->kind == WANT_TWIST)
			output_motion(r->d, b->outputs[i], &w->X, m->v, m->w);
		if (w->kind == WANT_ACCEL)
			output_motion(r->d, b->outputs[i], &w->X, svec_sub(r->d, x->free_a, svec_cross(r->d, m->w, m->v)), m->dw);
	}
}

struct svec want_turn(struct dag *d, const struct frame *x, const struct placement *X, int in_world, struct svec u)
{
	struct smat R = smat_const(d, &X->R);

	return in_world ? smat_mul_transposed(d, &x->R0, u) : smat_mul(d, &R, u);
}

/* A wrench (f, n) at a link's origin takes R f and R n + p x R f off what the body's joint must bear. */
static void pull(const struct tour *r, const struct push *p, int argument, struct frame *x)
{
	struct dag *d = r->d;
	const struct build *b = r->context;
	struct svec f = svec_input(d, argument, 0), n = svec_input(d, argument, 3);

	f = want_turn(d, x, &p->X, b->k->in_world, f);
	n = want_turn(d, x, &p->X, b->k->in_world, n);
	x->f = svec_sub(d, x->f, f);
	x->n = svec_sub(d, x->n, svec_add(d, n, svec_cross(d, svec_const(d, p->X.p), f)));
}

void want_pull(const struct tour *r, int body)
{
	const struct build *b = r->context;
	const struct body *k = &r->t->bodies[body];
	struct frame *x = &r->frames[body + 1];

	if (needs_pose(b->k))
		place(r, k, &r->frames[k->parent + 1], x);
	for (int i = 0; i < b->k->push_count; i++)
		if (b->k->pushes[i].body == body)
			pull(r, &b->k->pushes[i], b->pushed[i], x);
}

void want_free(const struct tour *r, int body)
{
	const struct build *b = r->context;
	const struct frame *parent = &r->frames[r->t->bodies[body].parent + 1];

	if (b->k->contact_count || request_wants(b->k, WANT_ACCEL))
		r->frames[body + 1].free_a = tour_acceleration(r, body, parent->free_a);
}

void want_bear(const struct tour *r, int body)
{
	want_free(r, body);
	want_pull(r, body);
	contacts_entered(r, body);
	contacts_pull(r, body);
}

void want_entered(const struct tour *r, int body)
{
	struct build *b = r->context;
	const struct body *k = &r->t->bodies[body];
	struct frame *x = &r->frames[body + 1];
	struct parameters known = rigid_body_parameters(r->d, &k->inertia);
	const struct parameters *p = b->parameters[body] ? b->parameters[body] : &known;

	want_bear(r, body);
	if (request_wants(b->k, WANT_KINETIC))
		b->kinetic = dag_add(r->d, b->kinetic, rigid_body_kinetic(r->d, p, &x->motion));
	output_links(r, body);
	if (b->regressor.r)
		regressor_enter(&b->regressor, body);
}

/* ---- on the way back ---- */

/* The wrench through the joint, in the URDF's frame of its child link. */
void want_leaving(const struct tour *r, int body)
{
	const struct build *b = r->context;
	const struct frame *x = &r->frames[body + 1];
	struct smat A = smat_const(r->d, &r->t->bodies[body].frame);

	for (int i = 0; i < b->k->want_count; i++)
		if (b->k->wants[i].kind == WANT_WRENCH && b->k->wants[i].body == body) {
			struct svec f = smat_mul(r->d, &A, x->f), n = smat_mul(r->d, &A, x->n);

			n = svec_add(r->d, n, svec_cross(r->d, svec_const(r->d, r->t->bodies[body].origin), f));

			for (int c = 0; c < 3; c++) {
				dag_output(r->d, b->outputs[i], c, f.x[c]);
				dag_output(r->d, b->outputs[i], 3 + c, n.x[c]);
			}
		}
}

/* ---- when it is back ---- */

/* Where nothing else pulls, no link stands, and the ground holds nothing, the first wrench is what all that moves takes. */
int want_gives_rate(const struct build *b)
{
	for (int k = 0; k < b->t->body_count; k++)
		if (lumps_is_held(b->t, k))
			return 0;
	return request_wants(b->k, WANT_TAU) && request_wants(b->k, WANT_DMOMENTUM) && !b->k->push_count &&
	       !b->k->contact_count;
}

void want_rate(const struct build *b, const struct tour *r)
{
	const struct svec g = {{b->gravity[0], b->gravity[1], b->gravity[2]}};
	const struct frame *first = r->frames + 1 + b->places.hub;

	if (want_gives_rate(b) && b->places.gives_rate && !b->d->failed)
		kinematics_momentum_rate(&b->places, first->f, first->n, g);
}

/* ---- where things are ---- */

/* Of a body that has been entered where nothing accelerates: dJ/dt qd of what it carries. */
static void rate_entered(const struct tour *r, int body)
{
	const struct motion *m = &r->frames[body + 1].motion;
	const struct build *b = r->context;

	kinematics_rate(&b->places, body, &(struct carried_motion){m->v, m->w, m->a, m->dw});
}

/* The rate of the momentum alone, where places were there before qdd. */
static void run_rate(struct build *b, struct joint_inputs in)
{
	struct request k = *b->k;
	struct want rate = {.kind = WANT_DMOMENTUM};
	int argument = want_output(b, WANT_DMOMENTUM);
	struct kinematics x = {.d = b->d, .t = b->t, .k = &k, .in = in, .parameters = b->parameters, .outputs = &argument};

	k.wants = &rate;
	k.want_count = 1;
	kinematics_run(&x);
}

void want_kinematics(struct build *b, struct joint_inputs in)
{
	static const struct ref nothing[3] = {{0}, {0}, {0}};
	struct tour r = want_tour(b, in);
	int was_early = b->places.bodies != NULL;

	want_places(b, in);
	if (was_early && request_wants(b->k, WANT_DMOMENTUM))
		run_rate(b, in);
	if (!request_wants(b->k, WANT_DJACOBIAN))
		return;
	dag_section(b->d, SECTION_RATE, 0);
	r.in.qdd = (struct source){.argument = -1};
	r.gravity = nothing;
	r.entered = rate_entered;
	tour_run(&r);
}
