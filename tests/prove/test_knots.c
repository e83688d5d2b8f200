/* What knots say of a field anywhere, beside the field itself: coefficients, second derivatives, and the largest of a whole grid.
   It would catch a row of q in another's place, a weight that is off, a point of the grid that is left out, and waves that are
   taken to cancel. */
#include "prove/robot_box.h"
#include "range/cover.h"
#include "range/extreme.h"
#include "range/knots.h"
#include "range/magnitude.h"
#include "range/seek.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 23, POINTS = 30, MOST = 12, STATES = 300 };

static const struct robot_case {
	const char *name, *scene;
} ROBOTS[] = {
	{"double_pendulum", "range qdd=-5,9\nrange q=-3,3\nrange qd=-2,5"},
	{"prismatic_skew", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"hyq", "range qdd=-20,20"},
	{"ur5", "range qdd=-20,20"},
	{"ur5", "range qdd=-20,20\nwant gravity,M"},
	{"iiwa14", "range qdd=-20,20\ndamping"},
	{"panda", "range qdd=-20,20"},
	{"cartpole", "range qdd=-5,9\nrange qd=-2,5\nrange q=-1,1\nfriction\ndamping"},
	{"planar_tilted", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"mimic_chain", "range qdd=-5,9\nrange qd=-2,5"},
	{"double_pendulum", "free payload.lower,gravity,offset.elbow\nrange payload.lower=0,2\nrange gravity=-9,9\n"
		"range offset.elbow=-1,1\nrange q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
};
enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS };

struct set_up {
	struct robot_box x;
	struct relaxed relaxed;
	struct field *fields;
	int count;
	struct effort effort;
};

static void set_up(struct set_up *s, int robot)
{
	robot_box_open(&s->x, ROBOTS[robot].name, ROBOTS[robot].scene, 0);
	ck_assert_msg(!relax(&s->relaxed, &s->x.analysis, s->x.box.rows, &s->x.arena, &s->x.error), "%s", s->x.error.message);
	s->count = field_split(&s->fields, &s->relaxed, &s->x.arena, &s->x.error);
	ck_assert_msg(s->count > 0, "%s: %s", ROBOTS[robot].name, s->x.error.message);
	s->effort = robot_box_effort();
}

static void tear_down(struct set_up *s)
{
	workers_close(s->effort.workers);
	robot_box_close(&s->x);
}

static double place_in(const struct field_dim *dim, struct rng *r)
{
	return dim->is_angle ? rng_uniform(r, -4, 4) : rng_uniform(r, dim->lower, dim->upper);
}

/* All coefficients of an output at q, by summing over all knots with the product of their weights. */
static void sum_up(const struct knots *k, int output, const struct field_point *q, int along, double *c, double *spread)
{
	const struct field *f = k->f;
	double by[FIELD_DIMS][64];

	for (int l = 0; l < f->dim_count; l++)
		spread[l] = knots_weigh(k, l, q->x[l], l == along, by[l]);
	memset(c, 0, f->coefficient_count * sizeof *c);
	for (size_t i = 0; i < k->points; i++) {
		const double *of = k->values + ((size_t)output * k->points + i) * k->stride;
		double weight = 1;
		size_t number = i;

		for (int l = 0; l < f->dim_count; number /= (size_t)k->counts[l++])
			weight *= by[l][number % (size_t)k->counts[l]];
		for (size_t n = 0; n < f->coefficient_count; n++)
			c[n] += weight * of[n];
	}
}

/* The field's own coefficients there, or their second differences of fourth order. */
static void evaluate(const struct field *f, struct field_point q, const double *at, int along, double *work, double *c)
{
	static const double BY[] = {-1.0 / 12, 16.0 / 12, -30.0 / 12, 16.0 / 12, -1.0 / 12};
	size_t count = (size_t)f->output_count * f->coefficient_count;
	double *own = calloc(count, sizeof *own), step = 0.01;

	field_evaluate(f, &q, work, c);
	for (int i = 0; i < 5 && along >= 0; i++) {
		field_place(&f->dims[along], at[along] + (i - 2) * step, q.x[along]);
		field_evaluate(f, &q, work, own);
		for (size_t n = 0; n < count; n++)
			c[n] = (i ? c[n] : 0) + BY[i] / (step * step) * own[n];
	}
	free(own);
}

static void check_points(const struct knots *k, struct rng *r)
{
	const struct field *f = k->f;
	size_t n = f->coefficient_count;
	double *work = field_work(f), *c = calloc((size_t)f->output_count * n, sizeof *c), *sum = calloc(n, sizeof *sum);

	ck_assert(work && c && sum);
	for (int i = 0; i < POINTS; i++) {
		int along = i % 2 ? rng_below(r, f->dim_count) : -1, o = rng_below(r, f->output_count);
		double at[FIELD_DIMS], spread[FIELD_DIMS], off;
		struct field_point q;

		for (int l = 0; l < f->dim_count; l++)
			field_place(&f->dims[l], at[l] = place_in(&f->dims[l], r), q.x[l]);
		if (along >= 0 && field_is_point(&f->dims[along]))
			continue;
		evaluate(f, q, at, along, work, c);
		sum_up(k, o, &q, along, sum, spread);
		off = knots_off(k, o, spread);
		ck_assert_msg(off <= 1e-3 * k->size[o] + 1e-300, "output %d: %g of %g", o, off, k->size[o]);
		off += along >= 0 ? 1e-5 * k->size[o] + 1e5 * f->noise[o] : f->noise[o];
		for (size_t j = 0; j < n; j++)
			ck_assert_msg(fabs(sum[j] - c[(size_t)o * n + j]) <= off, "output %d along %d: %g, not %g, may be off by %g", o, along,
				sum[j], c[(size_t)o * n + j], off);
	}
	free(sum);
	free(c);
	free(work);
}

/* Every point of a grid by itself. */
static void check_walk(const struct knots *k, const struct effort *x, struct rng *r)
{
	const struct field *f = k->f;
	int counts[FIELD_DIMS], along = rng_chance(r, 0.5) ? rng_below(r, f->dim_count) : -1, o = rng_below(r, f->output_count);
	double *c = calloc(f->coefficient_count, sizeof *c), spread[FIELD_DIMS], most[2] = {-1e300, -1e300}, size;
	struct grid grid;
	struct knots_walk w = {.knots = k, .grid = &grid, .output = o, .along = along, .most = {-1e300, -1e300}};

	for (int l = 0; l < f->dim_count; l++)
		counts[l] = 1 + rng_below(r, f->dim_count > 4 ? 2 : 4);
	ck_assert(grid_make(&grid, f, counts, rng_chance(r, 0.5)));
	ck_assert_int_eq(knots_walk(&w, x), 1);
	for (size_t i = 0; i < (size_t)grid_size(&grid); i++) {
		struct field_point q;

		grid_point(&grid, i, &q);
		sum_up(k, o, &q, along, c, spread);
		for (int side = 0; side < 2; side++)
			most[side] = fmax(most[side], extreme_above(f, c, side ? 1 : -1, -1e300));
	}
	size = 1e-6 * (fabs(most[0]) + fabs(most[1])) + (double)f->coefficient_count * w.off;
	if (along >= 0) /* the larger of both is asked for */
		ck_assert_msg(fabs(fmax(w.most[0], w.most[1]) - fmax(most[0], most[1])) <= size, "output %d along %d: %g, not %g", o, along,
			fmax(w.most[0], w.most[1]), fmax(most[0], most[1]));
	for (int side = 0; side < 2 && along < 0; side++)
		ck_assert_msg(fabs(w.most[side] - most[side]) <= size, "output %d: %g, not %g", o, w.most[side], most[side]);
	grid_free(&grid);
	free(c);
}

static void check_robot(int robot, void check(const struct knots *k, const struct effort *x, struct rng *r))
{
	struct rng r = rng_seed(SEED);
	struct set_up s;
	int made = 0;

	set_up(&s, robot);
	for (int i = 0; i < s.count && made < 4; i++) {
		struct knots k;
		int done = knots_make(&k, &s.fields[i], &s.effort, 1e3);

		ck_assert(done || !s.fields[i].has_grid || !s.fields[i].dim_count);
		if (done)
			check(&k, &s.effort, &r);
		made += done;
		knots_free(&k);
	}
	ck_assert_int_gt(made, 0);
	tear_down(&s);
}

static void check_all_points(const struct knots *k, const struct effort *x, struct rng *r)
{
	(void)x;
	check_points(k, r);
}

static void check_walks(const struct knots *k, const struct effort *x, struct rng *r)
{
	for (int i = 0; i < MOST; i++)
		check_walk(k, x, r);
}

START_TEST(test_points)
{
	check_robot(_i, check_all_points);
}
END_TEST

START_TEST(test_walks)
{
	check_robot(_i, check_walks);
}
END_TEST

/* ---- ranges ---- */

/* Nothing that is found, anywhere over the box and at the worst drives and rates there, is out of the range. */
static void check_cover(const struct cover *c, const struct field *f, const struct sought (*best)[2], struct rng *r)
{
	double *work = field_work(f), *all = calloc((size_t)f->output_count * f->coefficient_count, sizeof *all), x[2 * FIELD_DIMS];
	struct field_point q;

	ck_assert(work && all);
	for (int o = 0; o < f->output_count; o++)
		ck_assert_msg(best[o][0].value >= c->lower[o] && best[o][1].value <= c->upper[o], "output %d: %g to %g is not from %g to %g", o,
			best[o][0].value, best[o][1].value, c->lower[o], c->upper[o]);
	for (int i = 0; i < STATES; i++) {
		int is_corner = rng_chance(r, 0.3);

		for (int l = 0; l < f->dim_count; l++) {
			const struct field_dim *dim = &f->dims[l];

			field_place(dim, is_corner ? (rng_chance(r, 0.5) ? dim->lower : dim->upper) : rng_uniform(r, dim->lower, dim->upper), q.x[l]);
		}
		field_evaluate(f, &q, work, all);
		for (int o = 0; o < f->output_count; o++)
			for (int sign = -1; sign <= 1; sign += 2) {
				const double *of = all + (size_t)o * f->coefficient_count;
				double value;

				extreme_corner(f, of, sign, x);
				value = robot_box_polynomial(f, of, x);
				ck_assert_msg(value >= c->lower[o] && value <= c->upper[o], "output %d: %g is not from %g to %g", o, value, c->lower[o],
					c->upper[o]);
			}
	}
	free(all);
	free(work);
}

/* The largest slack of an output over what is found. */
static double slack_of(const struct cover *c, const struct field *f, const struct sought (*best)[2])
{
	double most = 0;

	for (int o = 0; o < f->output_count; o++)
		most = fmax(most, fmax(-c->lower[o], c->upper[o]) / fmax(fabs(best[o][0].value), fabs(best[o][1].value)));
	return most;
}

static double cover_for(struct set_up *s, const struct box *box, const struct field *f, double seconds, struct rng *r)
{
	size_t n = (size_t)f->output_count;
	struct sought (*best)[2] = calloc(n, sizeof *best);
	double (*found)[2] = calloc(n, sizeof *found), *largest = calloc(n, sizeof *largest), slack;
	double *most = calloc(n * (size_t)f->dim_count, sizeof *most);
	struct interval *whole = calloc(n, sizeof *whole);
	struct curvature_start from = {whole, largest, most, NULL};
	struct curvature bends;
	struct cover c;
	struct knots knots;
	int with_knots;

	ck_assert(seek_extremes(best, f, &s->effort, 0.2 * seconds));
	for (size_t o = 0; o < n; o++)
		for (int side = 0; side < 2; side++)
			largest[o] = fmax(largest[o], fabs(found[o][side] = best[o][side].value));
	ck_assert(magnitude_find(whole, f, box, 1, &s->effort, 0.1 * seconds) && magnitude_bends(most, f, box, &s->effort));
	with_knots = knots_make(&knots, f, &s->effort, KNOTS_SHARE * seconds);
	from.knots = with_knots ? &knots : NULL;
	ck_assert(curvature_find(&bends, f, &from, &s->effort, seconds));
	ck_assert(cover_find(&c, f, &(struct cover_start){bends.most, (const double(*)[2])found, from.knots, 0}, &s->effort, seconds));
	knots_free(&knots);
	check_cover(&c, f, (const struct sought(*)[2])best, r);
	slack = slack_of(&c, f, (const struct sought(*)[2])best);
	free(bends.most);
	free(c.lower);
	free(c.upper);
	free(best);
	free(found);
	free(largest);
	free(most);
	free(whole);
	return slack;
}

/* With more time where a slow machine needs it. */
START_TEST(test_covers)
{
	static const struct cover_case {
		int robot;
		double seconds, slack; /* 0: any */
	} CASES[] = {{3, 0.5, 1.5}, {6, 2.5, 0}, {9, 0.5, 0}}; /* the second in half the time where not all is asked for */
	struct rng r = rng_seed(SEED + 1);
	struct set_up s;
	struct box box;

	set_up(&s, CASES[_i].robot);
	memcpy(box.rows, s.relaxed.rows, sizeof box.rows);
	for (int i = 0; i < s.count; i++) {
		double seconds = CASES[_i].seconds / (_i == 1 && !exhaustive() ? 2 : 1), most = CASES[_i].slack, slack;

		if (s.fields[i].dim_count < 3)
			continue;
		while ((slack = cover_for(&s, &box, &s.fields[i], seconds, &r)) > most && most > 0 && seconds < 60)
			seconds *= 4;
		ck_assert_msg(slack <= most || most == 0 || sanitized(), "%s: %g", ROBOTS[CASES[_i].robot].name, slack);
	}
	tear_down(&s);
}
END_TEST

/* Without time there are none, and a short length far from 0 has none. */
START_TEST(test_none)
{
	struct set_up s;
	struct knots k;
	int lengths = 0;

	set_up(&s, 1);
	ck_assert_int_eq(knots_make(&k, &s.fields[0], &s.effort, 0), 0);
	knots_free(&k);
	for (int l = 0; l < s.fields[0].dim_count; l++) {
		struct field_dim *dim = &s.fields[0].dims[l];

		lengths += !dim->is_angle;
		dim->lower += dim->is_angle ? 0 : 1e3;
		dim->upper += dim->is_angle ? 0 : 1e3;
	}
	ck_assert_int_gt(lengths, 0);
	ck_assert_int_eq(knots_make(&k, &s.fields[0], &s.effort, 1e3), 0);
	knots_free(&k);
	tear_down(&s);
}
END_TEST

/* A degree that is too high by one is found to be: knots of it are lowered to those of the field's own, or fewer. */
START_TEST(test_lower)
{
	struct rng r = rng_seed(SEED);
	struct set_up s;

	set_up(&s, _i);
	for (int i = 0; i < s.count; i++) {
		struct field *f = &s.fields[i];
		struct knots k;
		int degrees[FIELD_DIMS];

		for (int l = 0; l < f->dim_count; l++) {
			degrees[l] = f->dims[l].degree;
			f->dims[l].degree += f->dims[l].is_angle;
		}
		if (knots_make(&k, f, &s.effort, 1e3)) {
			ck_assert(knots_lower(&k, f));
			for (int l = 0; l < f->dim_count; l++)
				ck_assert_msg(f->dims[l].degree <= degrees[l] && k.counts[l] == k.grid.counts[l] &&
						      (!f->dims[l].is_angle || k.counts[l] == 2 * f->dims[l].degree + 1),
					"%s: degree %d in row %d", ROBOTS[_i].name, f->dims[l].degree, l);
			check_points(&k, &r);
		}
		knots_free(&k);
	}
	tear_down(&s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("knots");

	suite_add(suite, "points", test_points, ROBOT_COUNT, 600);
	suite_add(suite, "walks", test_walks, ROBOT_COUNT, 600);
	suite_add(suite, "covers", test_covers, 3, 600);
	suite_add(suite, "lower", test_lower, 4, 600);
	suite_add(suite, "none", test_none, 1, 60);
	return suite_run(suite);
}
