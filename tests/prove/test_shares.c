/* The length of an output's derivatives by the cosine and sine of an angle is at least that of a sweep back over the
   text's own DAG, at states drawn within small boxes; p = c x + s y beside c y - s x is a rotation, and beside c y + s
   x, or c z - s x, it is none. */
#include "dag/eval.h"
#include "prove/robot_box.h"
#include "prove/shares.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEED = 31, BOXES = 12, STATES = 4 };

static const char *const ROBOTS[] = {"iiwa14", "panda", "ur5", "hyq", "skew_axis", "negative_axes", "planar_joint"};

/* The derivatives of an output by all nodes, where the inputs are in[]. */
static void sweep(const struct dag *d, size_t output, double *const *in, double *slope)
{
	double *v = calloc(d->count, sizeof *v), by[3];

	for (uint32_t i = 0; i < d->count; i++)
		v[i] = d->nodes[i].op == OP_INPUT ? in[d->nodes[i].arg[0].i][d->nodes[i].arg[1].i] : eval_node(&d->nodes[i], v);
	memset(slope, 0, d->count * sizeof *slope);
	slope[d->outputs[output].value.i] = 1;
	for (uint32_t i = d->outputs[output].value.i + 1; i-- > 0;) {
		eval_partials(&d->nodes[i], v, by);
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			slope[d->nodes[i].arg[k].i] += slope[i] * by[k];
	}
	free(v);
}

/* Over a box, of one angle. */
static double length_of(const struct dag *d, size_t output, uint32_t cosine, uint32_t sine, const struct interval *const *rows)
{
	struct arena a;
	struct adjoint x;
	struct norms n;
	struct norms_values v = {0};
	struct shares s;
	double length;

	arena_init(&a, NULL);
	ck_assert(adjoint_make(&x, d, output, 1, &a) && norms_make(&n, &x.d, 0, &a) &&
		  shares_find(&s, &n, d, &x, cosine, sine, &a));
	ck_assert(norms_lay(&n, &a) && norms_values_make(&v, &n, &a));
	norms_evaluate(&n, rows, &v);
	length = shares_length(&s, &n, &v);
	arena_free(&a);
	return length;
}

static uint32_t cosine_of(const struct dag *d, uint32_t sine)
{
	for (uint32_t i = 1; i < d->count; i++)
		if (d->nodes[i].op == OP_COS && d->nodes[i].arg[0].i == d->nodes[sine].arg[0].i)
			return i;
	return 0;
}

/* A box around a state, of a few hundredths of what there is room for. */
static void draw_box(const struct robot_box *x, struct rng *r, struct box *b)
{
	const struct dag *d = &x->analysis.dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < d->arguments[i].rows && x->box.rows[i]; k++) {
			struct interval all = x->box.rows[i][k];
			double half = rng_uniform(r, 0, 0.04) * (all.upper - all.lower),
			       at = rng_uniform(r, all.lower + half, all.upper - half);

			b->rows[i][k] = (struct interval){at - half, at + half};
		}
}

static void draw_within(const struct dag *d, struct rng *r, const struct box *b, double *const *in)
{
	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < d->arguments[i].rows && b->rows[i]; k++)
			in[i][k] = rng_uniform(r, b->rows[i][k].lower, b->rows[i][k].upper);
}

START_TEST(test_robots)
{
	struct robot_box x;
	struct rng r = rng_seed(SEED);
	struct box b = {{0}};
	const struct dag *d;
	double *slope;

	robot_box_open(&x, ROBOTS[_i], "range qdd=-20,20\nrange qd=-2,2\nrange q=-2,2", 0);
	d = &x.analysis.dag;
	slope = calloc(d->count, sizeof *slope);
	ck_assert(box_copy(b.rows, &x.box, d, &x.arena));
	for (int i = 0; i < BOXES; i++) {
		size_t output = (size_t)i % d->output_count;

		draw_box(&x, &r, &b);
		for (int k = 0; k < STATES; k++) {
			draw_within(d, &r, &b, x.in);
			sweep(d, output, x.in, slope);
			for (uint32_t s = 1; s <= d->outputs[output].value.i; s++) {
				uint32_t c = d->nodes[s].op == OP_SIN ? cosine_of(d, s) : 0;
				double least, length;

				if (!c || (slope[s] == 0 && slope[c] == 0))
					continue;
				least = hypot(slope[s], slope[c]);
				length = length_of(d, output, c, s, (const struct interval *const *)b.rows);
				ck_assert_msg(length >= least * (1 - 1e-9),
					"%s, seed %d, output %zu, sine %u: %g, but %g is one", ROBOTS[_i], SEED, output,
					s, length, least);
			}
		}
	}
	free(slope);
	robot_box_close(&x);
}
END_TEST

enum sums { ROTATION, OTHER_SIGN, OTHER_VALUE };

/* v p + w r, by rows 1 to 5 of the input: x, y, v, w, and what stands in the place of y in r. */
static double two_sums(enum sums kind, const double *row, double *least)
{
	struct arena a;
	struct dag d;
	struct ref c, s, in[6], other, p, r;
	struct interval box[6];
	double slope[64], *rows[DAG_ARGUMENTS] = {(double *)(uintptr_t)row}, length;

	arena_init(&a, NULL);
	dag_init(&d, &a);
	dag_argument(&d, "x", 6, 0);
	dag_argument(&d, "y", 1, 1);
	for (int i = 0; i < 6; i++) {
		in[i] = dag_input(&d, 0, i);
		box[i] = (struct interval){row[i], row[i]};
	}
	c = dag_cos(&d, in[0]);
	s = dag_sin(&d, in[0]);
	p = dag_add(&d, dag_mul(&d, c, in[1]), dag_mul(&d, s, in[2]));
	other = kind == OTHER_VALUE ? in[5] : in[2];
	r = dag_add(&d, dag_mul(&d, c, other), dag_mul(&d, kind == OTHER_SIGN ? s : dag_neg(&d, s), in[1]));
	dag_output(&d, 1, 0, dag_add(&d, dag_mul(&d, in[3], p), dag_mul(&d, in[4], r)));
	ck_assert(!d.failed && d.count <= 64);
	sweep(&d, 0, rows, slope);
	*least = hypot(slope[c.i], slope[s.i]);
	length = length_of(&d, 0, c.i, s.i, (const struct interval *const[DAG_ARGUMENTS]){box});
	arena_free(&a);
	return length;
}

START_TEST(test_rotation)
{
	struct rng r = rng_seed(SEED);

	for (int i = 0; i < 100; i++) {
		double row[6], least, length;

		for (int k = 0; k < 6; k++)
			row[k] = rng_uniform(&r, -2, 2);
		length = two_sums(ROTATION, row, &least);
		ck_assert_msg(length >= least * (1 - 1e-9) && length <= least * (1 + 1e-6), "seed %d: %g, not %g", SEED,
			length, least);
		for (enum sums kind = OTHER_SIGN; kind <= OTHER_VALUE; kind++) {
			length = two_sums(kind, row, &least);
			ck_assert_msg(length >= least * (1 - 1e-9), "seed %d, no rotation: %g, but %g is one", SEED,
				length, least);
		}
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("shares");

	suite_add(suite, "robots", test_robots, (int)(sizeof ROBOTS / sizeof *ROBOTS), 60);
	suite_add(suite, "rotation", test_rotation, 1, 20);
	return suite_run(suite);
}
