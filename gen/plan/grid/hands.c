#include "plan/grid/hands.h"
#include <string.h>

/* Operations of the whole, and of a hand. H100, 1 M samples, ps, one kernel and two: g1_brainco, 9010 operations, f64 2447 and 1064,
   in aos 3745 and 1515; but f32 462 and 522, and in aos, where the rows of a part stand apart, 663 and 1091. */
enum { LEAST = 5000, LEAST_HAND = 500 };

struct finder {
	const struct parts_of *x;
	const struct dag *d;
	struct hands *h;
	struct arena *a;
	int *children;       /* by body */
	unsigned char *rows; /* by row of tau: it belongs to a hand, or is taken by what one hands on */
	unsigned char *beyond, *from, *to;
};

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
	for (int k = m->body + 1; k <= m->last; k++)
		memset(own + t->bodies[k].iv, 1, (size_t)joint_nv(t->bodies[k].type));
	for (int k = 0; k < t->body_count; k++)
		if ((k <= m->body || k > m->last) && joint_nv(t->bodies[k].type) && own[t->bodies[k].iv])
			return 0;
	return 1;
}

/* Rows of the arm, from the hand on, for what is handed on. Returns 0 where there are too few. */
static int choose_rows(struct finder *f, struct hand *m)
{
	const struct body *bodies = f->x->tree->bodies;
	int k = m->body;

	for (int i = 0; i < m->cut.count; i++, k = bodies[k].parent) {
		if (k < 0 || !is_single(&bodies[k]) || f->rows[bodies[k].iv])
			return 0;
		m->rows[i] = bodies[k].iv;
	}
	return m->cut.count > 0;
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
		f->to[d->outputs[i].value.i] |= own[d->outputs[i].row];
	dag_mark_operands(d, d->count, f->to);
	for (size_t i = 0; i < d->count; i++) {
		f->beyond[i] = f->from[i];
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			f->beyond[i] |= f->beyond[d->nodes[i].arg[k].i];
		count += f->beyond[i] && f->to[i];
	}
	return count;
}

/* Returns 0 when memory runs out; a hand that is none has no cut. */
static int cut_hand(struct finder *f, struct hand *m, unsigned char *own)
{
	const struct dag *d = f->d;

	m->cut.count = 0;
	if (!mark_rows(f, m, own))
		return 1;
	memset(f->to, 0, d->count);
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		f->from[i] = n->op == OP_INPUT && n->arg[0].i < DAG_ARGUMENTS &&
			role_rows(d->arguments[n->arg[0].i].role) != ROWS_ANY && d->arguments[n->arg[0].i].rows == f->x->tree->nv &&
			own[n->arg[1].i];
	}
	for (size_t i = 0; i < d->output_count; i++)
		f->to[d->outputs[i].value.i] |= !own[d->outputs[i].row];
	if (!cut_find(&m->cut, d, f->from, f->to, f->a))
		return 0;
	if (!choose_rows(f, m) || operations_of(f, m, own) < LEAST_HAND)
		m->cut.count = 0;
	return 1;
}

static int find_hands(struct finder *f)
{
	const struct tree *t = f->x->tree;
	unsigned char *own = arena_alloc(f->a, (size_t)t->nv + 1, 1);
	int last = t->body_count; /* where the last hand that was found begins */

	for (int k = 0; k < t->body_count; k++)
		if (t->bodies[k].parent >= 0)
			f->children[t->bodies[k].parent]++;
	for (int k = t->body_count; k-- > 0 && !f->a->failed;) {
		struct hand *m = &f->h->list[f->h->count];
		int end = k + 1;

		while (end < t->body_count && t->bodies[end].parent >= k)
			end++;
		if (f->children[k] < 2 || end > last)
			continue;
		*m = (struct hand){.body = k, .last = end - 1};
		last = k;
		if (!cut_hand(f, m, own))
			return 0;
		if (!m->cut.count)
			continue;
		for (int row = 0; row < t->nv; row++)
			f->rows[row] |= own[row];
		for (int i = 0; i < m->cut.count; i++)
			f->rows[m->rows[i]] = 1;
		f->h->count++;
	}
	return !f->a->failed;
}

/* ---- what the kernels make ---- */

/* The hand that writes the torque of a row; -1: none does. */
static int hand_of(const struct hands *h, const struct tree *t, int row)
{
	int body = -1;

	for (int k = 0; k < t->body_count && body < 0; k++)
		if (joint_nv(t->bodies[k].type) && t->bodies[k].iv <= row && row < t->bodies[k].iv + joint_nv(t->bodies[k].type))
			body = k;
	for (int i = 0; i < h->count; i++)
		if (body > h->list[i].body && body <= h->list[i].last)
			return i;
	return -1;
}

static int share_outputs(struct finder *f)
{
	struct hands *h = f->h;
	const struct dag *d = f->d;
	size_t most = d->output_count + (size_t)h->count * CUT_MOST;
	struct output *outputs = arena_alloc(f->a, most, sizeof *outputs);

	h->owner = arena_alloc(f->a, most, sizeof *h->owner);
	if (!outputs || !h->owner)
		return 0;
	h->first = *d;
	h->first.outputs = memcpy(outputs, d->outputs, d->output_count * sizeof *outputs);
	for (size_t i = 0; i < d->output_count; i++)
		h->owner[i] = hand_of(h, f->x->tree, d->outputs[i].row);
	for (int k = 0; k < h->count; k++)
		for (int i = 0; i < h->list[k].cut.count; i++) {
			h->owner[h->first.output_count] = k;
			outputs[h->first.output_count++] =
				(struct output){d->outputs[0].argument, h->list[k].rows[i], {h->list[k].cut.nodes[i]}};
		}
	return 1;
}

/* A copy without the hands, in which what they hand on is read from tau. */
static int make_second(struct finder *f)
{
	struct hands *h = f->h;
	const struct dag *d = f->d;
	int *none = arena_alloc(f->a, d->output_count, sizeof *none);
	struct dag read = *d;
	struct share share;

	read.nodes = arena_alloc(f->a, d->count, sizeof *read.nodes);
	if (!read.nodes || !none)
		return 0;
	memcpy(read.nodes, d->nodes, d->count * sizeof *read.nodes);
	for (int k = 0; k < h->count; k++)
		for (int i = 0; i < h->list[k].cut.count; i++) {
			struct node *n = &read.nodes[h->list[k].cut.nodes[i]];

			*n = (struct node){.op = OP_INPUT, .arg = {{(uint32_t)d->outputs[0].argument}, {(uint32_t)h->list[k].rows[i]}},
				.tag = n->tag};
		}
	for (size_t i = 0; i < d->output_count; i++)
		none[i] = h->owner[i];
	if (!share_begin(&share, &read, none, f->a))
		return 0;
	share_copy(&share, -1, 0, &h->second, f->a);
	return !h->second.failed;
}

int hands_are_read_first(const struct plan *p, const struct hands *h)
{
	for (int k = 0; k < h->count; k++) {
		int is_written = 0;

		for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
			const struct node *n = &p->dag->nodes[l->value.i];

			for (int i = 0; i < h->list[k].cut.count; i++)
				if (l->kind == LINE_STORE)
					is_written |= p->dag->outputs[l->index].row == h->list[k].rows[i];
				else if (l->kind == LINE_INPUT && p->dag->arguments[n->arg[0].i].is_output &&
					(int)n->arg[1].i == h->list[k].rows[i] && is_written)
					return 0;
		}
	}
	return 1;
}

/* tau alone, since its rows hold what is handed on; in f64, for in mixed precision a row has fewer bits, and f32 loses. Which of
   two products is joined to their sum goes by how often each is used, which two kernels count anew: so not where the same bits
   are wanted. */
static int may_have(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;
	int outputs = 0, tau = dag_find_role(x->raw, ROLE_JOINT_TORQUE, 1);

	for (int i = 0; i < x->raw->argument_count; i++)
		outputs += x->raw->arguments[i].is_output;
	if (o->strict || outputs != 1 || tau < 0 || x->tree->nq != x->tree->nv)
		return 0;
	return o->precision == RNEAGEN_F64 && plan_flops(plan_operations(&x->whole->plan)) >= LEAST;
}

int hands_find(struct hands *h, const struct parts_of *x, struct arena *a)
{
	const struct dag *d = x->raw;
	size_t bodies = (size_t)x->tree->body_count;
	struct finder f = {.x = x, .d = d, .h = h, .a = a};

	*h = (struct hands){0};
	if (!may_have(x))
		return 1;
	h->list = arena_alloc(a, bodies, sizeof *h->list);
	f.children = arena_alloc(a, bodies, sizeof *f.children);
	f.rows = arena_alloc(a, (size_t)x->tree->nv + 1, 1);
	f.beyond = arena_alloc(a, d->count, 1);
	f.from = arena_alloc(a, d->count, 1);
	f.to = arena_alloc(a, d->count, 1);
	if (a->failed || !find_hands(&f))
		return 0;
	return !h->count || (share_outputs(&f) && make_second(&f));
}
