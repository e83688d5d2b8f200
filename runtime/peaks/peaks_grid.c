/* What values can be between the places of a grid, in two ways for each row k of q:
   - M. Riesz (Eine trigonometrische Interpolationsformel, 1914): a trigonometric polynomial of degree d is at most
   1/cos(pi d/n) times its largest value at n > 2 d places of a circle, evenly spread;
   - straight lines between places h apart, half of that to the nearest: it is off them by h^2/2 of its second
   derivative.
   - a single place in the middle of a range: by half of that times its first derivative.
   Taken for one row after the other, those for Riesz first,
     |u| <= product of 1/cos (largest at places + sum of h^2/2 |d2u/dq_k^2| + sum of h |du/dq_k|).
   For a vector u of the components along a fixed direction, so of its length. Second derivatives are bounded by norms,
   and by Bernstein: d^2 of the largest over all angles. So first places are spread over all angles, then over the box.
 */
#define _POSIX_C_SOURCE 200809L
#include "core/seconds.h"
#include "peaks/peaks_points.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Closer than this, over what is found, bounds need not be. */
#define CLOSE 0.01
#define WORTH 0.99  /* of what is known */
#define UNKNOWN 1e9 /* a derivative, over what is found */

enum { FIRST_POINTS = 1024, MORE = 8, MOST_PLACES = 4096, AHEAD = 12 };

/* Of the time: with places over all angles. */
#define SHARE_WHOLE 0.6
#define OF_TIME 0.6 /* a grid that is not done in time is lost */
#define LATE 1	    /* of the time, by which it may be late */

static const real TURN = 6.283185307179586476925286766559L;

struct gridding {
	struct peaks *p;
	const struct peaks_group *g;
	struct peaks_points *points;
	int dims[PEAKS_DIMS], dim_count; /* of p->dims */
	int is_whole;
	double lower[PEAKS_DIMS], upper[PEAKS_DIMS], half[PEAKS_DIMS];
	double bend[PEAKS_DIMS], tilt[PEAKS_DIMS]; /* weighted, over what was found */
	int counts[PEAKS_DIMS];
	peaks_place *places[PEAKS_DIMS];
	double *found; /* by member */
	double size;   /* of the grid */
	double pace;   /* seconds of a point */
	double late;   /* a grid that takes longer than was thought is given up then */
	struct arena arena;
};

static int is_circle(const struct gridding *s, int k)
{
	return s->is_whole && s->p->is_angle[s->dims[k]];
}

static int degree_of(const struct gridding *s, int k)
{
	return is_circle(s, k) ? s->g->degrees[s->dims[k]] : PEAK_NO_DEGREE;
}

/* By how much a row's places make bounds larger than what is found: Riesz; INFINITY where there are too few. */
static double factor_of(const struct gridding *s, int k, int n)
{
	int d = degree_of(s, k);

	return d == 0				 ? 1
	       : d < PEAK_NO_DEGREE && n > 2 * d ? (1 + 0x1p-40) / cos(3.14159265358979323846 * d / n)
						 : (double)INFINITY;
}

/* h^2/2, as it will be about */
static double gap_of(const struct gridding *s, int k, int n)
{
	double half = 0.5 * (s->upper[k] - s->lower[k]) / (is_circle(s, k) ? n : n - 1);

	return 0.5 * half * half;
}

/* ---- which grid ---- */

static double bend_of(const struct gridding *s, const struct peak *x, int k)
{
	double bends = x->bends[s->dims[k]];

	return s->is_whole ? bends : interval_least(x->near[s->dims[k]], bends);
}

/* Of the members, by their weights. */
static void weigh_bends(struct gridding *s)
{
	for (int k = 0; k < s->dim_count; k++) {
		double bends = 0, tilts = 0, weights = 0;

		for (size_t i = 0; i < s->g->count; i++) {
			const struct peak *x = &s->p->list[s->g->members[i]];
			double size = s->found[i] > 0 ? s->found[i] : x->most;

			if (!(size > 0))
				continue;
			bends += x->weight * fmin(UNKNOWN, bend_of(s, x, k) / size);
			tilts += x->weight * fmin(UNKNOWN, x->tilts[s->dims[k]] / size);
			weights += x->weight;
		}
		s->bend[k] = weights > 0 ? bends / weights : 0;
		s->tilt[k] = weights > 0 ? tilts / weights : 0;
	}
}

/* About what a row adds to the bound, over what is found. */
static double cost_of(const struct gridding *s, int k, int n)
{
	if (!is_circle(s, k) && n == 1)
		return 0.5 * (s->upper[k] - s->lower[k]) * s->tilt[k];
	return fmin(factor_of(s, k, n) - 1, gap_of(s, k, n) * s->bend[k]);
}

static double cost_of_all(const struct gridding *s)
{
	double sum = 0;

	for (int k = 0; k < s->dim_count; k++)
		sum += cost_of(s, k, s->counts[k]);
	return sum;
}

/* Places where they gain most, in room for so many points. */
static double choose(struct gridding *s, double room)
{
	double size = 1;

	weigh_bends(s);
	for (int k = 0; k < s->dim_count; k++)
		s->counts[k] = 1;
	while (cost_of_all(s) > CLOSE) {
		double best = 0;
		int at = -1, to = 0;

		for (int k = 0; k < s->dim_count; k++)
			for (int n = s->counts[k] + 1; n <= s->counts[k] + AHEAD && n <= MOST_PLACES; n++) {
				double more = (double)n / s->counts[k];
				double gain = (cost_of(s, k, s->counts[k]) - cost_of(s, k, n)) / log(more);

				if (size * more <= room && gain > best) {
					best = gain;
					at = k;
					to = n;
				}
			}
		if (at < 0)
			break;
		size *= (double)to / s->counts[at];
		s->counts[at] = to;
	}
	return size;
}

/* ---- places ---- */

static void put_place(peaks_place *to, real x)
{
	(*to)[0] = (double)x;
	(*to)[1] = (double)sinl(x);
	(*to)[2] = (double)cosl(x);
}

static void spread_circle(struct gridding *s, int k)
{
	for (int i = 0; i < s->counts[k]; i++)
		put_place(&s->places[k][i], TURN * (real)i / (real)s->counts[k]);
	s->half[k] = round_up((double)(TURN / 2 / (real)s->counts[k]) * (1 + 0x1p-40));
}

static void spread_range(struct gridding *s, int k)
{
	double before = s->lower[k], most = 0;
	int n = s->counts[k];

	if (n == 1) {
		double middle = 0.5 * s->lower[k] + 0.5 * s->upper[k];

		put_place(&s->places[k][0], (real)middle);
		s->half[k] = 2 * fmax(round_up(s->upper[k] - middle), round_up(middle - s->lower[k]));
		return;
	}
	for (int i = 0; i < n; i++) {
		double x = i == n - 1 ? s->upper[k]
				      : fmin(s->upper[k], s->lower[k] + (s->upper[k] - s->lower[k]) * i / (n - 1));

		put_place(&s->places[k][i], (real)x);
		most = fmax(most, round_up(x - before));
		before = x;
	}
	s->half[k] = 0.5 * most;
}

static int make_places(struct gridding *s)
{
	for (int k = 0; k < s->dim_count; k++) {
		if (!(s->places[k] = arena_alloc(&s->arena, (size_t)s->counts[k], sizeof *s->places[k])))
			return 0;
		if (is_circle(s, k))
			spread_circle(s, k);
		else
			spread_range(s, k);
	}
	return 1;
}

/* A range that is longer than a turn is one. */
static void set_ranges(struct gridding *s)
{
	for (int k = 0; k < s->dim_count; k++) {
		struct interval r = s->p->rows[s->p->position][s->p->dims[s->dims[k]]];
		double turn = round_up(r.lower + (double)TURN * (1 + 0x1p-48));

		s->lower[k] = is_circle(s, k) ? 0 : r.lower;
		s->upper[k] = is_circle(s, k)				     ? (double)TURN
			      : s->p->is_angle[s->dims[k]] && turn < r.upper ? turn
									     : r.upper;
	}
}

/* ---- bounds ---- */

static double slack_of(const struct gridding *s, const struct peak *x, int k)
{
	double bends = bend_of(s, x, k), tilts = x->tilts[s->dims[k]];

	if (!is_circle(s, k) && s->counts[k] == 1)
		return tilts > 0 ? 0.5 * s->half[k] * tilts * (1 + 0x1p-40) : 0;
	return bends > 0 ? s->half[k] * s->half[k] / 2 * bends : 0;
}

static double bound_by(const struct gridding *s, const struct peak *x, double found, const unsigned char *is_first)
{
	double sum = found + 0x1p-500, factor = 1; /* what squares of up to 512 lanes lose below the least normal number */

	for (int k = 0; k < s->dim_count; k++)
		if (is_first[k])
			factor *= factor_of(s, k, s->counts[k]);
		else
			sum += slack_of(s, x, k);
	return factor * sum * (1 + 0x1p-30) + DBL_MIN;
}

/* The best that is found by changing the way of one row at a time. */
static double bound_of(const struct gridding *s, const struct peak *x, double found)
{
	unsigned char is_first[PEAKS_DIMS] = {0};
	double best;

	for (int k = 0; k < s->dim_count; k++)
		is_first[k] = isfinite(factor_of(s, k, s->counts[k])) ? 1 : 0;
	best = bound_by(s, x, found, is_first);
	for (int k = 0; k < s->dim_count; k++) {
		double now;

		if (!isfinite(factor_of(s, k, s->counts[k])))
			continue;
		is_first[k] = !is_first[k];
		now = bound_by(s, x, found, is_first);
		if (now < best)
			best = now;
		else
			is_first[k] = !is_first[k];
	}
	return best;
}

static void take_found(const struct gridding *s)
{
	for (size_t i = 0; i < s->g->count; i++) {
		struct peak *x = &s->p->list[s->g->members[i]];
		double bound = bound_of(s, x, s->found[i] + peaks_points_off(s->points, i));

		x->found = s->found[i];
		x->most = interval_least(bound, x->most);
		if (s->is_whole)
			x->whole = interval_least(bound, x->whole);
	}
}

/* Bernstein: d^2 of the largest over all angles. */
static void take_degrees(const struct gridding *s)
{
	for (size_t i = 0; i < s->g->count; i++) {
		struct peak *x = &s->p->list[s->g->members[i]];

		for (int k = 0; k < s->dim_count; k++) {
			double d = s->g->degrees[s->dims[k]];

			if (d < PEAK_NO_DEGREE && s->p->is_angle[s->dims[k]])
				x->bends[s->dims[k]] =
					interval_least(d * d * x->whole * (1 + 0x1p-40), x->bends[s->dims[k]]);
		}
	}
}

/* ---- rounds ---- */

/* Is a grid likely to gain anything? */
static int is_worth(const struct gridding *s)
{
	double bound = 0, most = 0, over = 1 + cost_of_all(s);

	for (size_t i = 0; i < s->g->count; i++) {
		const struct peak *x = &s->p->list[s->g->members[i]];

		bound += x->weight * fmin(1, over * s->found[i] / x->most);
		most += x->weight;
	}
	return bound < WORTH * most;
}

/* Returns 0 when memory runs out. */
static int take_grid(struct gridding *s, double room)
{
	double start = seconds_now();

	s->size = choose(s, room);
	if (s->pace > 0 && !is_worth(s))
		return 1;
	if (!make_places(s))
		return 0;
	if (peaks_points_take(s->points, s->counts, s->places, s->found, s->late)) {
		take_found(s);
		s->pace = (seconds_now() - start) / s->size;
	}
	return 1;
}

/* On a few points first, to see how long they take; then on more and more, so that what is lost in the end is not all.
 */
static int take_rounds(struct gridding *s, int is_whole, double deadline)
{
	double room = FIRST_POINTS;
	int done;

	s->is_whole = is_whole;
	set_ranges(s);
	for (;;) {
		double before = room;

		done = take_grid(s, room);
		room = s->pace > 0 ? OF_TIME * (deadline - seconds_now()) / s->pace : 0;
		if (!done || room < 2 * before || cost_of_all(s) <= CLOSE)
			return done;
		room = fmin(room, MORE * before);
	}
}

int peaks_grid(struct peaks *p, const struct peaks_group *g, double deadline)
{
	double now = seconds_now();
	struct gridding s = {.p = p, .g = g, .late = fmin(p->deadline, deadline + LATE * (deadline - now))};
	int is_large, done;

	arena_init(&s.arena, NULL);
	for (int k = 0; k < p->dim_count; k++)
		if (g->dims >> k & 1)
			s.dims[s.dim_count++] = k;
	s.points = peaks_points_new(p, g, &is_large);
	s.found = calloc(g->count + 1, sizeof *s.found);
	done = s.points && s.found;
	if (done && !is_large) {
		done = take_rounds(&s, 1, now + SHARE_WHOLE * (deadline - now));
		take_degrees(&s);
		done = done && take_rounds(&s, 0, deadline);
	}
	peaks_points_free(s.points);
	free(s.found);
	arena_free(&s.arena);
	return done;
}
