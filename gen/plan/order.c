/* Another order of the lines, in which fewer values wait. What a sweep over the whole DAG makes, a vjp above all, comes
   after all that it reads: nearly every value of the tour would wait for it. Here the rows of the last joints come
   first, each with what it takes and nothing else, and a line is written as soon as no more values wait after it than
   before. */
#include "plan/readings.h"
#include <string.h>

/* An order is taken in which this much of the values wait, summed over the lines, and in which those that wait at once
   have room in registers or are this much of the DAG's own. H100, 1 M samples, ps, old and new: tau and vjp of atlas
   555, 396, of g1_29dof 790, 422, in f64 19400, 3110; qdd with gradients of hyq 263, 213, f64 540, 491. What is left
   out: Minv of atlas in f64, 174 of 232 at once, 1508, 2910; qdd of g1_29dof, 247 of 238, 329, 344. */
static const double FEWER_IN_ALL = 0.8, FEWER_AT_ONCE = 0.6;
enum { ROOM_SINGLE = 230, ROOM_DOUBLE = 110 };

struct orderer {
	const struct plan *p;
	const struct tree *t;
	struct readings r;
	uint32_t *begin, *readers; /* of a node: lines; nodes + 1 of them */
	uint32_t *left;            /* by node: lines that will read it */
	uint32_t *wait;            /* by line: readings that are not made yet */
	uint32_t *need;            /* by line: values that are at hand at once while it is made (Sethi and Ullman 1970) */
	unsigned char *done;       /* by line */
	uint32_t *order, count;    /* lines */
	int *row_at;               /* by place in that order: the row of qd for which the line was written */
	uint32_t *stack, *ready;
	int row;
};

/* ---- what reads what ---- */

static void find_left(struct orderer *x)
{
	for (size_t i = 0; i < x->p->dag->count; i++)
		x->left[i] = x->begin[i + 1] - x->begin[i];
}

static void find_readers(struct orderer *x)
{
	const struct readings *r = &x->r;
	size_t lines = x->p->line_count;

	for (uint32_t k = 0; k < r->begin[lines]; k++)
		x->left[r->list[k].node]++;
	for (size_t i = 0; i < x->p->dag->count; i++)
		x->begin[i + 1] = x->begin[i] + x->left[i];
	for (uint32_t i = 0; i < lines; i++) {
		x->wait[i] = r->begin[i + 1] - r->begin[i];
		for (uint32_t k = r->begin[i]; k < r->begin[i + 1]; k++)
			x->readers[x->begin[r->list[k].node]++] = i;
	}
	for (size_t i = x->p->dag->count; i-- > 0;)
		x->begin[i] -= x->left[i];
}

/* With the neediest operand first, each next one has one value more beside it. */
static uint32_t need_of(const struct orderer *x, uint32_t line)
{
	const struct readings *r = &x->r;
	uint32_t need = 1;

	for (uint32_t k = r->begin[line]; k < r->begin[line + 1]; k++) {
		uint32_t own = x->need[r->made[r->list[k].node]], before = 0;

		for (uint32_t i = r->begin[line]; i < r->begin[line + 1]; i++) {
			uint32_t other = x->need[r->made[r->list[i].node]];

			before += other > own || (other == own && i < k);
		}
		need = own + before > need ? own + before : need;
	}
	return need;
}

static int alloc(struct orderer *x, struct arena *a)
{
	size_t lines = x->p->line_count, nodes = x->p->dag->count, readings;

	if (!readings_make(&x->r, x->p, a))
		return 0;
	readings = x->r.begin[lines];
	x->begin = arena_alloc(a, nodes + 1, sizeof *x->begin);
	x->readers = arena_alloc(a, readings + 1, sizeof *x->readers);
	x->left = arena_alloc(a, nodes, sizeof *x->left);
	x->wait = arena_alloc(a, lines, sizeof *x->wait);
	x->need = arena_alloc(a, lines, sizeof *x->need);
	x->done = arena_alloc(a, lines, 1);
	x->order = arena_alloc(a, lines, sizeof *x->order);
	x->row_at = arena_alloc(a, lines, sizeof *x->row_at);
	x->stack = arena_alloc(a, lines, sizeof *x->stack);
	x->ready = arena_alloc(a, 2 * readings + lines, sizeof *x->ready);
	if (a->failed)
		return 0;
	find_readers(x);
	for (uint32_t i = 0; i < lines; i++)
		x->need[i] = need_of(x, i);
	return 1;
}

/* ---- the order ---- */

/* How many values more wait after the line than before it. */
static int growth(const struct orderer *x, uint32_t line)
{
	struct ref made[2];
	int more = readings_made(x->p, &x->p->lines[line], made);

	for (uint32_t k = x->r.begin[line]; k < x->r.begin[line + 1]; k++)
		more -= x->left[x->r.list[k].node] == 1;
	return more;
}

static int is_due(const struct orderer *x, uint32_t line)
{
	return !x->done[line] && !x->wait[line] && x->r.begin[line] < x->r.begin[line + 1] && growth(x, line) <= 0;
}

/* Puts the readers of a node that are due on the heap of those to look at. */
static uint32_t offer(struct orderer *x, uint32_t node, uint32_t count)
{
	for (uint32_t k = x->begin[node]; k < x->begin[node + 1]; k++)
		if (is_due(x, x->readers[k]))
			x->ready[count++] = x->readers[k];
	return count;
}

static uint32_t write_line(struct orderer *x, uint32_t line, uint32_t count)
{
	struct ref made[2];
	int values = readings_made(x->p, &x->p->lines[line], made);

	x->done[line] = 1;
	x->row_at[x->count] = x->row;
	x->order[x->count++] = line;
	for (int i = 0; i < values; i++)
		for (uint32_t k = x->begin[made[i].i]; k < x->begin[made[i].i + 1]; k++)
			x->wait[x->readers[k]]--;
	for (uint32_t k = x->r.begin[line]; k < x->r.begin[line + 1]; k++)
		x->left[x->r.list[k].node]--;
	for (int i = 0; i < values; i++)
		count = offer(x, made[i].i, count);
	for (uint32_t k = x->r.begin[line]; k < x->r.begin[line + 1]; k++)
		if (x->left[x->r.list[k].node] == 1)
			count = offer(x, x->r.list[k].node, count);
	return count;
}

/* A line, and those that are due then. */
static void write_due(struct orderer *x, uint32_t line)
{
	uint32_t count = write_line(x, line, 0);

	while (count > 0) {
		uint32_t next = x->ready[--count];

		if (is_due(x, next))
			count = write_line(x, next, count);
	}
}

/* The neediest operand that is not made yet; the line itself where all are. */
static uint32_t next_of(const struct orderer *x, uint32_t line)
{
	uint32_t found = line;

	for (uint32_t k = x->r.begin[line]; k < x->r.begin[line + 1]; k++) {
		uint32_t i = x->r.made[x->r.list[k].node];

		if (!x->done[i] && (found == line || x->need[i] > x->need[found]))
			found = i;
	}
	return found;
}

static void write_with_operands(struct orderer *x, uint32_t line)
{
	size_t depth = 0;

	x->stack[depth++] = line;
	while (depth > 0) {
		uint32_t top = x->stack[depth - 1], next = next_of(x, top);

		if (!x->done[top] && next != top) {
			x->stack[depth++] = next;
			continue;
		}
		if (!x->done[top])
			write_due(x, top);
		depth--;
	}
}

/* The row of qd that a stored row belongs to; a row of what is no joint's counts from the end. */
static int row_of(const struct orderer *x, const struct line *l)
{
	const struct output *o = &x->p->dag->outputs[l->index];
	int last = x->t->nv - 1;

	if (x->p->dag->arguments[o->argument].role == ROLE_VJP)
		return o->row % x->t->nv;
	return o->row < last ? o->row : last;
}

static void write_all(struct orderer *x)
{
	find_left(x);
	for (x->row = x->t->nv - 1; x->row >= 0; x->row--)
		for (uint32_t i = 0; i < x->p->line_count; i++)
			if (x->p->lines[i].kind == LINE_STORE && !x->done[i] && row_of(x, &x->p->lines[i]) == x->row)
				write_with_operands(x, i);
}

/* Values that wait behind the lines. */
struct waiting {
	size_t most, sum;
};

/* Of the plan's own lines where `order` is NULL. */
static struct waiting waiting_in(struct orderer *x, const uint32_t *order)
{
	struct waiting w = {0};
	size_t now = 0;

	find_left(x);
	for (uint32_t i = 0; i < (order ? x->count : x->p->line_count); i++) {
		uint32_t line = order ? order[i] : i;
		struct ref made[2];

		now += (size_t)readings_made(x->p, &x->p->lines[line], made);
		for (uint32_t k = x->r.begin[line]; k < x->r.begin[line + 1]; k++)
			now -= --x->left[x->r.list[k].node] == 0;
		w.sum += now;
		w.most = now > w.most ? now : w.most;
	}
	return w;
}

static int is_better(struct waiting w, struct waiting own, size_t room)
{
	return (double)w.sum <= FEWER_IN_ALL * (double)own.sum &&
		(w.most <= room || (double)w.most <= FEWER_AT_ONCE * (double)own.most);
}

/* ---- the DAG in that order ---- */

static void copy_node(struct dag *out, const struct dag *d, uint32_t i, struct ref *map)
{
	const struct node *n = &d->nodes[i];
	struct ref arg[3] = {{0}};

	if (i == 0 || map[i].i)
		return;
	for (int k = 0; k < op_arity[n->op]; k++) {
		copy_node(out, d, n->arg[k].i, map);
		arg[k] = map[n->arg[k].i];
	}
	out->is_wide = n->is_wide;
	map[i] = op_arity[n->op] ? dag_node(out, n->op, arg[0], arg[1], arg[2], 0) : dag_copy_leaf(out, d, i);
	if (n->tag.quantity[0])
		dag_tag(out, map[i], n->tag.quantity, n->tag.body, n->tag.component);
}

static void copy_line(const struct orderer *x, const struct line *l, struct dag *out, struct ref *map)
{
	const struct dag *d = x->p->dag;
	struct ref made[2];

	for (int k = 0, values = readings_made(x->p, l, made); k < values; k++)
		copy_node(out, d, made[k].i, map);
	if (l->kind != LINE_STORE)
		return;
	copy_node(out, d, l->value.i, map);
	dag_output(out, d->outputs[l->index].argument, d->outputs[l->index].row, map[l->value.i]);
}

/* With a section for the rows of each joint. */
static void copy_all(const struct orderer *x, struct dag *out, struct ref *map)
{
	int body = -1;

	for (int i = 0; i < x->p->dag->argument_count; i++)
		dag_argument_of(out, x->p->dag->arguments[i]);
	for (uint32_t i = 0; i < x->count; i++) {
		int next = tree_joint_of_row(x->t, x->row_at[i])->body;

		if (next != body)
			dag_section(out, SECTION_ROWS, next);
		body = next;
		copy_line(x, &x->p->lines[x->order[i]], out, map);
	}
	out->is_wide = 0;
}

static int takes_over(const struct orderer *x, struct pass *p, struct arena *a, struct arena *spare)
{
	struct ref *map = arena_alloc(spare, p->dag.count, sizeof *map);
	struct dag out;

	if (!map)
		return 0;
	dag_init(&out, a);
	copy_all(x, &out, map);
	if (out.failed)
		return 0;
	p->dag = out;
	return plan_build(&p->plan, &p->dag, x->t, a);
}

int plan_order(struct pass *p, const struct tree *t, const struct rneagen_options *o, struct arena *a)
{
	struct orderer x = {.p = &p->plan, .t = t};
	size_t room = o->precision == RNEAGEN_F32 ? ROOM_SINGLE : ROOM_DOUBLE;
	struct waiting own;
	struct arena spare;
	int done;

	arena_init(&spare, &a->allocator);
	done = alloc(&x, &spare);
	if (done) {
		own = waiting_in(&x, NULL);
		write_all(&x);
		done = !is_better(waiting_in(&x, x.order), own, room) || takes_over(&x, p, a, &spare);
	}
	arena_free(&spare);
	return done;
}
