/* How close bounds of single samples are, as a table in Markdown: build/tests/bounds_measure [ROBOT...] >tests/bounds/bounds.md
   Bounds over errors, by the evaluator, as rnearun report has them, and by the text itself: the largest ||bound|| / ||tau|| over
   the largest ||error|| / ||tau||; ||bound|| / ||error|| of the sample in the middle; the largest bound of a torque over its
   largest error, where that is most. */
#define _POSIX_C_SOURCE 200809L
#include "dag/eval.h"
#include "emit/number_type.h"
#include "hard/compiled.h"
#include <check.h>
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 23, SAMPLES = 1000, PRECISIONS = 4 };

static const struct hard_case ROBOTS[] = {
	{.name = "iiwa14", .file = "iiwa14.urdf"}, {.name = "panda", .file = "panda.urdf"}, {.name = "ur5", .file = "ur5.urdf"},
	{.name = "hyq", .file = "hyq.urdf"}, {.name = "hyq, floating", .file = "hyq.urdf", .floating = 1},
	{.name = "atlas", .file = "atlas.urdf"}, {.name = "atlas, floating", .file = "atlas.urdf", .floating = 1},
	{.name = "g1_29dof", .file = "g1_29dof.urdf"}, {.name = "g1_29dof, floating", .file = "g1_29dof.urdf", .floating = 1}};

static const struct {
	const char *name;
	enum rneagen_precision precision;
} KINDS[PRECISIONS] = {{"f32", RNEAGEN_F32}, {"f64", RNEAGEN_F64}, {"mixed", RNEAGEN_MIXED}, {"f32x2", RNEAGEN_F32X2}};

/* A bound beside the error: of the norm, and of single torques. */
struct figures {
	double largest, *ratio, *row; /* of ||tau||; bound over error of each sample; the largest of each torque */
	int count;
};

typedef void single_bounded(const float *q, const float *qd, const float *qdd, float *tau, float *bound);
typedef void double_bounded(const double *q, const double *qd, const double *qdd, double *tau, double *bound);

struct measured {
	struct compiled text;
	struct array bound;
	single_bounded *single;
	double_bounded *wide;
	double size, error, *row, *of;  /* ||tau||; the largest error of that; by torque, of all samples and of one */
	struct figures evaluated, own;  /* by eval_bound; by the text itself */
};

static struct figures figures_new(int nv)
{
	return (struct figures){.ratio = numbers_new(SAMPLES, sizeof(double)), .row = numbers_new(nv, sizeof(double))};
}

static void figures_free(struct figures *f)
{
	free(f->ratio);
	free(f->row);
}

static void open_case(struct measured *x, const struct hard_case *c, enum rneagen_precision precision)
{
	static const struct compiler plain = {"gcc", {"-O0", "-Dalways_inline=unused"}};
	const struct rneagen_options how = {.precision = precision, .trig = RNEAGEN_ACCURATE,
		.bounded = precision != RNEAGEN_F32X2};
	char name[512];

	*x = (struct measured){0};
	compiled_open(&x->text, c, &how, &plain, "measured");
	snprintf(name, sizeof name, "%s_rnea_bounded", x->text.target.text.name);
	if (how.bounded)
		target_symbol(&x->text.target, x->text.target.library, name,
			x->text.target.f32 ? (void *)&x->single : (void *)&x->wide);
	x->bound = array_new(x->text.target.f32, (size_t)x->text.nv);
	x->row = numbers_new(x->text.nv, sizeof(double));
	x->of = numbers_new(x->text.nv, sizeof(double));
	x->evaluated = figures_new(x->text.nv);
	x->own = figures_new(x->text.nv);
}

static void close_case(struct measured *x)
{
	array_free(&x->bound);
	free(x->row);
	free(x->of);
	figures_free(&x->evaluated);
	figures_free(&x->own);
	compiled_close(&x->text);
}

static void run(struct measured *x)
{
	struct compiled *t = &x->text;

	if (x->single)
		x->single(t->in[0].data, t->in[1].data, t->in[2].data, t->tau.data, x->bound.data);
	else if (x->wide)
		x->wide(t->in[0].data, t->in[1].data, t->in[2].data, t->tau.data, x->bound.data);
	else
		target_rnea(&t->target, &t->in[0], &t->in[1], &t->in[2], &t->tau);
}

/* Bounds of one sample; all of them hold, but for the reference's own rounding. */
static void take(struct measured *x, struct figures *f, const double *bound)
{
	int n = x->text.nv;
	double error = numbers_norm(n, x->of), of_all = numbers_norm(n, bound);

	for (int i = 0; i < n; i++) {
		if (!(x->of[i] <= bound[i] + 0x1p-100 * x->text.noise[i]))
			ck_abort_msg("%s: torque %d is off by %g, bound %g", x->text.target.what, i, x->of[i], bound[i]);
		f->row[i] = fmax(f->row[i], bound[i]);
	}
	f->largest = fmax(f->largest, of_all / x->size);
	if (error > 0)
		f->ratio[f->count++] = of_all / error;
}

static void add_sample(struct measured *x, const struct eval_model *m)
{
	struct compiled *t = &x->text;
	double *bound = numbers_new(t->nv, sizeof *bound);

	compiled_set(t);
	run(x);
	compiled_refer(t);
	if (!eval_bound(&t->hard.model.dag[ALGORITHM_rnea], m, (const double *[]){t->state[0], t->state[1], t->state[2], NULL},
			(double *[]){NULL, NULL, NULL, t->eval}))
		abort();
	for (int i = 0; i < t->nv; i++) {
		x->of[i] = fabs((double)((__float128)array_get(&t->tau, (size_t)i) - t->reference[i]));
		x->row[i] = fmax(x->row[i], x->of[i]);
		bound[i] = fabs((double)t->reference[i]);
	}
	x->size = numbers_norm(t->nv, bound);
	x->error = fmax(x->error, numbers_norm(t->nv, x->of) / x->size);
	take(x, &x->evaluated, t->eval);
	for (int i = 0; i < t->nv && (x->wide || x->single); i++)
		bound[i] = array_get(&x->bound, (size_t)i);
	if (x->wide || x->single)
		take(x, &x->own, bound);
	free(bound);
}

static int ascending(const void *a, const void *b)
{
	const double *x = a, *y = b;

	return (*x > *y) - (*x < *y);
}

/* Largest over largest of the norm; the middle of all samples; the torque where largest over largest is most. */
static void put_figures(const struct measured *x, struct figures *f)
{
	double most = 0;

	qsort(f->ratio, (size_t)f->count, sizeof *f->ratio, ascending);
	for (int i = 0; i < x->text.nv; i++)
		if (x->row[i] > 0)
			most = fmax(most, f->row[i] / x->row[i]);
	if (f->count)
		printf(" %.1f | %.1f | %.1f |", f->largest / x->error, f->ratio[f->count / 2], most);
	else
		printf(" - | - | - |");
}

static void measure(const struct hard_case *c, int kind)
{
	const struct rneagen_options o = {.precision = KINDS[kind].precision, .trig = RNEAGEN_ACCURATE};
	struct eval_model m = eval_model_of(&o, 0);
	struct rng rng = rng_seed(SEED);
	struct measured x;

	open_case(&x, c, KINDS[kind].precision);
	for (int i = 0; i < SAMPLES; i++) {
		compiled_sample(&x.text, &rng);
		add_sample(&x, &m);
	}
	printf("| %s | %s | %.1e |", c->name, KINDS[kind].name, x.error);
	put_figures(&x, &x.evaluated);
	put_figures(&x, &x.own);
	putchar('\n');
	fflush(stdout);
	close_case(&x);
}

static char **given;

static int is_wanted(const char *name)
{
	if (!*given)
		return 1;
	for (char **p = given; *p; p++)
		if (!strcmp(*p, name))
			return 1;
	return 0;
}

START_TEST(table)
{
	for (size_t i = 0; i < sizeof ROBOTS / sizeof *ROBOTS; i++)
		for (int k = 0; k < PRECISIONS && is_wanted(ROBOTS[i].name); k++)
			measure(&ROBOTS[i], k);
}
END_TEST

/* What the tests share needs a test around it. */
int main(int argc, char **argv)
{
	Suite *suite = suite_create("measure");
	TCase *c = tcase_create("table");
	SRunner *runner = srunner_create(suite);
	int failed;

	given = argv + (argc > 0);
	printf("| robot | precision | error, largest | report: largest | middle | torque | --bounded: largest | middle | torque |\n"
	       "|---|---|---:|---:|---:|---:|---:|---:|---:|\n");
	fflush(stdout);
	tcase_add_test(c, table);
	suite_add_tcase(suite, c);
	srunner_set_fork_status(runner, CK_NOFORK);
	srunner_run_all(runner, CK_SILENT);
	failed = srunner_ntests_failed(runner);
	srunner_free(runner);
	return failed != 0;
}
