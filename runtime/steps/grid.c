#include "steps/grid.h"
#include <stdlib.h>
#include <string.h>

#define CLOSED (1 + 0x1p-40)

static int is_point(const struct point_dim *k)
{
	return !k->is_angle && k->range.lo == k->range.hi;
}

static double half_of(const struct point_dim *k)
{
	return 0.5 * (k->range.hi - k->range.lo);
}

/* |d2g/dq_k^2| is at most this times |g|. */
static double bend_of(const struct point_dim *k)
{
	if (k->is_angle)
		return (double)(k->degree * k->degree);
	return k->degree < 2 || is_point(k) ? 0 : 4 / (half_of(k) * half_of(k)) * CLOSED;
}

void grid_begin(const struct points *p, const struct bends_start *start, double *bends)
{
	for (int k = 0; k < p->dim_count; k++)
		bends[k] = fmin(start->bends[k], bend_of(&p->dims[k]) * start->whole * CLOSED);
}

/* ---- places ---- */

struct places {
	int count;
	double (*at)[2]; /* sine and cosine, or a length and nothing */
};

static void put_place(const struct point_dim *k, real q, double at[2])
{
	at[0] = k->is_angle ? (double)sinl(q) : (double)q;
	at[1] = k->is_angle ? (double)cosl(q) : 0;
}

static int is_circle(const struct point_dim *k)
{
	return k->is_angle && k->range.hi - k->range.lo >= 6.283185307179586;
}

/* The half distance, or the largest where the ends are places. */
static double spread(struct places *x, const struct point_dim *k, int count, int is_whole)
{
	static const real TURN = 6.283185307179586476925286766559L;
	int has_turn = k->is_angle && (is_whole || is_circle(k));
	double before = k->range.lo, most = 0;

	x->count = count;
	x->at = malloc((size_t)count * sizeof *x->at);
	for (int i = 0; i < count && x->at; i++) {
		double q = count == 1 ? k->range.lo : i == count - 1 ? k->range.hi : before;

		if (has_turn) {
			put_place(k, TURN * (real)i / (real)count, x->at[i]);
			continue;
		}
		if (i > 0 && i < count - 1)
			q = k->range.lo + (k->range.hi - k->range.lo) * i / (count - 1);
		most = fmax(most, out_up(q - before));
		before = q;
		put_place(k, (real)q, x->at[i]);
	}
	return has_turn ? OUT_PI / count * CLOSED : count == 1 ? out_up(k->range.hi - k->range.lo) : 0.5 * most;
}

static int grid_open(struct places *x, double *half, const struct points *p, const int *counts, int is_whole)
{
	int done = 1;

	memset(x, 0, POINT_DIMS * sizeof *x);
	for (int k = 0; k < p->dim_count; k++) {
		half[k] = spread(&x[k], &p->dims[k], counts[k], is_whole);
		done &= x[k].at != NULL;
	}
	return done;
}

static void grid_close(struct places *x)
{
	for (int k = 0; k < POINT_DIMS; k++)
		free(x[k].at);
}

/* The next point, those of `skip` apart; 0 after the last one. */
static int next(const struct points *p, const struct places *x, int skip, int *index, double (*q)[2])
{
	int k = 0;

	while (k < p->dim_count && (k == skip || ++index[k] == x[k].count)) {
		if (k != skip)
			index[k] = 0;
		k++;
	}
	for (int i = 0; i < p->dim_count && i <= k; i++)
		if (i != skip)
			memcpy(q[i], x[i].at[index[i]], sizeof q[i]);
	return k < p->dim_count;
}

static void first(const struct points *p, const struct places *x, int *index, double (*q)[2])
{
	memset(index, 0, POINT_DIMS * sizeof *index);
	for (int k = 0; k < p->dim_count; k++)
		memcpy(q[k], x[k].at[0], sizeof q[k]);
}

/* ---- second derivatives ---- */

/* Of a trigonometric polynomial at place 0 by the values at n places of a circle, n > 2 degree; of a parabola by those at
   three. */
static double set_weights(const struct point_dim *k, int n, double *by)
{
	double size = 0, half = half_of(k);

	for (int j = 0; j < n; j++) {
		real sine = sinl((real)j * 3.141592653589793238462643383280L / (real)n),
			cosine = cosl((real)j * 3.141592653589793238462643383280L / (real)n);

		if (!k->is_angle)
			by[j] = (j == 1 ? -2 : 1) / (half * half);
		else if (j == 0)
			by[j] = (n % 2 ? 1.0 - (double)n * n : -2.0 - (double)n * n) / 12;
		else
			by[j] = (j % 2 ? 1 : -1) * (double)((n % 2 ? cosine : 1) / (2 * sine * sine));
		size += fabs(by[j]);
	}
	return size;
}

struct sweep {
	const struct points *p;
	int k;
	double by[GRID_PASS_PLACES], *work, *line, *second; /* line: [place][coefficient] */
	double most;
};

static void take_line(struct sweep *s, double (*q)[2], const struct places *own)
{
	size_t count = s->p->coefficients;
	int turns = s->p->dims[s->k].is_angle ? own->count : 1;

	for (int i = 0; i < own->count; i++) {
		memcpy(q[s->k], own->at[i], sizeof q[s->k]);
		points_at(s->p, (const double(*)[2])q, s->work, s->line + (size_t)i * count);
	}
	for (int t = 0; t < turns; t++) {
		memset(s->second, 0, count * sizeof *s->second);
		for (int i = 0; i < own->count; i++)
			for (size_t c = 0; c < count; c++)
				s->second[c] += s->by[(i - t + own->count) % own->count] * s->line[(size_t)i * count + c];
		for (int sign = -1; sign <= 1; sign += 2)
			s->most = fmax(s->most, points_above(s->p, s->second, sign, s->most));
	}
}

/* Places along the dimension that is differentiated. */
static int own_count(const struct point_dim *k, int count)
{
	int least = k->is_angle ? 2 * k->degree + 2 : 3;

	return k->is_angle && count > least ? count : least;
}

/* The largest second derivative by q_k on the grid. */
static int sweep(const struct points *p, const int *counts, int k, double *most)
{
	struct sweep *s = calloc(1, sizeof *s);
	struct places x[POINT_DIMS];
	double half[POINT_DIMS], q[POINT_DIMS][2], size;
	int index[POINT_DIMS], done = s && grid_open(x, half, p, counts, 1);

	if (!s)
		return 0;
	*s = (struct sweep){.p = p, .k = k};
	size = set_weights(&p->dims[k], counts[k], s->by);
	s->work = points_work(p);
	s->line = malloc(((size_t)counts[k] + 1) * p->coefficients * sizeof *s->line);
	done &= s->work && s->line;
	if (done) {
		s->second = s->line + (size_t)counts[k] * p->coefficients;
		first(p, x, index, q);
		do
			take_line(s, q, &x[k]);
		while (next(p, x, k, index, q));
		*most = (s->most + size * (p->noise + 0x1p-44 * p->size) * (double)p->coefficients) * CLOSED;
	}
	grid_close(x);
	free(s->work);
	free(s->line);
	free(s);
	return done;
}

/* What a dimension adds. */
struct addition {
	double factor, gap; /* factor INFINITY: that way is closed */
};

static struct addition addition_of(const struct point_dim *l, int count)
{
	static const double lebesgue[] = {1, 1, 1.25};
	double half = OUT_PI / count * CLOSED;

	if (!l->is_angle)
		return (struct addition){is_point(l) ? 1 : lebesgue[l->degree] * CLOSED, 0};
	return (struct addition){count > 2 * l->degree ? CLOSED / cos(l->degree * half) : (double)INFINITY,
		half * half / 2 * CLOSED};
}

/* One way or the other for each dimension: the best that changing one after the other finds. */
static double everywhere(const struct points *p, const int *counts, int k, double most, const double *bends)
{
	double factors[POINT_DIMS], gaps[POINT_DIMS], best = (double)INFINITY;
	int by_factor[POINT_DIMS];

	for (int l = 0; l < p->dim_count; l++) {
		struct addition a = addition_of(&p->dims[l], counts[l]);

		factors[l] = a.factor;
		gaps[l] = a.gap * fmin(bend_of(&p->dims[l]) * bends[k], bend_of(&p->dims[k]) * bends[l]) * CLOSED;
		by_factor[l] = !p->dims[l].is_angle || isfinite(a.factor);
	}
	for (int change = -1; change < p->dim_count; change++) {
		double factor = 1, sum = most;

		if (change >= 0 && !p->dims[change].is_angle)
			continue;
		if (change >= 0)
			by_factor[change] = !by_factor[change];
		for (int l = 0; l < p->dim_count; l++) {
			factor *= by_factor[l] ? factors[l] * CLOSED : 1;
			sum += by_factor[l] ? 0 : gaps[l];
		}
		if (change >= 0 && !(factor * sum < best))
			by_factor[change] = !by_factor[change];
		best = fmin(best, factor * sum * CLOSED);
	}
	return best;
}

static int needs_sweep(const struct point_dim *k, int count)
{
	return !is_point(k) && (k->is_angle ? k->degree > 0 && count > 1 : k->degree == 2);
}

int grid_pass(const struct points *p, const int *counts, double *bends)
{
	int own[POINT_DIMS];

	memcpy(own, counts, sizeof own);
	for (int k = 0; k < p->dim_count; k++) {
		double most = (double)INFINITY;

		if (!needs_sweep(&p->dims[k], counts[k]))
			continue;
		own[k] = own_count(&p->dims[k], counts[k]);
		if (!sweep(p, own, k, &most))
			return 0;
		for (int round = 0; round < 4; round++)
			bends[k] = fmin(bends[k], everywhere(p, own, k, most, bends));
		own[k] = counts[k];
	}
	return 1;
}

double grid_pass_size(const struct points *p, const int *counts)
{
	double size = 1, sum = 0;

	for (int k = 0; k < p->dim_count; k++)
		size *= counts[k];
	for (int k = 0; k < p->dim_count; k++)
		sum += needs_sweep(&p->dims[k], counts[k]) ? size / counts[k] * own_count(&p->dims[k], counts[k]) : 0;
	return sum;
}

/* ---- the range ---- */

double grid_cover_size(const struct points *p, const int *counts)
{
	double size = 1;

	for (int k = 0; k < p->dim_count; k++)
		size *= counts[k];
	return size;
}

/* All sums round, and the model's constants are not quite those of the exact robot: 2^-30 is far more. */
static double closed(double value, double slack, double noise)
{
	return out_up(value + slack + noise + 0x1p-30 * (fabs(value) + slack));
}

int grid_cover(const struct points *p, const int *counts, const double *bends, struct span *value)
{
	struct places x[POINT_DIMS];
	double half[POINT_DIMS], q[POINT_DIMS][2], slack = 0, noise = p->noise * (double)p->coefficients * CLOSED;
	double *work = points_work(p), *c = malloc(p->coefficients * sizeof *c), above = -(double)INFINITY,
		below = -(double)INFINITY;
	int index[POINT_DIMS], done = grid_open(x, half, p, counts, 0) && work && c;

	if (done) {
		first(p, x, index, q);
		do {
			points_at(p, (const double(*)[2])q, work, c);
			above = fmax(above, points_above(p, c, 1, above));
			below = fmax(below, points_above(p, c, -1, below));
		} while (next(p, x, -1, index, q));
		for (int k = 0; k < p->dim_count; k++)
			slack += p->dims[k].range.lo == p->dims[k].range.hi ? 0 : half[k] * half[k] / 2 * bends[k] * CLOSED;
		*value = (struct span){-closed(below, slack, noise), closed(above, slack, noise)};
	}
	grid_close(x);
	free(work);
	free(c);
	return done;
}
