/* Loops over columns of outputs: what is made of DAG_COLUMN runs once for each. */
#include "dag/dag.h"

int dag_loop(struct dag *d)
{
	if (d->loop_count == DAG_LOOPS)
		return -1;
	dag_section(d, SECTION_COLUMNS, 0);
	d->arguments[DAG_COLUMN + d->loop_count] =
		(struct argument){.name = "column", .is_output = 1, .role = ROLE_UNKNOWN, .of = ""};
	return d->loop_count++;
}

void dag_loop_over(struct dag *d, int argument, int first)
{
	struct column_run *last = d->run_count ? &d->runs[d->run_count - 1] : NULL;
	int loop = d->loop_count - 1;

	if (last && last->loop == loop && last->argument == argument && last->first + last->count == first)
		last->count++;
	else if (d->run_count < DAG_RUNS)
		d->runs[d->run_count++] = (struct column_run){loop, argument, first, 1};
	else
		d->failed = 1;
}
