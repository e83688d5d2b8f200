/* Second derivatives on grids; pace.c tells what follows for all q. */
#define _POSIX_C_SOURCE 200809L
#include "range/curvature.h"
#include "core/seconds.h"
#include "range/extreme.h"
#include "range/pace.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PLACES = 48, LINES = 64, MOST_POINTS = 20000000 };

struct sweep {
	const struct field *f;
	struct grid *grid;
	const struct effort *effort;
	int k;                      /* along this dimension */
	double by[MOST_PLACES];     /* second derivative at place 0, by places */
	double by_size;
	size_t lines;
	double *most;               /* [piece][output] */
	atomic_int failed;
};

/* ---- one dimension ---- */

/* The second derivative of a trigonometric polynomial at a place, by its values at n places of a circle: n > 2 degree. */
static void set_circle(struct sweep *s, int n)
{
	const double pi = 3.14159265358979323846;

	s->by[0] = n % 2 ? -(n * n - 1) / 12.0 : -(n * n + 2) / 12.0;
	for (int j = 1; j < n; j++) {
		double sine = sin(pi * j / n);

		s->by[j] = (j % 2 ? 1 : -1) * (n % 2 ? cos(pi * j / n) : 1) / (2 * sine * sine);
	}
}

static void set_length(struct sweep *s, const struct field_dim *k)
{
	double half = 0.5 * (k->upper - k->lower);

	s->by[0] = s->by[2] = 1 / (half * half);
	s->by[1] = -2 / (half * half);
}

static void set_derivative(struct sweep *s)
{
	const struct field_dim *dim = &s->f->dims[s->k];
	int n = s->grid->counts[s->k];

	if (dim->is_angle)
		set_circle(s, n);
	else
		set_length(s, dim);
	s->by_size = 0;
	for (int i = 0; i < n; i++)
		s->by_size += fabs(s->by[i]);
}

/* Second derivatives of all coefficients at place t, from those of the whole line. */
static void derive(const struct sweep *s, const double *line, int t, double *out)
{
	size_t count = (size_t)s->f->output_count * s->f->coefficient_count;
	int n = s->grid->counts[s->k];

	memset(out, 0, count * sizeof *out);
	for (int i = 0; i < n; i++) {
		double by = s->by[(i - t + n) % n];
		const double *from = line + (size_t)i * count;

		for (size_t c = 0; c < count; c++)
			out[c] += by * from[c];
	}
}

static void take_place(const struct sweep *s, const double *c, double *most)
{
	for (int o = 0; o < s->f->output_count; o++) {
		const double *of = c + (size_t)o * s->f->coefficient_count;

		for (int sign = -1; sign <= 1; sign += 2)
			most[o] = fmax(most[o], extreme_above(s->f, of, sign, most[o]));
	}
}

static void take_line(const struct sweep *s, size_t number, double *work, double *line, double *most)
{
	size_t count = (size_t)s->f->output_count * s->f->coefficient_count;
	int n = s->grid->counts[s->k];
	struct field_point q;

	grid_point(s->grid, number, &q);
	for (int i = 0; i < n; i++) {
		q.x[s->k][0] = s->grid->places[s->k][i][0];
		q.x[s->k][1] = s->grid->places[s->k][i][1];
		field_evaluate(s->f, &q, work, line + (size_t)i * count);
	}
	for (int t = 0; t < (s->f->dims[s->k].is_angle ? n : 1); t++) {
		derive(s, line, t, line + (size_t)n * count);
		take_place(s, line + (size_t)n * count, most);
	}
}

static void take_lines(void *job, size_t piece)
{
	struct sweep *s = job;
	size_t count = (size_t)s->f->output_count * s->f->coefficient_count;
	double *work = field_work(s->f), *line = malloc((size_t)(s->grid->counts[s->k] + 1) * count * sizeof *line);

	if (!work || !line)
		s->failed = 1;
	for (size_t i = piece * LINES; i < (piece + 1) * LINES && i < s->lines && !s->failed; i++)
		take_line(s, i, work, line, s->most + piece * (size_t)s->f->output_count);
	if (seconds_now() > s->effort->deadline)
		s->failed = 2;
	free(line);
	free(work);
}

/* The largest |g| on the grid into found[output], by dimension k. 0: memory ran out; -1: time did. */
static int sweep(struct sweep *s, double *found)
{
	size_t pieces, outputs = (size_t)s->f->output_count;

	s->grid->skip = s->k;
	s->lines = (size_t)grid_size(s->grid);
	pieces = (s->lines + LINES - 1) / LINES;
	set_derivative(s);
	s->most = calloc(pieces * outputs, sizeof *s->most);
	s->failed = !s->most;
	if (s->most)
		workers_run(s->effort->workers, s->effort->threads, take_lines, s, pieces);
	for (size_t o = 0; o < outputs; o++) {
		found[o] = 0;
		for (size_t i = 0; i < pieces && s->most; i++)
			found[o] = fmax(found[o], s->most[i * outputs + o]);
		found[o] += s->by_size * (s->f->noise[o] * (double)s->f->coefficient_count + 0x1p-40 * found[o]);
	}
	free(s->most);
	return s->failed == 2 ? -1 : !s->failed;
}

/* ---- which grid ---- */

/* The logarithm of how many points the cover will need: it goes with the root of each curvature. */
static double cost_of(const struct field *f, const int *counts, const double *found, const double *most)
{
	double sum = 0, now[FIELD_DIMS];

	for (int o = 0; o < f->output_count; o++) {
		memcpy(now, most + (size_t)o * (size_t)f->dim_count, (size_t)f->dim_count * sizeof *now);
		pace_close(f, counts, found + (size_t)o * (size_t)f->dim_count, now);
		for (int k = 0; k < f->dim_count; k++)
			sum += 0.5 * log(now[k] + 1e-300);
	}
	return sum / f->output_count;
}

static double size_of(const struct field *f, const int *counts)
{
	double size = 1;

	for (int k = 0; k < f->dim_count; k++)
		size *= counts[k];
	return size;
}

/* One place of a circle, or the ends of a length. */
static int fewest(const struct field *f, int k)
{
	return f->dims[k].is_angle || field_is_point(&f->dims[k]) ? 1 : 2;
}

/* Would these do, beside what the outputs bend by others? */
static int is_weak(const struct field *f, int k, const double *most, const double *found)
{
	double gap = pace_of(f, k, fewest(f, k)).gap;

	for (int o = 0; o < f->output_count; o++) {
		double largest = 0;

		for (int l = 0; l < f->dim_count; l++)
			largest = fmax(largest, found[o * f->dim_count + l]);
		if (gap * f->degree * f->degree * most[o * f->dim_count + k] > 0.1 * largest)
			return 0;
	}
	return 1;
}

/* More places where they gain the most, as long as there is room. */
static void choose(const struct field *f, int *counts, double room, const double *found, const double *most)
{
	for (;;) {
		double now = cost_of(f, counts, found, most), best = 0;
		int at = -1;

		for (int k = 0; k < f->dim_count; k++) {
			double gain;

			int step = counts[k] < LEAST_PLACES ? LEAST_PLACES - counts[k] : 2;

			if (!f->dims[k].is_angle || counts[k] + step > MOST_PLACES ||
				size_of(f, counts) / counts[k] * (counts[k] + step) > room)
				continue;
			counts[k] += step;
			gain = (now - cost_of(f, counts, found, most)) / log((double)counts[k] / (counts[k] - step));
			counts[k] -= step;
			if (gain > best) {
				best = gain;
				at = k;
			}
		}
		if (at < 0)
			return;
		counts[at] += 2;
	}
}

/* By dimension k from what was found on a grid. */
static void improve(struct curvature *c, const struct field *f, const int *counts, int k, const double *found)
{
	struct pace p[FIELD_DIMS];

	for (int l = 0; l < f->dim_count; l++)
		p[l] = pace_of(f, l, counts[l]);
	for (int o = 0; o < f->output_count; o++) {
		double *most = c->most + (size_t)o * (size_t)f->dim_count;

		for (int round = 0; round < PACE_ROUNDS; round++)
			most[k] = pace_best(p, f->dim_count, k, found[o], most);
	}
}

/* One dimension after the other, over a grid. 0: memory ran out; -1: time did. */
static int pass(struct curvature *c, const struct field *f, const struct effort *x, const int *counts, double *found)
{
	struct grid grid;
	struct sweep s = {.f = f, .grid = &grid, .effort = x};
	size_t n = (size_t)f->dim_count, outputs = (size_t)f->output_count;
	double *of_k = malloc((outputs + 1) * sizeof *of_k);
	int own[FIELD_DIMS], done = of_k != NULL;

	memcpy(own, counts, sizeof own);
	for (s.k = 0; s.k < f->dim_count && done == 1; s.k++) {
		double start = seconds_now();

		if (counts[s.k] < (f->dims[s.k].is_angle ? LEAST_PLACES : LENGTH_PLACES))
			continue;
		own[s.k] = pace_own_count(f, s.k, counts);
		done = grid_make(&grid, f, own, 1) ? sweep(&s, of_k) : 0;
		for (size_t o = 0; o < outputs && done == 1; o++)
			found[o * n + (size_t)s.k] = of_k[o];
		if (done == 1) {
			improve(c, f, own, s.k, of_k);
			c->speed = (seconds_now() - start) / ((double)s.lines * own[s.k]);
		}
		own[s.k] = counts[s.k];
		grid_free(&grid);
	}
	free(of_k);
	return done;
}

/* Bernstein, by the largest magnitude of the output over all angles; or what is known already. In place of what places find stands that
   outputs bend about as much as they are large. */
static void begin(struct curvature *c, const struct field *f, const struct curvature_start *from, double *found)
{
	for (int o = 0; o < f->output_count; o++)
		for (int k = 0; k < f->dim_count; k++) {
			int i = o * f->dim_count + k;

			c->most[i] = fmin(from->bends[i], pace_of(f, k, 1).bend * interval_size(from->whole[o]) * (1 + 0x1p-40));
			found[i] = from->found[o];
		}
}

/* A first pass of few places, then more where they gain, as long as there is time. */
static int passes(struct curvature *c, const struct field *f, const struct effort *x, double *found)
{
	int counts[FIELD_DIMS], done, strong = 0;

	for (int k = 0; k < f->dim_count; k++)
		counts[k] = is_weak(f, k, c->most, found) ? fewest(f, k) : f->dims[k].is_angle ? LEAST_PLACES : LENGTH_PLACES;
	if (size_of(f, counts) > MOST_POINTS)
		return 1;
	done = pass(c, f, x, counts, found);
	for (int k = 0; k < f->dim_count && done == 1; k++) {
		int is_few = is_weak(f, k, c->most, found);

		counts[k] = is_few ? fewest(f, k) : counts[k];
		strong += !is_few;
	}
	for (int i = 0; i < 2 && done == 1 && strong; i++) {
		choose(f, counts, (i ? 0.8 : 0.3) * (x->deadline - seconds_now()) / c->speed / strong, found, c->most);
		done = pass(c, f, x, counts, found);
	}
	return done;
}

int curvature_find(struct curvature *c, const struct field *f, const struct curvature_start *from, const struct effort *x, double seconds)
{
	size_t size = (size_t)f->output_count * (size_t)f->dim_count;
	double *found = calloc(size + 1, sizeof *found);
	struct effort own = *x;
	int done;

	own.deadline = fmin(x->deadline, seconds_now() + seconds);
	*c = (struct curvature){.most = malloc((size + 1) * sizeof *c->most)};
	if (c->most && found)
		begin(c, f, from, found);
	done = c->most && found ? passes(c, f, &own, found) : 0;
	free(found);
	return done != 0;
}
