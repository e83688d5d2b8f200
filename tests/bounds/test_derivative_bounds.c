/* gen/eval's bounds of the derivatives of the torques and of the mass matrix, beside those of the torques: what is computed,
   and arithmetic that does the worst its model allows, stays within them, seen from the DAG in quad precision and from
   central differences of the reference in quad precision. And no bound is far above the magnitudes that are summed. */
#include "hard/cases.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include "varied.h"
#include "worst.h"
#include <float.h>
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 9, TREES = 24, LINKS = 7, RATIOS = 1 << 18 };
#define SAMPLES (exhaustive() ? 3 : 2)

static const char COMPUTED[] = "computed", WORST[] = "at its worst";
static const char *const NAMES[OUTPUTS] = {"tau", "dtau_dq", "dtau_dqd", "M"};

/* Multiples of the rounding of all magnitudes that are summed, under which every bound must stay: four times the largest
   that has been seen. */
static const double CEILING = 90;

#define OPTIONS(p) {.precision = RNEAGEN_##p}

static struct variant {
	const char *name;
	struct rneagen_options options;
	int on_gpu;
	double share, most;          /* largest error over bound; largest bound over the rounding of the magnitudes */
	size_t count[OUTPUTS];       /* ratios of bounds to errors that are not 0 */
	float *ratios[OUTPUTS];
} VARIANTS[] = {
	{.name = "f32", .options = OPTIONS(F32)},
	{.name = "f32 on a GPU", .options = OPTIONS(F32), .on_gpu = 1},
	{.name = "f64", .options = OPTIONS(F64)},
	{.name = "mixed", .options = OPTIONS(MIXED)},
};
enum { VARIANT_COUNT = sizeof VARIANTS / sizeof *VARIANTS };

/* ---- what is computed, and its bounds ---- */

static void compute(struct varied *x, const struct variant *v)
{
	struct eval_terms terms = {.size = x->size};
	const struct dag *d = &x->model.dag;
	int f32 = v->options.precision == RNEAGEN_F32;
	POINTERS(float) narrow;
	POINTERS(double) p;

	POINT(narrow, x, x->in_f32, x->got_f32);
	POINT(p, x, x->in, x->got);
	ck_assert(f32 ? eval_f32(d, narrow.in, narrow.out, &terms) : eval_f64(d, p.in, p.out, &terms));
	for (int o = 0; o < OUTPUTS; o++)
		for (int i = 0; i < varied_rows(x, o); i++)
			x->got[o][i] = f32 ? (double)x->got_f32[o][i] : v->options.precision == RNEAGEN_MIXED
				? (double)(float)x->got[o][i] : x->got[o][i];
}

static double distance(double a, __float128 b)
{
	return (double)fabsq((__float128)a - b);
}

/* An element within its bound; `got` has been rounded to double. Where it overflows the bound says so. */
static void judge_element(const struct varied *x, struct variant *v, int o, int i, const char *how)
{
	double bound = x->bound[o][i] + (how == WORST ? 0x1p-53 * fabs(x->got[o][i]) + DBL_TRUE_MIN : 0),
		off = distance(x->got[o][i], x->exact[o][i]);
	int row = o == TAU ? i : i / x->nv;

	if (!isfinite(x->got[o][i])) {
		ck_assert_msg(isinf(bound), "%s, %s: %s %d is %g, bound %g", x->what, v->name, NAMES[o], i, x->got[o][i], bound);
		return;
	}
	ck_assert_msg(off <= bound, "%s, %s, %s: %s %d is %g off the DAG's, bound %g", x->what, v->name, how,
		NAMES[o], i, off, bound);
	ck_assert_msg(distance(x->got[o][i], x->want[o][i]) <= bound + x->noise[row],
		"%s, %s, %s: %s %d is %g off, bound %g and noise %g (%.17g, not %.17g)", x->what, v->name, how, NAMES[o], i,
		distance(x->got[o][i], x->want[o][i]), bound, x->noise[row], x->got[o][i], (double)x->want[o][i]);
	if (bound > 0)
		v->share = fmax(v->share, off / bound);
}

static void judge(const struct varied *x, struct variant *v, const char *how)
{
	for (int o = 0; o < OUTPUTS; o++)
		for (int i = 0; i < varied_rows(x, o); i++)
			judge_element(x, v, o, i, how);
}

/* Bounds beside the errors of what is computed, and beside magnitudes. */
static void note_bounds(const struct varied *x, struct variant *v)
{
	double unit = v->options.precision == RNEAGEN_F64 ? 0x1p-53 : 0x1p-24;

	for (size_t i = 0; i < x->model.dag.output_count; i++) {
		const struct output *out = &x->model.dag.outputs[i];
		int o = x->number[out->argument];
		double bound = x->bound[o][out->row], off = distance(x->got[o][out->row], x->exact[o][out->row]), more;

		if (!isfinite(bound) || bound == 0)
			continue;
		if (off > 0 && v->count[o] < RATIOS)
			v->ratios[o][v->count[o]++] = (float)(bound / off);
		more = varied_half_units(x, o, out->row) + 1e-30;
		if (x->size[i] > 1e-30)
			v->most = fmax(v->most, (bound - more) / (unit * x->size[i]));
		ck_assert_msg(bound <= CEILING * unit * x->size[i] + more,
			"%s, %s: the bound %g of %s %d is %g times the rounding of its terms", x->what, v->name, bound, NAMES[o],
			out->row, bound / (unit * x->size[i]));
	}
}

static void check_variant(struct varied *x, struct variant *v)
{
	struct eval_model m = eval_model_of(&v->options, v->on_gpu);
	POINTERS(double) p;

	POINT(p, x, x->in, x->bound);
	ck_assert(eval_bound(&x->model.dag, &m, p.in, p.out));
	compute(x, v);
	judge(x, v, COMPUTED);
	note_bounds(x, v);
	POINT(p, x, x->in, x->got);
	worst_evaluate(&x->model.dag, &m, &x->rng, p.in, p.out);
	judge(x, v, WORST);
}

static void check_state(struct varied *x)
{
	varied_refer(x);
	for (int i = 0; i < VARIANT_COUNT; i++)
		check_variant(x, &VARIANTS[i]);
}

static int by_size(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Of all that this process has checked. */
static void tell(int robots)
{
	printf("%d robots, %d states each, seed %d\n", robots, SAMPLES, SEED);
	for (struct variant *v = VARIANTS; v < VARIANTS + VARIANT_COUNT; v++) {
		printf("%-12s at most %.2f of a bound, bounds at most %.1f times the rounding of their terms; "
		       "median bound over error:", v->name, v->share, v->most);
		for (int o = 0; o < OUTPUTS; o++) {
			qsort(v->ratios[o], v->count[o], sizeof *v->ratios[o], by_size);
			printf(" %s %.1f", NAMES[o], v->count[o] ? (double)v->ratios[o][v->count[o] / 2] : 0);
			free(v->ratios[o]);
		}
		putchar('\n');
	}
}

static void start(void)
{
	for (int i = 0; i < VARIANT_COUNT; i++)
		for (int o = 0; o < OUTPUTS; o++)
			VARIANTS[i].ratios[o] = numbers_new(RATIOS, sizeof(float));
}

/* ---- robots ---- */

/* A joint with one row that can be held: a line of the scene. */
static int lock_joint(const char *urdf, const struct rneagen_options *o, uint64_t seed, char *line, size_t size, double *at)
{
	struct reference *r = scene_reference(urdf, o);
	int entry = -1, first = (int)(seed % (uint64_t)r->nj);

	for (int k = 0; k < r->nj && entry < 0; k++) {
		const struct reference_joint *j = &r->joints[(first + k) % r->nj];

		if (j->nv == 1 && r->nv > 1)
			entry = (first + k) % r->nj;
	}
	*at = 0.3125;
	if (entry >= 0)
		snprintf(line, size, "lock %s=%.17g\n", r->joints[entry].name, *at);
	reference_close(r);
	return entry;
}

/* Returns whether there was anything to check. */
static int check_tree(uint64_t seed)
{
	struct rneagen_options o = rneagen_options_default();
	char *urdf = torque_robot(seed, LINKS, NO_ODD_NAMES | (seed % 4 ? 0 : ALWAYS_MIMIC)), lock[300] = "", what[64];
	struct varied *x = numbers_new(1, sizeof *x);
	int held = -1, opened;
	double at = 0;

	o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	if (seed % 2)
		held = lock_joint(urdf, &o, seed, lock, sizeof lock, &at);
	snprintf(what, sizeof what, "tree of seed %d%s", (int)seed, *lock ? ", a joint held" : "");
	opened = varied_open(x, urdf, &o, SEED, lock, what);
	if (opened) {
		x->held = held;
		x->at = at;
		for (int k = 0; k < SAMPLES; k++) {
			varied_draw(x);
			check_state(x);
		}
		varied_close(x);
	}
	free(x);
	free(urdf);
	return opened;
}

START_TEST(trees)
{
	int count = 0;

	start();
	for (uint64_t seed = 900; seed < 900 + TREES; seed++)
		count += check_tree(seed);
	tell(count);
	ck_assert_int_gt(count, TREES / 2);
}
END_TEST

static int check_case(const struct hard_case *c)
{
	struct varied *x = numbers_new(1, sizeof *x);
	struct hard h;
	int opened;

	hard_open(&h, c);
	opened = varied_open(x, h.urdf, &h.options, SEED, "", c->name);
	for (int k = 0; k < SAMPLES && opened; k++) {
		hard_sample(&h, &x->rng, 1, x->whole[0], x->whole[1], x->whole[2]);
		varied_settle(x);
		check_state(x);
	}
	if (opened)
		varied_close(x);
	else
		printf("left out, for its %d rows: %s\n", h.model.tree.nv, c->name);
	hard_close(&h);
	free(x);
	return opened;
}

START_TEST(hard_cases)
{
	int count = 0;

	start();
	for (int i = 0; i < HARD_CASE_COUNT; i++)
		count += check_case(&HARD_CASES[i]);
	tell(count);
	ck_assert_int_gt(count, HARD_CASE_COUNT / 2);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("derivative_bounds");
	TCase *c = tcase_create("derivative_bounds");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 600);
	tcase_add_test(c, trees);
	tcase_add_test(c, hard_cases);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
