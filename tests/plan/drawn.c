#include "plan/drawn.h"
#include <stdlib.h>
#include <string.h>

enum { LATE_NODES = 6 };

void drawn_inputs(struct dag *d, int argument, int rows)
{
	for (int row = 0; row < rows; row++)
		dag_input(d, argument, row);
}

static struct ref operand(const struct dag *d, struct rng *r)
{
	int nodes = (int)d->count - 1, late = nodes < LATE_NODES ? nodes : LATE_NODES;

	return (struct ref){(uint32_t)(rng_chance(r, 0.6) ? nodes - rng_below(r, late) : 1 + rng_below(r, nodes))};
}

void drawn_operations(struct dag *d, struct rng *r, int count)
{
	static const enum op ops[] = {OP_NEG, OP_ADD, OP_ADD, OP_SUB, OP_MUL, OP_MUL, OP_FMA, OP_SIN, OP_COS};
	const struct ref none = {0};
	size_t end = d->count + (size_t)count;

	for (int tries = 0; d->count < end && tries < 20 * count; tries++) {
		enum op op = ops[rng_below(r, sizeof ops / sizeof *ops)];
		struct ref arg[3] = {none, none, none};

		for (int k = 0; k < op_arity[op]; k++)
			arg[k] = operand(d, r);
		if (op == OP_COS && d->count + 1 == end)
			continue;
		if (op == OP_COS)
			dag_node(d, OP_SIN, arg[0], none, none, 0);
		dag_node(d, op, arg[0], arg[1], arg[2], 0);
	}
}

static int is_read(const struct dag *d, uint32_t node)
{
	for (size_t i = 0; i < d->count; i++)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			if (d->nodes[i].arg[k].i == node)
				return 1;
	return 0;
}

void drawn_outputs(struct dag *d, struct rng *r, int argument)
{
	int row = 0;

	for (uint32_t i = 1; i < d->count; i++)
		if (node_is_operation(&d->nodes[i]) && (!is_read(d, i) || rng_chance(r, 0.1)))
			for (int times = rng_chance(r, 0.1) ? 2 : 1; times > 0; times--)
				dag_output(d, argument, row++, (struct ref){i});
	d->arguments[argument].rows = row > d->arguments[argument].rows ? row : d->arguments[argument].rows;
}

/* ---- lines ---- */

static int is_sine(const struct node *n)
{
	return n->op == OP_SIN || n->op == OP_COS;
}

static void mark(const struct dag *d, uint32_t node, unsigned char *marks)
{
	marks[node] = 1;
	for (int k = 0; k < op_arity[d->nodes[node].op]; k++)
		mark(d, d->nodes[node].arg[k].i, marks);
}

static void name_values(struct plan *p, struct rng *r, const struct drawn_knobs *k)
{
	const struct dag *d = p->dag;
	unsigned char *stored = calloc(d->count, 1);

	for (size_t i = 0; i < d->output_count && stored; i++)
		mark(d, d->outputs[i].value.i, stored);
	for (uint32_t i = 1; i < d->count && stored; i++) {
		const struct node *n = &d->nodes[i];
		int is_named = n->op == OP_INPUT ? rng_chance(r, k->named_inputs) : is_sine(n) || rng_chance(r, k->named);

		p->names[i] = stored[i] && n->op != OP_CONST && is_named ? "x" : NULL;
	}
	free(stored);
}

int drawn_made(const struct plan *p, const struct line *l, uint32_t made[2])
{
	int count = 0;

	if (l->kind == LINE_INPUT || l->kind == LINE_VALUE || l->kind == LINE_FETCH || l->kind == LINE_SINE)
		made[count++] = l->value.i;
	for (uint32_t i = 0; i < p->dag->count && l->kind == LINE_SINCOS; i++)
		if (p->names[i] && is_sine(&p->dag->nodes[i]) && p->dag->nodes[i].arg[0].i == p->dag->nodes[l->value.i].arg[0].i)
			made[count++] = i;
	return count;
}

static void read_node(const struct plan *p, uint32_t node, int is_made_here, unsigned char *reads)
{
	const struct node *n = &p->dag->nodes[node];

	if (!is_made_here && (p->names[node] || n->op == OP_INPUT)) {
		reads[node] = 1;
		return;
	}
	for (int k = 0; k < op_arity[n->op]; k++)
		read_node(p, n->arg[k].i, 0, reads);
}

void drawn_reads(const struct plan *p, const struct line *l, unsigned char *reads)
{
	memset(reads, 0, p->dag->count);
	if (l->kind == LINE_VALUE || l->kind == LINE_SINCOS || l->kind == LINE_STORE || l->kind == LINE_KEEP)
		read_node(p, l->value.i, l->kind == LINE_VALUE || l->kind == LINE_SINCOS, reads);
}

static int has_all(const struct plan *p, const struct line *l, const unsigned char *has, unsigned char *reads)
{
	drawn_reads(p, l, reads);
	for (size_t i = 0; i < p->dag->count; i++)
		if (reads[i] && p->names[i] && !has[i])
			return 0;
	return 1;
}

size_t drawn_first_too_early(const struct plan *p)
{
	unsigned char *has = calloc(2 * p->dag->count, 1), *reads = has + p->dag->count;
	size_t l = 0;

	for (; has && l < p->line_count && has_all(p, &p->lines[l], has, reads); l++) {
		uint32_t made[2];

		for (int k = drawn_made(p, &p->lines[l], made); k-- > 0;)
			has[made[k]] = 1;
	}
	free(has);
	return l;
}

/* All lines, in the order of the DAG. */
static void add_lines(struct plan *p)
{
	const struct dag *d = p->dag;

	for (uint32_t i = 1; i < d->count; i++) {
		enum line_kind kind = d->nodes[i].op == OP_INPUT ? LINE_INPUT : is_sine(&d->nodes[i]) ? LINE_SINCOS : LINE_VALUE;
		struct line l = {kind, {i}, 0};
		uint32_t made[2] = {i, i};

		if (p->names[i] && drawn_made(p, &l, made) && made[0] == i)
			p->lines[p->line_count++] = l;
	}
	for (size_t i = 0; i < d->output_count; i++)
		p->lines[p->line_count++] = (struct line){LINE_STORE, d->outputs[i].value, i};
}

/* One of the lines from `first` on that may come next is put there. */
static void draw_next(struct plan *p, size_t first, struct rng *r, double late, const unsigned char *has, unsigned char *reads)
{
	size_t chosen = first, may = 0;

	for (int others = rng_chance(r, late); !may && others >= 0; others--)
		for (size_t l = first; l < p->line_count; l++) {
			if ((others && p->lines[l].kind == LINE_STORE) || !has_all(p, &p->lines[l], has, reads))
				continue;
			if (rng_below(r, (int)++may) == 0)
				chosen = l;
		}
	struct line l = p->lines[chosen];
	p->lines[chosen] = p->lines[first];
	p->lines[first] = l;
}

void drawn_plan(struct plan *p, const struct dag *d, struct rng *r, const struct drawn_knobs *k, struct arena *a)
{
	unsigned char *has = calloc(2 * d->count, 1);

	*p = (struct plan){.dag = d, .names = arena_alloc(a, d->count, sizeof *p->names),
		.lines = arena_alloc(a, d->count + d->output_count, sizeof *p->lines)};
	name_values(p, r, k);
	add_lines(p);
	for (size_t l = 0; l < p->line_count && has; l++) {
		uint32_t made[2];

		draw_next(p, l, r, k->late, has, has + d->count);
		for (int i = drawn_made(p, &p->lines[l], made); i-- > 0;)
			has[made[i]] = 1;
	}
	free(has);
}
