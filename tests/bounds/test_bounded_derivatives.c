/* NAME_rnea_bounded of texts with matrices, as compiled: what NAME_rnea gives to the bit, and every element of every output
   within its bound, seen from the DAG in quad precision and from differences of the reference in quad precision. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/suite.h"
#include "target/target.h"
#include "varied.h"
#include <dlfcn.h>
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 10, SAMPLES = 20 };

/* Times the rounding of all magnitudes that are summed: four times the largest bound that has been seen. */
static const double CEILING = 110;

/* All three read q, qd and qdd. */
static const struct robot_file {
	const char *name;
	int floating;
} ROBOTS[] = {{"iiwa14", 0}, {"mimic_chain", 1}, {"hyq", 0}};
enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS };

/* Without inlining every operation is a call, which a compiler has soon done. */
static const struct kind {
	const char *name;
	struct rneagen_options options;
	const char *flags[3];
} KINDS[] = {
	{"f32", {.precision = RNEAGEN_F32}, {"-O0", "-Dalways_inline=unused", "-ffp-contract=off"}},
	{"f64", {.precision = RNEAGEN_F64}, {"-O0", "-Dalways_inline=unused", "-ffp-contract=off"}},
	{"mixed", {.precision = RNEAGEN_MIXED}, {"-O1", "-Dalways_inline=unused", "-march=native"}},
	{"f32 strict", {.precision = RNEAGEN_F32, .trig = RNEAGEN_BOUNDED, .strict = 1},
		{"-O1", "-Dalways_inline=unused", "-march=native"}},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

#define RNEA(T) void (T##_rnea)(const T *q, const T *qd, const T *qdd, T *tau, T *dtau_dq, T *dtau_dqd, T *M)
#define BOUNDED(T) void (T##_bounded)(const T *q, const T *qd, const T *qdd, T *tau, T *dtau_dq, T *dtau_dqd, T *M, T *bound)
typedef RNEA(float);
typedef RNEA(double);
typedef BOUNDED(float);
typedef BOUNDED(double);

struct fixture {
	struct varied v;
	const struct kind *kind;
	struct target target; /* its text and messages alone */
	void *library;
	union {
		void *address;
		float_rnea *single;
		double_rnea *wide;
	} rnea;
	union {
		void *address;
		float_bounded *single;
		double_bounded *wide;
	} bounded;
	float *out_f32[OUTPUTS], *bound_f32;
	double *again[OUTPUTS], *bounds; /* of all outputs, one after the other */
	double most, worst;              /* bound over the rounding of the terms, error over bound */
};

static void compile(struct fixture *x, const char *urdf, const struct rneagen_options *options)
{
	struct rneagen_options o = *options;
	struct target_path text = target_path("derivatives", ".c"), object = target_path("derivatives", ".so");
	const char *const *f = x->kind->flags;
	const char *const command[] = {"gcc", "-std=c11", f[0], f[1], f[2], WARNING_FLAGS, "-shared", "-fPIC", "-o", object.s,
		text.s, "-lm", NULL};
	char name[256];

	o.target = RNEAGEN_TARGET_C;
	o.precision = x->kind->options.precision;
	o.trig = x->kind->options.trig;
	o.strict = x->kind->options.strict;
	o.bounded = 1;
	o.scene = "want tau,dtau_dq,dtau_dqd,M\ndense\n";
	snprintf(x->target.what, sizeof x->target.what, "%s, %s", x->v.what, x->kind->name);
	target_generate(&x->target, urdf, strlen(urdf), &o, x->v.what);
	target_write(text, x->target.text.source);
	target_compile(&x->target, command);
	x->library = dlopen(object.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(x->library != NULL, "%s", dlerror());
	snprintf(name, sizeof name, "%s_rnea", x->target.text.name);
	x->rnea.address = dlsym(x->library, name);
	snprintf(name, sizeof name, "%s_rnea_bounded", x->target.text.name);
	x->bounded.address = dlsym(x->library, name);
	ck_assert(x->rnea.address && x->bounded.address);
	remove(text.s);
	remove(object.s);
}

static void fixture_open(struct fixture *x, const struct robot_file *robot, const struct kind *kind)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot(robot->name, &length);

	o.base = robot->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	*x = (struct fixture){.kind = kind};
	ck_assert(varied_open(&x->v, urdf, &o, SEED, "", robot->name));
	compile(x, urdf, &o);
	for (int i = 0; i < OUTPUTS; i++) {
		x->out_f32[i] = numbers_new(varied_rows(&x->v, i), sizeof(float));
		x->again[i] = numbers_new(varied_rows(&x->v, i), sizeof(double));
	}
	x->bounds = numbers_new(varied_rows(&x->v, MASS) * OUTPUTS, sizeof(double));
	x->bound_f32 = numbers_new(varied_rows(&x->v, MASS) * OUTPUTS, sizeof(float));
	free(urdf);
}

static void fixture_close(struct fixture *x)
{
	for (int i = 0; i < OUTPUTS; i++) {
		free(x->out_f32[i]);
		free(x->again[i]);
	}
	free(x->bounds);
	free(x->bound_f32);
	dlclose(x->library);
	rneagen_result_free(&x->target.text);
	varied_close(&x->v);
}

static int total_rows(const struct fixture *x)
{
	return varied_rows(&x->v, TAU) + 3 * varied_rows(&x->v, MASS);
}

static void widen(struct fixture *x, double *const *to)
{
	for (int o = 0; o < OUTPUTS; o++)
		for (int i = 0; i < varied_rows(&x->v, o); i++)
			to[o][i] = (double)x->out_f32[o][i];
}

/* Outputs into v.got and, by NAME_rnea, again; all bounds. */
static void run(struct fixture *x)
{
	struct varied *v = &x->v;
	float *const *s = x->out_f32;

	if (x->kind->options.precision == RNEAGEN_F64) {
		x->rnea.wide(v->in[0], v->in[1], v->in[2], x->again[TAU], x->again[DQ], x->again[DQD], x->again[MASS]);
		x->bounded.wide(v->in[0], v->in[1], v->in[2], v->got[TAU], v->got[DQ], v->got[DQD], v->got[MASS], x->bounds);
		return;
	}
	x->rnea.single(v->in_f32[0], v->in_f32[1], v->in_f32[2], s[TAU], s[DQ], s[DQD], s[MASS]);
	widen(x, x->again);
	x->bounded.single(v->in_f32[0], v->in_f32[1], v->in_f32[2], s[TAU], s[DQ], s[DQD], s[MASS], x->bound_f32);
	widen(x, v->got);
	for (int i = 0; i < total_rows(x); i++)
		x->bounds[i] = (double)x->bound_f32[i];
}

static double distance(double a, __float128 b)
{
	return (double)fabsq((__float128)a - b);
}

static void judge_output(struct fixture *x, int o, const double *bounds)
{
	const struct varied *v = &x->v;

	for (int i = 0; i < varied_rows(v, o); i++) {
		double off = distance(v->got[o][i], v->exact[o][i]), from = distance(v->got[o][i], v->want[o][i]);
		double noise = v->noise[o == TAU ? i : i / v->nv];

		ck_assert_msg(v->got[o][i] == x->again[o][i], "%s: output %d, row %d has other bits", x->target.what, o, i);
		ck_assert_msg(off <= bounds[i], "%s: output %d, row %d is %g off the DAG's, bound %g", x->target.what, o,
			i, off, bounds[i]);
		ck_assert_msg(from <= bounds[i] + noise, "%s: output %d, row %d is %g off, bound %g and noise %g",
			x->target.what, o, i, from, bounds[i], noise);
		if (bounds[i] > 0)
			x->worst = fmax(x->worst, off / bounds[i]);
	}
}

/* Bounds beside the magnitudes of the terms, by the evaluator. */
static void judge_sizes(struct fixture *x)
{
	struct varied *v = &x->v;
	const struct dag *d = &v->model.dag;
	double unit = x->kind->options.precision == RNEAGEN_F64 ? 0x1p-53 : 0x1p-24;
	POINTERS(double) p;

	POINT(p, v, v->in, v->bound);
	ck_assert(eval_f64(d, p.in, p.out, &(struct eval_terms){.size = v->size}));
	for (size_t i = 0; i < d->output_count; i++) {
		int o = v->number[d->outputs[i].argument], first = o == TAU ? 0 : v->nv + (o - 1) * v->nv * v->nv;
		double bound = x->bounds[first + d->outputs[i].row] - varied_half_units(v, o, d->outputs[i].row);

		if (v->size[i] > 1e-20)
			x->most = fmax(x->most, bound / (unit * v->size[i]));
	}
}

START_TEST(bounds_hold)
{
	struct fixture *x;

	/* each kind with one robot, in turn, unless all is asked for */
	if (!exhaustive() && _i % ROBOT_COUNT != _i / ROBOT_COUNT * 2 % ROBOT_COUNT)
		return;
	x = numbers_new(1, sizeof *x);
	fixture_open(x, &ROBOTS[_i % ROBOT_COUNT], &KINDS[_i / ROBOT_COUNT]);
	for (int k = 0; k < SAMPLES; k++) {
		varied_draw(&x->v);
		varied_refer(&x->v);
		run(x);
		for (int o = 0, first = 0; o < OUTPUTS; first += varied_rows(&x->v, o++))
			judge_output(x, o, x->bounds + first);
		judge_sizes(x);
	}
	printf("%s: %d states, seed %d: errors at most %.2f of a bound, bounds at most %.1f times the rounding of their terms\n",
		x->target.what, SAMPLES, SEED, x->worst, x->most);
	ck_assert_msg(x->most < CEILING, "%s: a bound is %g times the rounding of its terms", x->target.what, x->most);
	fixture_close(x);
	free(x);
}
END_TEST

/* What is not finite makes no finite bound. */
START_TEST(no_bound)
{
	struct fixture *x = numbers_new(1, sizeof *x);

	fixture_open(x, &ROBOTS[0], &KINDS[_i]);
	varied_draw(&x->v);
	x->v.in[1][1] = x->kind->options.precision == RNEAGEN_F32 ? 1e30 : 1e200;
	x->v.in_f32[1][1] = 1e30f;
	run(x);
	ck_assert_msg(!isfinite(x->bounds[1]) || x->kind->options.precision == RNEAGEN_MIXED,
		"%s: the bound of a torque", x->target.what);
	x->v.in[0][1] = (double)NAN;
	x->v.in_f32[0][1] = NAN;
	run(x);
	for (int i = 0; i < total_rows(x); i++)
		ck_assert_msg(isfinite(x->bounds[i]) ==
			isfinite(x->v.got[i < 7 ? TAU : 1 + (i - 7) / 49][i < 7 ? i : (i - 7) % 49]),
			"%s: bound %d is %g", x->target.what, i, x->bounds[i]);
	fixture_close(x);
	free(x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bounded_derivatives");
	TCase *c = tcase_create("bounded_derivatives");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, bounds_hold, 0, KIND_COUNT * ROBOT_COUNT);
	tcase_add_loop_test(c, no_bound, 0, 2);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
