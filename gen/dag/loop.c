/* Loops over columns of outputs, or over coordinates: what is made of DAG_COLUMN runs once for each. */
#include "dag/dag.h"

int dag_loop(struct dag *d, const struct column_room *room)
{
	if (d->loop_count == DAG_LOOPS)
		return -1;
	if (room && room->columns)
		dag_section(d, SECTION_WAY, room->body);
	else
		dag_section(d, SECTION_COLUMNS, 0);
	d->arguments[DAG_COLUMN + d->loop_count] =
		(struct argument){.name = "column", .is_output = 1, .per_batch = room && !room->is_batch, .role = ROLE_UNKNOWN, .of = ""};
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
	int count = d->rooms[loop].columns, is_of_all = dag_loop_is_last(d, loop);

	for (int i = 0; i < d->run_count; i++)
		count += is_of_all || d->runs[i].loop == loop ? d->runs[i].count : 0;
	return count;
}

void dag_loops_reduce(struct dag *d, int rows)
{
	d->arguments[DAG_REDUCED] =
		(struct argument){.name = "reduced", .rows = rows, .is_output = 1, .per_batch = 1, .role = ROLE_UNKNOWN, .of = ""};
}

int dag_reduced_rows(const struct dag *d)
{
	return d->arguments[DAG_REDUCED].rows;
}

int dag_loop_is_last(const struct dag *d, int loop)
{
	return dag_reduced_rows(d) && loop == d->loop_count - 1;
}

int *dag_loops_begin_rows(struct dag *d, int count)
{
	d->begins = arena_take(d->arena, (size_t)count, sizeof *d->begins);
	d->begin_count = d->begins ? count : 0;
	d->failed |= !d->begins;
	return d->begins;
}

void dag_loop_put(struct dag *d, const struct column_put *put)
{
	if (d->put_count == DAG_PUTS) {
		d->failed = 1;
		return;
	}
	d->puts[d->put_count] = *put;
	d->puts[d->put_count++].loop = d->loop_count - 1;
}

int dag_loops_go_back(const struct dag *d)
{
	return d->loop_count && d->rooms[0].columns;
}

int dag_loops_in_place(const struct dag *d)
{
	return d->loop_count && !d->rooms[d->loop_count - 1].rows;
}

size_t dag_loops_begin(const struct dag *d)
{
	for (size_t i = 0; i < d->section_count; i++)
		if (dag_section_loops(&d->sections[i]))
			return d->sections[i].node;
	return d->count;
}
