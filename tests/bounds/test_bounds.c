/* gen/eval's bounds of every variant of a text: what is computed stays within them, and so does arithmetic that does the
   worst its model allows, with signs by chance; both against the reference in quad precision. */
#include "support/model.h"
#include "hard/quad.h"
#include "support/numbers.h"
#include "support/suite.h"
#include "worst.h"
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 5, SAMPLES = 12 };

/* A kind of text, and what its bounds came to. */
struct variant {
	const char *name;
	struct rneagen_options options;
	int on_gpu;
	double share;	/* largest |tau_i - exact_i| / bound_i */
	double margin;	/* of one robot: bound over error, both the largest of a sample */
};

#define OPTIONS(p, t, s) {.precision = RNEAGEN_##p, .trig = RNEAGEN_##t, .strict = s}

static struct variant VARIANTS[] = {
	{"f32 accurate", OPTIONS(F32, ACCURATE, 0), 0, 0, 0},
	{"f32 accurate strict", OPTIONS(F32, ACCURATE, 1), 0, 0, 0},
	{"f32 bounded", OPTIONS(F32, BOUNDED, 0), 0, 0, 0},
	{"f32 fast on a GPU", OPTIONS(F32, FAST, 0), 1, 0, 0},
	{"f64 accurate", OPTIONS(F64, ACCURATE, 0), 0, 0, 0},
	{"f64 accurate on a GPU", OPTIONS(F64, ACCURATE, 0), 1, 0, 0},
	{"mixed accurate", OPTIONS(MIXED, ACCURATE, 0), 0, 0, 0},
};
enum { VARIANT_COUNT = sizeof VARIANTS / sizeof *VARIANTS };

struct fixture {
	const char *what;
	struct model model;
	struct quad *quad;
	struct rng rng;
	double *q, *qd, *qdd, *bound, *tau, *noise;
	float *in_f32[3], *tau_f32;
	__float128 *reference;
};

static void fixture_open(struct fixture *x, const char *path, const char *name, int floating)
{
	struct rneagen_options o = rneagen_options_default();
	char message[256], *urdf;
	size_t length;
	int nq, nv;

	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s", path);
	o.base = floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	*x = (struct fixture){.what = name, .rng = rng_seed(SEED)};
	model_open(&x->model, urdf, length, &o, name);
	x->quad = quad_open(urdf, length, floating, 0, QUAD_DECIMALS, o.gravity, NULL, message, sizeof message);
	ck_assert_msg(x->quad != NULL, "%s: %s", name, message);
	free(urdf);
	nq = x->model.tree.nq;
	nv = x->model.tree.nv;
	x->q = numbers_new(nq, sizeof(double));
	x->qd = numbers_new(nv, sizeof(double));
	x->qdd = numbers_new(nv, sizeof(double));
	x->bound = numbers_new(nv, sizeof(double));
	x->tau = numbers_new(nv, sizeof(double));
	x->noise = numbers_new(nv, sizeof(double));
	for (int i = 0; i < 3; i++)
		x->in_f32[i] = numbers_new(i ? nv : nq, sizeof(float));
	x->tau_f32 = numbers_new(nv, sizeof(float));
	x->reference = numbers_new(nv, sizeof(__float128));
}

static void fixture_close(struct fixture *x)
{
	void *all[] = {x->q, x->qd, x->qdd, x->bound, x->tau, x->noise, x->in_f32[0], x->in_f32[1], x->in_f32[2], x->tau_f32,
		x->reference};

	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
	quad_close(x->quad);
	model_close(&x->model);
}

/* A floating joint within the tree: a quaternion that is a unit also in floats, since otherwise it matters which way the
   reference multiplies. */
static void set_unit_quaternions(struct fixture *x)
{
	const struct tree *t = &x->model.tree;

	for (int k = 0; k < t->joint_count; k++)
		for (int i = 3; i < 7 && t->joints[k].type == JOINT_FLOATING && t->bodies[t->joints[k].body].parent >= 0; i++)
			x->q[t->joints[k].iq + i] = rng_chance(&x->rng, 0.5) ? 0.5 : -0.5;
}

/* The next state, all of it floats; every third with angles up to a hundred turns, where `large` allows. */
static void next_state(struct fixture *x, int sample, int large)
{
	double *const to[] = {x->q, x->qd, x->qdd};

	reference_sample(x->model.reference, &x->rng, 0, x->q, x->qd, x->qdd);
	set_unit_quaternions(x);
	for (int k = 0; k < x->model.tree.joint_count && large && sample % 3 == 2; k++)
		if (x->model.tree.joints[k].nq == 1)
			x->q[x->model.tree.joints[k].iq] *= 200;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < (i ? x->model.tree.nv : x->model.tree.nq); k++) {
			x->in_f32[i][k] = (float)to[i][k];
			to[i][k] = (double)x->in_f32[i][k];
		}
}

/* ---- the text's own, as gen/eval computes it ---- */

static void compute(struct fixture *x, const struct variant *v)
{
	const struct dag *d = &x->model.dag[ALGORITHM_rnea];

	if (v->options.precision == RNEAGEN_F32)
		ck_assert(eval_f32(d, (const float *[]){x->in_f32[0], x->in_f32[1], x->in_f32[2], NULL},
			(float *[]){NULL, NULL, NULL, x->tau_f32}, NULL));
	else
		ck_assert(eval_f64(d, (const double *[]){x->q, x->qd, x->qdd, NULL},
			(double *[]){NULL, NULL, NULL, x->tau}, NULL));
	for (int i = 0; i < x->model.tree.nv; i++)
		if (v->options.precision == RNEAGEN_F32)
			x->tau[i] = (double)x->tau_f32[i];
		else if (v->options.precision == RNEAGEN_MIXED)
			x->tau[i] = (double)(float)x->tau[i];
}

/* The largest error of the sample; each torque's within its bound, but for the reference's rounding and what is not the
   text's. */
static double judge(struct fixture *x, struct variant *v, const char *how, double unit)
{
	double largest = 0;

	for (int i = 0; i < x->model.tree.nv; i++) {
		double error = (double)fabsq((__float128)x->tau[i] - x->reference[i]);
		double noise = 0x1p-100 * x->noise[i] + unit * fabs(x->tau[i]);

		ck_assert_msg(error <= x->bound[i] + noise, "%s, %s, %s: torque %d is off by %g, bound %g", x->what, v->name, how,
			i, error, x->bound[i]);
		if (x->bound[i] > noise)
			v->share = fmax(v->share, (error - noise) / x->bound[i]);
		largest = fmax(largest, error);
	}
	return largest;
}

static void check_variant(struct fixture *x, struct variant *v)
{
	struct eval_model m = eval_model_of(&v->options, v->on_gpu);
	int fast = m.sincos == 0;
	double error = 0, bound = 0;

	for (int k = 0; k < SAMPLES; k++) {
		next_state(x, k, !fast);
		ck_assert(eval_bound(&x->model.dag[ALGORITHM_rnea], &m, (const double *[]){x->q, x->qd, x->qdd, NULL},
			(double *[]){NULL, NULL, NULL, x->bound}));
		quad_rnea(x->quad, x->q, x->qd, x->qdd, x->reference);
		quad_magnitude(x->quad, x->q, x->qd, x->qdd, x->noise);
		compute(x, v);
		error = fmax(error, judge(x, v, "computed", 0));
		worst_evaluate(&x->model.dag[ALGORITHM_rnea], &m, &x->rng, (const double *[]){x->q, x->qd, x->qdd, NULL},
			(double *[]){NULL, NULL, NULL, x->tau});
		if (fast)
			error = fmax(error, judge(x, v, "at its worst", 0x1p-53));
		else
			judge(x, v, "at its worst", 0x1p-53);
		for (int i = 0; i < x->model.tree.nv; i++)
			bound = fmax(bound, x->bound[i]);
	}
	v->margin = error > 0 ? bound / error : 0;
}

static void check_robot(const char *path, const char *name, void *floating)
{
	struct fixture x;

	if (!strncmp(name, "xfail", 5))
		return;
	fixture_open(&x, path, name, floating != NULL);
	printf("%-28s", name);
	for (int i = 0; i < VARIANT_COUNT; i++) {
		check_variant(&x, &VARIANTS[i]);
		printf(" %5.1f", VARIANTS[i].margin);
	}
	putchar('\n');
	fixture_close(&x);
}

static void print_shares(void)
{
	for (int i = 0; i < VARIANT_COUNT; i++)
		printf("%s: at most %.2f of a bound\n", VARIANTS[i].name, VARIANTS[i].share);
}

START_TEST(own_robots)
{
	printf("bound over largest error, %s base, by variant\n", _i ? "floating" : "fixed");
	ck_assert_int_gt(for_each_urdf(TEST_DIR "/robots", check_robot, _i ? "" : NULL), 0);
	print_shares();
}
END_TEST

START_TEST(real_robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");

	if (!folder) {
		printf("skipped: RNEAGEN_ROBOTS names no folder of robots\n");
		return;
	}
	ck_assert_int_gt(for_each_urdf(folder, check_robot, NULL), 0);
	print_shares();
}
END_TEST

/* Where nothing is known the bound says so. */
START_TEST(unknown)
{
	static const struct { double q, qd; int variant; } cases[] = {
		{1e5, 0, 2}, {3.2, 0, 3}, {(double)NAN, 0, 0}, {1, (double)INFINITY, 4}, {1, 1e30, 0},
		{1, 1e30, 6}, {1, 1e200, 4}};
	struct fixture x;

	fixture_open(&x, TEST_DIR "/robots/ur5.urdf", "ur5", 0);
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct variant *v = &VARIANTS[cases[k].variant];
		struct eval_model m = eval_model_of(&v->options, v->on_gpu);

		for (int i = 0; i < x.model.tree.nv; i++) {
			x.q[i] = cases[k].q;
			x.qd[i] = cases[k].qd;
		}
		ck_assert(eval_bound(&x.model.dag[ALGORITHM_rnea], &m, (const double *[]){x.q, x.qd, x.qdd, NULL},
			(double *[]){NULL, NULL, NULL, x.bound}));
		ck_assert_msg(isinf(x.bound[1]), "%s: q %g, qd %g: bound %g", v->name, cases[k].q, cases[k].qd, x.bound[1]);
	}
	fixture_close(&x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bounds");
	TCase *c = tcase_create("bounds");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("bounds of every variant, seed %d\n", SEED);
	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, own_robots, 0, 2);
	tcase_add_test(c, real_robots);
	tcase_add_test(c, unknown);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
