/* Nodes of one DAG in another, and a whole DAG in another arena. */
#include "dag/dag.h"
#include <string.h>

struct ref dag_copy_leaf(struct dag *out, const struct dag *d, size_t i)
{
	const struct node *n = &d->nodes[i];

	if (n->op == OP_CONST && n->arg[0].i)
		return dag_const_lanes(out, d->lanes[n->arg[0].i - 1]);
	if (n->op == OP_CONST)
		return dag_within(out, dag_number(d, n));
	return dag_input_anew(out, (int)n->arg[0].i, (int)n->arg[1].i, (int)n->arg[2].i);
}

void dag_copy(struct dag *out, const struct dag *d, struct ref *map, dag_copier *copy, void *context)
{
	size_t section = 0;

	for (int i = 0; i < d->argument_count; i++)
		dag_argument_of(out, d->arguments[i]);
	memcpy(out->arguments + DAG_COLUMN, d->arguments + DAG_COLUMN, (DAG_EVERY - DAG_COLUMN) * sizeof *d->arguments);
	memcpy(out->runs, d->runs, sizeof out->runs);
	memcpy(out->rooms, d->rooms, sizeof out->rooms);
	memcpy(out->puts, d->puts, sizeof out->puts);
	out->put_count = d->put_count;
	if (d->begin_count && dag_loops_begin_rows(out, d->begin_count))
		memcpy(out->begins, d->begins, (size_t)d->begin_count * sizeof *d->begins);
	out->run_count = d->run_count;
	out->width = d->width;
	out->is_each = d->is_each;
	out->loop_count = d->loop_count;
	for (size_t i = 0; i < d->count; i++) {
		const struct tag *tag = &d->nodes[i].tag;

		for (; section < d->section_count && d->sections[section].node <= i; section++)
			dag_section(out, d->sections[section].kind, d->sections[section].body);
		out->is_wide = d->nodes[i].is_wide;
		map[i] = copy(context, out, i);
		if (tag->quantity[0])
			dag_tag(out, map[i], tag->quantity, tag->body, tag->component);
	}
	out->is_wide = 0;
	for (; section < d->section_count; section++)
		dag_section(out, d->sections[section].kind, d->sections[section].body);
	for (size_t i = 0; i < d->output_count; i++)
		dag_output(out, d->outputs[i].argument, d->outputs[i].row, map[d->outputs[i].value.i]);
	for (size_t i = 0; i < out->section_count; i++)
		out->sections[i].output = d->sections[i].output;
}

static void *copy_of(struct arena *a, const void *from, size_t count, size_t size)
{
	void *to = arena_take(a, count, size);

	if (to && count)
		memcpy(to, from, count * size);
	return to;
}

void dag_take(struct dag *d, const struct dag *from)
{
	struct arena *a = d->arena;

	*d = *from;
	d->arena = a;
	d->table = NULL;
	d->limit = 0;
	d->nodes = copy_of(a, from->nodes, from->count, sizeof *d->nodes);
	d->outputs = copy_of(a, from->outputs, from->output_count, sizeof *d->outputs);
	d->sections = copy_of(a, from->sections, from->section_count, sizeof *d->sections);
	d->numbers = copy_of(a, from->numbers, from->number_count, sizeof *d->numbers);
	d->lanes = copy_of(a, from->lanes, from->lane_count, sizeof *d->lanes);
	d->begins = copy_of(a, from->begins, (size_t)from->begin_count, sizeof *d->begins);
	d->lane_capacity = d->lane_count;
	d->capacity = d->count;
	d->output_capacity = d->output_count;
	d->section_capacity = d->section_count;
	d->number_capacity = d->number_count;
	d->failed |= a->failed;
}
