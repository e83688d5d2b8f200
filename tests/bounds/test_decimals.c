/* Bounds against the decimals of the URDF: each torque within its bound of what these give in quad precision, though the
   constants are small differences of them. Bounds that took the file's numbers as rounded to doubles, or constants as good
   to so many bits of themselves, would not hold. */
#include "decimals.h"
#include "support/exhaustive.h"
#include "support/model.h"
#include "hard/quad.h"
#include "support/suite.h"
#include "worst.h"
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 16 };
#define SEEDS (exhaustive() ? 40 : 24)

static const struct kind {
	const char *name;
	struct rneagen_options options;
	int on_gpu;
} KINDS[] = {
	{"f64", {.precision = RNEAGEN_F64}, 0},
	{"f64 on a GPU", {.precision = RNEAGEN_F64}, 1},
	{"f32", {.precision = RNEAGEN_F32}, 0},
	{"mixed", {.precision = RNEAGEN_MIXED}, 0},
	{"f32x2", {.precision = RNEAGEN_F32X2}, 0},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

struct fixture {
	struct model model;
	struct quad *quad;
	struct rng rng;
	char what[128];
	double state[3][ROWS], bound[ROWS], noise[ROWS], tau[ROWS];
	__float128 exact[ROWS];
	double share; /* the largest error, of its bound */
	int bounds, broken;
};

static void fixture_open(struct fixture *x, const struct decimal_case *c, uint64_t seed)
{
	struct rneagen_options o = rneagen_options_default();
	char message[256], *urdf = c->draw(seed);

	snprintf(x->what, sizeof x->what, "%s, seed %d", c->name, (int)seed);
	o.gravity[2] = seed % 2 ? 0 : -9.81;
	model_open(&x->model, urdf, strlen(urdf), &o, x->what);
	ck_assert(x->model.tree.nq <= ROWS);
	x->quad = quad_open(urdf, strlen(urdf), 0, 0, QUAD_DECIMALS, o.gravity, NULL, message, sizeof message);
	ck_assert_msg(x->quad != NULL, "%s: %s", x->what, message);
	if (seed % 2 == 0)
		quad_set_gravity(x->quad, (__float128[]){0, 0, -9.81Q});
	x->rng = rng_seed(seed);
	free(urdf);
}

static void fixture_close(struct fixture *x)
{
	quad_close(x->quad);
	model_close(&x->model);
}

/* Errors but for the rounding of the reference and what else is not the text's. */
static void judge(struct fixture *x, const struct kind *k, const char *how, double unit)
{
	for (int i = 0; i < x->model.tree.nv; i++) {
		double error = (double)fabsq((__float128)x->tau[i] - x->exact[i]);

		error -= 0x1p-100 * x->noise[i] + unit * fabs(x->tau[i]);
		x->bounds++;
		if (error > x->bound[i] && !x->broken++)
			printf("%s, %s %s: torque %d is off by %g, bound %g\n", x->what, k->name, how, i, error, x->bound[i]);
		if (x->bound[i] > 0)
			x->share = fmax(x->share, error / x->bound[i]);
	}
}

/* As gen/eval computes it, and by arithmetic that does the worst its model allows. */
static void check_kind(struct fixture *x, const struct kind *k)
{
	const struct dag *d = &x->model.dag[ALGORITHM_rnea];
	const double *in[] = {x->state[0], x->state[1], x->state[2], NULL};
	struct eval_model m = eval_model_of(&k->options, k->on_gpu);

	ck_assert(eval_bound(d, &m, in, (double *[]){NULL, NULL, NULL, x->bound}));
	worst_evaluate(d, &m, &x->rng, in, (double *[]){NULL, NULL, NULL, x->tau});
	judge(x, k, "at its worst", 0x1p-53); /* its torques are rounded to doubles */
	if (k->options.precision == RNEAGEN_F64) {
		ck_assert(eval_f64(d, in, (double *[]){NULL, NULL, NULL, x->tau}, NULL));
		judge(x, k, "computed", 0);
	}
}

static void check_case(struct fixture *x, const struct decimal_case *c, const struct kind *k)
{
	for (uint64_t seed = 0; seed < (uint64_t)SEEDS; seed++) {
		fixture_open(x, c, seed);
		for (int i = 0; i < DECIMAL_STATES; i++) {
			decimal_state(x->model.reference, &x->rng, i, (double *const[]){x->state[0], x->state[1], x->state[2]});
			quad_rnea(x->quad, x->state[0], x->state[1], x->state[2], x->exact);
			quad_magnitude(x->quad, x->state[0], x->state[1], x->state[2], x->noise);
			check_kind(x, k);
		}
		fixture_close(x);
	}
}

START_TEST(drawn)
{
	const struct decimal_case *c = &DECIMAL_CASES[_i];
	int broken = 0;

	for (int k = 0; k < KIND_COUNT; k++) {
		static struct fixture x;

		x = (struct fixture){0};
		check_case(&x, c, &KINDS[k]);
		printf("%-10s %-13s %d bounds, %d broken; error at most %.2g of a bound\n", c->name, KINDS[k].name,
			x.bounds, x.broken, x.share);
		broken += x.broken;
	}
	ck_assert_msg(!broken, "%s: %d bounds are broken", c->name, broken);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("decimals");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("bounds against the URDF's decimals, seeds 0 to %d\n", SEEDS - 1);
	suite_add(suite, "drawn", drawn, DECIMAL_CASE_COUNT, 120);
	return suite_run(suite);
}
