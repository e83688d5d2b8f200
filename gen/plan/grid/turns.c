#include "plan/grid/turns.h"
#include <limits.h>

/* By part and row of the last array: it is stored, or read from where another part has left it. */
struct turns {
	const struct part *parts;
	int count, rows;
	unsigned char *stores, *reads;
};

/* Which kernel it is of: the last one is that of parts that are no hands. */
static int kernel_of(const struct part *p)
{
	return p->is_hand ? p->level : INT_MAX;
}

/* The row of it that the line reads; -1: it reads none. */
static int row_read(const struct plan *p, const struct line *l)
{
	const struct node *n = &p->dag->nodes[l->value.i];

	return l->kind == LINE_INPUT && p->dag->arguments[n->arg[0].i].is_output ? (int)n->arg[1].i : -1;
}

/* Returns 0 where it reads a row that it has written. */
static int mark(struct turns *x, int part)
{
	const struct plan *p = &x->parts[part].function.plan;
	unsigned char *stores = x->stores + part * x->rows, *reads = x->reads + part * x->rows;

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
		int row = row_read(p, l);

		if (row >= 0 && stores[row])
			return 0;
		if (row >= 0)
			reads[row] = 1;
		if (l->kind == LINE_STORE && p->dag->outputs[l->index].argument == parts_handed(p->dag))
			stores[p->dag->outputs[l->index].row] = 1;
	}
	return 1;
}

/* What a part reads or stores of a row: does it go with what the others do? */
static int goes(const struct turns *x, int part, int row)
{
	int kernel = kernel_of(&x->parts[part]), is_read = x->reads[part * x->rows + row], before = 0;

	for (int i = 0; i < x->count; i++) {
		int is_stored = x->stores[i * x->rows + row];

		if (i != part && is_stored && kernel_of(&x->parts[i]) == kernel && (is_read || x->stores[part * x->rows + row]))
			return 0;
		before += is_stored && kernel_of(&x->parts[i]) < kernel;
	}
	return !is_read || before == 1;
}

int turns_serve(const struct part *parts, int count, int rows, struct arena *a)
{
	size_t size = (size_t)count * (size_t)rows;
	struct turns x = {parts, count, rows, arena_alloc(a, size, 1), arena_alloc(a, size, 1)};

	if (!x.stores || !x.reads)
		return 0;
	for (int i = 0; i < count; i++)
		if (!mark(&x, i))
			return 0;
	for (int i = 0; i < count; i++)
		for (int row = 0; row < rows; row++)
			if (!goes(&x, i, row))
				return 0;
	return 1;
}
