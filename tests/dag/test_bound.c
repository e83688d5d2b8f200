/* Bounds as expressions, operation by operation: what a float's arithmetic makes of drawn numbers is within each, and comes close
   to it. A rounding that a rule forgets would break its bound; one that it counts twice would leave it far. */
#include "dag/bound.h"
#include "dag/eval.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>

enum { SEED = 18, DRAWS = 20000, INPUTS = 3 };

static real round_float(real x)
{
	return (real)(float)x;
}

/* Of float, with the C library's sine and cosine. */
static const struct eval_model FLOATS = {.add = 0x1p-24, .mul = 0x1p-24, .quotient = 0x1p-24, .tiny = 0x1p-150,
	.sincos = 2 * 0x1p-24, .sine = 0x1p-149, .cosine = 0x1p-149, .constant = round_float};

typedef struct ref expression(struct dag *d, const struct ref *x);

static struct ref sum(struct dag *d, const struct ref *x)
{
	return dag_add(d, x[0], x[1]);
}

static struct ref difference(struct dag *d, const struct ref *x)
{
	return dag_sub(d, x[0], x[1]);
}

static struct ref product(struct dag *d, const struct ref *x)
{
	return dag_mul(d, x[0], dag_neg(d, x[1]));
}

static struct ref quotient(struct dag *d, const struct ref *x)
{
	return dag_div(d, x[0], x[1]);
}

static struct ref root(struct dag *d, const struct ref *x)
{
	return dag_sqrt(d, dag_abs(d, x[0]));
}

static struct ref sine(struct dag *d, const struct ref *x)
{
	return dag_sin(d, x[0]);
}

static struct ref cosine(struct dag *d, const struct ref *x)
{
	return dag_cos(d, x[0]);
}

/* 0.1 is off by more than a quarter of the unit in float; the decimal is meant. */
static struct ref tenth(struct dag *d, const struct ref *x)
{
	return dag_mul(d, dag_within(d, within_decimal(0.1, 0.1L)), x[0]);
}

static struct ref half(struct dag *d, const struct ref *x)
{
	return dag_mul(d, dag_const(d, 0.5L), sum(d, x));
}

/* Of what is off already. */
static struct ref product_of_sums(struct dag *d, const struct ref *x)
{
	return dag_mul(d, dag_add(d, x[0], x[1]), dag_sub(d, x[1], x[2]));
}

static struct ref quotient_of_sums(struct dag *d, const struct ref *x)
{
	return dag_div(d, dag_add(d, x[0], x[1]), dag_sub(d, x[1], x[2]));
}

static struct ref root_of_sum(struct dag *d, const struct ref *x)
{
	return dag_sqrt(d, dag_add(d, dag_mul(d, x[0], x[0]), dag_mul(d, x[1], x[1])));
}

static struct ref sine_of_sum(struct dag *d, const struct ref *x)
{
	return dag_sin(d, dag_add(d, x[0], x[1]));
}

/* 1 + 2 + 4 ... small differences of large numbers */
static struct ref cancelled(struct dag *d, const struct ref *x)
{
	struct ref s = dag_mul(d, x[0], x[1]);

	return dag_sub(d, dag_mul(d, dag_add(d, s, x[2]), x[2]), dag_add(d, dag_mul(d, s, x[2]), dag_mul(d, x[2], x[2])));
}

static const struct rule {
	const char *name;
	expression *make;
	double share; /* of the bound that the largest error has, at least */
} RULES[] = {{"sum", sum, 0.95}, {"difference", difference, 0.95}, {"product", product, 0.95}, {"quotient", quotient, 0.95},
	{"root", root, 0.95},
	{"sine", sine, 0.4}, {"cosine", cosine, 0.4}, {"constant", tenth, 0.8}, {"half", half, 0.95},
	{"product of sums", product_of_sums, 0.7}, {"quotient of sums", quotient_of_sums, 0.7},
	{"root of a sum", root_of_sum, 0.3}, {"sine of a sum", sine_of_sum, 0.5}, {"cancelled", cancelled, 0.4}};

static void open_rule(struct dag *d, struct arena *a, const struct rule *rule)
{
	struct ref x[INPUTS], value;
	struct bound b;
	int in, out;

	arena_init(a, NULL);
	dag_init(d, a);
	in = dag_argument(d, "x", INPUTS, 0);
	out = dag_argument(d, "y", 2, 1);
	for (int i = 0; i < INPUTS; i++)
		x[i] = dag_input(d, in, i);
	value = rule->make(d, x);
	ck_assert(bound_make(&b, d, &FLOATS, &value, 1, NULL, NULL, 0));
	dag_output(d, out, 0, value);
	dag_output(d, out, 1, dag_mul(d, dag_const(d, bound_factor(&FLOATS, b.way[value.i])), b.error[value.i]));
	ck_assert(!d->failed);
}

/* Numbers of the same size, often nearly equal; in turn next to nothing. */
static void draw(struct rng *rng, int turn, float *x)
{
	double size = turn % 4 == 3 ? exp2(rng_uniform(rng, -140, 0)) : 1;

	for (int i = 0; i < INPUTS; i++)
		x[i] = (float)(size * rng_uniform(rng, -4, 4));
	if (turn % 4 == 1)
		x[1] = (float)((double)-x[0] * (1 + rng_uniform(rng, -1e-3, 1e-3)));
}

START_TEST(rules)
{
	const struct rule *rule = &RULES[_i];
	struct rng rng = rng_seed(SEED);
	struct arena a;
	struct dag d;
	double share = 0;

	open_rule(&d, &a, rule);
	for (int k = 0; k < DRAWS; k++) {
		float x[INPUTS], y[2];
		real wide[INPUTS], exact[2], error;

		draw(&rng, k, x);
		for (int i = 0; i < INPUTS; i++)
			wide[i] = (real)x[i];
		ck_assert(eval_f32(&d, (const float *[]){x, NULL}, (float *[]){NULL, y}, NULL));
		ck_assert(eval_real(&d, (const real *[]){wide, NULL}, (real *[]){NULL, exact}, NULL));
		error = fabsl((real)y[0] - exact[0]);
		ck_assert_msg(!(error > (real)y[1]), "%s of %a, %a, %a: %g is off by %Lg, bound %g", rule->name,
			(double)x[0], (double)x[1], (double)x[2], (double)y[0], error, (double)y[1]);
		if (isfinite(y[1]) && y[1] > 1e-30f)
			share = fmax(share, (double)(error / (real)y[1]));
	}
	printf("%-18s error at most %.2f of a bound\n", rule->name, share);
	ck_assert_msg(share > rule->share, "%s: bounds are too large", rule->name);
	arena_free(&a);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bound");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("bounds as expressions, seed %d\n", SEED);
	suite_add(suite, "rules", rules, sizeof RULES / sizeof *RULES, 30);
	return suite_run(suite);
}
