/* --want qdd,qdd_bound of a robot that the evaluator computes, opened as a program opens it: every qdd within its bound of the
   reference in quad precision, and the bound of use. It would catch an evaluator whose bound is of another arithmetic than its
   precision's. */
#define _POSIX_C_SOURCE 200809L
#include "forward_eval.h"
#include "support/read.h"
#include "support/suite.h"
#include "urdf.h"
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 23, SAMPLES = 50 };

static const struct {
	const char *robot;
	int floating;
} CASES[] = {{"iiwa14", 0}, {"hyq", 1}};

static const struct {
	enum rneagen_precision precision;
	double worth; /* the largest bound, of the largest qdd of its sample */
} KINDS[] = {{RNEAGEN_F32, 1e-2}, {RNEAGEN_MIXED, 2e-7}, {RNEAGEN_F64, 1e-10}};

enum { CASE_COUNT = sizeof CASES / sizeof *CASES, KIND_COUNT = sizeof KINDS / sizeof *KINDS };

/* Arrays of one sample: q, qd, tau, qdd and its bound. */
union sample {
	float narrow[5][FORWARD_ROWS];
	double wide[5][FORWARD_ROWS];
};

static double get(const union sample *s, int is_wide, int array, int row)
{
	return is_wide ? s->wide[array][row] : (double)s->narrow[array][row];
}

/* A state, whose numbers are floats. */
static void draw(struct solved *x, struct rng *rng, int is_wide, union sample *s, __float128 *want)
{
	double in[3][FORWARD_ROWS];

	solved_draw(x, rng, in[0], in[1], in[2]);
	solved_torques(x, in[0], in[1], in[2], want);
	for (int i = 0; i < x->nv; i++)
		in[2][i] = (double)(float)want[i];
	for (int array = 0; array < 3; array++)
		for (int i = 0; i < (array ? x->nv : x->nq); i++)
			if (is_wide)
				s->wide[array][i] = in[array][i];
			else
				s->narrow[array][i] = (float)in[array][i];
	solved_accelerations(x, in[0], in[1], in[2], want);
}

/* The largest bound over the largest qdd. */
static double check(const struct solved *x, const union sample *s, int is_wide, const __float128 *want, const char *what)
{
	double size = 0, most = 0;

	for (int i = 0; i < x->nv; i++) {
		double qdd = get(s, is_wide, 3, i), bound = get(s, is_wide, 4, i), off = (double)fabsq((__float128)qdd - want[i]);

		ck_assert_msg(off <= bound, "%s: row %d is %g, off by %g, bound %g, seed %d", what, i, qdd, off, bound, SEED);
		size = fmax(size, fabs(qdd));
		most = fmax(most, bound);
	}
	return most / size;
}

static struct rnea_robot *open_robot(const char *name, enum rneagen_precision precision, int floating)
{
	struct rneagen_options g = rneagen_options_default();
	struct rnea_options o = {.backend = RNEA_BACKEND_EVALUATOR, .threads = 1};
	struct rnea_robot *robot;
	struct rnea_error e;
	char path[512];

	snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", name);
	g.scene = "want qdd,qdd_bound";
	g.precision = precision;
	g.base = floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	ck_assert_msg(!rnea_open_urdf(path, &g, &o, &robot, &e), "%s", e.message);
	return robot;
}

START_TEST(evaluated)
{
	int floating = CASES[_i / KIND_COUNT].floating, kind = _i % KIND_COUNT, is_wide = KINDS[kind].precision == RNEAGEN_F64;
	const char *name = CASES[_i / KIND_COUNT].robot;
	__float128 want[FORWARD_ROWS];
	struct rng rng = rng_seed(SEED);
	struct rnea_robot *robot;
	struct solved x;
	char *urdf = robot_text(name);
	double most = 0;

	solved_open(&x, urdf, floating, 0, 0, name);
	ck_assert(x.nq <= FORWARD_ROWS);
	robot = open_robot(name, KINDS[kind].precision, floating);
	for (int k = 0; k < SAMPLES; k++) {
		union sample s = {0};
		struct rnea_error e;
		void *arrays[5];

		for (int i = 0; i < 5; i++)
			arrays[i] = is_wide ? (void *)s.wide[i] : (void *)s.narrow[i];
		draw(&x, &rng, is_wide, &s, want);
		ck_assert_msg(!rnea_run(robot, arrays, 1, &e), "%s", e.message);
		most = fmax(most, check(&x, &s, is_wide, want, name));
	}
	printf("%s, precision %d: a bound is at most %.2g of the largest qdd\n", name, (int)KINDS[kind].precision, most);
	ck_assert_msg(most < KINDS[kind].worth, "%s: a bound is %g of the largest qdd", name, most);
	rnea_close(robot);
	solved_close(&x);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("qdd_bound_opened");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("qdd within its bound as the evaluator has them, seed %d, %d states each\n", SEED, SAMPLES);
	suite_add(suite, "evaluated", evaluated, CASE_COUNT * KIND_COUNT, 60);
	return suite_run(suite);
}
