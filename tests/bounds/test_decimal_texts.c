/* NAME_rnea_bounded as compiled against the decimals of the URDF: each torque within its bound of what these give in quad
   precision. A text whose constants took the file's numbers for doubles would break its bounds. */
#define _POSIX_C_SOURCE 200809L
#include "decimals.h"
#include "hard/quad.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include "target/target.h"
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEEDS = 4, SAMPLES = 20, ROWS = 16 };

typedef void single_bounded(const float *q, const float *qd, const float *qdd, float *tau, float *bound);
typedef void double_bounded(const double *q, const double *qd, const double *qdd, double *tau, double *bound);

struct fixture {
	struct target target;
	struct reference *reference;
	struct quad *quad;
	struct array in[3], tau, bound;
	single_bounded *single;
	double_bounded *wide;
	int broken, bounds;
};

static void fixture_open(struct fixture *x, const char *urdf, enum rneagen_precision precision)
{
	static const struct compiler compiler = {"gcc", {"-O1"}};
	struct rneagen_options o = rneagen_options_default();
	char message[256], name[512];

	*x = (struct fixture){0};
	o.target = RNEAGEN_TARGET_C;
	o.precision = precision;
	o.bounded = 1;
	target_open(&x->target, urdf, strlen(urdf), &o, &compiler, "decimals");
	snprintf(name, sizeof name, "%s_rnea_bounded", x->target.text.name);
	target_symbol(&x->target, x->target.library, name, x->target.f32 ? (void *)&x->single : (void *)&x->wide);
	x->reference = reference_open(urdf, strlen(urdf), NULL, message, sizeof message);
	x->quad = quad_open(urdf, strlen(urdf), 0, 0, QUAD_DECIMALS, o.gravity, NULL, message, sizeof message);
	ck_assert_msg(x->reference && x->quad, "%s", message);
	quad_set_gravity(x->quad, (__float128[]){0, 0, -9.81Q});
	for (int i = 0; i < 3; i++)
		x->in[i] = array_new(x->target.f32, (size_t)(i ? x->reference->nv : x->reference->nq));
	x->tau = array_new(x->target.f32, (size_t)x->reference->nv);
	x->bound = array_new(x->target.f32, (size_t)x->reference->nv);
}

static void fixture_close(struct fixture *x)
{
	for (int i = 0; i < 3; i++)
		array_free(&x->in[i]);
	array_free(&x->tau);
	array_free(&x->bound);
	quad_close(x->quad);
	reference_close(x->reference);
	target_close(&x->target);
}

static void check_state(struct fixture *x, double (*state)[ROWS], const char *what)
{
	__float128 exact[ROWS];
	double noise[ROWS];

	for (int i = 0; i < 3; i++)
		for (size_t k = 0; k < x->in[i].count; k++)
			array_set(&x->in[i], k, state[i][k]);
	if (x->target.f32)
		x->single(x->in[0].data, x->in[1].data, x->in[2].data, x->tau.data, x->bound.data);
	else
		x->wide(x->in[0].data, x->in[1].data, x->in[2].data, x->tau.data, x->bound.data);
	quad_rnea(x->quad, state[0], state[1], state[2], exact);
	quad_magnitude(x->quad, state[0], state[1], state[2], noise);
	for (size_t i = 0; i < x->tau.count; i++) {
		double error = (double)fabsq((__float128)array_get(&x->tau, i) - exact[i]), bound = array_get(&x->bound, i);

		x->bounds++;
		if (error > bound + 0x1p-100 * noise[i] && !x->broken++)
			printf("%s, %s: torque %zu is off by %g, bound %g\n", what, x->target.what, i, error, bound);
	}
}

START_TEST(drawn)
{
	static const enum rneagen_precision precisions[] = {RNEAGEN_F64, RNEAGEN_F32, RNEAGEN_MIXED};
	const struct decimal_case *c = &DECIMAL_CASES[_i];
	int broken = 0, bounds = 0;

	/* a robot in one precision, in turn, unless all is asked for */
	for (int seed = exhaustive() ? 0 : _i % SEEDS; seed < SEEDS; seed += exhaustive() ? 1 : SEEDS) {
		char *urdf = c->draw((uint64_t)seed);
		struct rng rng = rng_seed((uint64_t)seed);
		double state[3][ROWS];
		struct fixture x;

		fixture_open(&x, urdf, precisions[seed % 2 ? seed / 2 + 1 : 0]);
		for (int i = 0; i < SAMPLES; i++) {
			decimal_state(x.reference, &rng, i % DECIMAL_STATES, (double *const[]){state[0], state[1], state[2]});
			check_state(&x, state, c->name);
		}
		broken += x.broken;
		bounds += x.bounds;
		fixture_close(&x);
		free(urdf);
	}
	printf("%-10s %d bounds, %d broken\n", c->name, bounds, broken);
	ck_assert_msg(!broken, "%s: %d bounds are broken", c->name, broken);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("decimal texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("texts with bounds against the URDF's decimals, seeds 0 to %d: f64, f32, f64, mixed\n", SEEDS - 1);
	suite_add(suite, "drawn", drawn, DECIMAL_CASE_COUNT, 120);
	return suite_run(suite);
}
