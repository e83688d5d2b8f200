/* Each step from expressions to proved ranges by itself, on own robots: the coefficients at a q, the largest value over drives and
   rates, how much outputs bend, norms that rotations keep, derivatives. It would catch a coefficient in the wrong place, a corner that
   is left out, a curvature that is not over all angles, and a norm of things that are no rotation. */
#include "dag/eval.h"
#include "prove/robot_box.h"
#include "norms/adjoint.h"
#include "range/curvature.h"
#include "range/cut.h"
#include "range/extreme.h"
#include "range/magnitude.h"
#include "norms/norms.h"
#include "range/seek.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 21, POINTS = 40 };

static const struct robot_case {
	const char *name, *scene;
} ROBOTS[] = {
	{"double_pendulum", "range qdd=-5,9\nrange q=-3,3\nrange qd=-2,5"},
	{"prismatic_skew", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"gantry", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"skew_axis", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"hyq", "range qdd=-20,20"},
	{"ur5", "range qdd=-20,20"},
	{"iiwa14", "range qdd=-20,20\ndamping"},
	{"panda", "range qdd=-20,20\nwant gravity,bias"},
	{"cartpole", "range qdd=-5,9\nrange qd=-2,5\nrange q=-1,1\nfriction\ndamping"},
	{"planar_tilted", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"mimic_chain", "range qdd=-5,9\nrange qd=-2,5"},
	{"mimic:double_pendulum", "range qdd=-5,9\nrange qd=-2,5\nrange q=-3,3"},
	{"floating_joint", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"floating:double_pendulum", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"double_pendulum", "free payload.lower,gravity,offset.elbow\nrange payload.lower=0,2\nrange gravity=-9,9\nrange offset.elbow=-1,1\n"
		"range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
};
enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS };

struct set_up {
	struct robot_box x;
	struct relaxed relaxed;
	struct box box;               /* of the relaxed inputs */
	double *in[DAG_ARGUMENTS];    /* these in a state */
	struct field *fields;
	int count;
};

static void set_up_of(struct set_up *s, const char *name, const char *scene)
{
	robot_box_open(&s->x, name, scene, 0);
	ck_assert_msg(!relax(&s->relaxed, &s->x.analysis, s->x.box.rows, &s->x.arena, &s->x.error), "%s", s->x.error.message);
	memcpy(s->box.rows, s->relaxed.rows, sizeof s->box.rows);
	for (int i = 0; i < s->relaxed.view.dag.argument_count; i++)
		s->in[i] = arena_alloc(&s->x.arena, (size_t)s->relaxed.view.dag.arguments[i].rows, sizeof *s->in[i]);
	s->count = field_split(&s->fields, &s->relaxed, &s->x.arena, &s->x.error);
	ck_assert_msg(s->count > 0, "%s: %s", name, s->x.error.message);
}

static void set_up(struct set_up *s, int robot)
{
	set_up_of(s, ROBOTS[robot].name, ROBOTS[robot].scene);
}

static double *coefficients(const struct field *f)
{
	double *c = calloc((size_t)f->output_count * f->coefficient_count, sizeof *c);

	ck_assert_ptr_nonnull(c);
	return c;
}

/* What the relaxed inputs are in the state that is drawn: the text's, and values of its nodes. They are in their ranges, of balls too. */
static void relax_state(struct set_up *s)
{
	const struct dag *d = &s->x.analysis.dag, *of = &s->relaxed.view.dag;
	double *v = calloc(d->count, sizeof *v);

	for (size_t k = 0; k < d->count; k++)
		v[k] = d->nodes[k].op == OP_INPUT ? s->x.in[d->nodes[k].arg[0].i][d->nodes[k].arg[1].i] : eval_node(&d->nodes[k], v);
	for (size_t k = 0; k < of->count; k++) {
		const struct node *n = &of->nodes[k];
		struct interval r;

		if (n->op != OP_INPUT)
			continue;
		s->in[n->arg[0].i][n->arg[1].i] = s->relaxed.source[k] ? v[s->relaxed.source[k] - 1] : s->x.in[n->arg[0].i][n->arg[1].i];
		r = s->box.rows[n->arg[0].i][n->arg[1].i];
		ck_assert(r.upper - r.lower >= 6.28 || (s->in[n->arg[0].i][n->arg[1].i] >= r.lower - 1e-12 && s->in[n->arg[0].i][n->arg[1].i] <= r.upper + 1e-12));
	}
	for (int b = 0; b < s->relaxed.ball_count; b++) {
		const struct relaxed_ball *ball = &s->relaxed.balls[b];
		double sum = 0;

		for (int k = 0; k < ball->count; k++)
			sum += s->in[s->relaxed.drives][ball->first + k] * s->in[s->relaxed.drives][ball->first + k];
		ck_assert_msg(sqrt(sum) <= ball->radius && sqrt(sum) >= 0.99 * ball->radius - (ball->count < 3) * ball->radius, "%g, not %g", sqrt(sum), ball->radius);
	}
	free(v);
}

/* That state as a point and as drives and rates over their scales. */
static void state_of(const struct set_up *x, const struct field *f, struct field_point *q, double *over)
{
	int position = dag_find_role(f->d, ROLE_JOINT_POSITION, 0);

	for (int k = 0; k < f->dim_count; k++)
		field_place(&f->dims[k], x->in[position][f->dims[k].row], q->x[k]);
	for (int i = 0; i < f->drive_count; i++)
		over[i] = x->in[f->drives[i].argument][f->drives[i].row] / f->drives[i].scale;
	for (int j = 0; j < f->rate_count; j++)
		over[f->drive_count + j] = x->in[f->rates[j].argument][f->rates[j].row] / f->rates[j].scale;
}

/* The polynomial is the output, and nothing in the box is above what extreme_above says; at most states it is near what it should be. */
static void check_field(struct set_up *s, const struct field *f, struct rng *r)
{
	double *work = field_work(f), *c = coefficients(f), over[2 * FIELD_DIMS], *scalars = field_scalars(f), values[64];
	struct robot_box *x = &s->x;
	struct field_point q;

	ck_assert(work && scalars);
	for (int i = 0; i < POINTS; i++) {
		robot_box_draw(x, r, 0, 0);
		robot_box_evaluate(x);
		relax_state(s);
		state_of(s, f, &q, over);
		field_evaluate(f, &q, work, c);
		field_values(f, &q, over, scalars, values);
		for (int o = 0; o < f->output_count; o++) {
			const double *of = c + (size_t)o * f->coefficient_count;
			double exact = robot_box_value(x, (size_t)f->outputs[o]), value = seek_value(f, of, over);
			double noise = f->noise[o] * (double)f->coefficient_count + 1e-12 * fabs(exact);

			ck_assert_msg(fabs(value - exact) <= noise, "%g is not %g", value, exact);
			ck_assert_msg(fabs(values[o] - exact) <= noise, "%g is not %g", values[o], exact);
			ck_assert(extreme_above(f, of, 1, -1e300) + noise >= exact && -extreme_above(f, of, -1, -1e300) - noise <= exact);
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
	struct set_up s;
	int outputs = 0;

	set_up(&s, _i);
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
	struct set_up s;
	struct field_point q;
	double *work, *c, over[2 * FIELD_DIMS], x[2 * FIELD_DIMS];

	set_up(&s, _i);
	work = field_work(&s.fields[0]);
	c = coefficients(&s.fields[0]);
	for (int i = 0; i < POINTS; i++) {
		double most, told;

		robot_box_draw(&s.x, &r, 0, 0);
		relax_state(&s);
		state_of(&s, &s.fields[0], &q, over);
		field_evaluate(&s.fields[0], &q, work, c);
		most = extreme_above(&s.fields[0], c, 1, -1e300);
		told = extreme_corner(&s.fields[0], c, 1, x);
		ck_assert(seek_value(&s.fields[0], c, x) <= most && told <= most * (1 + 1e-9) + 1e-9);
		for (int k = 0; k < 200; k++) {
			for (int j = 0; j < s.fields[0].drive_count + s.fields[0].rate_count; j++) {
				struct interval range = j < s.fields[0].drive_count ? s.fields[0].drives[j].range
										: s.fields[0].rates[j - s.fields[0].drive_count].range;

				over[j] = rng_chance(&r, 0.7) ? (rng_chance(&r, 0.5) ? range.lower : range.upper) : rng_uniform(&r, range.lower, range.upper);
			}
			ck_assert(seek_value(&s.fields[0], c, over) <= most);
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
			double place = dim->is_angle ? rng_uniform(r, -4, 4) : rng_uniform(r, dim->lower + step, dim->upper - step);

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
				y[t][o] = seek_value(f, c + (size_t)o * f->coefficient_count, x);
		}
		for (int o = 0; o < f->output_count; o++)
			ck_assert_msg(fabs(y[0][o] - 2 * y[1][o] + y[2][o]) / (step * step) <=
				  bends->most[o * f->dim_count + k] + 1e5 * f->noise[o] * (double)f->coefficient_count, "output %d, row %d: %g, not %g", o, k,
				fabs(y[0][o] - 2 * y[1][o] + y[2][o]) / (step * step), bends->most[o * f->dim_count + k]);
	}
	free(c);
	free(work);
}

enum { HARMONICS = 32 };

/* Along an angle no harmonic is above the degree; along a length no fourth difference is left. */
static void check_degree(const struct field *f, int k, struct field_point q, const double *x)
{
	double *scalars = field_scalars(f), *values = calloc((size_t)f->output_count, sizeof *values), *y = calloc(2 * HARMONICS, sizeof *y);
	int count = f->dims[k].is_angle ? 2 * HARMONICS : 4;

	for (int o = 0; o < f->output_count; o++) {
		double size = 0, most = 0;

		for (int i = 0; i < count; i++) {
			field_place(&f->dims[k], f->dims[k].is_angle ? 3.14159265358979323846 * i / HARMONICS : f->dims[k].lower + 0.1 * i, q.x[k]);
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
		ck_assert_msg(most <= 1e-10 * size + 1e-300, "output %d, row %d: %g of %g is above degree %d", o, k, most, size, f->dims[k].degree);
	}
	free(y);
	free(values);
	free(scalars);
}

START_TEST(test_degrees)
{
	struct rng r = rng_seed(SEED + 6);
	struct set_up s;

	set_up(&s, _i);
	for (int k = 0; k < s.count; k++)
		for (int i = 0; i < 3 && s.fields[k].has_grid; i++) {
			double x[2 * FIELD_DIMS];
			struct field_point q;

			robot_box_draw(&s.x, &r, 0, 0);
			relax_state(&s);
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
	struct set_up s;

	set_up(&s, _i);
	for (int k = 0; k < s.count && k < 3; k++) {
		const struct field *f = &s.fields[k];
		struct interval *whole = calloc((size_t)f->output_count, sizeof *whole);
		double *found = calloc((size_t)f->output_count, sizeof *found), *most = calloc((size_t)(f->output_count * f->dim_count + 1), sizeof *most);
		struct curvature bends, first = {.most = most};
		const struct curvature_start from = {whole, found, most};

		ck_assert(magnitude_find(whole, f, &s.box, 1, &effort, 0.05) && magnitude_bends(most, f, &s.box, &effort));
		for (int o = 0; o < f->output_count; o++)
			found[o] = 0.2 * interval_size(whole[o]);
		ck_assert(curvature_find(&bends, f, &from, &effort, 1));
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

/* Values and derivatives of all nodes are what eval_node and a sweep say, and within their intervals. */
static void check_adjoint(struct set_up *s, size_t output, int has_lanes, struct rng *r)
{
	struct robot_box *x = &s->x;
	struct adjoint a;
	struct norms n;
	struct norms_values values;
	struct interval *rows[DAG_ARGUMENTS];
	double *v;

	ck_assert(adjoint_make(&a, &s->relaxed.view.dag, output, 1, &x->arena) && norms_make(&n, &a.d, has_lanes, &x->arena));
	ck_assert(norms_lay(&n, &x->arena));
	ck_assert(box_copy(rows, &s->box, &s->relaxed.view.dag, &x->arena));
	ck_assert(norms_values_make(&values, &n, &x->arena));
	v = arena_alloc(&x->arena, a.d.count, sizeof *v);
	norms_evaluate(&n, (const struct interval *const *)rows, &values);
	for (int i = 0; i < POINTS; i++) {
		robot_box_draw(x, r, 0, 0);
		robot_box_evaluate(x);
		relax_state(s);
		for (size_t k = 0; k < a.d.count; k++) {
			const struct node *node = &a.d.nodes[k];
			struct interval range = norms_range(&n, &values, (uint32_t)k);
			double size = values.size[k], noise = 1e-9 * size;

			v[k] = node->op == OP_INPUT ? s->in[node->arg[0].i][node->arg[1].i] : eval_node(node, v);
			ck_assert_msg(v[k] >= range.lower - noise && v[k] <= range.upper + noise && fabs(v[k]) <= size + noise,
				"node %zu: %g is not from %g to %g", k, v[k], range.lower, range.upper);
		}
		ck_assert(fabs(v[a.root.i] - robot_box_value(x, output)) <= 1e-9 * values.size[a.root.i] + 1e-300);
	}
}

/* The derivative by a constant, from torques with it and with it changed. */
static void check_slopes(struct set_up *s, size_t output, struct rng *r)
{
	const struct dag *d = &s->relaxed.view.dag;
	struct robot_box *x = &s->x;
	double *v = calloc(d->count, sizeof *v), *w;
	struct adjoint a;
	uint32_t root = d->outputs[output].value.i;

	ck_assert(adjoint_make(&a, d, output, 1, &x->arena));
	w = calloc(a.d.count, sizeof *w);
	for (int i = 0; i < 30 && root; i++) {
		uint32_t at = (uint32_t)rng_below(r, (int)root) + 1;
		double sum[2];

		robot_box_draw(x, r, 0, 0);
		relax_state(s);
		for (size_t k = 0; k < a.d.count; k++)
			w[k] = a.d.nodes[k].op == OP_INPUT ? s->in[a.d.nodes[k].arg[0].i][a.d.nodes[k].arg[1].i] : eval_node(&a.d.nodes[k], w);
		if (d->nodes[at].op == OP_INPUT || !a.slope[at].i)
			continue;
		for (int side = 0; side < 2; side++) {
			for (uint32_t k = 0; k <= root; k++) {
				v[k] = d->nodes[k].op == OP_INPUT ? s->in[d->nodes[k].arg[0].i][d->nodes[k].arg[1].i] : eval_node(&d->nodes[k], v);
				v[k] += k == at ? (side ? 1e-6 : -1e-6) : 0;
			}
			sum[side] = v[root];
		}
		ck_assert_msg(fabs((sum[1] - sum[0]) / 2e-6 - w[a.slope[at].i]) <= 1e-6 * (1 + fabs(sum[0]) + fabs(w[a.slope[at].i])),
			"by node %u: %g, not %g", at, w[a.slope[at].i], (sum[1] - sum[0]) / 2e-6);
	}
	free(w);
	free(v);
}

START_TEST(test_norms)
{
	struct rng r = rng_seed(SEED + 3);
	struct set_up s;

	set_up(&s, _i);
	for (size_t o = 0; o < s.x.analysis.dag.output_count; o += 3) {
		check_adjoint(&s, o, 0, &r);
		check_adjoint(&s, o, 1, &r);
		check_slopes(&s, o, &r);
	}
	robot_box_close(&s.x);
}
END_TEST

/* Values of all nodes of the relaxed DAG in a drawn state. */
static void node_values(struct set_up *s, struct rng *r, double *v)
{
	const struct dag *d = &s->relaxed.view.dag;

	robot_box_draw(&s->x, r, 0, 0);
	relax_state(s);
	for (size_t k = 0; k < d->count; k++)
		v[k] = d->nodes[k].op == OP_INPUT ? s->in[d->nodes[k].arg[0].i][d->nodes[k].arg[1].i] : eval_node(&d->nodes[k], v);
}

/* Its outputs are those that it was cut from, where its inputs are what the nodes say. */
static void check_cut(struct set_up *s, const struct cut *c, const struct field *f, const double *v)
{
	const struct dag *d = &s->relaxed.view.dag;
	int rates = c->relaxed.view.dag.argument_count - 2, position = dag_find_role(d, ROLE_JOINT_POSITION, 0);
	double x[2 * FIELD_DIMS], *scalars = field_scalars(f), *values = calloc((size_t)f->output_count, sizeof *values);
	struct field_point q;

	ck_assert(scalars && values);
	for (int k = 0; k < c->leaf_count; k++)
		ck_assert_msg(v[c->leaves[k]] >= c->box.rows[rates][k].lower - 1e-9 && v[c->leaves[k]] <= c->box.rows[rates][k].upper + 1e-9, "leaf %d: %g",
			k, v[c->leaves[k]]);
	for (int k = 0; k < f->dim_count; k++)
		field_place(&f->dims[k], s->in[position][f->dims[k].row], q.x[k]);
	for (int i = 0; i < f->drive_count + f->rate_count; i++) {
		const struct field_input *in = i < f->drive_count ? &f->drives[i] : &f->rates[i - f->drive_count];

		x[i] = (in->argument >= rates ? v[c->leaves[in->row]] : s->in[in->argument][in->row]) / in->scale;
	}
	field_values(f, &q, x, scalars, values);
	for (int o = 0; o < f->output_count; o++) {
		int of = c->outputs[f->outputs[o]], wrench = of - (int)d->output_count;
		double value = v[wrench < 0 ? d->outputs[of].value.i : c->wrenches[wrench]];

		ck_assert_msg(fabs(values[o] - value) <= 1e-9 * (1 + fabs(value)), "output %d: %g, not %g", of, values[o], value);
	}
	free(values);
	free(scalars);
}

/* Limbs, and what carries them, are the robot's own parts. */
START_TEST(test_cuts)
{
	static const char *const names[] = {"atlas", "g1_29dof", "floating:atlas"};
	struct rng r = rng_seed(SEED + 5);
	struct effort effort = robot_box_effort();
	struct set_up s;
	struct cut *cuts, rest;
	struct interval **ranges;
	double *v;
	int count, most = 0;

	set_up_of(&s, names[_i], "range qdd=-20,20\nrange qd=-9,9");
	count = cut_make(&cuts, &s.relaxed, s.fields, s.count, 9, &effort, 0.1, &s.x.arena);
	ck_assert_int_gt(count, 0);
	ranges = arena_alloc(&s.x.arena, (size_t)count, sizeof *ranges);
	for (int i = 0; i < count; i++) {
		ranges[i] = arena_alloc(&s.x.arena, (size_t)cuts[i].wrench_count, sizeof **ranges);
		for (int k = 0; k < cuts[i].wrench_count; k++)
			ranges[i][k] = (struct interval){-1e9, 1e9};
		for (int k = 0; k < cuts[i].field_count; k++)
			most = cuts[i].fields[k].dim_count > most ? cuts[i].fields[k].dim_count : most;
	}
	ck_assert_int_le(most, 6);
	ck_assert_int_ge(cut_rest(&rest, &s.relaxed, s.fields, s.count, 9, cuts, count, ranges, &s.x.arena), 0);
	v = arena_alloc(&s.x.arena, s.relaxed.view.dag.count, sizeof *v);
	for (int i = 0; i < POINTS; i++) {
		node_values(&s, &r, v);
		for (int k = 0; k < count; k++)
			for (int f = 0; f < cuts[k].field_count; f++)
				check_cut(&s, &cuts[k], &cuts[k].fields[f], v);
		for (int f = 0; f < rest.field_count; f++)
			check_cut(&s, &rest, &rest.fields[f], v);
	}
	workers_close(effort.workers);
	robot_box_close(&s.x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("range");

	suite_add(suite, "fields", test_fields, ROBOT_COUNT, 600);
	suite_add(suite, "corners", test_corners, ROBOT_COUNT, 600);
	suite_add(suite, "curvature", test_curvature, ROBOT_COUNT, 600);
	suite_add(suite, "degrees", test_degrees, ROBOT_COUNT, 600);
	suite_add(suite, "cuts", test_cuts, 3, 600);
	suite_add(suite, "norms", test_norms, ROBOT_COUNT, 600);
	return suite_run(suite);
}
