/* Rows of arrays. */
#include "emit/unparse.h"
#include "plan/stretch.h"

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

void unparse_element(const struct unparser *u, int argument, int row, struct text *out)
{
	const struct argument *a = &u->plan->dag->arguments[argument];
	const struct stretches *s = u->pass->stretches;

	text_put(out, u->is_over_columns ? "RNEA_COLUMNS_AT(" : "");
	if (a->per_batch || u->numbers->is_beside)
		text_printf(out, "%s[%d]", a->name, row);
	else if (s && s->period && argument == s->divided && row >= s->period)
		put_divided(s, a->name, row, out);
	else if (s && s->gap && row >= s->second)
		text_printf(out, "%s[(%d - gap)*stride]", a->name, row);
	else
		unparse_index(a->name, (unsigned)row, "stride", out);
	text_put(out, u->is_over_columns ? ")" : "");
}
