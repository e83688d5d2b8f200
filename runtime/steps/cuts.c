#include "steps/cuts.h"
#include <stdlib.h>

void cuts_put(struct cuts *c, int row)
{
	if (c->count == c->capacity && !c->failed) {
		size_t more = c->capacity ? 2 * c->capacity : 64;
		int *rows = realloc(c->rows, more * sizeof *rows);

		c->failed = !rows;
		c->rows = rows ? rows : c->rows;
		c->capacity = rows ? more : c->capacity;
	}
	if (!c->failed)
		c->rows[c->count++] = row;
}

void cuts_free(struct cuts *c)
{
	free(c->rows);
	*c = (struct cuts){0};
}

int cuts_check(const struct cuts *c, int row_count, size_t *second)
{
	size_t open[CUTS_DEEP]; /* cuts whose upper half is to come */
	size_t depth = 0;

	for (size_t i = 0; i < c->count; i++) {
		if (c->rows[i] >= row_count || c->rows[i] < CUTS_NONE || (c->rows[i] != CUTS_NONE && depth == CUTS_DEEP))
			return 0;
		second[i] = 0;
		if (c->rows[i] != CUTS_NONE)
			open[depth++] = i;
		else if (depth)
			second[open[--depth]] = i + 1;
		else
			return i + 1 == c->count;
	}
	return 0;
}

int record_make(struct record *r, size_t outputs)
{
	*r = (struct record){calloc(outputs + 1, sizeof *r->outputs), outputs};
	return r->outputs != NULL;
}

void record_free(struct record *r)
{
	for (size_t i = 0; i < r->count && r->outputs; i++) {
		cuts_free(&r->outputs[i].errors);
		cuts_free(&r->outputs[i].values);
	}
	free(r->outputs);
	*r = (struct record){0};
}
