/* Derivatives of outputs by all nodes, and norms that rotations keep, on own robots: values and derivatives are what evaluation
   and differences of it say, and within their intervals. It would catch a derivative by the wrong node, a norm of things that are
   no rotation, and an interval that is rounded inwards. */
#include "dag/eval.h"
#include "norms/adjoint.h"
#include "norms/norms.h"
#include "prove/relaxed_box.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEED = 24, POINTS = 40 };

/* Values and derivatives of all nodes are what eval_node and a sweep say, and within their intervals. */
static void check_adjoint(struct relaxed_box *s, size_t output, int has_lanes, struct rng *r)
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
		relaxed_box_see(s);
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
static void check_slopes(struct relaxed_box *s, size_t output, struct rng *r)
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
		relaxed_box_see(s);
		for (size_t k = 0; k < a.d.count; k++)
			w[k] = a.d.nodes[k].op == OP_INPUT ? s->in[a.d.nodes[k].arg[0].i][a.d.nodes[k].arg[1].i]
				: eval_node(&a.d.nodes[k], w);
		if (d->nodes[at].op == OP_INPUT || !a.slope[at].i)
			continue;
		for (int side = 0; side < 2; side++) {
			for (uint32_t k = 0; k <= root; k++) {
				v[k] = d->nodes[k].op == OP_INPUT ? s->in[d->nodes[k].arg[0].i][d->nodes[k].arg[1].i]
					: eval_node(&d->nodes[k], v);
				v[k] += k == at ? (side ? 1e-6 : -1e-6) : 0;
			}
			sum[side] = v[root];
		}
		ck_assert_msg(fabs((sum[1] - sum[0]) / 2e-6 - w[a.slope[at].i]) <= 1e-6 *
			(1 + fabs(sum[0]) + fabs(w[a.slope[at].i])),
			"by node %u: %g, not %g", at, w[a.slope[at].i], (sum[1] - sum[0]) / 2e-6);
	}
	free(w);
	free(v);
}

START_TEST(test_norms)
{
	struct rng r = rng_seed(SEED);
	struct relaxed_box s;

	relaxed_box_case(&s, _i);
	for (size_t o = 0; o < s.x.analysis.dag.output_count; o += 3) {
		check_adjoint(&s, o, 0, &r);
		check_adjoint(&s, o, 1, &r);
		check_slopes(&s, o, &r);
	}
	robot_box_close(&s.x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("norms");

	suite_add(suite, "norms", test_norms, RELAXED_BOX_CASES, 600);
	return suite_run(suite);
}
