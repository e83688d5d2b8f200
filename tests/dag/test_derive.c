/* Derivatives of expressions against differences. */
#include "dag/derive.h"
#include "dag/eval.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>

static const real AT = 0.7L, STEP = 1e-6L;

/* Every operation at once: 3 y/sqrt(y^2 + 2) + sqrt(y)/(1 + y) - sin(2 y) cos(y), in numbers */
static real number(real y)
{
	return 3 * y / sqrtl(y * y + 2) + sqrtl(y) / (1 + y) - sinl(2 * y) * cosl(y);
}

/* and in symbols. */
static struct ref symbol(struct dag *d, struct ref y)
{
	struct ref two = dag_const(d, 2), one = dag_const(d, 1), sum;

	sum = dag_div(d, dag_mul(d, dag_const(d, 3), y), dag_sqrt(d, dag_fma(d, y, y, two)));
	sum = dag_add(d, sum, dag_div(d, dag_sqrt(d, y), dag_add(d, one, y)));
	return dag_sub(d, sum, dag_mul(d, dag_sin(d, dag_mul(d, two, y)), dag_cos(d, dag_neg(d, y))));
}

static struct ref unit(void *context, int argument, int row)
{
	ck_assert(argument == 0 && row == 0);
	return *(struct ref *)context;
}

START_TEST(test_rules)
{
	struct arena a;
	struct dag d;
	struct derivable x;
	struct ref in, root, *dot, *bar, one;
	real out[2], slope = (number(AT + STEP) - number(AT - STEP)) / (2 * STEP);

	arena_init(&a, NULL);
	dag_init(&d, &a);
	dag_argument(&d, "in", 1, 0);
	dag_argument(&d, "out", 2, 1);
	in = dag_input(&d, 0, 0);
	one = dag_const(&d, 1);
	root = symbol(&d, in);
	ck_assert(derive_begin(&x, &d, &root, 1));
	dot = arena_alloc(&a, x.count, sizeof *dot);
	bar = arena_alloc(&a, x.count, sizeof *bar);
	derive_forward(&x, unit, &one, dot);
	derive_backward(&x, &one, bar);
	dag_output(&d, 1, 0, dot[root.i]);
	dag_output(&d, 1, 1, bar[in.i]);
	ck_assert(eval_real(&d, (const real *[]){&AT, NULL}, (real *[]){NULL, out}, NULL));
	for (int i = 0; i < 2; i++)
		ck_assert_msg(fabsl(out[i] - slope) < 1e-11L, "%s: %.15Lg, not %.15Lg",
			i ? "backwards" : "forwards", out[i], slope);
	arena_free(&a);
}
END_TEST

/* The same rules in numbers, from the root back. */
START_TEST(test_partials)
{
	struct arena a;
	struct dag d;
	struct ref in, root;
	double *value, *by, partials[3], slope = (double)((number(AT + STEP) - number(AT - STEP)) / (2 * STEP));

	arena_init(&a, NULL);
	dag_init(&d, &a);
	dag_argument(&d, "in", 1, 0);
	in = dag_input(&d, 0, 0);
	root = symbol(&d, in);
	value = arena_alloc(&a, d.count, sizeof *value);
	by = arena_alloc(&a, d.count, sizeof *by);
	for (size_t i = 0; i < d.count; i++)
		value[i] = i == in.i ? (double)AT : eval_node(&d.nodes[i], value);
	by[root.i] = 1;
	for (size_t i = d.count; i-- > 0;) {
		eval_partials(&d.nodes[i], value, partials);
		for (int k = 0; k < op_arity[d.nodes[i].op]; k++)
			by[d.nodes[i].arg[k].i] += by[i] * partials[k];
	}
	ck_assert_msg(fabs(value[root.i] - (double)number(AT)) < 1e-15, "%.17g, not %.17g", value[root.i], (double)number(AT));
	ck_assert_msg(fabs(by[in.i] - slope) < 1e-11, "%.15g, not %.15g", by[in.i], slope);
	arena_free(&a);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("derive");
	TCase *c = tcase_create("derive");

	tcase_add_test(c, test_rules);
	tcase_add_test(c, test_partials);
	suite_add_tcase(s, c);
	return suite_run(s);
}
