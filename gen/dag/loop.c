/* Loops over columns of outputs: what is made of DAG_COLUMN runs once for each. */
#include "dag/dag.h"

int dag_loop(struct dag *d, const struct column_room *room)
{
	if (d->loop_count == DAG_LOOPS)
		return -1;
	dag_section(d, SECTION_COLUMNS, 0);
	d->arguments[DAG_COLUMN + d->loop_count] =
		(struct argument){.name = "column", .is_output = 1, .per_batch = room != NULL, .role = ROLE_UNKNOWN, .of = ""};
	if (room)
		d->rooms[d->loop_count] = *room;
	return d->loop_count++;
}

void dag_loop_over(struct dag *d, int argument, int first)
{
	struct column_run *last = d->run_count ? &d->runs[d->run_count - 1] : NULL;
	int loop = d->loop_count - 1;

	if (last && last->loop == loop && last->argument == argument && last->first + last->count == first)
		last->count++;
	else if (d->run_count < DAG_RUNS)
		d->runs[d->run_count++] = (struct column_run){loop, argument, first, 1, dag_loop_columns(d, loop)};
	else
		d->failed = 1;
}

int dag_loop_columns(const struct dag *d, int loop)
{
	int count = 0;

	for (int i = 0; i < d->run_count; i++)
		count += d->runs[i].loop == loop ? d->runs[i].count : 0;
	return count;
}

int dag_loops_in_place(const struct dag *d)
{
	return d->loop_count && !d->rooms[0].rows;
}

size_t dag_loops_begin(const struct dag *d)
{
	for (size_t i = 0; i < d->section_count; i++)
		if (d->sections[i].kind == SECTION_COLUMNS)
			return d->sections[i].node;
	return d->count;
}
