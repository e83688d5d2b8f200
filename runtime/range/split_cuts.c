/* The boxes that are left, as the cuts that made them. */
#include "range/split.h"
#include <stdlib.h>

struct boxes {
	const struct split *s;
	const struct interval *(*q); /* by box: its spans by dimension */
	const int *rows;
	struct cuts *cuts;
};

/* Is none of the boxes on both sides? */
static int is_cut(const struct boxes *b, size_t first, size_t end, int k, double middle)
{
	int sides = 0;

	for (size_t i = first; i < end; i++) {
		const struct interval *q = &b->q[i][k];

		if (q->lower < middle && q->upper > middle)
			return 0;
		sides |= q->upper <= middle ? 1 : 2;
	}
	return sides == 3;
}

/* Those below the middle first; returns where the others begin. */
static size_t part(const struct boxes *b, size_t first, size_t end, int k, double middle)
{
	size_t at = first;

	for (size_t i = first; i < end; i++)
		if (b->q[i][k].upper <= middle) {
			const struct interval *q = b->q[i];

			b->q[i] = b->q[at];
			b->q[at++] = q;
		}
	return at;
}

static void put(const struct boxes *b, size_t first, size_t end, struct interval *whole, int depth)
{
	for (int k = 0; k < b->s->dim_count && end - first > 1 && depth < CUTS_DEEP; k++) {
		struct interval before = whole[k];
		double middle = cuts_middle(before.lower, before.upper);
		size_t at;

		if (!is_cut(b, first, end, k, middle))
			continue;
		at = part(b, first, end, k, middle);
		cuts_put(b->cuts, b->rows[k]);
		whole[k].upper = middle;
		put(b, first, at, whole, depth + 1);
		whole[k] = (struct interval){middle, before.upper};
		put(b, at, end, whole, depth + 1);
		whole[k] = before;
		return;
	}
	cuts_put(b->cuts, CUTS_NONE);
}

int split_cuts(const struct split *s, const struct leaf *root, const int *rows, struct cuts *cuts)
{
	struct boxes b = {s, malloc((s->count + 1) * sizeof *b.q), rows, cuts};
	struct interval whole[SPLIT_DIMS];

	for (size_t i = 0; i < s->count && b.q; i++)
		b.q[i] = ((const struct leaf *)(const void *)(s->leaves + i * s->stride))->q;
	for (int k = 0; k < s->dim_count; k++)
		whole[k] = root->q[k];
	if (b.q)
		put(&b, 0, s->count, whole, 0);
	free(b.q);
	return b.q && !cuts->failed;
}
