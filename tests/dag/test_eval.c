/* The DAG's evaluator: values, magnitudes and error bounds of seeded random DAGs in four precisions, before and after
   fusing; what happens when there is no memory. */
#include "dag/eval.h"
#include "support/expression.h"
#include "support/rng.h"
#include "support/suite.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef RNEAGEN_QUAD
typedef __float128 wide;
#define eval_wide eval_quad
#else
typedef real wide;
#define eval_wide eval_real
#endif

enum { INPUTS = 6, OUTPUTS = 8, DAGS = 1000, SAMPLES = 5 };

/* One state in every precision. */
struct state {
	float f32[INPUTS];
	double f64[INPUTS];
	real extended[INPUTS];
	wide exact[INPUTS];
};

struct values {
	float f32[OUTPUTS];
	double f64[OUTPUTS];
	real extended[OUTPUTS];
	wide exact[OUTPUTS];
	double bound[3][OUTPUTS], size[OUTPUTS], exact_bound[OUTPUTS]; /* bounds of f32, f64, real */
};

static struct state random_state(struct rng *rng, double scale)
{
	struct state s;

	for (int i = 0; i < INPUTS; i++) {
		s.f32[i] = (float)rng_uniform(rng, -2 * scale, 2 * scale);
		s.f64[i] = (double)s.f32[i];
		s.extended[i] = (real)s.f32[i];
		s.exact[i] = (wide)s.f32[i];
	}
	return s;
}

static real random_constant(struct rng *rng)
{
	static const real plain[] = {0, 1, -1, 2, 0.5L, -0.25L, 0.1L, 1e-5L};

	return rng_chance(rng, 0.4) ? plain[rng_below(rng, 8)] : (real)rng_uniform(rng, -3, 3) + 0x1p-58L;
}

/* Nodes from older ones; the younger are likelier. Products stay small by way of a sine now and then. */
static struct ref random_node(struct dag *d, struct rng *rng, const struct ref *pool, int count)
{
	struct ref a = pool[rng_below(rng, count)], b = pool[rng_chance(rng, 0.5) ? count - 1 : rng_below(rng, count)];

	switch (rng_below(rng, 9)) {
	case 0:
	case 1:
		return dag_add(d, a, b);
	case 2:
	case 3:
		return dag_sub(d, a, b);
	case 4:
		return dag_mul(d, dag_sin(d, a), b);
	case 5:
		return dag_mul(d, a, dag_cos(d, b));
	case 6:
		return dag_neg(d, b);
	case 7:
		return dag_add(d, a, dag_mul(d, dag_const(d, random_constant(rng)), dag_sin(d, b)));
	default:
		return dag_sub(d, dag_mul(d, dag_sin(d, a), dag_sin(d, b)), a);
	}
}

static void random_dag(struct dag *d, struct arena *a, struct rng *rng)
{
	struct ref pool[200];
	int count = 0, end = 20 + rng_below(rng, 180);

	dag_init(d, a);
	dag_argument(d, "in", INPUTS, 0);
	dag_argument(d, "out", OUTPUTS, 1);
	for (; count < INPUTS; count++)
		pool[count] = dag_input(d, 0, count);
	for (; count < INPUTS + 4; count++)
		pool[count] = dag_const(d, random_constant(rng));
	for (; count < end; count++) {
		if (rng_chance(rng, 0.1))
			dag_section(d, SECTION_OUT, 0);
		pool[count] = random_node(d, rng, pool, count);
	}
	for (int i = 0; i < OUTPUTS; i++)
		dag_output(d, 1, i, pool[i < 3 ? count - 1 - i : rng_below(rng, count)]);
	ck_assert(!d->failed);
}

static void evaluate(const struct dag *d, const struct state *s, struct values *v)
{
	const float *f32[] = {s->f32, NULL};
	const double *f64[] = {s->f64, NULL};
	const real *extended[] = {s->extended, NULL};
	const wide *exact[] = {s->exact, NULL};

	ck_assert(eval_f32(d, f32, (float *[]){NULL, v->f32}, &(struct eval_terms){v->size, v->bound[0]}));
	ck_assert(eval_f64(d, f64, (double *[]){NULL, v->f64}, &(struct eval_terms){NULL, v->bound[1]}));
	ck_assert(eval_real(d, extended, (real *[]){NULL, v->extended}, &(struct eval_terms){v->size, v->bound[2]}));
	ck_assert(eval_wide(d, exact, (wide *[]){NULL, v->exact}, &(struct eval_terms){NULL, v->exact_bound}));
}

static double distance(wide a, wide b)
{
	return (double)(a < b ? b - a : a - b);
}

/* Errors against quad precision, over their bounds, largest first. */
struct ratios {
	double of[3];
};

static void check_bounds(const struct values *v, uint64_t seed, struct ratios *r)
{
	for (int i = 0; i < OUTPUTS; i++) {
		const double errors[3] = {distance((wide)v->f32[i], v->exact[i]), distance((wide)v->f64[i], v->exact[i]),
			distance((wide)v->extended[i], v->exact[i])};

		for (int p = 0; p < 3; p++) {
			double bound = v->bound[p][i] + v->exact_bound[i];

			ck_assert_msg(errors[p] <= bound, "seed %llu, output %d, precision %d: off by %g, bound %g",
				(unsigned long long)seed, i, p, errors[p], bound);
			if (bound > 0 && errors[p] / bound > r->of[p])
				r->of[p] = errors[p] / bound;
		}
		ck_assert((double)fabsl(v->extended[i]) <= v->size[i] * (1 + 1e-10));
	}
}

static void check_equal(const struct values *a, const struct values *b, uint64_t seed)
{
	for (int i = 0; i < OUTPUTS; i++) {
		int equal = distance((wide)a->f32[i], (wide)b->f32[i]) <= a->bound[0][i] + b->bound[0][i] &&
			distance((wide)a->f64[i], (wide)b->f64[i]) <= a->bound[1][i] + b->bound[1][i] &&
			distance((wide)a->extended[i], (wide)b->extended[i]) <= a->bound[2][i] + b->bound[2][i] &&
			distance(a->exact[i], b->exact[i]) <= a->exact_bound[i] + b->exact_bound[i];

		ck_assert_msg(equal, "seed %llu, output %d: %.9g before, %.9g after", (unsigned long long)seed, i, a->f64[i],
			b->f64[i]);
		ck_assert_msg(fabs(a->size[i] - b->size[i]) <= 1e-9 * a->size[i], "seed %llu, output %d: sizes %g and %g",
			(unsigned long long)seed, i, a->size[i], b->size[i]);
	}
}

START_TEST(random_dags)
{
	struct ratios before = {{0}}, after = {{0}};
	size_t nodes = 0, left = 0;

	for (uint64_t seed = 1; seed <= DAGS; seed++) {
		struct rng rng = rng_seed(seed);
		struct dag d, fused;
		struct arena a;

		arena_init(&a, NULL);
		random_dag(&d, &a, &rng);
		dag_init(&fused, &a);
		dag_fuse(&fused, &d, 0);
		for (int i = 0; i < SAMPLES; i++) {
			struct state s = random_state(&rng, 1);
			struct values raw, joined;

			evaluate(&d, &s, &raw);
			evaluate(&fused, &s, &joined);
			check_bounds(&raw, seed, &before);
			check_bounds(&joined, seed, &after);
			check_equal(&raw, &joined, seed);
		}
		nodes += d.count;
		left += fused.count;
		arena_free(&a);
	}
	printf("%d random DAGs, seeds 1 to %d, %zu nodes, %zu fused; worst error of its bound: f32 %.2f, f64 %.2f, real %.2f\n",
		DAGS, DAGS, nodes, left, after.of[0], after.of[1], after.of[2]);
	for (int p = 0; p < 2; p++) /* a bound that says nothing would pass too */
		ck_assert(before.of[p] > 0.05 && after.of[p] > 0.05);
}
END_TEST

/* Products of inputs and of constants that are subnormal in single precision, or vanish there. */
START_TEST(underflow)
{
	static const double scales[] = {1e-18, 1e-20, 1e-22, 1e-30, 1e-44};
	struct ratios worst = {{0}};
	size_t rounded = 0;

	for (uint64_t seed = 1; seed <= DAGS; seed++) {
		double scale = scales[seed % 5];
		struct rng rng = rng_seed(seed);
		struct values v;
		struct state s;
		struct arena a;
		struct dag d;

		arena_init(&a, NULL);
		dag_init(&d, &a);
		dag_argument(&d, "in", INPUTS, 0);
		dag_argument(&d, "out", OUTPUTS, 1);
		for (int i = 0; i < OUTPUTS; i++) {
			struct ref x = dag_mul(&d, dag_input(&d, 0, i % INPUTS), dag_input(&d, 0, (i + 1) % INPUTS));
			struct ref y = dag_mul(&d, dag_const(&d, random_constant(&rng) * (real)scale),
				dag_input(&d, 0, i % INPUTS));

			dag_output(&d, 1, i, i % 2 ? dag_add(&d, x, y) : dag_fma(&d, dag_input(&d, 0, 3), y, x));
		}
		s = random_state(&rng, scale);
		evaluate(&d, &s, &v);
		check_bounds(&v, seed, &worst);
		for (int i = 0; i < OUTPUTS; i++)
			rounded += distance((wide)v.f32[i], v.exact[i]) > 0x1p-22 * fabs((double)v.exact[i]);
		arena_free(&a);
	}
	printf("%d DAGs of tiny numbers: %zu outputs lost bits to underflow; worst error of its bound: f32 %.2f\n", DAGS, rounded,
		worst.of[0]);
	ck_assert_uint_gt(rounded, DAGS);
}
END_TEST

/* Nothing is said of what overflowed, nor of what came of it, zero times infinity included. */
START_TEST(overflow)
{
	static const char *const expressions[] = {"* x y", "+ z * x y", "f x y z", "* z + * x y * x y", "s * x y", "- * x y 1"};
	float x[4] = {1e30f, 1e30f, 0, 0}, out;
	double bound;

	for (size_t i = 0; i < sizeof expressions / sizeof *expressions; i++) {
		struct arena a;
		struct dag d;

		arena_init(&a, NULL);
		expression_init(&d, &a);
		expression_build(&d, expressions[i]);
		ck_assert(eval_f32(
			&d, (const float *[]){x, NULL}, (float *[]){NULL, &out}, &(struct eval_terms){NULL, &bound}));
		ck_assert_msg(isinf(bound), "%s: %g, bound %g", expressions[i], (double)out, bound);
		arena_free(&a);
	}
}
END_TEST

static real as_it_is(real value)
{
	return value;
}

/* A compiler may round the product of a fused multiply-add by itself: it overflows where the sum does not. */
START_TEST(overflow_of_product)
{
	const double x[4] = {2e19, 2e19, -1e38, 0};
	struct eval_model m = {.add = 0x1p-24, .mul = 0x1p-24, .tiny = 0x1p-150, .largest = FLT_MAX, .store_largest = FLT_MAX,
		.constant = as_it_is};
	struct arena a;
	struct dag d;

	arena_init(&a, NULL);
	expression_init(&d, &a);
	expression_build(&d, "f x y z");
	for (m.fused = 0; m.fused < 2; m.fused++) {
		double bound = 0;

		ck_assert(eval_bound(&d, &m, (const double *[]){x, NULL}, (double *[]){NULL, &bound}));
		ck_assert_msg((isinf(bound) == 0) == m.fused, "fused %d: bound %g", m.fused, bound);
	}
	arena_free(&a);
}
END_TEST

/* ---- by hand ---- */

static const struct by_hand {
	const char *expression;
	double value, size, bound; /* of x y z w = 3 0.5 -2 0.25 in f64; bound in units of 2^-53 */
} by_hand[] = {
	{"x", 3, 3, 0}, {"n x", -3, 3, 0}, {"2", 2, 2, 0}, {"+ x z", 1, 5, 1}, {"- x z", 5, 5, 4}, {"* x z", -6, 6, 0},
	{"* x x", 9, 9, 8}, {"+ * x y * z w", 1, 2, 1}, {"+ * x x * x x", 18, 18, 16 + 8 + 8}, {"f x y z", -0.5, 3.5, 0.5},
	{"f x x z", 7, 11, 8 + 4}, {"* + x y - y w", 0.875, 2.625, 0.5 + 3.5 * 0.25 + 2 * 0.25},
	{"0.1", 0.1, 0.1, 0.04999}, {"* 0.1 x", 0.3, 0.3, 0.25 + 0.14997}, {"s 0", 0, 0, 0},
	{"c + x z", 0.5403023058681398, 0.54, 2 * 0.5 + 0.8415},
};

START_TEST(terms_by_hand)
{
	static const double x[4] = {3, 0.5, -2, 0.25};
	const struct by_hand *h = &by_hand[_i];
	double out = 99, size, bound;
	struct arena a;
	struct dag d;

	arena_init(&a, NULL);
	expression_init(&d, &a);
	expression_build(&d, h->expression);
	ck_assert(eval_f64(&d, (const double *[]){x, NULL}, (double *[]){NULL, &out}, &(struct eval_terms){&size, &bound}));
	ck_assert_msg(fabs(out - h->value) < 1e-15, "%s: %.17g", h->expression, out);
	ck_assert_msg(fabs(size - h->size) < 1e-3, "%s: size %g", h->expression, size);
	ck_assert_msg(bound >= h->bound * 0x1p-53 * 0.9999 && bound <= h->bound * 0x1p-53 * 1.001 + 0x1p-1000,
		"%s: bound %g units", h->expression, bound * 0x1p53);
	ck_assert(eval_f64(&d, (const double *[]){x, NULL}, (double *[]){NULL, &out}, NULL));
	ck_assert_msg(fabs(out - h->value) < 1e-15, "%s: %.17g", h->expression, out);
	arena_free(&a);
}
END_TEST

/* x*x - fl(x*x) is the rounding of the product: eps^2 for x = 1 + eps, and 0 if both were rounded. */
START_TEST(fma_rounds_once)
{
	float x32[4] = {1 + FLT_EPSILON, 0, 0, 0}, out32;
	double x64[4] = {1 + DBL_EPSILON, 0, 0, 0}, out64;
	struct arena a;
	struct dag d;

	arena_init(&a, NULL);
	expression_init(&d, &a);
	expression_build(&d, "f x x n * x x");
	ck_assert(eval_f64(&d, (const double *[]){x64, NULL}, (double *[]){NULL, &out64}, NULL));
	ck_assert(eval_f32(&d, (const float *[]){x32, NULL}, (float *[]){NULL, &out32}, NULL));
	ck_assert(out64 == DBL_EPSILON * DBL_EPSILON && out32 == FLT_EPSILON * FLT_EPSILON);
	arena_free(&a);
}
END_TEST

/* ---- no memory ---- */

struct ration {
	int left, out;
};

static void *ration_alloc(void *context, size_t size)
{
	struct ration *r = context;
	void *p = r->left-- > 0 ? malloc(size) : NULL;

	r->out += p != NULL;
	return p;
}

static void ration_release(void *context, void *block)
{
	((struct ration *)context)->out--;
	free(block);
}

/* However much is given: no crash, and once it failed it stays failed and can be asked for anything. */
START_TEST(failure_is_sticky)
{
	int complete = 0;

	for (int left = 0; left < 40 && !complete; left++) {
		struct ration ration = {left, 0};
		struct rneagen_allocator allocator = {ration_alloc, ration_release, &ration};
		struct rng rng = rng_seed(7);
		struct arena a;
		struct dag d, fused;
		struct ref x;

		arena_init(&a, &allocator);
		expression_init(&d, &a);
		for (int i = 0; i < 20000; i++)
			dag_add(&d, dag_const(&d, random_constant(&rng)),
				dag_mul(&d, dag_input(&d, 0, i), dag_input(&d, 0, i + 1)));
		x = expression_build(&d, "+ x * y z");
		dag_section(&d, SECTION_END, 0);
		complete = !d.failed;
		ration.left = d.failed ? 1000 : 1; /* memory that comes back changes nothing */
		dag_tag(&d, x, "w", 1, 'x');
		ck_assert_int_eq(d.failed, !complete);
		if (d.failed)
			ck_assert_uint_eq(expression_build(&d, "s + n x f y z * w 3").i + dag_lane(&d, x, 1).i, 0);
		dag_init(&fused, &a);
		dag_fuse(&fused, &d, 0);
		ck_assert(complete || fused.failed);
		ck_assert_int_eq(d.failed, !complete);
		arena_free(&a);
		ck_assert_int_eq(ration.out, 0);
	}
	ck_assert(complete);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("eval");
	TCase *c = tcase_create("eval");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_test(c, random_dags);
	tcase_add_test(c, underflow);
	tcase_add_test(c, overflow);
	tcase_add_test(c, overflow_of_product);
	tcase_add_loop_test(c, terms_by_hand, 0, sizeof by_hand / sizeof *by_hand);
	tcase_add_test(c, fma_rounds_once);
	tcase_add_test(c, failure_is_sticky);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
