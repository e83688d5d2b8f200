#include "study/choice.h"
#include <math.h>

static enum verdict judge(double value, double limit, enum verdict none, enum verdict over)
{
	return value <= limit ? VERDICT_CLOSE : isnan(value) ? none : over;
}

enum verdict choice_by_bound(const struct study_row *row, double limit)
{
	return judge(row->bound_max, limit, VERDICT_NO_BOUND, VERDICT_OVER_BOUND);
}

enum verdict choice_by_proof(const struct study_row *row, double limit)
{
	return judge(row->proved, limit, VERDICT_NO_PROOF, VERDICT_OVER_PROOF);
}

enum verdict choice_by_error(const struct study_row *row, double limit)
{
	return judge(row->errors.max, limit, VERDICT_NO_ERROR, VERDICT_OVER_ERROR);
}

static int is_close(const struct candidate *c)
{
	return c->verdict == VERDICT_CLOSE;
}

const struct candidate *choice_fastest(const struct candidate *c, int count)
{
	const struct candidate *best = NULL;

	for (int i = 0; i < count; i++)
		if (is_close(&c[i]) && (!best || c[i].row.least < best->row.least))
			best = &c[i];
	return best;
}

int choice_is_tied(const struct candidate *c, const struct candidate *fastest)
{
	const struct study_row *a = &c->row, *b = &fastest->row;

	return is_close(c) && a->backend == b->backend && a->precision == b->precision && a->layout == b->layout &&
		a->least <= fmax(fastest->slowest, CHOICE_ALIKE * b->least);
}

const struct candidate *choice_best(const struct candidate *c, int count)
{
	const struct candidate *fastest = choice_fastest(c, count), *best = fastest;

	for (int i = 0; i < count && fastest; i++)
		if (choice_is_tied(&c[i], fastest) && c[i].row.trig < best->row.trig)
			best = &c[i];
	return best;
}
