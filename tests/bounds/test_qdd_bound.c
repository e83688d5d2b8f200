/* --want qdd_bound: every qdd within its bound of the reference in quad precision, as evaluated and as compiled, and the bound of
   use. A rounding that the bound forgets would break it where it is the largest; a bound that is taken through all steps of the
   factors would be of no use. */
#define _POSIX_C_SOURCE 200809L
#include "forward_eval.h"
#include "forward_text.h"
#include "support/exhaustive.h"
#include "support/model.h"
#include "support/random_robot.h"
#include "support/suite.h"
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 17, SAMPLES = 20 };

static const enum rneagen_precision PRECISIONS[] = {RNEAGEN_F32, RNEAGEN_F64, RNEAGEN_MIXED};
static const char *const PRECISION_NAMES[] = {"f32", "f64", "mixed"};

/* Of many samples: finite ones, the largest and the sum of logarithms of bound over error in the norm, the largest bound in the norm. */
struct tally {
	long samples, finite;
	double worst, over, norm;
};

static double norm(int n, const double *x)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += x[i] * x[i];
	return sqrt(sum);
}

static void judge(const struct forward_eval *x, struct tally *t, const char *what)
{
	int n = x->solved.nv, is_finite = 1;
	double error[FORWARD_ROWS];

	for (int i = 0; i < n; i++) {
		error[i] = isfinite(x->qdd[i]) ? (double)fabsq((__float128)x->qdd[i] - x->want[i]) : (double)INFINITY;
		ck_assert_msg(!(error[i] > x->bound[i]), "%s: row %d is %g, off by %g, bound %g", what, i, x->qdd[i], error[i],
			x->bound[i]);
		is_finite &= isfinite(x->bound[i]) != 0;
		if (is_finite && x->bound[i] > 0)
			t->worst = fmax(t->worst, error[i] / x->bound[i]);
	}
	t->samples++;
	t->finite += is_finite;
	if (is_finite) {
		t->over += log(norm(n, x->bound) / (norm(n, error) + 1e-300));
		t->norm = fmax(t->norm, norm(n, x->bound) / norm(n, x->qdd));
	}
}

static void print_tally(const struct tally *t, const char *what, const struct forward_eval *x)
{
	struct operation_count c = plan_operations(&(struct plan){.dag = &x->analysis.dag});

	printf("%-36s nv %2d, %7u operations: %3.0f %% finite; error at most %.2g of a bound; bound %8.2g of the norm at most, %6.1f errors in the middle\n", what, x->solved.nv,
		plan_flops(c), 100.0 * (double)t->finite / (double)t->samples, t->worst, t->norm,
		t->finite ? exp(t->over / (double)t->finite) : 0);
}

/* ---- robots ---- */

static struct tally check(const char *urdf, const char *reference, const struct forward_scene *s, const char *name, int samples,
	const double *(*more)(const char *name))
{
	struct forward_eval *x = calloc(1, sizeof *x);
	struct rng rng = rng_seed(SEED);
	struct tally t = {0};
	char what[128];

	ck_assert_ptr_nonnull(x);
	snprintf(what, sizeof what, "%s %s%s", name, PRECISION_NAMES[s->precision == RNEAGEN_F32 ? 0 : s->precision == RNEAGEN_F64 ? 1 : 2],
		s->floating ? " floating" : "");
	if (forward_eval_open(x, urdf, reference, s, what)) {
		for (int i = 0; i < samples; i++) {
			forward_eval_run(x, &rng, more);
			judge(x, &t, what);
		}
		print_tally(&t, what, x);
		forward_eval_close(x);
	}
	free(x);
	return t;
}

struct walk {
	int turn, floating;
};

static void check_file(const char *path, const char *name, void *context)
{
	struct walk *w = context;
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail", 5) || !strncmp(name, "chain_75", 8) || (!exhaustive() && strstr("g1_29dof atlas fetch shadow_hand_right", name)))
		return;
	urdf = read_file(path, &length);
	for (int p = 0; p < 3; p++)
		if (exhaustive() || p == w->turn % 3)
			check(urdf, NULL, &(struct forward_scene){PRECISIONS[p], w->floating, "", 0, 0}, name, SAMPLES, NULL);
	w->turn++;
	free(urdf);
}

/* A precision for each robot in turn, or all. */
START_TEST(own_robots)
{
	struct walk w = {.floating = _i};

	ck_assert_int_gt(for_each_urdf(TEST_DIR "/robots", check_file, &w), 0);
}
END_TEST

START_TEST(real_robots)
{
	struct walk w = {0};
	const char *folder = getenv("RNEAGEN_ROBOTS");

	if (!folder)
		printf("skipped: RNEAGEN_ROBOTS names no folder of robots\n");
	else if (exhaustive())
		ck_assert_int_gt(for_each_urdf(folder, check_file, &w), 0);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("qdd_bound");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("qdd within its bound, seed %d, %d states each\n", SEED, SAMPLES);
	suite_add(suite, "own_robots", own_robots, 2, 120);
	suite_add(suite, "real_robots", real_robots, 1, 600);
	return suite_run(suite);
}
