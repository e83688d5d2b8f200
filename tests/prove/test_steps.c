/* What a checker of certificates evaluates holds: spans beside MPFR; ranges and errors over boxes, polynomials at points, bends
   and grids beside quad precision. States outside a box, a smaller bend and a coarser degree are seen to break it. */
#include "prove/robot_box.h"
#include "prove/spans.h"
#include "steps/boxes.h"
#include "steps/grid.h"
#include "dag/eval.h"
#include "emit/number_type.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEED = 41, PAIRS = 20000, BITS = 240, BOXES = 12, STATES = 60 };

static const struct steps_case {
	const char *name, *scene;
} CASES[] = {
	{"double_pendulum", "range qdd=-5,9\nrange q=-3,3\nrange qd=-2,5"},
	{"prismatic_skew", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"skew_axis", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"hyq", "range qdd=-20,20"},
	{"iiwa14", "range qdd=-20,20"},
	{"ur5", "range qdd=-20,20\nwant gravity,M"},
	/* angles that are computed: boxes alone know them */
	{"mimic_chain", "range qdd=-5,9"},
	{"mimic:double_pendulum", "range qdd=-5,9\nrange q=-3,3\nrange qd=-2,5"},
	{"double_pendulum", "free offset.elbow\nrange offset.elbow=-0.1,0.3\nrange qdd=-5,9\nrange q=-3,3\nrange qd=-2,5"},
};
enum { BOX_CASES = sizeof CASES / sizeof *CASES, CASE_COUNT = BOX_CASES - 3 };

/* ---- spans ---- */

static double angle(struct rng *r)
{
	double quarter = 1.5707963267948966 * rng_uniform(r, -9, 9);

	return rng_chance(r, 0.3) ? 1.5707963267948966 * round(quarter) : quarter;
}

START_TEST(test_spans)
{
	struct rng r = rng_seed(SEED);
	mpfr_t x, y, z;

	mpfr_inits2(BITS, x, y, z, (mpfr_ptr)0);
	for (int i = 0; i < PAIRS; i++) {
		struct span a = spans_draw(&r, spans_magnitude), b = spans_draw(&r, spans_magnitude), c = spans_draw(&r, angle);

		mpfr_set_d(x, spans_inside(&r, a), MPFR_RNDN);
		mpfr_set_d(y, spans_inside(&r, b), MPFR_RNDN);
		mpfr_add(z, x, y, MPFR_RNDN);
		ck_assert(spans_contain(span_add(a, b), z));
		mpfr_mul(z, x, y, MPFR_RNDN);
		ck_assert(spans_contain(span_mul(a, b), z));
		ck_assert(span_size(a) >= fabs(mpfr_get_d(x, MPFR_RNDZ)));
		mpfr_set_d(x, spans_inside(&r, c), MPFR_RNDN);
		mpfr_sin(z, x, MPFR_RNDN);
		ck_assert(spans_contain(span_sin(c), z));
		mpfr_cos(z, x, MPFR_RNDN);
		ck_assert(spans_contain(span_cos(c), z));
	}
	mpfr_clears(x, y, z, (mpfr_ptr)0);
}
END_TEST

/* No wider than they need be, and everything where nothing is known. */
START_TEST(test_spans_are_close)
{
	struct span s = span_sin((struct span){0.1, 0.2}), c = span_cos((struct span){-0.1, 0.2}),
		m = span_mul((struct span){0.1, 0.3}, (struct span){-0.7, 0.9});
	const double infinite = (double)INFINITY;

	ck_assert(s.lo > sin(0.1) - 1e-14 && s.hi < sin(0.2) + 1e-14 && c.hi == 1 && c.lo > cos(0.2) - 1e-14);
	ck_assert(m.lo >= -0.21 * (1 + 0x1p-50) && m.hi <= 0.27 * (1 + 0x1p-50));
	ck_assert(span_size((struct span){(double)NAN, 1}) >= 1 && span_size((struct span){0, (double)NAN}) == infinite);
	m = span_mul((struct span){1, infinite}, (struct span){-1, 1});
	ck_assert(m.lo == -infinite && m.hi == infinite);
	s = span_sin((struct span){(double)NAN, 1});
	ck_assert(s.lo == -1 && s.hi == 1);
}
END_TEST

/* ---- robots ---- */

struct spanned {
	struct robot_box robot;
	struct span *rows[DAG_ARGUMENTS];
	int position;
};

static void spanned_open(struct spanned *x, const struct steps_case *c)
{
	robot_box_open(&x->robot, c->name, c->scene, 0);
	x->position = dag_find_role(&x->robot.analysis.dag, ROLE_JOINT_POSITION, 0);
	for (int i = 0; i < x->robot.analysis.dag.argument_count; i++) {
		size_t count = (size_t)x->robot.analysis.dag.arguments[i].rows;

		x->rows[i] = x->robot.box.rows[i] ? arena_alloc(&x->robot.arena, count, sizeof(struct span)) : NULL;
		for (size_t k = 0; x->rows[i] && k < count; k++)
			x->rows[i][k] = (struct span){x->robot.box.rows[i][k].lower, x->robot.box.rows[i][k].upper};
	}
}

/* A part of the box of q, in both forms. */
static void cut(struct spanned *x, struct rng *r)
{
	int rows = x->robot.analysis.dag.arguments[x->position].rows, halvings = rng_below(r, 8);

	for (int k = 0; k < rows; k++)
		for (int i = 0; i < halvings; i++) {
			struct interval *range = &x->robot.box.rows[x->position][k];
			double middle = cuts_middle(range->lower, range->upper);

			*(rng_chance(r, 0.5) ? &range->lower : &range->upper) = middle;
			x->rows[x->position][k] = (struct span){range->lower, range->upper};
		}
}

/* The bound of the single state in x->robot.in, as texts have it. */
static double bound_there(struct spanned *x, size_t output, const struct eval_model *m)
{
	const struct output *o = &x->robot.analysis.dag.outputs[output];

	ck_assert(eval_bound(&x->robot.analysis.dag, m, (const double *const *)x->robot.in, x->robot.out));
	return x->robot.out[o->argument][o->row];
}

/* How many of the drawn states break what is said of a part of the box. */
static int broken_box(struct spanned *x, size_t output, struct rng *r, double wider)
{
	static const enum rneagen_precision precisions[] = {RNEAGEN_F32, RNEAGEN_F64, RNEAGEN_MIXED, RNEAGEN_F32X2};
	struct rneagen_options o = x->robot.options;
	struct eval_model models[4];
	struct errors errors;
	struct box_bound bound;
	struct arena arena;
	int broken = 0;

	arena_init(&arena, NULL);
	for (int k = 0; k < 4; k++) {
		o.precision = precisions[k];
		models[k] = eval_model_of(&o, 0);
	}
	ck_assert(errors_make(&errors, &x->robot.analysis.dag, output, models, 4, &arena));
	errors_evaluate(&errors, x->rows, &bound);
	for (int i = 0; i < STATES; i++) {
		double value;

		robot_box_draw(&x->robot, r, i % 2 == 0, wider);
		robot_box_evaluate(&x->robot);
		value = robot_box_value(&x->robot, output);
		broken += !(value >= bound.value.lo && value <= bound.value.hi);
		broken += i % 4 < 2 && !(robot_box_error(&x->robot, output, i % 2 == 0) <= bound.errors[i % 2]);
		/* the bound of a state adds up by magnitudes what derivatives see cancel, and underflow of what is exact */
		broken += !(bound_there(x, output, &models[i % 4]) <= 1.05 * bound.errors[i % 4] + 0x1p-140);
	}
	arena_free(&arena);
	return broken;
}

START_TEST(test_boxes)
{
	struct rng r = rng_seed(SEED + 1);
	int outside = 0;

	for (int i = 0; i < BOXES * BOX_CASES; i++) {
		const struct steps_case *c = &CASES[i % BOX_CASES];
		struct spanned x;
		size_t output;

		spanned_open(&x, c);
		cut(&x, &r);
		output = (size_t)rng_below(&r, (int)x.robot.analysis.dag.output_count);
		ck_assert_msg(broken_box(&x, output, &r, 0) == 0, "%s, %s: output %zu", c->name, c->scene, output);
		outside += broken_box(&x, output, &r, 4);
		robot_box_close(&x.robot);
	}
	ck_assert_msg(outside > 0, "states outside are seen");
}
END_TEST

/* Turns keep lengths: plain spans of seven joints are far wider. */
START_TEST(test_turns)
{
	struct spanned x;
	struct errors errors;
	struct box_bound bound;
	struct points p;

	spanned_open(&x, &(struct steps_case){"iiwa14", "params urdf\nrange qdd=-20,20"});
	for (size_t i = 0; i < x.robot.analysis.dag.output_count; i++) {
		if (x.robot.analysis.dag.outputs[i].row != 0)
			continue;
		ck_assert(errors_make(&errors, &x.robot.analysis.dag, i, NULL, 0, &x.robot.arena));
		errors_evaluate(&errors, x.rows, &bound);
		ck_assert_int_eq(points_make(&p, &x.robot.analysis.dag, i, x.rows, x.position, &x.robot.arena), 1);
		ck_assert_msg(span_size(bound.value) < 0.08 * p.size / 4, "%g beside %g", span_size(bound.value), p.size / 4);
	}
	robot_box_close(&x.robot);
}
END_TEST

/* ---- points ---- */

/* The polynomial at the state in x->robot.in. */
static double polynomial(const struct points *p, struct spanned *x, double *work, double *c)
{
	double q[POINT_DIMS][2], a[POINT_INPUTS], v[POINT_INPUTS], sum;

	for (int k = 0; k < p->dim_count; k++) {
		double at = x->robot.in[x->position][p->dims[k].row];

		q[k][0] = p->dims[k].is_angle ? (double)sinl((real)at) : at;
		q[k][1] = p->dims[k].is_angle ? (double)cosl((real)at) : 0;
	}
	points_at(p, (const double(*)[2])q, work, c);
	sum = c[0];
	for (int i = 0; i < p->drive_count; i++) {
		a[i] = x->robot.in[p->drives[i].argument][p->drives[i].row] / p->drives[i].scale;
		sum += c[1 + i] * a[i];
	}
	for (int j = 0; j < p->rate_count; j++)
		v[j] = x->robot.in[p->rates[j].argument][p->rates[j].row] / p->rates[j].scale;
	for (int j = 0; j < p->rate_count; j++) {
		sum += c[1 + p->drive_count + j] * v[j];
		for (int k = j; k < p->rate_count; k++)
			sum += c[points_pair(p, j, k)] * v[j] * v[k];
	}
	return sum;
}

START_TEST(test_points)
{
	struct rng r = rng_seed(SEED + 2);

	for (int i = 0; i < 2 * CASE_COUNT; i++) {
		struct spanned x;
		struct points p;
		size_t output;
		double *work, *c, exact, sum;

		spanned_open(&x, &CASES[i % CASE_COUNT]);
		output = (size_t)rng_below(&r, (int)x.robot.analysis.dag.output_count);
		ck_assert_int_eq(points_make(&p, &x.robot.analysis.dag, output, x.rows, x.position, &x.robot.arena), 1);
		work = points_work(&p);
		c = calloc(p.coefficients, sizeof *c);
		ck_assert(work && c);
		for (int k = 0; k < STATES; k++) {
			robot_box_draw(&x.robot, &r, 0, 0);
			robot_box_evaluate(&x.robot);
			exact = robot_box_value(&x.robot, output);
			sum = polynomial(&p, &x, work, c);
			ck_assert_msg(fabs(sum - exact) <= p.noise * (double)p.coefficients * 1.001, "%s: %.17g beside %.17g",
				CASES[i % CASE_COUNT].name, sum, exact);
			ck_assert(fabs(sum - exact) <= 1e-8 * (1 + fabs(exact)));
			ck_assert(exact <= points_above(&p, c, 1, -1e300) + p.noise * (double)p.coefficients);
			ck_assert(-exact <= points_above(&p, c, -1, -1e300) + p.noise * (double)p.coefficients);
		}
		free(work);
		free(c);
		robot_box_close(&x.robot);
	}
}
END_TEST

/* ---- bends and grids ---- */

/* The value at a state one of whose angles is moved. */
static double moved(struct spanned *x, size_t output, int row, double by)
{
	double *q = &x->robot.in[x->position][row], before = *q, value;

	*q += by;
	robot_box_evaluate(&x->robot);
	value = robot_box_value(&x->robot, output);
	*q = before;
	return value;
}

/* The largest second difference that drawn states have, over `bend`: 1 + a little at most where bend is true. */
static double bent(struct spanned *x, size_t output, const struct point_dim *k, double bend, struct rng *r)
{
	const double h = 1e-3;
	double most = 0;

	for (int i = 0; i < STATES; i++) {
		double *q;

		robot_box_draw(&x->robot, r, 0, 0);
		q = x->robot.in[x->position];
		for (int row = 0; row < x->robot.analysis.dag.arguments[x->position].rows && k->is_angle; row++)
			q[row] = x->rows[x->position][row].lo < 2 ? rng_uniform(r, -3.2, 3.2) : q[row];
		if (!k->is_angle)
			q[k->row] = cuts_middle(k->range.lo, k->range.hi);
		most = fmax(most, fabs(moved(x, output, k->row, h) - 2 * moved(x, output, k->row, 0) + moved(x, output,
			k->row, -h)) / (h * h));
	}
	return bend > 1e-9 ? most / bend : most > 1e-3 ? (double)INFINITY : 0;
}

static double check_bends(struct spanned *x, size_t output, const struct points *p, const double *bends,
	const char *name, struct rng *r)
{
	int all_angles = 1;
	double most = 0;

	for (int k = 0; k < p->dim_count; k++)
		all_angles &= p->dims[k].is_angle;
	for (int k = 0; k < p->dim_count && all_angles; k++) {
		double share = bent(x, output, &p->dims[k], bends[k], r);

		ck_assert_msg(share <= 1 + 1e-4, "%s: row %d bends %g times as much", name, p->dims[k].row, share);
		most = fmax(most, share);
	}
	return most;
}

static void check_grid(const struct steps_case *c, size_t output, double seconds, struct rng *r)
{
	struct spanned x;
	struct points p;
	struct bends_start start;
	struct grid_step g;

	spanned_open(&x, c);
	output %= x.robot.analysis.dag.output_count;
	ck_assert_int_eq(points_make(&p, &x.robot.analysis.dag, output, x.rows, x.position, &x.robot.arena), 1);
	ck_assert(bends_find(&start, &p, &x.robot.analysis.dag, output, x.rows, x.position));
	check_bends(&x, output, &p, start.bends, c->name, r);
	ck_assert(grid_find(&g, &p, &start, 10, seconds));
	ck_assert_ptr_null(grid_check(&g, &p, &start));
	for (int i = 0; i < g.pass_count; i++)
		check_bends(&x, output, &p, g.passes[i].bends, c->name, r);
	/* a grid of all angles comes closer than the expression does */
	ck_assert(c != CASES || (g.pass_count > 0 && g.passes[0].bends[0] < 0.8 * start.bends[0]));
	for (int i = 0; i < 5 * STATES && g.dim_count; i++) {
		double value;

		robot_box_draw(&x.robot, r, 0, 0);
		robot_box_evaluate(&x.robot);
		value = robot_box_value(&x.robot, output);
		ck_assert_msg(value >= g.value.lo && value <= g.value.hi, "%s: %g is not from %g to %g", c->name, value,
			g.value.lo, g.value.hi);
	}
	robot_box_close(&x.robot);
}

START_TEST(test_grids)
{
	struct rng r = rng_seed(SEED + 3);

	for (int i = 0; i < CASE_COUNT; i++)
		check_grid(&CASES[i], (size_t)rng_below(&r, 12), 0.15, &r);
}
END_TEST

/* ---- cuts ---- */

START_TEST(test_cuts)
{
	static const struct {
		int rows[8], count, is_cover;
	} cases[] = {{{-1}, 1, 1}, {{0, -1, -1}, 3, 1}, {{0, 1, -1, -1, -1}, 5, 1}, {{0, -1}, 2, 0}, {{0, -1, -1, -1}, 4, 0},
		{{2, -1, -1}, 3, 0},
		{{-2}, 1, 0}, {{0}, 0, 0}, {{0, -1, 1, -1, -1}, 5, 1}};
	int deep[2 * CUTS_DEEP + 3];
	size_t second[2 * CUTS_DEEP + 3];

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct cuts c = {(int *)cases[i].rows, (size_t)cases[i].count, 8, 0};

		ck_assert_int_eq(cuts_check(&c, 2, second), cases[i].is_cover);
	}
	for (int i = 0; i < 2 * CUTS_DEEP + 3; i++)
		deep[i] = i <= CUTS_DEEP ? 0 : -1;
	ck_assert(!cuts_check(&(struct cuts){deep, 2 * CUTS_DEEP + 3, 0, 0}, 1, second));
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("steps");

	printf("seed %d\n", SEED);
	suite_add(suite, "spans", test_spans, 1, 60);
	suite_add(suite, "close", test_spans_are_close, 1, 60);
	suite_add(suite, "boxes", test_boxes, 1, 120);
	suite_add(suite, "turns", test_turns, 1, 60);
	suite_add(suite, "points", test_points, 1, 120);
	suite_add(suite, "grids", test_grids, 1, 120);
	suite_add(suite, "cuts", test_cuts, 1, 60);
	return suite_run(suite);
}
