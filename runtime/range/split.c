#define _POSIX_C_SOURCE 200809L
#include "range/split.h"
#include "core/seconds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LEAVES = 1 << 20, TRY_EVERY = 32 };

/* Leaves are a heap, as long as their dimensions need: none has a larger first size than the one above it. */
static struct leaf *leaf_at(const struct split *s, size_t i)
{
	return (struct leaf *)(void *)(s->leaves + i * s->stride);
}

static double size_at(const struct split *s, size_t i)
{
	return leaf_at(s, i)->sizes[0];
}

static int push(struct split *s, const struct leaf *leaf)
{
	size_t at = s->count;

	if (s->count == s->capacity) {
		size_t more = s->capacity ? 2 * s->capacity : 64;
		char *leaves = realloc(s->leaves, more * s->stride);

		if (!leaves)
			return 0;
		s->leaves = leaves;
		s->capacity = more;
	}
	s->count++;
	for (; at > 0 && size_at(s, (at - 1) / 2) < leaf->sizes[0]; at = (at - 1) / 2)
		memcpy(leaf_at(s, at), leaf_at(s, (at - 1) / 2), s->stride);
	memcpy(leaf_at(s, at), leaf, s->stride);
	return 1;
}

static void pop(struct split *s, struct leaf *leaf)
{
	struct leaf last;
	size_t at = 0, child;

	memcpy(leaf, leaf_at(s, 0), s->stride);
	memcpy(&last, leaf_at(s, --s->count), s->stride);
	for (; (child = 2 * at + 1) < s->count; at = child) {
		if (child + 1 < s->count && size_at(s, child + 1) > size_at(s, child))
			child++;
		if (!(size_at(s, child) > last.sizes[0]))
			break;
		memcpy(leaf_at(s, at), leaf_at(s, child), s->stride);
	}
	memcpy(leaf_at(s, at), &last, s->stride);
}

/* Returns what of the size is left, at the worse half. */
static double halve(const struct split *s, const struct leaf *leaf, int k, struct leaf halves[2])
{
	double middle = 0.5 * (leaf->q[k].lower + leaf->q[k].upper);

	memcpy(&halves[0], leaf, s->stride);
	memcpy(&halves[1], leaf, s->stride);
	halves[0].q[k].upper = halves[1].q[k].lower = middle;
	s->examine(s->context, &halves[0]);
	s->examine(s->context, &halves[1]);
	return fmax(halves[0].sizes[0], halves[1].sizes[0]) / leaf->sizes[0];
}

static double part_of(const struct split *s, const struct leaf *leaf, int k)
{
	return s->width[k] > 0 ? (leaf->q[k].upper - leaf->q[k].lower) / s->width[k] : 0;
}

/* The dimension to halve: all are tried now and then; what each gained is remembered. */
static int choose(struct split *s, const struct leaf *leaf, int is_tried)
{
	struct leaf halves[2];
	int best = 0;

	for (int k = 0; k < s->dim_count && is_tried && seconds_now() < s->deadline; k++)
		if (part_of(s, leaf, k) > 0)
			s->score[k] = 0.5 * (s->score[k] + fmax((1 - halve(s, leaf, k, halves)) / part_of(s, leaf, k), 1e-6));
	for (int k = 1; k < s->dim_count; k++)
		if (s->score[k] * part_of(s, leaf, k) > s->score[best] * part_of(s, leaf, best))
			best = k;
	return best;
}

int split_run(struct split *s, struct leaf *root, double deadline)
{
	struct leaf leaf, halves[2];

	s->deadline = deadline;
	s->stride = offsetof(struct leaf, q) + (size_t)s->dim_count * sizeof *root->q;
	for (int k = 0; k < s->dim_count; k++) {
		s->width[k] = root->q[k].upper - root->q[k].lower;
		s->score[k] = 0.1;
	}
	s->examine(s->context, root);
	if (!push(s, root))
		return 0;
	for (size_t i = 0; s->dim_count && s->count < MOST_LEAVES && seconds_now() < deadline; i++) {
		int k;

		if (!isfinite(size_at(s, 0)) || !(size_at(s, 0) > 0))
			return 1;
		pop(s, &leaf);
		k = choose(s, &leaf, i % TRY_EVERY == 0);
		if (!(part_of(s, &leaf, k) > 1e-12))
			return push(s, &leaf);
		s->score[k] = 0.9 * s->score[k] + 0.1 * fmax(1e-6, (1 - halve(s, &leaf, k, halves)) / part_of(s, &leaf, k));
		if (!push(s, &halves[0]) || !push(s, &halves[1]))
			return 0;
	}
	return 1;
}

void split_total(const struct split *s, double sizes[SPLIT_SIZES], struct interval *value)
{
	*value = (struct interval){(double)INFINITY, -(double)INFINITY};
	memset(sizes, 0, SPLIT_SIZES * sizeof *sizes);
	for (size_t i = 0; i < s->count; i++) {
		const struct leaf *l = leaf_at(s, i);

		/* an end that is no number is not known */
		value->lower = fmin(value->lower, isnan(l->value.lower) ? -(double)INFINITY : l->value.lower);
		value->upper = fmax(value->upper, isnan(l->value.upper) ? (double)INFINITY : l->value.upper);
		for (int k = 0; k < SPLIT_SIZES; k++)
			sizes[k] = fmax(sizes[k], l->sizes[k]);
	}
}

void split_free(struct split *s)
{
	free(s->leaves);
	s->leaves = NULL;
	s->count = s->capacity = 0;
}

/* ---- the boxes that are left, as the cuts that made them ---- */

struct boxes {
	const struct split *s;
	const struct interval *(*q); /* by box: its spans by dimension */
	const int *rows;
	int q_rows;
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

		if (b->rows[k] >= b->q_rows || !is_cut(b, first, end, k, middle))
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

int split_cuts(const struct split *s, const struct leaf *root, const int *rows, int q_rows, struct cuts *cuts)
{
	struct boxes b = {s, malloc((s->count + 1) * sizeof *b.q), rows, q_rows, cuts};
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
