/* Writes lines: the rows of the last joints first, each with what it takes and nothing else, or what the first joints are enough
   for; and a line as soon as no more values wait after it than before. */
#include "plan/order.h"
#include <string.h>

/* ---- what reads what ---- */

void order_find_left(struct orderer *x)
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
	for (uint32_t i = 0; i < lines; i++)
		for (uint32_t k = r->begin[i]; k < r->begin[i + 1]; k++)
			x->readers[x->begin[r->list[k].node]++] = i;
	for (size_t i = x->p->dag->count; i-- > 0;)
		x->begin[i] -= x->left[i];
}

static unsigned char taken_by(const struct dag *d, const struct node *n)
{
	enum role role;

	if (n->op != OP_INPUT)
		return 0;
	role = d->arguments[n->arg[0].i].role;
	return role == ROLE_JOINT_VELOCITY ? TAKES_VELOCITIES : role == ROLE_JOINT_TORQUE ? TAKES_TORQUES : 0;
}

static void find_taken(struct orderer *x)
{
	const struct dag *d = x->p->dag;

	for (size_t i = 0; i < d->count; i++) {
		x->takes[i] = taken_by(d, &d->nodes[i]);
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			x->takes[i] |= x->takes[d->nodes[i].arg[k].i];
	}
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

int order_begin(struct orderer *x, struct arena *a)
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
	x->takes = arena_alloc(a, nodes, 1);
	x->reach = arena_alloc(a, nodes, sizeof *x->reach);
	x->cone = arena_alloc(a, lines, sizeof *x->cone);
	x->done = arena_alloc(a, lines, 1);
	x->order = arena_alloc(a, lines, sizeof *x->order);
	x->row_at = arena_alloc(a, lines, sizeof *x->row_at);
	x->stack = arena_alloc(a, lines, sizeof *x->stack);
	x->ready = arena_alloc(a, 2 * readings + lines, sizeof *x->ready);
	if (a->failed)
		return 0;
	find_readers(x);
	find_taken(x);
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
	return line < x->end && !x->done[line] && !x->wait[line] && x->r.begin[line] < x->r.begin[line + 1] && growth(x, line) <= 0;
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
	const struct argument *a = &x->p->dag->arguments[o->argument];
	int last = x->t->nv - 1;

	if (a->role == ROLE_VJP || (a->role == ROLE_JVP && !strcmp(a->of, "vjp"))) /* by q, qd and qdd */
		return o->row % x->t->nv;
	return o->row < last ? o->row : last;
}

/* What is known without the torques, and takes velocities, where torques come in on the way to a line: the bias of forward
   dynamics. */
static void write_bias(struct orderer *x, uint32_t line)
{
	x->cone[line] = ++x->cones;
	for (uint32_t i = line + 1; i-- > 0;) {
		if (x->cone[i] != x->cones || x->done[i] || !(x->takes[x->p->lines[i].value.i] & TAKES_TORQUES))
			continue;
		for (uint32_t k = x->r.begin[i]; k < x->r.begin[i + 1]; k++) {
			uint32_t node = x->r.list[k].node, operand = x->r.made[node];

			x->cone[operand] = x->cones;
			if (x->takes[node] == TAKES_VELOCITIES && !x->done[operand])
				write_with_operands(x, operand);
		}
	}
}

static void begin_writing(struct orderer *x, uint32_t end)
{
	x->count = 0;
	x->end = end;
	for (uint32_t i = 0; i < x->p->line_count; i++) {
		x->wait[i] = x->r.begin[i + 1] - x->r.begin[i];
		x->done[i] = 0;
	}
	order_find_left(x);
}

/* Joint after joint, all lines that the inputs up to its own are enough for. */
static void write_by_inputs(struct orderer *x)
{
	readings_reach(x->reach, x->p->dag, x->t);
	for (x->row = 0; x->row < x->t->nv; x->row++)
		for (uint32_t i = 0; i < x->p->line_count; i++) {
			const struct line *l = &x->p->lines[i];

			if (!x->done[i] && l->kind != LINE_SECTION && l->kind != LINE_INPUT && x->reach[l->value.i] <= x->row)
				write_with_operands(x, i);
		}
}

static void write_by_rows(struct orderer *x, enum order_way way)
{
	for (x->row = x->t->nv - 1; x->row >= 0; x->row--)
		for (uint32_t i = 0; i < x->p->line_count; i++) {
			if (x->p->lines[i].kind != LINE_STORE || x->done[i] || row_of(x, &x->p->lines[i]) != x->row)
				continue;
			if (way == ORDER_BIAS)
				write_bias(x, i);
			write_with_operands(x, i);
		}
}

void order_write(struct orderer *x, enum order_way way)
{
	begin_writing(x, (uint32_t)x->p->line_count);
	x->way = way;
	if (way == ORDER_INPUTS)
		write_by_inputs(x);
	else
		write_by_rows(x, way);
}

void order_write_early(struct orderer *x, uint32_t end)
{
	begin_writing(x, end);
	for (uint32_t i = 0; i < x->p->line_count; i++)
		if (!x->done[i])
			write_due(x, i);
}
