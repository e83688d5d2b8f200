/* Let I_k replace a function on each line along q_k by the straight lines between its values at the places. It is positive, so
   |I_k f| <= |f|, and |f - I_k f| <= h_k^2/2 sup |d2f/dq_k^2|. Taken for one dimension after the other,
     f <= (largest value at a place) + sum_k h_k^2/2 sup |d2f/dq_k^2|.
   This holds for each drive and rate, so also for the largest over them. */
#define _POSIX_C_SOURCE 200809L
#include "range/cover.h"
#include "core/seconds.h"
#include "range/extreme.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* How often to look at the clock. */
enum { LOOK_EVERY = 16 };

enum { POINTS = 256, MOST_PLACES = 4096, FIRST_POINTS = 4096, FIRST_OF_KNOTS = 100000, FIRST_LEAST = 64 };

struct covering {
	const struct field *f;
	struct grid grid;
	const struct effort *effort;
	const double (*found)[2];
	size_t points;
	const struct knots *knots; /* NULL: none */
	double pace;
	int first, end; /* outputs that have a grid together: all, or where knots make points cheap each its own */
	double *most; /* [piece][output][2]: of -f, of f */
	atomic_int failed;
};

static void take_point(const struct covering *s, const double *c, double *most)
{
	for (int o = 0; o < s->f->output_count; o++)
		for (int side = 0; side < 2; side++) {
			double *to = &most[2 * o + side];

			*to = fmax(*to, extreme_above(s->f, c + (size_t)o * s->f->coefficient_count, side ? 1 : -1, *to));
		}
}

static void take_points(void *job, size_t piece)
{
	struct covering *s = job;
	size_t outputs = (size_t)s->f->output_count;
	double *work = s->failed ? NULL : field_work(s->f), *c = malloc(outputs * s->f->coefficient_count * sizeof *c);
	double *most = s->most + 2 * outputs * piece;
	struct field_point q;

	if (!s->failed && (!work || !c))
		s->failed = 1;
	for (size_t o = 0; o < outputs; o++) {
		most[2 * o] = -s->found[o][0];
		most[2 * o + 1] = s->found[o][1];
	}
	for (size_t i = piece * POINTS; i < (piece + 1) * POINTS && i < s->points && !s->failed; i++) {
		grid_point(&s->grid, i, &q);
		field_evaluate(s->f, &q, work, c);
		take_point(s, c, most);
		if (i % LOOK_EVERY == 0 && seconds_now() > s->effort->deadline)
			s->failed = 2;
	}
	free(c);
	free(work);
}

/* ---- which grid ---- */

/* Over its range, of which an angle too may have one value; field_is_point is about whole circles. */
static int has_one_value(const struct field_dim *k)
{
	return k->lower == k->upper;
}

static double gap_of(const struct field_dim *k, int count)
{
	double width = k->upper - k->lower;
	double half = k->is_circle ? 3.1415926535897932 / count : count == 1 ? width : 0.5 * width / (count - 1);

	return half * half / 2;
}

static double slack_of(const struct field *f, const int *counts, const double *bends)
{
	double sum = 0;

	for (int k = 0; k < f->dim_count; k++)
		sum += has_one_value(&f->dims[k]) ? 0 : gap_of(&f->dims[k], counts[k]) * bends[k];
	return sum;
}

/* The outputs' slacks over what was found; large ones count more. */
static double worth_of(const struct covering *s, const int *counts, const double *bends)
{
	double sum = 0, slack;

	for (int o = s->first; o < s->end; o++) {
		double size = fmax(fabs(s->found[o][0]), fabs(s->found[o][1]));

		if (!(size > 0))
			continue;
		slack = slack_of(s->f, counts, bends + (size_t)o * (size_t)s->f->dim_count) / size;
		sum += slack * slack;
	}
	return sum;
}

static void choose(const struct covering *s, int *counts, double room, const double *bends)
{
	double size = 1;

	for (int k = 0; k < s->f->dim_count; k++) {
		counts[k] = has_one_value(&s->f->dims[k]) ? 1 : 2;
		size *= counts[k];
	}
	for (;;) {
		double now = worth_of(s, counts, bends), best = 0;
		int at = -1;

		for (int k = 0; k < s->f->dim_count; k++) {
			double gain, more = (counts[k] + 1.0) / counts[k];

			if (has_one_value(&s->f->dims[k]) || size * more > room || counts[k] == MOST_PLACES)
				continue;
			counts[k]++;
			gain = (now - worth_of(s, counts, bends)) / log(more);
			counts[k]--;
			if (gain > best) {
				best = gain;
				at = k;
			}
		}
		if (at < 0)
			return;
		size *= (counts[at] + 1.0) / counts[at];
		counts[at]++;
	}
}

/* ---- ranges ---- */

/* Sums round: 2^-30 of all that is summed is far more, and covers what the model's replaced constants change. */
static double closed(double value, double slack, double noise)
{
	return round_up(value + slack + noise + 0x1p-30 * (fabs(value) + slack));
}

/* The largest -f and f that were found of an output, and how far they may be off. */
static void take_output(struct cover *c, const struct covering *s, const double *bends, int o, const double most[2], double noise)
{
	int n = s->f->dim_count;
	double slack = 0;

	for (int k = 0; k < n; k++)
		slack += has_one_value(&s->f->dims[k]) ? 0 : s->grid.half[k] * s->grid.half[k] / 2 * bends[o * n + k];
	c->lower[o] = fmax(c->lower[o], -closed(most[0], slack, noise));
	c->upper[o] = fmin(c->upper[o], closed(most[1], slack, noise));
}

static void take_cover(struct cover *c, const struct covering *s, const double *bends, size_t pieces)
{
	for (int o = 0; o < s->f->output_count; o++) {
		double most[2] = {-(double)INFINITY, -(double)INFINITY};

		for (size_t i = 0; i < pieces; i++)
			for (int side = 0; side < 2; side++)
				most[side] = fmax(most[side], s->most[2 * ((size_t)s->f->output_count * i + (size_t)o) + (size_t)side]);
		take_output(c, s, bends, o, most, s->f->noise[o] * (double)s->f->coefficient_count);
	}
}

/* On the grid that is made, by the DAG. */
static int by_points(struct cover *c, struct covering *s, const double *bends)
{
	size_t pieces = ((size_t)c->points + POINTS - 1) / POINTS;

	s->points = (size_t)c->points;
	s->most = malloc(2 * pieces * (size_t)s->f->output_count * sizeof *s->most);
	s->failed = !s->most;
	if (s->most)
		workers_run(s->effort->workers, s->effort->threads, take_points, s, pieces);
	if (!s->failed)
		take_cover(c, s, bends, pieces);
	free(s->most);
	return s->failed != 1;
}

static int by_knots(struct cover *c, const struct covering *s, const double *bends)
{
	int o = s->first, done;
	struct knots_walk w = {.knots = s->knots, .grid = &s->grid, .output = o, .along = -1,
		.most = {-s->found[o][0], s->found[o][1]}};

	done = knots_walk(&w, s->effort);
	if (done == 1)
		take_output(c, s, bends, o, w.most, w.off * (double)s->f->coefficient_count);
	return done != 0;
}

static int cover_once(struct cover *c, struct covering *s, const double *bends, double room)
{
	int counts[FIELD_DIMS], done = 1;

	choose(s, counts, room, bends);
	if (!grid_make(&s->grid, s->f, counts, 0))
		return 0;
	if (grid_size(&s->grid) <= 2 * room) { /* else the corners alone are too many */
		c->points = grid_size(&s->grid);
		done = s->knots ? by_knots(c, s, bends) : by_points(c, s, bends);
	}
	grid_free(&s->grid);
	return done;
}

/* More places each time, as there is time; a grid that is too large even with the fewest places tells nothing of the speed. */
static int rounds(struct cover *c, struct covering *s, const double *bends, double end)
{
	static const double SHARES[] = {0.2, 0.2, 0.85};
	double speed = s->knots ? fmax(s->pace, KNOTS_PACE) : 1, least = s->pace > KNOTS_PACE ? FIRST_LEAST : FIRST_POINTS;
	int done = 1;

	for (int i = 0; i < 3 && done && seconds_now() < end; i++) {
		double start = seconds_now(), of_time = SHARES[i] * (end - start) / speed;
		double room = i ? of_time : s->knots ? fmax(least, fmin(FIRST_OF_KNOTS, of_time)) : FIRST_POINTS;

		c->points = 0;
		done = cover_once(c, s, bends, room);
		speed = c->points > 0 ? (seconds_now() - start) / c->points : speed;
	}
	return done;
}

/* Returns 0 where memory ran out. */
static int each_by_knots(struct cover *c, struct covering *s, const double *bends, double end)
{
	int n = s->f->output_count, done = 1;

	for (int o = 0; o < n && done; o++) {
		s->first = o;
		s->end = o + 1;
		done = rounds(c, s, bends, seconds_now() + (end - seconds_now()) / (n - o));
	}
	return done;
}

static int all_by_points(struct cover *c, struct covering *s, const double *bends, double end)
{
	s->knots = NULL;
	s->first = 0;
	s->end = s->f->output_count;
	return rounds(c, s, bends, end);
}

int cover_find(struct cover *c, const struct field *f, const struct cover_start *from, const struct effort *x, double seconds)
{
	struct effort own = *x;
	struct covering s = {.f = f, .effort = &own, .knots = from->knots, .pace = from->pace, .found = from->found};
	size_t outputs = (size_t)f->output_count;
	double end = seconds_now() + seconds;

	*c = (struct cover){.upper = malloc(outputs * sizeof *c->upper), .lower = malloc(outputs * sizeof *c->lower)};
	if (!c->upper || !c->lower)
		return 0;
	for (size_t o = 0; o < outputs; o++) {
		c->upper[o] = f->plain[o];
		c->lower[o] = -f->plain[o];
	}
	own.deadline = fmin(x->deadline, seconds_now() + 1.2 * seconds);
	return (s.knots && each_by_knots(c, &s, from->bends, end)) || all_by_points(c, &s, from->bends, end);
}
