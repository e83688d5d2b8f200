/* Of the ways to make the same outputs, the one that takes less. */
#include "dynamics/registry.h"
#include "dynamics/singular.h"
#include "dynamics/want.h"

static const enum role STATE[] = {ROLE_JOINT_POSITION, ROLE_JOINT_VELOCITY, ROLE_JOINT_ACCELERATION};

/* What is alive: operations other than signs, and which of q, qd and qdd are read. */
struct use {
	size_t operations;
	int is_read[3];
};

static struct use use_of(struct dag *d)
{
	uint32_t *uses = d->failed ? NULL : arena_alloc(d->arena, d->count, sizeof *uses);
	struct use x = {0};

	if (!uses) {
		d->failed = 1;
		return x;
	}
	dag_uses(d, uses);
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		for (int k = 0; k < 3 && uses[i] && n->op == OP_INPUT; k++)
			x.is_read[k] |= d->arguments[n->arg[0].i].role == STATE[k];
		x.operations += uses[i] && op_arity[n->op] > 0 && n->op != OP_NEG;
	}
	arena_release(d->arena, uses);
	return x;
}

/* A trial of forward mode may make half as many nodes as the recursion, and these: all that it needs where it has ever taken
   less, on short branches whose recursion makes some 20000; on chains it takes up to three times as much. */
enum { MORE_NODES = 1 << 16 };

/* Other ways instead, if these take less; `most` nodes, 0: as many as it takes. */
static int take_cheaper(struct dag *d, const struct tree *t, const struct request *k, struct ways other, size_t most)
{
	size_t operations = use_of(d).operations;
	int is_taken;
	struct arena spare;
	struct dag trial;

	arena_init(&spare, &d->arena->allocator);
	dag_init(&trial, &spare);
	if (most)
		dag_limit(&trial, most);
	want_build_in(&trial, t, k, other);
	is_taken = use_of(&trial).operations < operations && !trial.failed;
	if (is_taken) {
		struct arena *a = d->arena;

		dag_free(d);
		d->arena = a;
		dag_take(d, &trial);
	}
	d->failed |= spare.failed;
	d->arena->failed |= spare.failed;
	arena_free(&spare);
	return is_taken;
}

static int takes_factors(const struct request *k)
{
	return k->is_forward || request_wants_any(k, IS_OPSPACE);
}

static void build_cheapest(struct dag *d, const struct tree *t, const struct request *k, enum handed handed)
{
	int has_derivatives = request_wants(k, WANT_DTAU_DQ) || request_wants(k, WANT_DTAU_DQD) ||
		request_wants(k, WANT_DQDD_DQ) ||
		request_wants(k, WANT_DQDD_DQD);
	int is_shorter = articulated_is_shorter(t) || (handed == HANDED_FORCES && articulated_serves(t)); /* little waits of it */
	int is_open = k->dynamics == DYNAMICS_CHEAPER &&
		(!is_shorter || request_wants(k, WANT_QDD_BOUND)); /* which takes M too */
	struct ways now = {
		.derivatives = k->derivatives == DERIVATIVES_FORWARD ? DERIVATIVES_FORWARD : DERIVATIVES_RECURSION,
		.dynamics = is_open || k->dynamics == DYNAMICS_FACTOR ? DYNAMICS_FACTOR : DYNAMICS_ARTICULATED,
		.handed = handed}, other = now;

	want_build_in(d, t, k, now);
	other.derivatives = DERIVATIVES_FORWARD;
	if (has_derivatives && k->derivatives == DERIVATIVES_CHEAPER && !d->failed)
		if (take_cheaper(d, t, k, other, d->count / 2 + MORE_NODES))
			now = other;
	other = now;
	other.dynamics = DYNAMICS_ARTICULATED;
	if (takes_factors(k) && is_open && articulated_serves(t) && !d->failed)
		take_cheaper(d, t, k, other, 0);
}

/* Where nothing of q, qd or qdd is read, there is no such input: torques are differentiated by it all the same, so that is known
   when all is made. Forward dynamics always takes q, qd and tau. */
static void strike_unread(struct dag *d, const struct request *k)
{
	struct use x = use_of(d);

	for (int i = 0; i < 3 && !k->is_forward && !d->failed; i++) {
		int argument = dag_find_role(d, STATE[i], 0);

		if (argument >= 0 && !x.is_read[i])
			dag_strike(d, argument);
	}
}

void want_build(struct dag *d, const struct tree *t, const struct request *k)
{
	if (takes_factors(k) && singular_find(d, t, k))
		return;
	build_cheapest(d, t, k, HANDED_NOTHING);
	strike_unread(d, k);
}

/* Is nothing wanted but qdd and its derivatives by q and qd? */
static int is_relayed(const struct request *k)
{
	for (int i = 0; i < k->want_count; i++)
		if (k->wants[i].kind != WANT_QDD && k->wants[i].kind != WANT_DQDD_DQ && k->wants[i].kind != WANT_DQDD_DQD)
			return 0;
	return request_wants(k, WANT_QDD);
}

int algorithm_build_looped(struct dag *d, const struct tree *t, const struct request *k, enum looped use)
{
	struct loops loops;
	int is_relay = use == LOOPED_RELAY, is_in_place = is_relay || use == LOOPED_BATCH;

	if (!request_wants(k, WANT_DQDD_DQ) && !request_wants(k, WANT_DQDD_DQD))
		return 0;
	if (k->dynamics == DYNAMICS_ARTICULATED || k->refine_steps || request_wants_any(k, IS_PRODUCT) ||
		k->stored_count < k->want_count || k->contact_count || (is_relay && !is_relayed(k)) ||
		(use == LOOPED_LANES && t->mimic_count) || !forward_loops(&loops, t, k->dense, is_in_place, d->arena))
		return 0;
	loops.is_relay = is_relay;
	loops.is_in_lanes = use == LOOPED_LANES;
	want_build_in(d, t, k, (struct ways){
		.derivatives = k->derivatives == DERIVATIVES_FORWARD ? DERIVATIVES_FORWARD : DERIVATIVES_RECURSION,
		.dynamics = DYNAMICS_FACTOR, .loops = &loops});
	return 1;
}

void algorithm_build_handed(struct dag *d, const struct tree *t, const struct request *k, enum handed handed)
{
	build_cheapest(d, t, k, handed);
}

/* Where elements of d tau stand: in its matrices, in those of d qdd, or in the columns that are to be solved. */
static int find_places(struct pattern *to, const struct tree *t, const struct request *k, const struct loops *loops,
	struct arena *a)
{
	if (!k->is_forward)
		return pattern_make(to, t, 0, k->dense, a);
	if (!pattern_coupled(to, t, 0, k->dense, a))
		return 0;
	for (int i = 0; i < t->nv && loops->rooms; i++)
		for (int j = 0; j < t->nv; j++)
			to->row[i * t->nv + j] = loops->rooms[0].first + i * loops->rooms[0].room + j;
	return 1;
}

/* Does the recursion make all gradients that are wanted, and, of accelerations, do articulated bodies solve their columns? */
static int may_go_back(const struct tree *t, const struct request *k)
{
	int by_q = request_wants(k, WANT_DTAU_DQ) || request_wants(k, WANT_DQDD_DQ);

	if (k->derivatives == DERIVATIVES_FORWARD || request_wants_any(k, IS_PRODUCT) || k->refine_steps ||
		!want_is_recursive(t, k, DERIVATIVES_RECURSION, by_q ? WANT_DTAU_DQ : WANT_DTAU_DQD))
		return 0;
	return !k->is_forward ||
		(k->dynamics != DYNAMICS_FACTOR && articulated_serves(t) && !tree_has_type(t, JOINT_FLOATING));
}

int algorithm_build_way_back(struct dag *d, const struct tree *t, const struct request *k, int is_batch)
{
	enum dynamics dynamics = k->is_forward ? DYNAMICS_ARTICULATED : DYNAMICS_FACTOR;
	struct loops loops = {0};
	struct way_back way;
	struct pattern to;

	if (!may_go_back(t, k) || (k->is_forward && !forward_loops_behind(&loops, t, k, is_batch, d->arena)) ||
		!find_places(&to, t, k, &loops, d->arena) || !way_back_begin(&way, t, k, &to, is_batch))
		return 0;
	want_build_in(d, t, k, (struct ways){
		.derivatives = DERIVATIVES_RECURSION, .dynamics = dynamics, .loops = k->is_forward ? &loops : NULL, .way = &way});
	if (!d->failed)
		strike_unread(d, k);
	return 1;
}
