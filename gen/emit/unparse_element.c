/* Rows of arrays. */
#include "emit/columns/emit_way_back.h"
#include "emit/unparse.h"
#include "plan/tiles/tiles.h"
#include <stdio.h>

void unparse_index(const char *array, unsigned i, const char *step, struct text *out)
{
	if (i == 0)
		text_printf(out, "%s[0]", array);
	else if (i == 1)
		text_printf(out, "%s[%s]", array, step);
	else
		text_printf(out, "%s[%u*%s]", array, i, step);
}

/* `vjp[(40 + skip)*stride]`: a row in the second or a later period. */
static void put_divided(const struct stretches *s, const char *array, int row, struct text *out)
{
	text_printf(out, "%s[(%d + ", array, row);
	if (row >= 2 * s->period)
		text_printf(out, "%d*", row / s->period);
	text_put(out, "skip)*stride]");
}

static void put_row(const struct unparser *u, const char *array, int argument, int row, struct text *out)
{
	int is_inner = u->has_inner && !u->plan->dag->arguments[argument].is_output;
	const struct stretches *s = is_inner ? u->function->tiles : u->has_inner ? NULL : u->function->stretches;
	const char *step = is_inner ? "inner" : "stride";

	if (emit_is_carried(u->plan->dag, argument))
		text_printf(out, "%s[%d*step + l]", array, row);
	else if (u->plan->dag->arguments[argument].per_batch || u->numbers->is_beside ||
		(u->has_samples && argument < DAG_ARGUMENTS && !u->plan->dag->arguments[argument].is_output))
		text_printf(out, "%s[%d]", array, row);
	else if (s && s->period && argument == s->divided && row >= s->period)
		put_divided(s, array, row, out);
	else if (s && s->gap && row >= s->second)
		text_printf(out, "%s[(%d - gap)*%s]", array, row, step);
	else
		unparse_index(array, (unsigned)row, step, out);
}

void unparse_element(const struct unparser *u, int argument, int row, struct text *out)
{
	text_put(out, u->is_over_columns ? "RNEA_COLUMNS_AT(" : "");
	put_row(u, u->plan->dag->arguments[argument].name, argument, row, out);
	text_put(out, u->is_over_columns ? ")" : "");
}

void unparse_element_each(const struct unparser *u, int argument, int row, struct text *out)
{
	char array[80];

	snprintf(array, sizeof array, "%.70s" EMIT_EACH, u->plan->dag->arguments[argument].name);
	put_row(u, array, argument, row, out);
}
