/* Products of the derivatives of any outputs with vectors, without their matrices: jvp by a sweep forwards over the expressions
   that the outputs have, vjp by one backwards. An output that is new takes no code here.

   Where qdd is found, it is an input of these expressions (DAG_HELD), and ID(q, qd, qdd) = tau says how it varies. With T for
   ID's derivatives at that qdd: forwards dqdd = M^-1 (dtau - T_q dq - T_qd dqd), then all others along it; backwards the weights
   that outputs put on qdd are collected, mu = M^-1 of them is the derivative by tau, and a sweep with -mu on ID gives all
   else. */
#include "dag/derive.h"
#include "dynamics/want.h"
#include "mechanics/tangent.h"
#include <string.h>

enum varied { VARIED_Q, VARIED_QD, VARIED_QDD, VARIED_COUNT };

struct sweep {
	struct build *b;
	struct dag *d;
	struct joint_inputs in;
	int arguments[VARIED_COUNT];     /* -1: no such input */
	struct ref *along[VARIED_COUNT]; /* the direction, in rows of q itself */
	struct ref *roots, *weights;     /* of the outputs, then of ID */
	int count;                       /* of the outputs */
};

void product_declare(const struct build *b)
{
	const struct request *k = b->k;

	if (request_wants(k, WANT_JVP))
		dag_argument_of(b->d, (struct argument){.name = "jvp_v", .rows = 3 * b->t->nv, .role = ROLE_TANGENT, .of = ""});
	for (int i = 0; i < k->by_count && request_wants(k, WANT_JVP); i++)
		dag_argument_of(b->d, (struct argument){.name = k->by[i].direction, .rows = k->by[i].rows,
			.per_batch = k->by[i].per_batch, .role = ROLE_TANGENT, .of = k->by[i].word});
	if (request_wants(k, WANT_VJP))
		dag_argument_of(b->d, (struct argument){.name = "vjp_v", .rows = k->vjp.rows, .role = ROLE_COTANGENT,
			.of = k->vjp.words});
}

static const struct product *product_of(const struct request *k, int want)
{
	return k->wants[want].kind == WANT_JVP ? &k->jvp : k->wants[want].kind == WANT_VJP ? &k->vjp : NULL;
}

int product_is_of_torques(const struct build *b, int want)
{
	const struct product *p = product_of(b->k, want);

	return p && request_is_plain_product(b->k, p);
}

struct ref want_hand_on(const struct build *b, int row, struct ref value, const char *quantity)
{
	int argument = b->ways.handed ? b->outputs[0] : want_output(b, WANT_VJP);
	const struct tree_joint *j = tree_joint_of_row(b->t, row % b->t->nv);
	struct ref read = value;

	dag_output(b->d, argument, row, value);
	if (b->ways.handed)
		read = dag_input(b->d, argument, row);
	if (b->ways.handed && j->nv == 1)
		dag_tag(b->d, read, quantity, b->t->bodies[j->body].number, 0);
	return read;
}

/* ---- what is differentiated ---- */

static int begin(struct sweep *s, struct build *b, struct joint_inputs in, const struct product *p)
{
	struct arena *a = b->d->arena;
	size_t nq = (size_t)b->t->nq, nv = (size_t)b->t->nv, found = (size_t)contacts_found(b), most = (size_t)p->rows + found;

	*s = (struct sweep){.b = b, .d = b->d, .in = in, .arguments = {in.q.argument, in.qd.argument, in.qdd.argument},
		.count = p->rows, .along = {arena_alloc(a, nq, sizeof(struct ref)), arena_alloc(a, nv, sizeof(struct ref)),
			arena_alloc(a, found, sizeof(struct ref))},
		.roots = arena_alloc(a, most, sizeof(struct ref)), .weights = arena_alloc(a, most, sizeof(struct ref))};
	return !a->failed;
}

/* The rows of a want. */
static void find_roots(const struct sweep *s, int want, struct ref *roots)
{
	struct dag *d = s->d;
	const struct want *w = &s->b->k->wants[want];
	const struct contact *c = request_contact_of(s->b->k, w);
	int is_held = s->b->forward && (c || w->kind == WANT_QDD), first = c ? s->b->t->nv + c->first : 0;

	for (int i = 0; i < w->rows && is_held; i++)
		roots[i] = dag_input(d, DAG_HELD, first + i);
	for (size_t i = 0; i < d->output_count && !is_held; i++)
		if (d->outputs[i].argument == s->b->outputs[want])
			roots[d->outputs[i].row] = d->outputs[i].value;
}

/* Is it read by an argument that is varied? */
static int is_varied(const struct sweep *s, const struct node *n)
{
	const struct request *k = s->b->k;

	for (int i = 0; i < VARIED_COUNT; i++)
		if ((int)n->arg[0].i == s->arguments[i])
			return 1;
	for (int i = 0; i < k->by_count; i++)
		if ((int)n->arg[0].i == dag_find_argument(s->d, k->by[i].argument))
			return 1;
	return 0;
}

/* Does any of these values vary? */
static int vary(const struct sweep *s, const struct ref *roots, int count)
{
	struct derivable x;
	int found = 0;

	if (!derive_begin(&x, s->d, roots, count))
		return 1;
	for (uint32_t i = 0; i < x.count && !found; i++)
		found = x.live[i] && s->d->nodes[i].op == OP_INPUT && is_varied(s, &s->d->nodes[i]);
	arena_release(s->d->arena, x.live);
	return found;
}

static int has_given(const struct build *b)
{
	const struct request *k = b->k;
	int found = 0;

	for (int i = 0; i < b->t->nq; i++)
		found |= k->q[i].is_given;
	for (int i = 0; i < b->t->nv; i++)
		found |= k->qd[i].is_given | k->qdd[i].is_given | k->tau[i].is_given;
	return found;
}

/* Of a robot whose output is constant the product is zero; of a scene that has made it so it is a mistake. */
static void add_roots(struct sweep *s, const struct product *p)
{
	const struct request *k = s->b->k;

	for (int i = 0, at = 0; i < p->count && !s->d->failed; at += k->wants[p->of[i++]].rows) {
		find_roots(s, p->of[i], s->roots + at);
		if (!request_is_plain_product(k, p) && has_given(s->b) && !vary(s, s->roots + at, k->wants[p->of[i]].rows))
			s->d->failed = s->d->constant = 1 + p->of[i];
	}
}

/* ---- forwards ---- */

static struct ref seed(void *context, int argument, int row)
{
	const struct sweep *s = context;
	const struct request *k = s->b->k;
	const struct ref zero = {0};

	for (int i = 0; i < VARIED_COUNT; i++)
		if (argument == s->arguments[i])
			return s->along[i][row];
	for (int i = 0; i < k->by_count; i++)
		if (argument == dag_find_argument(s->d, k->by[i].argument))
			return dag_input(s->d, dag_find_argument(s->d, k->by[i].direction), row);
	return zero;
}

/* The derivatives of values along the direction, in their place. */
static void sweep_forward(struct sweep *s, struct ref *values, int count)
{
	struct derivable x;
	struct ref *dot;

	if (!derive_begin(&x, s->d, values, count) || !(dot = arena_alloc(s->d->arena, x.count, sizeof *dot))) {
		s->d->failed = 1;
		return;
	}
	derive_forward(&x, seed, s, dot);
	for (int i = 0; i < count; i++)
		values[i] = dot[values[i].i];
	arena_release(s->d->arena, dot);
}

/* dqdd = M^-1 (dtau - T_q dq - T_qd dqd), while qdd stands still. */
static void vary_found(struct sweep *s, const struct ref *dtau)
{
	int nv = s->b->t->nv, found = contacts_found(s->b);
	struct ref *x = s->roots + s->count;

	memcpy(x, s->b->torques, (size_t)found * sizeof *x);
	sweep_forward(s, x, found);
	for (int i = 0; i < found && !s->d->failed; i++)
		x[i] = i < nv ? dag_sub(s->d, dtau[i], x[i]) : dag_neg(s->d, x[i]);
	for (int i = 0; i < nv && s->b->ways.handed == HANDED_ALL && !s->d->failed; i++)
		x[i] = want_hand_on(s->b, i, x[i], "rhs");
	forward_solve(s->b->forward, x);
	memcpy(s->along[VARIED_QDD], x, (size_t)found * sizeof *x);
}

static void output_jvp(struct sweep *s, int argument)
{
	struct dag *d = s->d;
	int nv = s->b->t->nv, direction = dag_find_role(d, ROLE_TANGENT, 0);
	struct ref *v = arena_alloc(d->arena, 3 * (size_t)nv, sizeof *v);

	if (!v) {
		d->failed = 1;
		return;
	}
	for (int i = 0; i < 3 * nv; i++)
		v[i] = dag_input(d, direction, i);
	tangent_all(d, s->b->t, s->in, v, s->along[VARIED_Q]);
	memcpy(s->along[VARIED_QD], v + nv, (size_t)nv * sizeof *v);
	if (s->b->forward)
		vary_found(s, v + 2 * nv);
	else
		memcpy(s->along[VARIED_QDD], v + 2 * nv, (size_t)nv * sizeof *v);
	sweep_forward(s, s->roots, s->count);
	for (int i = 0; i < s->count && !d->failed; i++)
		dag_output(d, argument, i, s->roots[i]);
}

/* ---- backwards ---- */

/* After derive_backward: the derivative by a row of an argument. */
static struct ref bar_of(const struct derivable *x, const struct ref *bar, int argument, int row)
{
	const struct ref none = {0};
	struct ref found = argument < 0 ? none :
		dag_find(x->d, OP_INPUT, (struct ref){(uint32_t)argument}, (struct ref){(uint32_t)row}, none, 0);

	return found.i && found.i < x->count ? bar[found.i] : none;
}

/* The first `count` roots with their weights; the result is by node. NULL when memory runs out. */
static struct ref *sweep_backward(struct sweep *s, struct derivable *x, int count)
{
	struct ref *bar = derive_begin(x, s->d, s->roots, count) ? arena_alloc(s->d->arena, x->count, sizeof *bar) : NULL;

	if (!bar)
		s->d->failed = 1;
	else
		derive_backward(x, s->weights, bar);
	return bar;
}

/* M^-1 of weights on qdd; with contacts also what holds these, which is read where it was found before (contacts.h). */
static void solve_found(const struct sweep *s, struct ref *mu)
{
	const struct build *b = s->b;
	int nv = b->t->nv;

	if (b->ways.handed == HANDED_BY_FORCES) {
		for (int i = nv; i < contacts_found(b) && !s->d->failed; i++)
			mu[i] = dag_neg(s->d, b->weights[i - nv]);
		contacts_solve_pulled(b->forward, s->in, mu, mu + nv);
	} else {
		forward_solve(b->forward, mu);
	}
	if (b->ways.handed)
		memcpy(mu + nv, b->weights, (size_t)b->k->contact_rows * sizeof *mu);
}

/* As an output: what all else takes. */
static struct ref output_mu(const struct sweep *s, int row, struct ref mu)
{
	const struct build *b = s->b;

	if (b->ways.handed != HANDED_BY_FORCES || contacts_weights_fit(b->t, b->k))
		return want_hand_on(b, 2 * b->t->nv + row, mu, "mu");
	dag_output(s->d, b->outputs[0], 2 * b->t->nv + row, mu);
	return mu;
}

/* The weights on qdd become -mu on ID, one more root for each row; mu is the derivative by tau. Returns how many roots there
   are. */
static int weigh_found(struct sweep *s)
{
	struct dag *d = s->d;
	int nv = s->b->t->nv, found = contacts_found(s->b);
	struct ref *mu = s->weights + s->count;
	struct derivable x;
	struct ref *bar = sweep_backward(s, &x, s->count);

	for (int i = 0; i < found && !d->failed; i++) {
		mu[i] = bar_of(&x, bar, DAG_HELD, i);
		mu[i] = i < nv ? mu[i] : dag_neg(d, mu[i]);
	}
	solve_found(s, mu);
	for (int i = 0; i < nv && !d->failed; i++)
		mu[i] = dag_neg(d, output_mu(s, i, mu[i]));
	memcpy(s->roots + s->count, s->b->torques, (size_t)found * sizeof *mu);
	return s->count + found;
}

static void output_by(const struct sweep *s, const struct derivable *x, const struct ref *bar)
{
	const struct request *k = s->b->k;

	for (int i = 0; i < k->stored_count; i++) {
		const struct want *w = &k->wants[i];

		for (int row = 0; w->kind == WANT_VJP_BY && row < w->rows; row++)
			dag_output(s->d, s->b->outputs[i], row,
				bar_of(x, bar, dag_find_argument(s->d, k->by[w->body].argument), row));
	}
}

static void output_vjp(struct sweep *s, int argument)
{
	struct dag *d = s->d;
	const struct tree *t = s->b->t;
	int nv = t->nv, vector = dag_find_role(d, ROLE_COTANGENT, 0), count = s->count;
	struct derivable x;
	struct ref *bar;

	for (int i = 0; i < s->count; i++)
		s->weights[i] = dag_input(d, vector, i);
	if (s->b->forward)
		count = weigh_found(s);
	bar = d->failed ? NULL : sweep_backward(s, &x, count);
	if (!bar)
		return;
	for (int i = 0; i < t->nq; i++)
		s->along[VARIED_Q][i] = bar_of(&x, bar, s->arguments[VARIED_Q], i);
	for (int i = 0; i < nv; i++) {
		dag_output(d, argument, i, tangent_transposed(d, t, s->in, s->along[VARIED_Q], i));
		dag_output(d, argument, nv + i, bar_of(&x, bar, s->arguments[VARIED_QD], i));
		if (!s->b->forward)
			dag_output(d, argument, 2 * nv + i, bar_of(&x, bar, s->arguments[VARIED_QDD], i));
	}
	output_by(s, &x, bar);
	arena_release(d->arena, bar);
}

/* ---- all of them ---- */

void product_output(struct build *b, struct joint_inputs in, int want)
{
	const struct product *p = product_of(b->k, want);
	struct sweep s;

	if ((b->forward && !b->torques) || !begin(&s, b, in, p)) {
		b->d->failed = 1;
		return;
	}
	add_roots(&s, p);
	if (b->d->failed)
		return;
	dag_section(b->d, request_is_plain_product(b->k, p) ? SECTION_PRODUCTS : SECTION_SWEEPS, 0);
	if (p == &b->k->jvp)
		output_jvp(&s, b->outputs[want]);
	else
		output_vjp(&s, b->outputs[want]);
}

/* The vjp comes first: the jvp may be of it. */
void product_outputs(struct build *b, struct joint_inputs in)
{
	for (int is_jvp = 0; is_jvp < 2; is_jvp++)
		for (int i = 0; i < b->k->stored_count && !b->d->failed; i++)
			if (product_of(b->k, i) && (b->k->wants[i].kind == WANT_JVP) == is_jvp && !product_is_of_torques(b, i))
				product_output(b, in, i);
}
