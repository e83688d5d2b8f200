/* The request of a scene: torques from what it gives and frees, and whatever else it asks for. The DAG drops what nobody
   needs, so each quantity is simply computed where its operands are at hand. */
#include "dynamics/want.h"
#include <string.h>

/* ---- inputs ---- */

static const struct argument INPUTS[] = {{.name = "q", .role = ROLE_JOINT_POSITION}, {.name = "qd", .role = ROLE_JOINT_VELOCITY},
	{.name = "qdd", .role = ROLE_JOINT_ACCELERATION}, {.name = "tau", .role = ROLE_JOINT_TORQUE}};
enum { INPUT_Q, INPUT_QD, INPUT_QDD, INPUT_TAU, INPUT_COUNT };

static int declare(struct dag *d, struct argument a, int rows)
{
	a.rows = rows;
	return dag_argument_of(d, a);
}

static struct source source(struct dag *d, int input, const struct row *rows, int count)
{
	return (struct source){.argument = request_has_all(rows, count) ? -1 : declare(d, INPUTS[input], count), .given = rows};
}

/* ---- the whole ---- */

/* Where accelerations are found torques are given; products take those of the accelerations, which vary with all inputs. */
static int has_torques_given(const struct build *b)
{
	return b->k->is_forward && !request_wants(b->k, WANT_JVP) && !request_wants(b->k, WANT_VJP);
}

/* tau . qd */
static struct ref power(const struct build *b, const struct tour *r)
{
	int are_given = has_torques_given(b);
	struct ref sum = {0};

	for (int i = 0; i < r->t->nv; i++) {
		struct ref tau = are_given ? source_row(r->d, &b->forward->torques, i) : r->tau[i];

		sum = dag_add(r->d, sum, dag_mul(r->d, tau, source_row(r->d, &r->in.qd, i)));
	}
	return sum;
}

int want_output(const struct build *b, enum want_kind kind)
{
	for (int i = 0; i < b->k->want_count; i++)
		if (b->k->wants[i].kind == kind)
			return b->outputs[i];
	return -1;
}

/* The recursion always makes M and the Coriolis matrix. By q, it knows nothing of wrenches that stay as they are
   in the world; and a body that floats between others it takes to be turned by a quaternion of norm one. */
int want_is_recursive(const struct tree *t, const struct request *k, enum derivatives derivatives, enum want_kind kind)
{
	if (kind == WANT_MASS || kind == WANT_CORIOLIS)
		return 1;
	for (int i = 0; i < t->body_count; i++)
		if (t->bodies[i].type == JOINT_FLOATING && t->bodies[i].parent >= 0)
			return 0;
	if (kind == WANT_DTAU_DQ && k->push_count && k->in_world)
		return 0;
	return derivatives != DERIVATIVES_FORWARD;
}

/* What a recursion by q, qd and qdd writes, or what is solved with it. */
static const enum want_kind BY_RECURSION[BY_COUNT] = {WANT_DTAU_DQ, WANT_DTAU_DQD, WANT_CORIOLIS, WANT_MASS};
static const enum want_kind SOLVED[BY_COUNT] = {WANT_DQDD_DQ, WANT_DQDD_DQD, WANT_CORIOLIS, WANT_MASS};

/* On a processor, derivatives of qdd of one sample: values that wait are in memory, and are not made again. */
static int is_single(const struct build *b)
{
	return b->ways.loops && b->ways.loops->rooms;
}

static void begin_recursion(struct build *b, const struct tour *r)
{
	int arguments[BY_COUNT], is_used[BY_COUNT];

	for (enum by by = BY_Q; by < BY_COUNT; by++) {
		int serves = want_is_recursive(b->t, b->k, b->ways.derivatives, BY_RECURSION[by]);

		arguments[by] = serves ? want_output(b, BY_RECURSION[by]) : -1;
		b->solved[by] = serves ? want_output(b, SOLVED[by]) : -1;
		is_used[by] = arguments[by] >= 0 || b->solved[by] >= 0;
		for (int i = 0; i < b->k->want_count && serves; i++)
			b->done[i] |= b->k->wants[i].kind == BY_RECURSION[by] || b->k->wants[i].kind == SOLVED[by];
	}
	if (!is_used[BY_Q] && !is_used[BY_QD] && !is_used[BY_CORIOLIS] && !is_used[BY_QDD])
		return;
	recursion_begin(&b->recursion, r, arguments);
	b->recursion.has_gradients = is_used[BY_Q] || is_used[BY_QD];
	b->recursion.has_coriolis = is_used[BY_CORIOLIS];
	b->recursion.is_row_first = is_single(b);
	b->recursion.way = b->ways.way;
	forward_tell_matrices(b, arguments);
	b->recursion.is_in_lanes = b->ways.loops && b->ways.loops->is_in_lanes;
	b->recursion.has_shifts = b->solved[BY_Q] >= 0 || b->solved[BY_QD] >= 0;
}

struct tour want_tour(struct build *b, struct joint_inputs in)
{
	return (struct tour){.d = b->d, .t = b->t, .request = b->k, .in = in, .f_in = -1, .v_out = -1, .a_out = -1,
		.f_out = -1, .tau_out = -1, .gravity = b->gravity, .parameters = b->parameters, .own = b->own, .context = b};
}

/* The torques of gravity and velocities, without what the scene adds: a tour of its own. */
static void run_bias(struct build *b, struct joint_inputs in)
{
	struct tour r = want_tour(b, in);

	r.tau_out = want_output(b, WANT_BIAS);
	if (r.tau_out < 0)
		return;
	dag_section(b->d, SECTION_BIAS, 0);
	r.in.qdd = (struct source){.argument = -1};
	tour_run(&r);
}

/* The torques of gravity, and its potential -g.C, with C = sum of m c of all that moves, in the world. */
static void run_gravity(struct build *b, struct joint_inputs in, int tau_out, int potential)
{
	struct tour r = want_tour(b, in);
	const struct svec g = {{b->gravity[0], b->gravity[1], b->gravity[2]}};

	if (tau_out < 0 && potential < 0)
		return;
	dag_section(b->d, SECTION_GRAVITY, 0);
	r.tau_out = tau_out;
	r.comes_back = r.at_rest = 1;
	tour_run(&r);
	if (potential >= 0 && r.frames)
		dag_output(b->d, potential, 0, dag_neg(b->d, svec_dot(b->d, g, at_rest_moment(b->d, &r.frames[0]))));
}

static void output_scalars(const struct build *b, const struct tour *r)
{
	int power_out = want_output(b, WANT_POWER), kinetic_out = want_output(b, WANT_KINETIC);

	dag_section(b->d, SECTION_TOTALS, 0);
	if (power_out >= 0 && (r->tau || has_torques_given(b)))
		dag_output(b->d, power_out, 0, power(b, r));
	if (kinetic_out >= 0)
		dag_output(b->d, kinetic_out, 0, b->kinetic);
}

/* A complete column is solved at once, before others wait beside it. */
static void want_left(const struct tour *r, int body)
{
	struct build *b = r->context;

	if (!b->recursion.r)
		return;
	recursion_leave(&b->recursion, body);
	if (b->forward && !recursion_grows(&b->recursion))
		forward_by_body(b->forward, &b->recursion, body, b->solved);
}

static void end_recursion(struct build *b)
{
	recursion_end(&b->recursion);
	for (int k = 0; k < b->t->body_count && b->forward; k++)
		if (recursion_grows(&b->recursion) && !b->t->bodies[k].follower)
			forward_by_body(b->forward, &b->recursion, k, b->solved);
}

static void run_main(struct build *b, struct joint_inputs in)
{
	struct tour r = want_tour(b, in);

	r.world = want_world;
	r.entered = want_entered;
	r.leaving = want_leaving;
	r.left = want_left;
	r.own_terms = own_terms;
	r.tau_out = want_output(b, WANT_TAU);
	r.comes_back = (request_wants(b->k, WANT_POWER) && !has_torques_given(b)) || request_wants(b->k, WANT_WRENCH) ||
		request_wants_derivative(b->k);
	begin_recursion(b, &r);
	if (request_wants(b->k, WANT_REGRESSOR))
		regressor_begin(&b->regressor, &r, want_output(b, WANT_REGRESSOR));
	tour_run(&r);
	if (b->recursion.r && !b->d->failed)
		end_recursion(b);
	want_rate(b, &r);
	output_scalars(b, &r);
	b->torques = contacts_join(b, r.tau);
	gradient_outputs(&r, b->forward, b->outputs, b->done);
	if (b->ways.way && b->recursion.r && !b->d->failed)
		recursion_loop(&b->recursion);
}

static int is_zero(const struct row *rows, int count)
{
	for (int i = 0; i < count; i++)
		if (!rows[i].is_given || rows[i].value.x != 0)
			return 0;
	return 1;
}

/* Are the torques those of gravity, and nothing asked for that takes the recursion? */
static int is_gravity_alone(const struct build *b)
{
	const struct request *k = b->k;

	for (int i = 0; i < k->want_count; i++)
		if (k->wants[i].kind != WANT_TAU && k->wants[i].kind != WANT_GRAVITY && k->wants[i].kind != WANT_POTENTIAL &&
			!want_is(k->wants[i].kind, IS_PLACED))
			return 0;
	return (!request_wants(k, WANT_TAU) || (is_zero(k->qd, b->t->nv) && is_zero(k->qdd, b->t->nv))) && !k->push_count;
}

/* Is anything wanted of the tour whose accelerations are those asked for? */
static int takes_main(const struct request *k)
{
	for (int i = 0; i < k->want_count; i++)
		if (!want_is(k->wants[i].kind, IS_PLACED | IS_PRODUCT))
			return 1;
	return k->is_forward;
}

/* Factors need the Jacobians of what stands before qdd is found. */
static int is_without_qdd(const struct build *b, struct joint_inputs in)
{
	return b->k->is_forward && in.qdd.argument < 0 && !in.qdd.found;
}

void want_places(struct build *b, struct joint_inputs in)
{
	if (b->places.bodies)
		return;
	b->places = (struct kinematics){.d = b->d, .t = b->t, .k = b->k, .in = in, .parameters = b->parameters,
		.outputs = b->outputs, .gives_rate = is_without_qdd(b, in) || (want_gives_rate(b) && !is_gravity_alone(b))};
	if (request_wants_any(b->k, IS_PLACED) || b->k->contact_count)
		kinematics_run(&b->places);
}

static int alloc(struct build *b)
{
	struct arena *a = b->d->arena;

	b->pushed = arena_alloc(a, (size_t)b->k->push_count, sizeof *b->pushed);
	b->outputs = arena_alloc(a, (size_t)b->k->want_count, sizeof *b->outputs);
	b->done = arena_alloc(a, (size_t)b->k->want_count, 1);
	b->forces = arena_alloc(a, (size_t)b->k->contact_rows, sizeof *b->forces);
	b->weights = arena_alloc(a, (size_t)b->k->contact_rows, sizeof *b->weights);
	b->accelerated = arena_alloc(a, (size_t)b->k->contact_rows, sizeof *b->accelerated);
	return !a->failed;
}

static struct argument output(const struct request *k, const struct want *w)
{
	const struct want_type *type = want_type(w->kind);

	return (struct argument){.name = w->argument, .rows = w->rows, .is_output = 1, .role = type->role,
		.of = want_is(w->kind, OF_FREED) ? k->freed[w->body].word : w->kind == WANT_JVP ? k->jvp.words
			: want_of(w->word)};
}

/* Inputs of the request, besides q, qd and qdd and what is freed; then its outputs. */
static void declare_request(const struct build *b)
{
	for (int i = 0; i < b->k->push_count; i++)
		b->pushed[i] = dag_argument_of(b->d, (struct argument){.name = b->k->pushes[i].argument, .rows = 6,
			.role = ROLE_LINK_WRENCH, .of = want_of(b->k->pushes[i].word)});
	product_declare(b);
	for (int i = 0; i < b->k->stored_count; i++)
		b->outputs[i] = dag_argument_of(b->d, output(b->k, &b->k->wants[i]));
	for (int i = b->k->stored_count; i < b->k->want_count; i++)
		b->outputs[i] = DAG_UNSTORED + i;
}

/* Derivatives of qdd take a tour of their own at the qdd found. What both tours have in common waits from one to the other, where
   it is not made again. */
static int is_made_again(const struct build *b)
{
	return b->forward && !is_single(b) && (request_wants(b->k, WANT_DQDD_DQ) || request_wants(b->k, WANT_DQDD_DQD));
}

/* Where tau is an input, qdd is what it makes: held while torques are differentiated, until all is made. */
static void hold_qdd(struct build *b, struct joint_inputs *in, struct forward *x)
{
	forward_outputs(x, want_output(b, WANT_QDD), want_output(b, WANT_MINV));
	for (int i = 0; i < b->t->nv && b->ways.loops && b->ways.loops->is_relay && !b->d->failed; i++)
		x->qdd[i] = dag_input(b->d, want_output(b, WANT_QDD), i);
	for (int i = 0; i < b->t->nv && b->ways.handed && request_wants_any(b->k, IS_PRODUCT) && !b->d->failed; i++)
		x->qdd[i] = want_hand_on(b, i, x->qdd[i], "qdd");
	in->qdd = (struct source){.argument = DAG_HELD};
	contacts_hold(b);
	forward_bound(x, *in, want_output(b, WANT_QDD_BOUND));
}

static void find_qdd(struct build *b, struct joint_inputs *in, struct forward *x)
{
	if (b->ways.handed == HANDED_BY_FORCES)
		contacts_hold(b);
	forward_find(x, b, *in);
	if (b->ways.handed && x->stands)
		contacts_hand_on(x);
	if (b->ways.handed != HANDED_FORCES)
		hold_qdd(b, in, x);
}

static struct joint_inputs declare_inputs(const struct build *b, struct forward *x)
{
	const struct request *k = b->k;
	struct joint_inputs in = {.q = source(b->d, INPUT_Q, k->q, b->t->nq),
		.by_halves = k->is_motion && k->pose == POSE_QUATERNION && request_wants(k, WANT_POSE)};

	in.qd = source(b->d, INPUT_QD, k->qd, b->t->nv);
	if (k->is_forward) {
		x->torques = source(b->d, INPUT_TAU, k->tau, b->t->nv);
		in.qdd.argument = -1; /* until it is found */
	} else {
		in.qdd = source(b->d, INPUT_QDD, k->qdd, b->t->nv);
	}
	return in;
}

/* All but qdd and what is found with it. */
static void run_outputs(struct build *b, struct joint_inputs in)
{
	in.is_again = is_made_again(b);
	want_kinematics(b, in);
	if (is_gravity_alone(b))
		run_gravity(b, in, want_output(b, WANT_TAU), -1);
	else if (takes_main(b->k))
		run_main(b, in);
	run_bias(b, in);
	run_gravity(b, in, want_output(b, WANT_GRAVITY), want_output(b, WANT_POTENTIAL));
	opspace_outputs(b, in);
	product_outputs(b, in);
}

void want_build_in(struct dag *d, const struct tree *t, const struct request *k, struct ways ways)
{
	struct build b = {.d = d, .t = t, .k = k, .ways = ways};
	struct joint_inputs in;
	struct forward forward = {.b = &b, .torques = {.argument = -1},
		.stands = k->contact_count > 0 && ways.handed != HANDED_BY_FORCES};

	if (!alloc(&b)) {
		d->failed = 1;
		return;
	}
	dag_section(d, SECTION_FREED, 0);
	in = declare_inputs(&b, &forward);
	if (!want_constants(&b))
		return;
	in.offset = b.offset;
	declare_request(&b);
	if (is_single(&b))
		forward_declare_columns(d, ways.loops);
	way_back_declare(b.ways.way, d);
	if (ways.pivots_alone) {
		forward_find(&forward, &b, in);
		forward_pivots(&forward, in);
		dag_forget(d);
		return;
	}
	if (k->is_forward)
		find_qdd(&b, &in, &forward);
	if (b.ways.handed != HANDED_FORCES)
		run_outputs(&b, in);
	if (ways.loops)
		forward_loop(&forward);
	dag_forget(d);
	if (k->is_forward)
		dag_substitute(d, forward.qdd);
}
