#include "plan/grid/hands/base_sides.h"
#include "plan/grid/hands/finder.h"
#include "plan/readings.h"
#include <string.h>

/* Operations of the whole, and of a hand. H100, 1 M samples, ps, one kernel and two: g1_brainco, 9010 operations, f64 2447 and
   1064, in aos 3745 and 1515; but f32 462 and 522, and in aos, where the rows of a part stand apart, 663 and 1091. With the vjp,
   by limbs alone and so: f64, jvrc1, whose hands have 1131 operations, 2943 and 1401; but romeo, whose neck has 686, 898 and 912;
   f32, jvrc1, 8950, 564 and 723, pr2, 6792, 388 and 437; but g1_d_wheeled, 9837, 2433 and 774, g1_brainco, 20991, 3560 and
   1286. */
enum { LEAST = 5000, LEAST_PRODUCT_SINGLE = 9400, LEAST_HAND = 500, LEAST_HAND_PRODUCT = 1000 };

/* Numbers that a hand hands on, at most. */
enum { MOST_HANDED = 18 };

/* Values at once of the whole, beyond which f32 has hands too, and parts need no room in shared memory; joints of an arm that one
   part may hold. H100, 1 M samples, ps, chain_75 whole and so: f32 2572 and 1120, f64 7761 and 2961, in aos 9915 and 4626. */
enum { FULL = 300, LONGEST_SINGLE = 30, LONGEST_DOUBLE = 16 };

/* What a node is made of. */
enum { CONSTANT, OWN, OTHERS };

/* ---- which bodies carry a hand ---- */

static int is_single(const struct body *b)
{
	return !b->follower && joint_nv(b->type) == 1;
}

/* The rows of the hand, by row. Returns 0 where other bodies have one of them too. */
static int mark_rows(struct finder *f, const struct hand *m, unsigned char *own)
{
	const struct tree *t = f->x->tree;

	memset(own, 0, (size_t)t->nv);
	for (int k = m->first; k <= m->last; k++)
		memset(own + t->bodies[k].iv, 1, (size_t)joint_nv(t->bodies[k].type));
	for (int k = 0; k < t->body_count; k++)
		if ((k < m->first || k > m->last) && joint_nv(t->bodies[k].type) && own[t->bodies[k].iv])
			return 0;
	return 1;
}

static int is_product(const struct finder *f)
{
	return finder_rows(f->d) > f->x->tree->nv;
}

/* Rows of the arm for what is handed on, one for each joint, of a vjp three: those that are written last, which are nearest to
   the hand for torques, and farthest for a vjp, whose lines go by rows. Returns 0 where there are too few. */
static int choose_rows(struct finder *f, struct hand *m)
{
	const struct tree *t = f->x->tree;
	int *arm = arena_alloc(f->a, (size_t)t->body_count, sizeof *arm), joints = 0, count = 0;

	for (int k = m->body; k >= 0 && arm; k = t->bodies[k].parent)
		if (is_single(&t->bodies[k]))
			arm[joints++] = t->bodies[k].iv;
	for (int i = 0; i < joints; i++)
		for (int row = arm[is_product(f) ? joints - 1 - i : i]; row < finder_rows(f->d) && count < m->cut.count; row += t->nv)
			if (!f->rows[row])
				m->rows[count++] = row;
	return count > 0 && count == m->cut.count;
}

/* Operations that the hand's joints have a say in and what is handed on, or a torque of the hand, takes. */
static unsigned operations_of(struct finder *f, const struct hand *m, const unsigned char *own)
{
	const struct dag *d = f->d;
	unsigned count = 0;

	memset(f->to, 0, d->count);
	for (int i = 0; i < m->cut.count; i++)
		f->to[m->cut.nodes[i]] = 1;
	for (size_t i = 0; i < d->output_count; i++)
		f->to[d->outputs[i].value.i] |= (unsigned char)finder_owns(f, own, i);
	dag_mark_operands(d, d->count, f->to);
	for (size_t i = 0; i < d->count; i++) {
		f->beyond[i] = f->from[i];
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			f->beyond[i] |= f->beyond[d->nodes[i].arg[k].i];
		count += f->beyond[i] && f->to[i];
	}
	return count;
}

/* An input of the hand's joints. */
static int is_own_input(const struct finder *f, const struct node *n, const unsigned char *own)
{
	const struct argument *a = n->op == OP_INPUT && n->arg[0].i < DAG_ARGUMENTS ? &f->d->arguments[n->arg[0].i] : NULL;

	if (a && f->is_base) {
		const struct tree_joint *j = readings_joint(f->d, n, f->x->tree);

		return j && own[j->iv];
	}
	return a && role_rows(a->role) != ROWS_ANY && a->rows == f->x->tree->nv && own[n->arg[1].i];
}

/* Where what the hand's inputs alone make meets anything else: what is handed on is beyond, not the inputs themselves. */
static void mark_meetings(struct finder *f)
{
	const struct dag *d = f->d;

	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		int own = f->from[i], others = n->op == OP_INPUT && !own;

		for (int k = 0; k < op_arity[n->op]; k++) {
			own |= f->kind[n->arg[k].i] == OWN;
			others |= f->kind[n->arg[k].i] == OTHERS;
		}
		f->kind[i] = others ? OTHERS : own ? OWN : CONSTANT;
		f->meets[i] = own && others;
	}
}

/* From where to where all goes that is handed on. */
static void mark_ends(struct finder *f, const unsigned char *own)
{
	const struct dag *d = f->d;

	memset(f->to, 0, d->count);
	for (size_t i = 0; i < d->count; i++)
		f->from[i] = (unsigned char)is_own_input(f, &d->nodes[i], own);
	if (f->is_felt) {
		base_sides_mark(f, own);
		return;
	}
	for (size_t i = 0; i < d->output_count; i++)
		f->to[d->outputs[i].value.i] |= !finder_owns(f, own, i);
	mark_meetings(f);
}

/* Returns 0 when memory runs out; a hand that is none has no cut. */
static int cut_hand(struct finder *f, struct hand *m, unsigned char *own)
{
	m->cut.count = 0;
	if (!mark_rows(f, m, own))
		return 1;
	mark_ends(f, own);
	if (!cut_find(&m->cut, f->d, f->is_felt ? f->from : f->meets, f->to, f->a))
		return 0;
	if ((!f->is_felt && m->cut.count > MOST_HANDED) || !(f->is_base ? base_sides_rows(f, m, own) : choose_rows(f, m)) ||
		operations_of(f, m, own) < (is_product(f) ? LEAST_HAND_PRODUCT : LEAST_HAND))
		m->cut.count = 0;
	return 1;
}

int finder_look(struct hand *m, struct finder *f, int body, int first, int end, unsigned char *own)
{
	*m = (struct hand){.body = body, .first = first, .last = end - 1, .level = f->h->level_count};
	return cut_hand(f, m, own);
}

int finder_try(struct finder *f, int body, int first, int end, unsigned char *own)
{
	struct hand *m = &f->h->list[f->h->count];

	if (!finder_look(m, f, body, first, end, own))
		return 0;
	if (!m->cut.count)
		return 1;
	memset(f->taken + first, 1 + m->level, (size_t)(end - first));
	for (int row = 0; row < finder_rows(f->d); row++)
		f->rows[row] |= own[row % f->x->tree->nv];
	for (int i = 0; i < m->cut.count; i++)
		f->rows[m->rows[i]] = 1;
	f->h->count++;
	return 1;
}

/* Does one of these bodies carry several others? */
static int is_branched(const struct finder *f, int first, int end)
{
	while (first < end && f->children[first] < 2)
		first++;
	return first < end;
}

/* All that a body carries; where some of it branches again, of its children those beyond which nothing does. */
static int find_beyond(struct finder *f, int body, unsigned char *own)
{
	const struct tree *t = f->x->tree;
	int end = tree_end(t, body), next;

	if (!is_branched(f, body + 1, end))
		return finder_try(f, body, body + 1, end, own);
	for (int first = body + 1; first < end; first = next) {
		next = tree_end(t, first);
		if (!is_branched(f, first, next) && !finder_try(f, body, first, next, own))
			return 0;
	}
	return 1;
}

static int find_branches(struct finder *f, unsigned char *own)
{
	const struct tree *t = f->x->tree;

	for (int k = 0; k < t->body_count; k++)
		if (t->bodies[k].parent >= 0)
			f->children[t->bodies[k].parent]++;
	for (int k = t->body_count; k-- > 0;)
		if (f->children[k] >= 2 && !find_beyond(f, k, own))
			return 0;
	return 1;
}

/* Is it the last of its arm, but for what hands have taken? */
static int is_end(const struct finder *f, int body)
{
	int end = tree_end(f->x->tree, body);

	for (int k = body + 1; k < end; k++)
		if (!f->taken[k])
			return 0;
	return !f->taken[body];
}

static int depth_of(const struct tree *t, int body)
{
	int depth = 0;

	for (; body >= 0; body = t->bodies[body].parent)
		depth++;
	return depth;
}

/* Has this kernel a hand among the bodies of the subtree? */
static int has_hand(const struct finder *f, int body)
{
	int end = tree_end(f->x->tree, body);

	while (body < end && f->taken[body] <= f->h->level_count)
		body++;
	return body < end;
}

/* The end of an arm that is too long, the arm in pieces of one length. */
static int find_ends(struct finder *f, unsigned char *own)
{
	const struct tree *t = f->x->tree;
	int longest = f->x->options->precision == RNEAGEN_F32 ? LONGEST_SINGLE : LONGEST_DOUBLE;

	for (int k = t->body_count; k-- > 0;) {
		int depth = depth_of(t, k), length = depth / ((depth + longest - 1) / longest), first = k;

		if (depth <= longest || !is_end(f, k))
			continue;
		while (--length > 0)
			first = t->bodies[first].parent;
		if (!has_hand(f, first) && !finder_try(f, t->bodies[first].parent, first, tree_end(t, first), own))
			return 0;
	}
	return 1;
}

/* ---- all hands ---- */

static int has_base(const struct parts_of *x)
{
	return x->tree->nq != x->tree->nv;
}

/* tau alone, or in soa with its vjp, since rows hold what is handed on. */
static int has_rows(const struct parts_of *x, unsigned flops)
{
	const struct rneagen_options *o = x->options;
	const struct dag *d = x->raw;
	int has_tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1) >= 0, has_vjp = dag_find_role(d, ROLE_VJP, 1) == parts_handed(d),
	    outputs = 0;

	for (int i = 0; i < d->argument_count; i++)
		outputs += d->arguments[i].is_output;
	if (has_vjp && (o->layout != RNEAGEN_SOA || (o->precision == RNEAGEN_F32 && !has_base(x) && flops < LEAST_PRODUCT_SINGLE)))
		return 0;
	return flops >= LEAST && outputs > 0 && outputs == has_tau + has_vjp;
}

/* Not in mixed precision, where a row has fewer bits; in f32 where the whole is full. Which of two products is joined to their
   sum goes by how often each is used, which two kernels count anew: so not where the same bits are wanted. Says whether the whole
   is full. */
static int may_have(struct hands *h, const struct parts_of *x, struct arena *a)
{
	const struct rneagen_options *o = x->options;

	if (o->strict || (o->precision == RNEAGEN_F32 && o->layout == RNEAGEN_AOS) || (has_base(x) && !base_sides_may(x)) ||
		!has_rows(x, plan_flops(plan_operations(&x->whole->plan))))
		return 0;
	h->is_full = plan_alive(&x->whole->plan, a) > FULL;
	return o->precision == RNEAGEN_F64 || (o->precision == RNEAGEN_F32 && h->is_full);
}

/* One more kernel, if `find` finds hands for it. */
static int find_level(struct finder *f, int (*find)(struct finder *f, unsigned char *own), unsigned char *own)
{
	struct hands *h = f->h;
	struct hand_level *level = &h->levels[h->level_count];
	int begin = h->count;

	f->beyond = arena_alloc(f->a, f->d->count, 1);
	f->from = arena_alloc(f->a, f->d->count, 1);
	f->to = arena_alloc(f->a, f->d->count, 1);
	f->kind = arena_alloc(f->a, f->d->count, 1);
	f->meets = arena_alloc(f->a, f->d->count, 1);
	if (f->a->failed || !find(f, own))
		return 0;
	if (h->count == begin)
		return 1;
	if (!finder_share(f, level, begin) || !finder_rest(f, level, begin))
		return 0;
	f->d = &level->rest;
	h->level_count++;
	return 1;
}

static int begin(struct finder *f)
{
	size_t bodies = (size_t)f->x->tree->body_count;

	f->h->list = arena_alloc(f->a, bodies, sizeof *f->h->list);
	f->h->levels = arena_alloc(f->a, HAND_LEVELS, sizeof *f->h->levels);
	f->children = arena_alloc(f->a, bodies, sizeof *f->children);
	f->taken = arena_alloc(f->a, bodies, 1);
	f->rows = arena_alloc(f->a, (size_t)finder_rows(f->d) + 1, 1);
	f->h->is_base = f->is_base;
	if (!f->a->failed && f->is_base)
		base_sides_bar(f);
	return !f->a->failed;
}

int hands_find(struct hands *h, const struct parts_of *x, struct arena *a)
{
	struct finder f = {.x = x, .d = x->raw, .h = h, .a = a, .is_base = has_base(x)};
	unsigned char *own = arena_alloc(a, (size_t)finder_rows(f.d) + 1, 1);
	int count;

	*h = (struct hands){0};
	if (!may_have(h, x, a))
		return 1;
	if (!begin(&f) || !find_level(&f, f.is_base ? base_sides_find : find_branches, own))
		return 0;
	if (f.is_base)
		return 1;
	do {
		count = h->count;
		if (!find_level(&f, find_ends, own))
			return 0;
	} while (h->count > count && h->level_count < HAND_LEVELS);
	return 1;
}

int hands_find_felt(struct hands *h, const struct dag *base, const struct parts_of *x, struct arena *a)
{
	struct finder f = {.x = x, .d = base, .h = h, .a = a, .is_base = 1, .is_felt = 1};
	unsigned char *own = arena_alloc(a, (size_t)finder_rows(base) + 1, 1);

	*h = (struct hands){0};
	return own && begin(&f) && find_level(&f, base_sides_find, own);
}
