#include "plan/grid/hands/turns.h"
#include <string.h>

/* By part and row of the last array: it is stored, or read from where another part has left it. */
struct turns {
	const struct part *parts;
	int count, rows, most; /* kernels before that may have stored a row which is read */
	unsigned char *stores, *reads;
};

/* The row of it that the line reads; -1: it reads none. */
static int row_read(const struct plan *p, const struct line *l)
{
	const struct node *n = &p->dag->nodes[l->value.i];

	return l->kind == LINE_INPUT && p->dag->arguments[n->arg[0].i].is_output ? (int)n->arg[1].i : -1;
}

/* The row of it that the line stores; -1: it stores none. */
static int row_stored(const struct plan *p, const struct line *l)
{
	const struct output *o = l->kind == LINE_STORE ? &p->dag->outputs[l->index] : NULL;

	return o && o->argument == parts_handed(p->dag) ? o->row : -1;
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
		if (row_stored(p, l) >= 0)
			stores[row_stored(p, l)] = 1;
	}
	return 1;
}

/* What a part reads or stores of a row: does it go with what the others do? */
static int goes(const struct turns *x, int part, int row)
{
	int kernel = part_kernel(&x->parts[part]), is_read = x->reads[part * x->rows + row], before = 0;

	for (int i = 0; i < x->count; i++) {
		int is_stored = x->stores[i * x->rows + row];

		if (i != part && is_stored && part_kernel(&x->parts[i]) == kernel && (is_read || x->stores[part * x->rows + row]))
			return 0;
		before += is_stored && part_kernel(&x->parts[i]) < kernel;
	}
	return !is_read || (before > 0 && before <= x->most);
}

int turns_serve(const struct part *parts, int count, int rows, int most, struct arena *a)
{
	size_t size = (size_t)count * (size_t)rows;
	struct turns x = {parts, count, rows, most, arena_alloc(a, size, 1), arena_alloc(a, size, 1)};

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

/* By row: how many lines have been read when it is read for the last time. */
static size_t *last_readings(const struct plan *p, struct arena *a)
{
	size_t *last = arena_alloc(a, (size_t)p->dag->arguments[parts_handed(p->dag)].rows, sizeof *last);

	for (size_t l = 0; l < p->line_count && last; l++)
		if (row_read(p, &p->lines[l]) >= 0)
			last[row_read(p, &p->lines[l])] = l + 1;
	return last;
}

int turns_delay_stores(struct plan *p, struct arena *a)
{
	struct line *lines = arena_alloc(a, p->line_count + 1, sizeof *lines), *late = arena_alloc(a, p->line_count + 1, sizeof *late);
	size_t *last = last_readings(p, a), count = 0, waiting = 0;

	if (!lines || !late || !last)
		return 0;
	for (size_t l = 0; l < p->line_count; l++) {
		size_t kept = 0;
		int row = row_stored(p, &p->lines[l]);

		if (row >= 0 && last[row] > l)
			late[waiting++] = p->lines[l];
		else
			lines[count++] = p->lines[l];
		for (size_t i = 0; i < waiting; i++)
			if (last[row_stored(p, &late[i])] <= l + 1)
				lines[count++] = late[i];
			else
				late[kept++] = late[i];
		waiting = kept;
	}
	memcpy(p->lines, lines, count * sizeof *lines);
	return 1;
}
