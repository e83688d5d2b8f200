#include "plan/grid/places.h"
#include "plan/readings.h"

/* The last line that reads each row of the inputs; line_count: none does. */
struct last_lines {
	size_t first[DAG_ARGUMENTS]; /* of an argument's rows */
	size_t *line;                /* by row of all arguments */
};

/* By node: the line in which it is made. A value without a name is made in the line of what it stands in, which comes
   after it. */
static size_t *lines_of(const struct plan *p, struct arena *a)
{
	const struct dag *d = p->dag;
	size_t *line = arena_alloc(a, d->count + 1, sizeof *line);
	struct ref made[2];

	for (size_t l = 0; l < p->line_count && line; l++) {
		for (int k = readings_made(p, &p->lines[l], made); k-- > 0;)
			line[made[k].i] = l;
		if (p->lines[l].kind == LINE_STORE && !p->names[p->lines[l].value.i])
			line[p->lines[l].value.i] = l;
	}
	for (size_t i = d->count; i-- > 0 && line;)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++) {
			uint32_t of = d->nodes[i].arg[k].i;

			if (!p->names[of] && line[i] > line[of])
				line[of] = line[i];
		}
	return line;
}

static int most_rows(const struct dag *d)
{
	int rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		rows = d->arguments[i].rows > rows ? d->arguments[i].rows : rows;
	return rows;
}

static int find_last(struct last_lines *x, const struct plan *p, struct arena *a)
{
	const struct dag *d = p->dag;
	size_t rows = 0, *line = lines_of(p, a);

	for (int i = 0; i < d->argument_count; i++) {
		x->first[i] = rows;
		rows += (size_t)most_rows(d);
	}
	x->line = arena_alloc(a, rows + 1, sizeof *x->line);
	if (!line || !x->line)
		return 0;
	for (size_t i = 0; i < rows; i++)
		x->line[i] = p->line_count;
	for (size_t i = 0; i < d->count; i++)
		if (d->nodes[i].op == OP_INPUT) {
			size_t *last = &x->line[x->first[d->nodes[i].arg[0].i] + d->nodes[i].arg[1].i];

			*last = *last == p->line_count || line[i] > *last ? line[i] : *last;
		}
	return 1;
}

/* Of an input the row that a store writes over. */
static size_t row_under(const struct last_lines *x, const struct stretches *s, const struct output *o)
{
	int is_divided = s->period && o->argument == s->divided;
	int place = is_divided ? o->row / s->period : s->place_of[o->argument];

	return x->first[place] + (size_t)(is_divided ? o->row % s->period + s->shift : o->row);
}

int places_serve(int *serves, const struct function *p, const struct stretches *s, struct arena *a)
{
	const struct plan *plan = &p->plan;
	struct last_lines x = {0};

	*serves = 1;
	if (!find_last(&x, plan, a))
		return 0;
	for (size_t l = 0; l < plan->line_count; l++) {
		const struct output *o = plan->lines[l].kind == LINE_STORE ? &p->dag.outputs[plan->lines[l].index] : NULL;
		size_t last = o && s->place_of[o->argument] != o->argument
			? x.line[row_under(&x, s, o)] : plan->line_count;

		*serves &= last == plan->line_count || last <= l;
	}
	return 1;
}
