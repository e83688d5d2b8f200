/* The hard cases as compiled texts: the evaluated DAG's torques within both bounds, the reference's within one; what a
   sample that is not finite does to its neighbours in a batch. In f32 and f64 in turn, and without the longest; where
   all is asked for in both, and the longest in turn. */
#include "compiled.h"
#include "target/rerun.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 20, BATCH = 11, SICK = 5 };

struct fixture {
	struct compiled text;
	double *bound, *again; /* by torque */
};

static void fixture_open(struct fixture *x, const struct hard_case *c, int f32, enum rneagen_trig trig)
{
	static const struct compiler compiler = {"gcc", {"-O0", "-Dalways_inline=unused"}};
	const struct rneagen_options how = {.precision = f32 ? RNEAGEN_F32 : RNEAGEN_F64, .trig = trig};

	compiled_open(&x->text, c, &how, &compiler, "hard");
	x->bound = numbers_new(x->text.nv, sizeof(double));
	x->again = numbers_new(x->text.nv, sizeof(double));
}

static void fixture_close(struct fixture *x)
{
	free(x->bound);
	free(x->again);
	compiled_close(&x->text);
}

/* gen/eval's torques and bounds, by row. */
static void evaluate(struct fixture *x)
{
	const struct dag *d = &x->text.hard.model.dag[ALGORITHM_rnea];
	double *bound = numbers_new(x->text.nv, sizeof *bound);
	struct eval_terms terms = {NULL, bound};
	float *tau = numbers_new(x->text.nv, sizeof *tau);

	if (x->text.target.f32)
		ck_assert(eval_f32(d, (const float *[]){x->text.in[0].data, x->text.in[1].data, x->text.in[2].data, NULL},
			(float *[]){NULL, NULL, NULL, tau}, &terms));
	else
		ck_assert(eval_f64(d, (const double *[]){x->text.state[0], x->text.state[1], x->text.state[2], NULL},
			(double *[]){NULL, NULL, NULL, x->text.eval}, &terms));
	for (int i = 0; x->text.target.f32 && i < x->text.nv; i++)
		x->text.eval[i] = (double)tau[i];
	for (size_t i = 0; i < d->output_count; i++)
		x->bound[d->outputs[i].row] = bound[i];
	free(bound);
	free(tau);
}

/* Returns whether the torque is finite. Where eval's is not, the text's is neither. */
static int judge(const struct fixture *x, int i)
{
	double tau = array_get(&x->text.tau, (size_t)i), off = fabs((double)((__float128)tau - x->text.reference[i]));

	ck_assert_msg(same_number(tau, x->again[i]), "%s: torque %d is %a, its DAG gives %a", x->text.target.what, i,
		tau, x->again[i]);
	if (!isfinite(x->text.eval[i])) {
		ck_assert_msg(!isfinite(tau), "%s: torque %d is %g, eval's overflows", x->text.target.what, i, tau);
		return 0;
	}
	ck_assert_msg(fabs(tau - x->text.eval[i]) <= 2 * x->bound[i], "%s: torque %d is %g, eval's %g, bound %g",
		x->text.target.what, i, tau, x->text.eval[i], x->bound[i]);
	ck_assert_msg(off <= x->bound[i] + 0x1p-100 * x->text.noise[i], "%s: torque %d is off by %g, bound %g",
		x->text.target.what, i, off, x->bound[i]);
	return 1;
}

static void check_sample(struct fixture *x, int *finite)
{
	const double *in[] = {x->text.state[0], x->text.state[1], x->text.state[2], NULL};
	double *out[] = {NULL, NULL, NULL, x->again};

	compiled_set(&x->text);
	evaluate(x);
	compiled_refer(&x->text);
	target_rnea(&x->text.target, &x->text.in[0], &x->text.in[1], &x->text.in[2], &x->text.tau);
	rerun(&x->text.hard.model.dag[ALGORITHM_rnea], &x->text.target, 0, in, out);
	for (int i = 0; i < x->text.nv; i++)
		*finite += judge(x, i);
}

/* An angle beyond what the bounded mode takes: not a number, rather than a wrong one. */
static void check_refused(struct fixture *x)
{
	compiled_set(&x->text);
	target_rnea(&x->text.target, &x->text.in[0], &x->text.in[1], &x->text.in[2], &x->text.tau);
	for (int i = 0; i < x->text.nv; i++)
		ck_assert_msg(isnan(array_get(&x->text.tau, (size_t)i)), "%s: torque %d is a number", x->text.target.what, i);
}

static int large_angles(const struct hard_case *c)
{
	return c->states == STATES_TURNS_1E5 || c->states == STATES_TURNS_1E6;
}

static int check_text(const struct hard_case *c, int f32, enum rneagen_trig trig)
{
	int samples = c->samples < SAMPLES ? c->samples : SAMPLES, finite = 0;
	struct rng rng = rng_seed(2);
	struct fixture x;

	fixture_open(&x, c, f32, trig);
	for (int i = 0; i < samples; i++) {
		compiled_sample(&x.text, &rng);
		if (f32 && trig == RNEAGEN_BOUNDED && large_angles(c))
			check_refused(&x);
		else
			check_sample(&x, &finite);
	}
	fixture_close(&x);
	return finite;
}

START_TEST(texts)
{
	const struct hard_case *c = &HARD_CASES[_i];

	for (int f32 = 0; f32 < 2; f32++) {
		if ((f32 != _i % 2 && (hard_is_long(c) || !exhaustive())) || (hard_is_long(c) && !exhaustive()))
			continue;
		int finite = check_text(c, f32, RNEAGEN_ACCURATE);

		ck_assert_msg(finite > 0 || c->states == STATES_HUGE, "%s: no torque is finite", c->name);
		if (large_angles(c))
			check_text(c, f32, RNEAGEN_BOUNDED);
	}
}
END_TEST

/* ---- one sick sample in a batch ---- */

static struct array batch_of(const struct fixture *x, int rows)
{
	return array_new(x->text.target.f32, (size_t)(rows * BATCH));
}

static void run_batch(struct fixture *x, const struct array in[3], const struct array *tau)
{
	target_batch(&x->text.target, &in[0], &in[1], &in[2], tau, BATCH);
}

/* Every sample but the sick one as it was. */
static void compare_batches(const struct fixture *x, const struct array *was, const struct array *is, double poison)
{
	for (int i = 0; i < x->text.nv; i++)
		for (int k = 0; k < BATCH; k++) {
			size_t at = (size_t)(i * BATCH + k);

			ck_assert_msg(k == SICK || same_number(array_get(was, at), array_get(is, at)),
				"%s: %g in sample %d changes torque %d of sample %d", x->text.target.what, poison, SICK, i, k);
		}
}

static void poison_each(struct fixture *x, struct array in[3], const struct array *was, double poison)
{
	struct array is = batch_of(x, x->text.nv);

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < (i ? x->text.nv : x->text.nq); k++) {
			size_t at = (size_t)(k * BATCH + SICK);
			double old = array_get(&in[i], at);

			array_set(&in[i], at, poison);
			run_batch(x, in, &is);
			compare_batches(x, was, &is, poison);
			array_set(&in[i], at, old);
		}
	array_free(&is);
}

START_TEST(sick_sample)
{
	static const char *const names[] = {"skew", "free_fall", "balance"};
	const struct hard_case *c = HARD_CASES;
	struct rng rng = rng_seed(3);
	struct array in[3], was;
	struct fixture x;

	while (strcmp(c->name, names[_i / 2]))
		c++;
	fixture_open(&x, c, _i % 2, RNEAGEN_ACCURATE);
	for (int i = 0; i < 3; i++)
		in[i] = batch_of(&x, i ? x.text.nv : x.text.nq);
	for (int k = 0; k < BATCH; k++) {
		compiled_sample(&x.text, &rng);
		for (int i = 0; i < 3; i++)
			for (int row = 0; row < (i ? x.text.nv : x.text.nq); row++)
				array_set(&in[i], (size_t)(row * BATCH + k), x.text.state[i][row]);
	}
	was = batch_of(&x, x.text.nv);
	run_batch(&x, in, &was);
	poison_each(&x, in, &was, (double)NAN);
	poison_each(&x, in, &was, (double)-INFINITY);
	poison_each(&x, in, &was, x.text.target.f32 ? (double)FLT_MAX : DBL_MAX);
	for (int i = 0; i < 3; i++)
		array_free(&in[i]);
	array_free(&was);
	fixture_close(&x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("hard texts");
	TCase *c = tcase_create("hard texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("hard cases as C texts, seeds 2 and 3\n");
	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, texts, 0, HARD_CASE_COUNT);
	tcase_add_loop_test(c, sick_sample, 0, 6);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
