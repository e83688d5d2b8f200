/* Rows of arrays. */
#include "emit/unparse.h"
#include "plan/stretch.h"
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
	const struct stretches *s = u->pass->stretches;

	if (u->plan->dag->arguments[argument].per_batch || u->numbers->is_beside)
		text_printf(out, "%s[%d]", array, row);
	else if (s && s->period && argument == s->divided && row >= s->period)
		put_divided(s, array, row, out);
	else if (s && s->gap && row >= s->second)
		text_printf(out, "%s[(%d - gap)*stride]", array, row);
	else
		unparse_index(array, (unsigned)row, "stride", out);
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

void unparse_asks(const struct unparser *u, const struct plan *p, size_t line, struct text *out)
{
	size_t end = u->ahead && u->zeros != ZEROS_ALONE ? line + u->ahead + 1 : 0;

	for (size_t i = line ? line + u->ahead : 0; i < end && i < p->line_count; i++) {
		const struct node *n = &p->dag->nodes[p->lines[i].value.i];

		if (p->lines[i].kind != LINE_INPUT || p->dag->arguments[n->arg[0].i].per_batch)
			continue;
		text_put(out, "\tRNEA_ASK(");
		unparse_element(u, (int)n->arg[0].i, (int)n->arg[1].i, out);
		text_put(out, ");\n");
	}
}
