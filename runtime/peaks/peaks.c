/* In which groups peaks are looked at, and how long. */
#define _POSIX_C_SOURCE 200809L
#include "peaks/peaks.h"
#include "core/seconds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the time: for derivatives, by which so long is spent for each node and row of q. */
#define SHARE_BENDS 0.3
#define SHARE_GRIDS 0.8 /* of what is left, the rest is for grids that take longer than was thought */
#define SECONDS_OF_A_NODE 1e-5

enum { FULL_ROWS = 5 };

/* Lanes of all drives and rates take so long that all degrees are one: the largest. */
static int is_of(const struct peaks *p, const struct peaks_group *g, const struct peak *k)
{
	return g->kind == k->kind && g->dims == k->dims &&
	       (k->kind == PEAK_FULL || !memcmp(g->degrees, k->degrees, (size_t)p->dim_count));
}

/* NULL when memory runs out. */
static struct peaks_group *group_of(
	const struct peaks *p, struct peaks_group *groups, size_t *count, const struct peak *k)
{
	struct peaks_group *g = groups;

	while (g < groups + *count && !is_of(p, g, k))
		g++;
	if (g == groups + *count) {
		*g = (struct peaks_group){.kind = k->kind,
			.dims = k->dims,
			.degrees = arena_alloc(p->arena, (size_t)p->dim_count + 1, 1)};
		++*count;
	}
	for (int i = 0; i < p->dim_count && g->degrees; i++)
		g->degrees[i] = k->degrees[i] > g->degrees[i] ? k->degrees[i] : g->degrees[i];
	return p->arena->failed ? NULL : g;
}

static struct peaks_group *groups_make(const struct peaks *p, size_t *count)
{
	struct peaks_group *groups = arena_alloc(p->arena, p->count + 1, sizeof *groups), *g;

	*count = 0;
	for (size_t i = 0; i < p->count && groups; i++)
		if (peak_is_asked(&p->list[i])) {
			if (!(g = group_of(p, groups, count, &p->list[i])))
				return NULL;
			g->count++;
			g->weight += p->list[i].weight;
		}
	for (g = groups; groups && g < groups + *count; g++) {
		if (!(g->members = arena_alloc(p->arena, g->count, sizeof *g->members)))
			return NULL;
		g->count = 0;
		for (size_t i = 0; i < p->count; i++)
			if (peak_is_asked(&p->list[i]) && is_of(p, g, &p->list[i]))
				g->members[g->count++] = i;
	}
	return groups;
}

/* More rows of q take more points. Where lanes are many and rows too, there are too few points to gain much. */
static double share_of(const struct peaks_group *g)
{
	double n = __builtin_popcountll(g->dims);

	return g->weight * n * n * (g->kind == PEAK_FULL && n > FULL_ROWS ? 0.3 : 1);
}

/* Those first that may leave time to others. */
static int by_share(const void *a, const void *b)
{
	double x = share_of(a), y = share_of(b);

	return (x > y) - (x < y);
}

static int take_groups(struct peaks *p)
{
	size_t count;
	struct peaks_group *groups = groups_make(p, &count);
	double sum = 0, end = seconds_now() + SHARE_GRIDS * (p->deadline - seconds_now());
	int done = groups != NULL;

	if (done)
		qsort(groups, count, sizeof *groups, by_share);
	for (size_t i = 0; i < count && done; i++)
		sum += share_of(&groups[i]);
	for (size_t i = 0; i < count && done && seconds_now() < end; i++) {
		double share = share_of(&groups[i]), now = seconds_now();

		done = peaks_grid(p, &groups[i], now + (end - now) * (sum > 0 ? fmin(1, share / sum) : 1));
		sum -= share;
	}
	return done;
}

int peaks_find(struct peaks *p)
{
	double now = seconds_now(), of_bends = SHARE_BENDS * (p->deadline - now);

	if (SECONDS_OF_A_NODE * (double)p->x->d.count * p->dim_count > of_bends)
		return 1;
	return peaks_mark(p) && peaks_bends(p, now + of_bends) && take_groups(p);
}
