/* NAME_rnea_bounded as compiled: the torques of NAME_rnea to the bit, each within its bound of the reference in quad
   precision; the bound itself beside gen/eval's. */
#define _POSIX_C_SOURCE 200809L
#include "hard/compiled.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 6, SAMPLES = 12 };

/* Without inlining every operation is a call, which a compiler has soon done. */
static const struct kind {
	const char *name;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
	int strict;
	struct compiler compiler;
	int bounded; /* 0: the closer ones */
} KINDS[] = {
	{"f32", RNEAGEN_F32, RNEAGEN_ACCURATE, 0, {"gcc", {"-O0", "-Dalways_inline=unused"}}, 0},
	{"f64", RNEAGEN_F64, RNEAGEN_ACCURATE, 0, {"clang", {"-O0", "-Dalways_inline=unused"}}, 0},
	{"mixed", RNEAGEN_MIXED, RNEAGEN_ACCURATE, 0, {"clang", {"-O0", "-Dalways_inline=unused"}}, 0},
	{"f32 bounded", RNEAGEN_F32, RNEAGEN_BOUNDED, 0, {"gcc", {"-O2", "-march=native", "-ffp-contract=fast"}}, 0},
	{"f64 bounded", RNEAGEN_F64, RNEAGEN_BOUNDED, 0, {"gcc", {"-O2", "-march=native", "-ffp-contract=fast"}}, 0},
	{"f32 strict", RNEAGEN_F32, RNEAGEN_BOUNDED, 1, {"gcc", {"-O1"}}, 0},
	{"f64 fast", RNEAGEN_F64, RNEAGEN_FAST, 0, {"clang", {"-O1"}}, 0},
	{"f32 running", RNEAGEN_F32, RNEAGEN_ACCURATE, 0, {"gcc", {"-O1"}}, RNEAGEN_BOUNDS_RUNNING},
	{"f64 running", RNEAGEN_F64, RNEAGEN_BOUNDED, 0, {"gcc", {"-O1"}}, RNEAGEN_BOUNDS_RUNNING},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

typedef void single_bounded(const float *q, const float *qd, const float *qdd, float *tau, float *bound);
typedef void double_bounded(const double *q, const double *qd, const double *qdd, double *tau, double *bound);

struct fixture {
	const struct kind *kind;
	struct compiled text;
	struct rng rng;
	single_bounded *single;
	double_bounded *wide;
	struct array again, bound;
	double error, largest, largest_eval; /* error, bound and gen/eval's bound, the largest */
	int held;
};

static void find_bounded(struct fixture *x)
{
	const struct target *t = &x->text.target;
	char name[512];

	snprintf(name, sizeof name, "%s_rnea_bounded", t->text.name);
	target_symbol(t, t->library, name, t->f32 ? (void *)&x->single : (void *)&x->wide);
}

static void fixture_open(struct fixture *x, const struct hard_case *c, const struct kind *kind)
{
	const struct rneagen_options how = {
		.precision = kind->precision, .trig = kind->trig, .strict = kind->strict,
		.bounded = kind->bounded ? kind->bounded : RNEAGEN_BOUNDS_CLOSE};

	*x = (struct fixture){.kind = kind, .rng = rng_seed(SEED)};
	compiled_open(&x->text, c, &how, &kind->compiler, "bounded");
	find_bounded(x);
	x->again = array_new(x->text.target.f32, (size_t)x->text.nv);
	x->bound = array_new(x->text.target.f32, (size_t)x->text.nv);
}

static void fixture_close(struct fixture *x)
{
	array_free(&x->again);
	array_free(&x->bound);
	compiled_close(&x->text);
}

static void run_bounded(struct fixture *x)
{
	target_rnea(&x->text.target, &x->text.in[0], &x->text.in[1], &x->text.in[2], &x->again);
	if (x->text.target.f32)
		x->single(x->text.in[0].data, x->text.in[1].data, x->text.in[2].data, x->text.tau.data, x->bound.data);
	else
		x->wide(x->text.in[0].data, x->text.in[1].data, x->text.in[2].data, x->text.tau.data, x->bound.data);
	ck_assert(array_intact(&x->text.tau) && array_intact(&x->bound));
	for (int i = 0; i < x->text.nv; i++)
		ck_assert_msg(same_number(array_get(&x->text.tau, (size_t)i), array_get(&x->again, (size_t)i)),
			"%s: torque %d has other bits", x->text.target.what, i);
}

static void judge(struct fixture *x, int i)
{
	double tau = array_get(&x->text.tau, (size_t)i), bound = array_get(&x->bound, (size_t)i);
	double error = isfinite(tau) ? fabs((double)((__float128)tau - x->text.reference[i])) : (double)INFINITY;

	ck_assert_msg(error <= bound + 0x1p-100 * x->text.noise[i], "%s: torque %d is %g, off by %g, bound %g",
		x->text.target.what, i, tau, error, bound);
	if (!isfinite(bound))
		return;
	x->held++;
	x->error = fmax(x->error, error);
	x->largest = fmax(x->largest, bound);
	x->largest_eval = fmax(x->largest_eval, x->text.eval[i]);
}

static void check_sample(struct fixture *x)
{
	struct eval_model m = eval_model_of(&x->text.target.options, 0);

	compiled_sample(&x->text, &x->rng);
	compiled_set(&x->text);
	run_bounded(x);
	ck_assert(eval_bound(&x->text.hard.model.dag[ALGORITHM_rnea], &m, (const double *[]){x->text.state[0], x->text.state[1],
		x->text.state[2], NULL}, (double *[]){NULL, NULL, NULL, x->text.eval}));
	compiled_refer(&x->text);
	for (int i = 0; i < x->text.nv; i++)
		judge(x, i);
}

static int is_refused(const struct hard_case *c, const struct kind *k)
{
	return k->trig != RNEAGEN_ACCURATE && k->precision == RNEAGEN_F32 &&
	       (c->states == STATES_TURNS_1E5 || c->states == STATES_TURNS_1E6);
}

static void check_case(const struct hard_case *c, const struct kind *kind)
{
	struct fixture x;

	fixture_open(&x, c, kind);
	for (int i = 0; i < SAMPLES && i < c->samples; i++)
		check_sample(&x);
	ck_assert_msg(x.held > 0 || is_refused(c, kind) || c->states == STATES_HUGE, "%s: no bound", x.text.target.what);
	printf(" %6.1f (%4.1f)", x.error > 0 ? x.largest / x.error : 0, x.largest_eval > 0 ? x.largest / x.largest_eval : 0);
	fixture_close(&x);
}

/* The kinds in turn on the first three cases, f32 and f64 in turn on two of three others; where all is asked for, every kind on
   one, and all cases. */
START_TEST(hard_cases)
{
	if ((hard_is_long(&HARD_CASES[_i]) || (_i > 2 && _i % 3 == 2)) && !exhaustive())
		return;
	printf("%-14s", HARD_CASES[_i].name);
	for (int k = 0; k < KIND_COUNT; k++)
		if ((_i < 3 ? (exhaustive() && _i == 1) || k % 3 == _i : k == _i % 2) ||
			(is_refused(&HARD_CASES[_i], &KINDS[k]) && (exhaustive() || k == 5)))
			check_case(&HARD_CASES[_i], &KINDS[k]);
	putchar('\n');
}
END_TEST

static void check_own(const char *path, const char *name, void *turn)
{
	struct hard_case c = {.name = name, .file = name, .samples = SAMPLES};
	const int now = (*(int *)turn)++;

	(void)path;
	if (!exhaustive() && now / 2 % 2 && !has_rare_joints(name))
		return;
	printf("%-28s", name);
	check_case(&c, &KINDS[(now + exhaustive()) % 2]);
	putchar('\n');
}

/* In f32 and f64 in turn, two of every four, and those with rare joints; where all is asked for, all, in the other
   one than else. */
START_TEST(own_robots)
{
	int turn = 0;

	ck_assert_int_gt(for_each_urdf(TEST_DIR "/robots", check_own, &turn), 0);
}
END_TEST

/* ---- where the error comes close to the bound ---- */

/* tau of `swing` is 9.81 sin(q) + qdd at rest, of `push` the sum of two accelerations. */
static char *build_sharp(void)
{
	return strdup("<robot name='sharp'><link name='world'/><link name='rod'><inertial><origin xyz='0 0 -1'/>"
		      "<mass value='1'/><inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial></link>"
		      "<link name='rail'/><link name='cart'><inertial><mass value='1'/>"
		      "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
		      "<joint name='swing' type='continuous'><parent link='world'/><child link='rod'/><axis xyz='0 1 0'/></joint>"
		      "<joint name='carry' type='prismatic'><parent link='world'/><child link='rail'/><axis xyz='1 0 0'/>"
		      "<limit lower='-9' upper='9' effort='1' velocity='1'/></joint>"
		      "<joint name='push' type='prismatic'><parent link='rail'/><child link='cart'/><axis xyz='1 0 0'/>"
		      "<limit lower='-9' upper='9' effort='1' velocity='1'/></joint></robot>");
}

/* A bound that takes the sine's or the sum's error for half of what it may be would not hold. */
START_TEST(sharp)
{
	static const struct hard_case c = {.name = "sharp", .build = build_sharp};
	static const struct { int kind; double sine; } kinds[] = {{0, 0.5}, {1, 0.5}, {5, 0.6}};
	double share[3] = {0};
	struct fixture x;

	fixture_open(&x, &c, &KINDS[kinds[_i].kind]);
	for (int i = 0; i < 10000; i++) {
		compiled_sample(&x.text, &x.rng);
		for (int k = 0; k < 3; k++)
			x.text.state[1][k] = 0;
		/* what is left of the sine's term is its error; `swing` comes last, since children are walked by name */
		x.text.state[2][2] = -9.81 * sin(x.text.state[0][2]);
		x.text.state[2][2] = x.text.target.f32 ? (double)(float)x.text.state[2][2] : x.text.state[2][2];
		compiled_set(&x.text);
		run_bounded(&x);
		quad_rnea(x.text.quad, x.text.state[0], x.text.state[1], x.text.state[2], x.text.reference);
		for (int k = 0; k < 3; k++) {
			judge(&x, k);
			share[k] = fmax(share[k],
				fabs((double)((__float128)array_get(&x.text.tau, (size_t)k) - x.text.reference[k])) /
							  array_get(&x.bound, (size_t)k));
		}
	}
	printf("%s: sum %.2f, sine %.2f of the bound\n", KINDS[kinds[_i].kind].name, share[1], share[2]);
	ck_assert_msg(share[1] > 0.9 && share[2] > kinds[_i].sine, "%s: bounds are too large", x.text.target.what);
	fixture_close(&x);
}
END_TEST

/* ---- where there is no bound ---- */

static double bound_at(struct fixture *x, int which, double value, int torque)
{
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < (i ? x->text.nv : x->text.nq); k++)
			x->text.state[i][k] = 1;
	x->text.state[which][1] = value;
	compiled_set(&x->text);
	run_bounded(x);
	return array_get(&x->bound, (size_t)torque);
}

START_TEST(no_bound)
{
	const struct kind *k = &KINDS[_i];
	double infinity = (double)INFINITY, huge = k->precision == RNEAGEN_F32 ? 1e30
		: k->precision == RNEAGEN_F64 ? 1e200 : 1e38;
	struct fixture x;

	if (!exhaustive() && _i == 4)
		return; /* f32 by the same flags, and f64 by others, are there */
	fixture_open(&x, &HARD_CASES[0], k);
	for (int i = 0; i < 3; i++) {
		ck_assert_msg(isnan(bound_at(&x, i, (double)NAN, 1)), "%s: NaN in array %d", x.text.target.what, i);
		ck_assert_msg(isnan(bound_at(&x, i, infinity, 1)), "%s: infinity in array %d", x.text.target.what, i);
		ck_assert(isfinite(bound_at(&x, i, 1, 1)));
	}
	ck_assert_msg(isinf(bound_at(&x, 1, huge, 1)), "%s: overflow", x.text.target.what);
	if (k->trig != RNEAGEN_ACCURATE)
		ck_assert_msg(isinf(bound_at(&x, 0, 2e7, 1)), "%s: an angle beyond the domain", x.text.target.what);
	fixture_close(&x);
}
END_TEST

/* Only C texts have the function. */
START_TEST(other_targets)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result result;
	struct rneagen_error e;
	size_t length;
	char *urdf = target_robot("pendulum", &length);

	o.bounded = 1;
	o.target = _i ? RNEAGEN_TARGET_HEADER : RNEAGEN_TARGET_CUDA;
	ck_assert_int_eq(rneagen_generate(urdf, length, &o, &result, &e), RNEAGEN_USAGE);
	ck_assert_msg(strstr(e.message, "--bounded is for target c") != NULL, "%s", e.message);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bounded");
	TCase *cases[] = {tcase_create("hard"), tcase_create("own"), tcase_create("none")};

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("texts with bounds, seed %d: largest bound over largest error (over gen/eval's largest bound):", SEED);
	for (int k = 0; k < KIND_COUNT; k++)
		printf("%s %s", k ? "," : "", KINDS[k].name);
	putchar('\n');
	tcase_add_loop_test(cases[0], hard_cases, 0, HARD_CASE_COUNT);
	tcase_add_test(cases[1], own_robots);
	tcase_add_loop_test(cases[1], sharp, 0, 3);
	tcase_add_loop_test(cases[2], no_bound, 0, KIND_COUNT);
	tcase_add_loop_test(cases[2], other_targets, 0, 2);
	for (int i = 0; i < 3; i++) {
		tcase_set_timeout(cases[i], 900);
		suite_add_tcase(suite, cases[i]);
	}
	return suite_run(suite);
}
