/* Each step from expressions to proved ranges by itself, on own robots: the coefficients at a q, the largest value over drives
   and rates, how much outputs bend and of which degree they are, limbs that are cut off. It would catch a coefficient in the
   wrong place, a corner that is left out, a curvature that is not over all angles, and a limb that is cut where its wrench is not
   the robot's. */
#include "prove/relaxed_box.h"
#include "range/curvature.h"
#include "range/parts/cut.h"
#include "range/extreme.h"
#include "range/knots.h"
#include "range/magnitude.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEED = 21, POINTS = 40, LIMB_DIMS = 7 };

static double *coefficients(const struct field *f)
{
	double *c = calloc((size_t)f->output_count * f->coefficient_count, sizeof *c);

	ck_assert_ptr_nonnull(c);
	return c;
}

/* That state as a point and as drives and rates over their scales. */
static void state_of(const struct relaxed_box *x, const struct field *f, struct field_point *q, double *over)
{
	int position = dag_find_role(f->d, ROLE_JOINT_POSITION, 0);

	for (int k = 0; k < f->dim_count; k++)
		field_place(&f->dims[k], x->in[position][f->dims[k].row], q->x[k]);
	for (int i = 0; i < f->drive_count; i++)
		over[i] = x->in[f->drives[i].argument][f->drives[i].row] / f->drives[i].scale;
	for (int j = 0; j < f->rate_count; j++)
		over[f->drive_count + j] = x->in[f->rates[j].argument][f->rates[j].row] / f->rates[j].scale;
}

/* The polynomial is the output, and nothing in the box is above what extreme_above says; at most states it is near what it should
   be. */
static void check_field(struct relaxed_box *s, const struct field *f, struct rng *r)
{
	double *work = field_work(f), *c = coefficients(f), over[2 * FIELD_DIMS], *scalars = field_scalars(f), values[64];
	struct robot_box *x = &s->x;
	struct field_point q;

	ck_assert(work && scalars);
	for (int i = 0; i < POINTS; i++) {
		robot_box_draw(x, r, 0, 0);
		robot_box_evaluate(x);
		relaxed_box_see(s);
		state_of(s, f, &q, over);
		field_evaluate(f, &q, work, c);
		field_values(f, &q, over, scalars, values);
		for (int o = 0; o < f->output_count; o++) {
			const double *of = c + (size_t)o * f->coefficient_count;
			double exact = robot_box_value(x, (size_t)f->outputs[o]), value = robot_box_polynomial(f, of, over);
			double noise = f->noise[o] * (double)f->coefficient_count + 1e-12 * fabs(exact);

			ck_assert_msg(fabs(value - exact) <= noise, "%g is not %g", value, exact);
			ck_assert_msg(fabs(values[o] - exact) <= noise, "%g is not %g", values[o], exact);
			ck_assert(extreme_above(f, of, 1, -1e300) + noise >= exact &&
				-extreme_above(f, of, -1, -1e300) - noise <= exact);
			ck_assert(fabs(exact) <= f->plain[o]);
			ck_assert(f->noise[o] <= 1e-6 * f->plain[o] + 1e-300);
		}
	}
	free(scalars);
	free(c);
	free(work);
}

START_TEST(test_fields)
{
	struct rng r = rng_seed(SEED);
	struct relaxed_box s;
	int outputs = 0;

	relaxed_box_case(&s, _i);
	for (int k = 0; k < s.count; k++) {
		check_field(&s, &s.fields[k], &r);
		outputs += s.fields[k].output_count;
	}
	ck_assert_uint_eq((size_t)outputs, s.x.analysis.dag.output_count);
	robot_box_close(&s.x);
}
END_TEST

/* The corner that is told has the value that is told, and no corner has a larger one. */
START_TEST(test_corners)
{
	struct rng r = rng_seed(SEED + 1);
	struct relaxed_box s;
	struct field_point q;
	double *work, *c, over[2 * FIELD_DIMS], x[2 * FIELD_DIMS];

	relaxed_box_case(&s, _i);
	work = field_work(&s.fields[0]);
	c = coefficients(&s.fields[0]);
	for (int i = 0; i < POINTS; i++) {
		double most, told;

		robot_box_draw(&s.x, &r, 0, 0);
		relaxed_box_see(&s);
		state_of(&s, &s.fields[0], &q, over);
		field_evaluate(&s.fields[0], &q, work, c);
		most = extreme_above(&s.fields[0], c, 1, -1e300);
		told = extreme_corner(&s.fields[0], c, 1, x);
		ck_assert(robot_box_polynomial(&s.fields[0], c, x) <= most && told <= most * (1 + 1e-9) + 1e-9);
		for (int k = 0; k < 200; k++) {
			for (int j = 0; j < s.fields[0].drive_count + s.fields[0].rate_count; j++) {
				struct interval range = j < s.fields[0].drive_count ? s.fields[0].drives[j].range
										: s.fields[0].rates[j -
											s.fields[0].drive_count].range;

				over[j] = rng_chance(&r, 0.7) ? (rng_chance(&r, 0.5) ? range.lower : range.upper)
					: rng_uniform(&r, range.lower, range.upper);
			}
			ck_assert(robot_box_polynomial(&s.fields[0], c, over) <= most);
		}
	}
	free(c);
	free(work);
	robot_box_close(&s.x);
}
END_TEST

/* Second differences along each q, at any angles. */
static void check_bends(const struct field *f, const struct curvature *bends, struct rng *r)
{
	double *work = field_work(f), *c = coefficients(f), x[2 * FIELD_DIMS];

	for (int i = 0; i < POINTS; i++) {
		int k = rng_below(r, f->dim_count);
		struct field_point q;
		double at = 0, step = 0.01, y[3][64];

		for (int l = 0; l < f->dim_count; l++) {
			const struct field_dim *dim = &f->dims[l];
			double place = dim->is_angle ? rng_uniform(r, -4, 4)
				: rng_uniform(r, dim->lower + step, dim->upper - step);

			at = l == k ? place : at;
			field_place(dim, place, q.x[l]);
		}
		for (int j = 0; j < f->drive_count; j++)
			x[j] = rng_chance(r, 0.5) ? f->drives[j].range.lower : f->drives[j].range.upper;
		for (int j = 0; j < f->rate_count; j++)
			x[f->drive_count + j] = rng_chance(r, 0.5) ? f->rates[j].range.lower : f->rates[j].range.upper;
		for (int t = 0; t < 3; t++) {
			field_place(&f->dims[k], at + (t - 1) * step, q.x[k]);
			field_evaluate(f, &q, work, c);
			for (int o = 0; o < f->output_count; o++)
				y[t][o] = robot_box_polynomial(f, c + (size_t)o * f->coefficient_count, x);
		}
		for (int o = 0; o < f->output_count; o++)
			ck_assert_msg(fabs(y[0][o] - 2 * y[1][o] + y[2][o]) / (step * step) <=
				  bends->most[o * f->dim_count + k] + 1e5 * f->noise[o] * (double)f->coefficient_count,
				"output %d, row %d: %g, not %g", o, k, fabs(y[0][o] - 2 * y[1][o] + y[2][o]) / (step * step),
				bends->most[o * f->dim_count + k]);
	}
	free(c);
	free(work);
}

enum { HARMONICS = 32 };

/* Along an angle no harmonic is above the degree; along a length no fourth difference is left. */
static void check_degree(const struct field *f, int k, struct field_point q, const double *x)
{
	double *scalars = field_scalars(f), *values = calloc((size_t)f->output_count, sizeof *values),
		*y = calloc(2 * HARMONICS, sizeof *y);
	int count = f->dims[k].is_angle ? 2 * HARMONICS : 4;

	for (int o = 0; o < f->output_count; o++) {
		double size = 0, most = 0;

		for (int i = 0; i < count; i++) {
			field_place(&f->dims[k], f->dims[k].is_angle ? 3.14159265358979323846 * i / HARMONICS : f->dims[k].lower +
				0.1 * i, q.x[k]);
			field_values(f, &q, x, scalars, values);
			y[i] = values[o];
			size = fmax(size, fabs(y[i]));
		}
		for (int h = f->dims[k].degree + 1; h < HARMONICS && f->dims[k].is_angle; h++) {
			double c = 0, s = 0;

			for (int i = 0; i < count; i++) {
				c += y[i] * cos(3.14159265358979323846 * i * h / HARMONICS);
				s += y[i] * sin(3.14159265358979323846 * i * h / HARMONICS);
			}
			most = fmax(most, hypot(c, s));
		}
		if (!f->dims[k].is_angle)
			most = fabs(y[3] - 3 * y[2] + 3 * y[1] - y[0]);
		ck_assert_msg(most <= 1e-10 * size + 1e-300, "output %d, row %d: %g of %g is above degree %d", o, k, most, size,
			f->dims[k].degree);
	}
	free(y);
	free(values);
	free(scalars);
}

START_TEST(test_degrees)
{
	struct rng r = rng_seed(SEED + 6);
	struct relaxed_box s;

	relaxed_box_case(&s, _i);
	for (int k = 0; k < s.count; k++)
		for (int i = 0; i < 3 && s.fields[k].has_grid; i++) {
			double x[2 * FIELD_DIMS];
			struct field_point q;

			robot_box_draw(&s.x, &r, 0, 0);
			relaxed_box_see(&s);
			state_of(&s, &s.fields[k], &q, x);
			for (int l = 0; l < s.fields[k].dim_count; l++)
				check_degree(&s.fields[k], l, q, x);
		}
	robot_box_close(&s.x);
}
END_TEST

START_TEST(test_curvature)
{
	struct rng r = rng_seed(SEED + 2);
	struct effort effort = robot_box_effort();
	struct relaxed_box s;

	relaxed_box_case(&s, _i);
	for (int k = 0; k < s.count && k < 3; k++) {
		const struct field *f = &s.fields[k];
		struct interval *whole = calloc((size_t)f->output_count, sizeof *whole);
		double *found = calloc((size_t)f->output_count, sizeof *found),
			*most = calloc((size_t)(f->output_count * f->dim_count + 1), sizeof *most);
		struct curvature bends, first = {.most = most};
		struct knots knots;
		int with_knots = knots_make(&knots, f, &effort, 1);
		const struct curvature_start from = {whole, found, most, with_knots ? &knots : NULL};

		ck_assert(magnitude_find(whole, f, &s.box, 1, &effort, 0.05) && magnitude_bends(most, f, &s.box, &effort));
		for (int o = 0; o < f->output_count; o++)
			found[o] = 0.2 * interval_size(whole[o]);
		ck_assert(curvature_find(&bends, f, &from, &effort, 1));
		knots_free(&knots);
		if (f->dim_count) {
			check_bends(f, &first, &r);
			check_bends(f, &bends, &r);
		}
		free(bends.most);
		free(found);
		free(most);
		free(whole);
	}
	workers_close(effort.workers);
	robot_box_close(&s.x);
}
END_TEST

/* Its outputs in the state that was drawn, where its own inputs are these; [output], in its DAG's order. */
static void part_values(const struct relaxed_box *s, const struct cut *c, const double *inputs, double *outputs)
{
	int rates = c->relaxed.view.dag.argument_count - 2, position = dag_find_role(&s->relaxed.view.dag, ROLE_JOINT_POSITION, 0);

	for (const struct field *f = c->fields; f < c->fields + c->field_count; f++) {
		double x[2 * FIELD_DIMS], *scalars = field_scalars(f), *values = calloc((size_t)f->output_count, sizeof *values);
		struct field_point q;

		ck_assert(scalars && values);
		for (int k = 0; k < f->dim_count; k++)
			field_place(&f->dims[k], s->in[position][f->dims[k].row], q.x[k]);
		for (int i = 0; i < f->drive_count + f->rate_count; i++) {
			const struct field_input *in = i < f->drive_count ? &f->drives[i] : &f->rates[i - f->drive_count];

			x[i] = (in->argument >= rates ? inputs[in->row] : s->in[in->argument][in->row]) / in->scale;
		}
		field_values(f, &q, x, scalars, values);
		for (int o = 0; o < f->output_count; o++)
			outputs[f->outputs[o]] = values[o];
		free(values);
		free(scalars);
	}
}

/* Its torques are those that it was cut from, where its inputs are what the nodes say, or the loads; its loads into *loads. */
static void check_cut(const struct relaxed_box *s, const struct cut *c, const double *v, const double *inputs, double *loads)
{
	const struct dag *d = &s->relaxed.view.dag;
	double *outputs = calloc(c->relaxed.view.dag.output_count, sizeof *outputs);

	part_values(s, c, inputs, outputs);
	for (size_t i = 0; i < c->relaxed.view.dag.output_count; i++) {
		int of = c->outputs[i], load = of - (int)d->output_count;

		if (load >= 0)
			loads[load] = outputs[i];
		else
			ck_assert_msg(fabs(outputs[i] - v[d->outputs[of].value.i]) <= 1e-9 * (1 + fabs(outputs[i])), "output %d: %g, not %g", of,
				outputs[i], v[d->outputs[of].value.i]);
	}
	free(outputs);
}

static void check_limb(const struct relaxed_box *s, const struct cut *c, const double *v, double *loads)
{
	double inputs[FIELD_DIMS];
	int rates = c->relaxed.view.dag.argument_count - 2;

	for (int k = 0; k < c->leaf_count; k++) {
		struct interval of = c->box.rows[rates][k];

		inputs[k] = v[c->leaves[k]];
		ck_assert_msg(inputs[k] >= of.lower - 1e-9 && inputs[k] <= of.upper + 1e-9, "leaf %d: %g", k, inputs[k]);
	}
	check_cut(s, c, v, inputs, loads);
}

/* With ranges that any load has. */
static void cut_all(struct relaxed_box *s, struct cut **cuts, int *count, struct cut *rest, const struct effort *effort)
{
	struct interval **ranges;

	*count = cut_make(cuts, &s->relaxed, s->fields, s->count, 9, LIMB_DIMS, effort, 0.1, &s->x.arena);
	ck_assert_int_gt(*count, 0);
	ranges = arena_alloc(&s->x.arena, (size_t)*count, sizeof *ranges);
	for (int i = 0; i < *count; i++) {
		ranges[i] = arena_alloc(&s->x.arena, (size_t)(*cuts)[i].load_count + 1, sizeof **ranges);
		for (int k = 0; k < (*cuts)[i].load_count; k++)
			ranges[i][k] = (struct interval){-1e9, 1e9};
	}
	ck_assert_int_eq(cut_rest(rest, &s->relaxed, s->fields, s->count, 9, *cuts, *count, ranges, &s->x.arena), 1);
}

/* Limbs, and what carries them, are the robot's own parts; and what carries them depends on no row of theirs. */
START_TEST(test_cuts)
{
	static const struct {
		const char *name, *scene;
		int limb_dims, rest_dims; /* most of a field; without sharing a sweep, motions have no names of their own */
	} CASES[] = {{"atlas", "", 7, 3}, {"g1_29dof", "", 7, 3}, {"floating:atlas", "", 7, 4}, {"floating:hyq", "", 3, 0},
		{"atlas", "want gravity,bias\n", 9, 17}};
	struct rng r = rng_seed(SEED + 5);
	struct effort effort = robot_box_effort();
	struct relaxed_box s;
	struct cut *cuts, rest;
	double *v, loads[200];
	char scene[100];
	int count;

	snprintf(scene, sizeof scene, "params urdf\n%srange qdd=-20,20\nrange qd=-9,9", CASES[_i].scene);
	relaxed_box_open(&s, CASES[_i].name, scene);
	cut_all(&s, &cuts, &count, &rest, &effort);
	for (int k = 0; k < count; k++)
		for (int f = 0; f < cuts[k].field_count; f++)
			ck_assert_int_le(cuts[k].fields[f].dim_count, CASES[_i].limb_dims);
	for (int f = 0; f < rest.field_count; f++)
		ck_assert_int_le(rest.fields[f].dim_count, CASES[_i].rest_dims);
	v = arena_alloc(&s.x.arena, s.relaxed.view.dag.count, sizeof *v);
	for (int i = 0; i < POINTS; i++) {
		int loaded = 0;

		relaxed_box_values(&s, &r, v);
		for (int k = 0; k < count; loaded += cuts[k++].load_count) {
			ck_assert_int_le(loaded + cuts[k].load_count, (int)(sizeof loads / sizeof *loads));
			check_limb(&s, &cuts[k], v, loads + loaded);
		}
		check_cut(&s, &rest, v, loads, NULL);
	}
	workers_close(effort.workers);
	robot_box_close(&s.x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("range");

	suite_add(suite, "fields", test_fields, RELAXED_BOX_CASES, 600);
	suite_add(suite, "corners", test_corners, RELAXED_BOX_CASES, 600);
	suite_add(suite, "curvature", test_curvature, RELAXED_BOX_CASES, 600);
	suite_add(suite, "degrees", test_degrees, RELAXED_BOX_CASES, 600);
	suite_add(suite, "cuts", test_cuts, 5, 600);
	return suite_run(suite);
}
