#define _POSIX_C_SOURCE 200809L
#include "range/grid.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

real grid_angle(int i, int n)
{
	return 6.283185307179586476925286766559L * (real)i / (real)n;
}

/* Of a circle the first place is 0, whatever the range. */
static void spread_circle(struct grid *g, int k)
{
	int n = g->counts[k];

	for (int i = 0; i < n; i++) {
		real angle = grid_angle(i, n);

		g->places[k][i][0] = (double)sinl(angle);
		g->places[k][i][1] = (double)cosl(angle);
	}
	g->half[k] = round_up((double)grid_angle(1, 2 * n) * (1 + 0x1p-40));
}

static void spread_range(struct grid *g, int k)
{
	const struct field_dim *dim = &g->f->dims[k];
	int n = g->counts[k];
	double before = dim->lower, most = 0;

	for (int i = 0; i < n; i++) {
		double x = n == 1 ? 0.5 * (dim->lower + dim->upper) : dim->lower + (dim->upper - dim->lower) * i / (n - 1);

		x = i == n - 1 && n > 1 ? dim->upper : x;
		field_place(dim, x, g->places[k][i]);
		most = fmax(most, round_up(x - before));
		before = x;
	}
	g->half[k] = n == 1 ? round_up(dim->upper - dim->lower) : 0.5 * most;
}

int grid_make(struct grid *g, const struct field *f, const int *counts, int is_whole)
{
	*g = (struct grid){.f = f, .skip = -1};
	for (int k = 0; k < f->dim_count; k++) {
		g->counts[k] = counts[k];
		g->places[k] = malloc((size_t)counts[k] * sizeof *g->places[k]);
		if (!g->places[k])
			return 0;
		if (f->dims[k].is_angle && (is_whole || f->dims[k].is_circle))
			spread_circle(g, k);
		else
			spread_range(g, k);
	}
	return 1;
}

void grid_free(struct grid *g)
{
	for (int k = 0; g->f && k < g->f->dim_count; k++)
		free(g->places[k]);
	*g = (struct grid){.skip = -1};
}

double grid_size(const struct grid *g)
{
	double size = 1;

	for (int k = 0; k < g->f->dim_count; k++)
		size *= k == g->skip ? 1 : g->counts[k];
	return size;
}

void grid_point(const struct grid *g, size_t number, struct field_point *q)
{
	for (int k = 0; k < g->f->dim_count; k++) {
		size_t n = k == g->skip ? 1 : (size_t)g->counts[k];

		q->x[k][0] = g->places[k][number % n][0];
		q->x[k][1] = g->places[k][number % n][1];
		number /= n;
	}
}

void grid_raise(_Atomic double *most, double x)
{
	double now = *most;

	while (now < x && !atomic_compare_exchange_weak(most, &now, x))
		;
}
