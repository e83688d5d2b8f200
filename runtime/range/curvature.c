/* Second derivatives on grids; pace.c tells what follows for all q. */
#define _POSIX_C_SOURCE 200809L
#include "range/curvature.h"
#include "core/seconds.h"
#include "range/extreme.h"
#include "range/knots.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PLACES = 48, LINES = 64, MOST_POINTS = 2000000000, FIRST_POINTS = 4000, FIRST_OF_KNOTS = 400000 };

/* The outputs from `first` on that have a grid together: all, or where knots make points cheap each its own. */
struct group {
	const struct knots *knots; /* NULL: none */
	int first, end;
};

struct sweep {
	const struct field *f;
	struct grid *grid;
	const struct effort *effort;
	int k;                      /* along this dimension */
	double by[MOST_PLACES];     /* second derivative at place 0, by places */
	double by_size;
	size_t lines;
	_Atomic double *most;       /* by output: so far */
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
	double *work = s->failed ? NULL : field_work(s->f);
	double *line = malloc((size_t)(s->grid->counts[s->k] + 1) * count * sizeof *line);
	double *most = malloc((size_t)s->f->output_count * sizeof *most);

	if (!s->failed && (!work || !line || !most))
		s->failed = 1;
	for (int o = 0; o < s->f->output_count && most; o++)
		most[o] = s->most[o];
	for (size_t i = piece * LINES; i < (piece + 1) * LINES && i < s->lines && !s->failed; i++) {
		take_line(s, i, work, line, most);
		if (seconds_now() > s->effort->deadline)
			s->failed = 2;
	}
	for (int o = 0; o < s->f->output_count && most; o++)
		grid_raise(&s->most[o], most[o]);
	free(most);
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
	s->most = malloc(outputs * sizeof *s->most);
	s->failed = !s->most;
	for (size_t o = 0; o < outputs && s->most; o++)
		s->most[o] = 0;
	if (s->most)
		workers_run(s->effort->workers, s->effort->threads, take_lines, s, pieces);
	for (size_t o = 0; o < outputs && s->most; o++) {
		found[o] = s->most[o];
		found[o] += s->by_size * (s->f->noise[o] * (double)s->f->coefficient_count + 0x1p-40 * found[o]);
	}
	free(s->most);
	return s->failed == 2 ? -1 : !s->failed;
}

/* The same of one output, by knots. */
static int sweep_knots(const struct sweep *s, const struct group *g, double *found)
{
	struct knots_walk w = {.knots = g->knots, .grid = s->grid, .output = g->first, .along = s->k};
	int done = knots_walk(&w, s->effort);

	found[g->first] = fmax(w.most[0], w.most[1]) + w.off * (double)s->f->coefficient_count;
	return done;
}

/* ---- which grid ---- */

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

/* How much of all outputs' bends by other rows these places may add. */
static double weight_of(const struct field *f, const struct group *g, int k, const double *most, const double *found)
{
	double worst = 0;

	for (int o = g->first; o < g->end; o++)
		if (found[o] > 0)
			worst = fmax(worst, most[o * f->dim_count + k] / found[o]);
	return worst;
}

/* Does it matter so little that the fewest places do? */
static int is_slight(const struct field *f, int k, double weight)
{
	return field_is_point(&f->dims[k]) || pace_of(f, k, fewest(f, k)).gap * f->dims[k].degree * f->dims[k].degree * weight < 0.1;
}

/* As many places as go with the root of how much outputs bend, times `scale`; few where that is few. */
static int places_of(const struct field *f, int k, double weight, double scale)
{
	int places = f->dims[k].is_angle ? 2 * (int)(0.5 * fmin(MOST_PLACES, scale * sqrt(weight))) : LENGTH_PLACES;

	if (is_slight(f, k, weight))
		return fewest(f, k);
	return f->dims[k].is_angle && places < pace_least(&f->dims[k]) ? pace_least(&f->dims[k]) : places;
}

/* The most places that there is room for, in points of the sweeps along all dimensions. */
static int choose(const struct field *f, const struct group *g, int *counts, double room, const double *most, const double *found)
{
	int is_one = 0;

	for (double scale = 0.5; scale < 100; scale *= 1.05) {
		int now[FIELD_DIMS] = {0}, sweeps = 0;

		for (int k = 0; k < f->dim_count; k++) {
			now[k] = places_of(f, k, weight_of(f, g, k, most, found), scale);
			sweeps += now[k] >= LENGTH_PLACES;
		}
		if (size_of(f, now) * sweeps > room)
			break;
		memcpy(counts, now, sizeof now);
		is_one = sweeps > 0;
	}
	return is_one;
}

/* ---- passes ---- */

/* By dimension k from what was found on a grid. */
static void improve(struct curvature *c, const struct field *f, const struct group *g, const int *counts, int k,
	const double *found)
{
	struct pace p[FIELD_DIMS];

	for (int l = 0; l < f->dim_count; l++)
		p[l] = pace_of(f, l, counts[l]);
	for (int o = g->first; o < g->end; o++) {
		double *most = c->most + (size_t)o * (size_t)f->dim_count;

		for (int round = 0; round < PACE_ROUNDS; round++)
			most[k] = pace_best(p, f->dim_count, k, found[o], most);
	}
}

/* Those that seem to matter least first: where they matter less still the others need few places of them. */
static void set_order(int *order, const struct field *f, const struct group *g, const double *most, const double *found)
{
	for (int i = 0; i < f->dim_count; i++) {
		int at = i;

		for (; at > 0 && weight_of(f, g, order[at - 1], most, found) > weight_of(f, g, i, most, found); at--)
			order[at] = order[at - 1];
		order[at] = i;
	}
}

/* Along one dimension, over a grid, into of_k[]. 1, 0 or -1 as sweep. */
static int pass_along(struct curvature *c, const struct field *f, const struct group *g, const struct effort *x, int k,
	const int *counts, double *of_k)
{
	struct grid grid;
	struct sweep s = {.f = f, .grid = &grid, .effort = x, .k = k};
	int own[FIELD_DIMS], done;
	double start = seconds_now();

	memcpy(own, counts, sizeof own);
	own[k] = pace_own_count(f, k, counts);
	done = grid_make(&grid, f, own, 1) ? g->knots ? sweep_knots(&s, g, of_k) : sweep(&s, of_k) : 0;
	if (done == 1) {
		improve(c, f, g, own, k, of_k);
		c->speed = (seconds_now() - start) / size_of(f, own);
	}
	grid_free(&grid);
	return done;
}

/* One dimension after the other. 0: memory ran out; -1: time did. */
static int pass(struct curvature *c, const struct field *f, const struct group *g, const struct effort *x, const int *counts,
	const double *found)
{
	double *of_k = malloc(((size_t)f->output_count + 1) * sizeof *of_k);
	int now[FIELD_DIMS], order[FIELD_DIMS], done = of_k != NULL;

	memcpy(now, counts, sizeof now);
	set_order(order, f, g, c->most, found);
	for (int i = 0; i < f->dim_count && done == 1; i++) {
		int k = order[i];

		if (now[k] < LENGTH_PLACES)
			continue;
		done = pass_along(c, f, g, x, k, now, of_k);
		if (is_slight(f, k, weight_of(f, g, k, c->most, found)))
			now[k] = fewest(f, k);
	}
	free(of_k);
	return done;
}

/* Bernstein, by the largest magnitude of the output over all angles; or what is known already. */
static void begin(struct curvature *c, const struct field *f, const struct curvature_start *from)
{
	for (int o = 0; o < f->output_count; o++)
		for (int k = 0; k < f->dim_count; k++) {
			int i = o * f->dim_count + k;

			c->most[i] = fmin(from->bends[i], pace_of(f, k, 1).bend * interval_size(from->whole[o]) * (1 + 0x1p-40));
		}
}

/* Each pass has more places than the one before, as many as its share of the time allows at the speed of that pass. By knots a
   pass of few points is slow for each of them: where no grid seems to fit into the time, the next is taken to be faster. */
static int passes(struct curvature *c, const struct field *f, const struct group *g, const struct curvature_start *from,
	const struct effort *x)
{
	static const double OF_POINTS[] = {0, 0.25, 0.85}, OF_KNOTS[] = {0.3, 0.3, 0.4, 0.55, 0.7};
	const double *shares = g->knots ? OF_KNOTS : OF_POINTS;
	int done = 1, count = g->knots ? 5 : 3;
	double before = 0;

	c->speed = g->knots ? KNOTS_PACE : 1e-5;
	for (int i = 0; i < count && done == 1; i++) {
		double of_time = shares[i] * (x->deadline - seconds_now()) / c->speed;
		double room = i ? of_time : g->knots ? fmax(FIRST_POINTS, fmin(FIRST_OF_KNOTS, of_time)) : FIRST_POINTS;
		int counts[FIELD_DIMS], is_one = choose(f, g, counts, fmin(room, MOST_POINTS), c->most, from->found);

		if (is_one && size_of(f, counts) > before)
			done = pass(c, f, g, x, counts, from->found);
		else if (!is_one && g->knots)
			c->speed *= 0.3;
		before = is_one ? size_of(f, counts) : 0;
	}
	return done;
}

/* One output after the other, each with its part of the time that is left. Returns 0 when memory runs out. */
static int by_knots(struct curvature *c, const struct knots *k, const struct curvature_start *from, const struct effort *x)
{
	int n = k->f->output_count, done = 1;

	for (int o = 0; o < n && done; o++) {
		const struct group g = {k, o, o + 1};
		struct effort own = *x;

		own.deadline = seconds_now() + (x->deadline - seconds_now()) / (n - o);
		done = passes(c, k->f, &g, from, &own) != 0;
	}
	return done;
}

int curvature_find(struct curvature *c, const struct field *f, const struct curvature_start *from, const struct effort *x,
	double seconds)
{
	size_t size = (size_t)f->output_count * (size_t)f->dim_count;
	const struct group all = {NULL, 0, f->output_count};
	struct effort own = *x;

	own.deadline = fmin(x->deadline, seconds_now() + seconds);
	*c = (struct curvature){.most = malloc((size + 1) * sizeof *c->most)};
	if (!c->most)
		return 0;
	begin(c, f, from);
	return (from->knots && by_knots(c, from->knots, from, &own)) || passes(c, f, &all, from, &own) != 0;
}
