/* Grids that are worth their time, and whether those of a certificate are as they say. */
#define _POSIX_C_SOURCE 200809L
#include "steps/grid.h"
#include "core/seconds.h"
#include <stdlib.h>
#include <string.h>

enum { FIRST_POINTS = 2000 };

/* What is stated, for another machine's sine. */
#define STATED (1 + 0x1p-36)

static int fewest(const struct point_dim *k)
{
	if (k->is_angle)
		return 1;
	return k->range.lo == k->range.hi ? 1 : k->degree + 1;
}

/* Places of an angle go with the root of how much the output bends by it; where that is little, one is enough. */
static int choose_pass(const struct points *p, int *counts, const double *bends, double found, double room)
{
	int is_one = 0;

	for (double scale = 0.5; scale < 100; scale *= 1.05) {
		int now[POINT_DIMS] = {0};

		for (int k = 0; k < p->dim_count; k++) {
			const struct point_dim *dim = &p->dims[k];
			int least = 2 * dim->degree + 2,
				many = 2 * (int)(0.5 * fmin(GRID_PASS_PLACES, scale * sqrt(bends[k] / found)));

			now[k] = fewest(dim);
			if (dim->is_angle && !(5 * dim->degree * dim->degree * bends[k] < 0.1 * found))
				now[k] = many < least ? least : many;
		}
		if (grid_pass_size(p, now) > room)
			break;
		memcpy(counts, now, sizeof now);
		is_one = grid_pass_size(p, now) > 0;
	}
	return is_one;
}

static double gap_of(const struct point_dim *k, int count)
{
	double length = k->range.hi - k->range.lo, half = length >= 6.28 && k->is_angle ? 3.15 / count : count == 1 ? length
		: 0.5 * length / (count - 1);

	return half * half / 2;
}

/* A place more where it takes most from the slack, for the points that it costs. */
static int choose_cover(const struct points *p, int *counts, const double *bends, double room)
{
	for (int k = 0; k < p->dim_count; k++)
		counts[k] = p->dims[k].range.lo == p->dims[k].range.hi ? 1 : 2;
	if (grid_cover_size(p, counts) > 2 * room)
		return 0;
	for (;;) {
		double best = 0;
		int at = -1;

		for (int k = 0; k < p->dim_count; k++) {
			double more = (counts[k] + 1.0) / counts[k];
			double gain = bends[k] * (gap_of(&p->dims[k], counts[k]) - gap_of(&p->dims[k], counts[k] + 1)) /
				log(more);

			if (p->dims[k].range.lo < p->dims[k].range.hi && counts[k] < GRID_PLACES && gain > best &&
				grid_cover_size(p, counts) * more <= room) {
				best = gain;
				at = k;
			}
		}
		if (at < 0)
			return 1;
		counts[at]++;
	}
}

static void state_bends(const struct points *p, double *bends)
{
	for (int k = 0; k < p->dim_count; k++)
		bends[k] *= STATED;
}

/* Points in a second, by some of them. */
static double speed_of(const struct points *p)
{
	double *work = points_work(p), *c = malloc(p->coefficients * sizeof *c), q[POINT_DIMS][2], most = -(double)INFINITY,
		start = seconds_now();
	int count = 0;

	for (; work && c && count < 300; count++) {
		for (int k = 0; k < p->dim_count; k++) {
			q[k][0] = p->dims[k].is_angle ? sin(count + k) : p->dims[k].range.lo;
			q[k][1] = p->dims[k].is_angle ? cos(count + k) : 0;
		}
		points_at(p, (const double(*)[2])q, work, c);
		most = fmax(most, points_above(p, c, 1, most) + points_above(p, c, -1, most));
	}
	free(work);
	free(c);
	return 0.7 * (count + 1) / (seconds_now() - start + 1e-6);
}

/* The first pass is short. */
static int find_bends(struct grid_step *g, const struct points *p, double *bends, double found, double seconds, double *speed)
{
	const double start = seconds_now();
	double done = 0;

	*speed = speed_of(p);
	for (int i = 0; i < GRID_PASSES; i++) {
		struct grid_pass *pass = &g->passes[g->pass_count];
		double before = seconds_now(), share = (i == 1 ? 0.08 : 0.4) * seconds - (before - start),
			room = i ? share * *speed : FIRST_POINTS;

		if (room < 2 * done || !choose_pass(p, pass->counts, bends, found, fmin(room, GRID_POINTS)))
			continue;
		done = grid_pass_size(p, pass->counts);
		if (!grid_pass(p, pass->counts, bends))
			return 0;
		state_bends(p, bends);
		memcpy(pass->bends, bends, sizeof pass->bends);
		*speed = grid_pass_size(p, pass->counts) / (seconds_now() - before + 1e-6);
		g->pass_count++;
	}
	return 1;
}

int grid_find(struct grid_step *g, const struct points *p, const struct bends_start *start, double found, double seconds)
{
	double bends[POINT_DIMS] = {0}, begun = seconds_now(), speed;

	*g = (struct grid_step){.dim_count = 0};
	grid_begin(p, start, bends);
	if (!(found > 0) || !isfinite(start->whole))
		return 1;
	if (!find_bends(g, p, bends, found, seconds, &speed))
		return 0;
	if (!choose_cover(p, g->counts, bends,
		fmin(GRID_POINTS, fmax(FIRST_POINTS, 0.8 * speed * (seconds - (seconds_now() - begun))))))
		return 1;
	if (!grid_cover(p, g->counts, bends, &g->value))
		return 0;
	g->value.lo -= fabs(g->value.lo) * (STATED - 1);
	g->value.hi += fabs(g->value.hi) * (STATED - 1);
	g->dim_count = p->dim_count;
	for (int k = 0; k < p->dim_count; k++)
		g->rows[k] = p->dims[k].row;
	return 1;
}

/* ---- checking ---- */

/* Between the ends of a range there is a line, so both are places. */
static int are_counts(const struct points *p, const int *counts, int is_pass)
{
	for (int k = 0; k < p->dim_count; k++) {
		const struct point_dim *dim = &p->dims[k];
		int least = is_pass ? fewest(dim) : dim->range.lo == dim->range.hi ? 1 : 2,
			most = is_pass ? GRID_PASS_PLACES : GRID_PLACES;

		if (counts[k] < least || counts[k] > most || (is_pass && !dim->is_angle && counts[k] != least))
			return 0;
	}
	return is_pass ? grid_pass_size(p, counts) <= GRID_POINTS : grid_cover_size(p, counts) <= GRID_POINTS;
}

const char *grid_check(const struct grid_step *g, const struct points *p, const struct bends_start *start)
{
	double bends[POINT_DIMS];
	struct span value;

	if (g->dim_count != p->dim_count)
		return "rows";
	for (int k = 0; k < p->dim_count; k++)
		if (g->rows[k] != p->dims[k].row)
			return "rows";
	grid_begin(p, start, bends);
	for (int i = 0; i < g->pass_count; i++) {
		if (!are_counts(p, g->passes[i].counts, 1))
			return "counts of a pass";
		if (!grid_pass(p, g->passes[i].counts, bends))
			return "memory";
		for (int k = 0; k < p->dim_count; k++)
			if (!states(g->passes[i].bends[k], bends[k]))
				return "bends";
		memcpy(bends, g->passes[i].bends, sizeof bends);
	}
	if (!are_counts(p, g->counts, 0))
		return "counts";
	if (!grid_cover(p, g->counts, bends, &value))
		return "memory";
	return !states(-g->value.lo, -value.lo) ? "low" : !states(g->value.hi, value.hi) ? "high" : NULL;
}
