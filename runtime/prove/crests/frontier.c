#include "prove/crests/frontier.h"
#include <stdlib.h>
#include <string.h>

/* Of a node: the peak reads it; it depends on drives, rates or the frontier; it is multiplied by what does. */
enum { LIVE = 1, OF_INPUTS = 2, MULTIPLIED = 4 };

enum { MOST_RATES = 17 };

struct cutting {
	const struct peaks *p;
	const struct peak *k;
	unsigned char *marks;
	struct ref *map;
	uint32_t leaves[FRONTIER_NODES];
	int leaf_count, rates, drives; /* arguments of the leaves */
};

static int is_constant(const struct dag *d, struct ref a)
{
	return d->nodes[a.i].op == OP_CONST;
}

/* A multiple of another is none of its own. */
static int is_leaf(const struct cutting *c, uint32_t i)
{
	const struct dag *d = &c->p->x->d;
	const struct node *n = &d->nodes[i];
	int is_multiple = n->op == OP_NEG || (n->op == OP_MUL && (is_constant(d, n->arg[0]) || is_constant(d, n->arg[1])));

	return c->p->reads[i] && !(c->p->reads[i] & ~c->k->cut) && !is_multiple;
}

/* Marks what the live nodes read, up to the frontier. Returns 0 where that has too many nodes. */
static int walk(struct cutting *c)
{
	const struct dag *d = &c->p->x->d;

	for (uint32_t i = (uint32_t)d->count; i-- > 1;) {
		if (!c->marks[i])
			continue;
		if (is_leaf(c, i)) {
			if (c->leaf_count == FRONTIER_NODES)
				return 0;
			c->leaves[c->leaf_count++] = i;
			c->marks[i] |= OF_INPUTS;
			continue;
		}
		if (d->nodes[i].op == OP_INPUT && (int)d->nodes[i].arg[0].i != c->p->position)
			c->marks[i] |= OF_INPUTS;
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			c->marks[d->nodes[i].arg[k].i] |= LIVE;
	}
	return 1;
}

static int has_operands(const struct cutting *c, uint32_t i)
{
	return c->marks[i] && op_arity[c->p->x->d.nodes[i].op] && !is_leaf(c, i);
}

static void mark_multiplied(struct cutting *c)
{
	const struct dag *d = &c->p->x->d;
	unsigned char *m = c->marks;

	for (uint32_t i = 1; i < d->count; i++)
		for (int k = 0; has_operands(c, i) && k < op_arity[d->nodes[i].op]; k++)
			m[i] = (unsigned char)(m[i] | (m[d->nodes[i].arg[k].i] & OF_INPUTS));
	for (uint32_t i = (uint32_t)d->count; i-- > 1;)
		for (int k = 0; has_operands(c, i) && k < op_arity[d->nodes[i].op]; k++) {
			const struct node *n = &d->nodes[i];
			int is_beside = n->op == OP_MUL && (m[n->arg[!k].i] & OF_INPUTS);

			m[n->arg[k].i] = (unsigned char)(m[n->arg[k].i] | (is_beside ? MULTIPLIED : m[i] & MULTIPLIED));
		}
}

/* Fields have products of two rates; what is never multiplied by an input is as good as a drive. */
static int is_rate(const struct cutting *c, uint32_t leaf)
{
	return c->marks[leaf] & MULTIPLIED;
}

int frontier_count(const struct peaks *p, struct peak *k)
{
	const struct dag *d = &p->x->d;
	struct cutting c = {.p = p, .k = k, .marks = calloc(d->count, 1)};
	int done = c.marks != NULL;

	k->rates = k->drives = k->steps = 0;
	for (int i = 0; i < 2 && done; i++)
		c.marks[k->nodes[i]] = LIVE;
	done = done && walk(&c);
	if (done)
		mark_multiplied(&c);
	for (uint32_t i = 1; i < d->count && done; i++) {
		const struct node *n = &d->nodes[i];

		k->steps += has_operands(&c, i);
		if (c.marks[i] && n->op == OP_INPUT && (int)n->arg[0].i != p->position)
			++*(d->arguments[n->arg[0].i].role == ROLE_JOINT_VELOCITY ? &k->rates : &k->drives);
	}
	for (int i = 0; i < c.leaf_count && done; i++)
		++*(is_rate(&c, c.leaves[i]) ? &k->rates : &k->drives);
	free(c.marks);
	return done && k->rates <= (k->kind == PEAK_PLAIN ? 0 : MOST_RATES);
}

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct cutting *c = context;
	const struct node *n = &c->p->x->d.nodes[i];
	struct ref arg[3] = {{0}};

	if (i == 0 || !c->marks[i])
		return (struct ref){0};
	for (int k = 0; k < c->leaf_count; k++)
		if (c->leaves[k] == i)
			return dag_input(out, is_rate(c, (uint32_t)i) ? c->rates : c->drives, k);
	if (op_arity[n->op] == 0)
		return dag_copy_leaf(out, &c->p->x->d, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		arg[k] = c->map[n->arg[k].i];
	return dag_operation(out, n->op, arg[0], arg[1], arg[2]);
}

/* Two more arguments of so many rows as there are leaves. */
static int declare(struct cutting *c, struct dag *from)
{
	if (from->argument_count + 2 > DAG_ARGUMENTS)
		return 0;
	c->rates = from->argument_count++;
	c->drives = from->argument_count++;
	from->arguments[c->rates] = (struct argument){.name = "cut_rates", .rows = c->leaf_count, .role = ROLE_JOINT_VELOCITY};
	from->arguments[c->drives] = (struct argument){.name = "cut_drives", .rows = c->leaf_count, .role = ROLE_JOINT_ACCELERATION};
	from->section_count = 0;
	return 1;
}

static int take_ranges(const struct cutting *c, struct relaxed *to, int argument, struct arena *arena)
{
	struct interval *rows = arena_alloc(arena, (size_t)c->leaf_count + 1, sizeof *rows);

	for (int k = 0; k < c->leaf_count && rows; k++)
		rows[k] = norms_range(c->p->norms, c->p->values, c->leaves[k]);
	to->rows[argument] = rows;
	return rows != NULL;
}

int frontier_cut(struct relaxed *to, const struct relaxed *of, const struct peaks *p, const struct peak *k, const uint32_t *nodes,
	size_t count, struct arena *arena)
{
	struct dag from = p->x->d;
	struct cutting c = {.p = p, .k = k, .marks = arena_alloc(arena, from.count, 1),
		.map = arena_alloc(arena, from.count, sizeof *c.map)};
	struct output *outputs = arena_alloc(arena, count, sizeof *outputs);

	if (arena->failed)
		return 0;
	for (size_t i = 0; i < count; i++) {
		c.marks[nodes[i]] = LIVE;
		outputs[i] = (struct output){p->text->outputs[p->output].argument, (int)i, {nodes[i]}};
	}
	if (!walk(&c) || !declare(&c, &from))
		return 0;
	mark_multiplied(&c);
	from.outputs = outputs;
	from.output_count = count;
	*to = *of;
	dag_init(&to->view.dag, arena);
	dag_copy(&to->view.dag, &from, c.map, copy, &c);
	return take_ranges(&c, to, c.rates, arena) && take_ranges(&c, to, c.drives, arena) && !to->view.dag.failed;
}
