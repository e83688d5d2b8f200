/* How close the bounds of --want qdd_bound are, and how often there is none, as a table in Markdown:
   build/tests/qdd_bound_measure FOLDER... >tests/bounds/forward/qdd_bound.md, with folders of robots. */
#include "forward_eval.h"
#include "plan/plan.h"
#include "support/numbers.h"
#include "support/read.h"
#include "support/suite.h"
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 19, SAMPLES = 500, REFERRED = 50 };

static const struct {
	const char *name;
	int floating;
} ROBOTS[] = {{"iiwa14", 0}, {"panda", 0}, {"ur5", 0}, {"hyq", 0}, {"hyq", 1}, {"atlas", 0}, {"atlas", 1}, {"g1_29dof", 0},
	{"g1_29dof", 1},
	{"g1_brainco", 0}, {"anymal_kinova", 1}, {"allegro_right", 0}, {"shadow_hand_right", 0}};

struct figures {
	int samples, infinite, bounds;
	double *bound, error; /* of the norm; the largest */
};

static void add_sample(struct figures *f, struct forward_eval *x, int is_referred)
{
	int n = x->solved.nv;
	double error[FORWARD_ROWS], size = numbers_norm(n, x->qdd), bound = numbers_norm(n, x->bound);

	f->samples++;
	if (!isfinite(bound)) {
		f->infinite++;
		return;
	}
	f->bound[f->bounds++] = bound / size;
	for (int i = 0; i < n && is_referred; i++)
		error[i] = (double)fabsq((__float128)x->qdd[i] - x->want[i]);
	if (is_referred)
		f->error = fmax(f->error, numbers_norm(n, error) / size);
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static unsigned operations(const char *urdf, const struct forward_scene *s, const char *scene)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	struct analysis a;
	unsigned n;

	o.precision = s->precision;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.scene = scene;
	if (analysis_open(&a, urdf, strlen(urdf), &o, &e))
		return 0;
	n = (unsigned)analysis_flops(&a);
	analysis_free(&a);
	return n;
}

static void measure(const char *urdf, const char *name, const struct forward_scene *s)
{
	struct forward_eval *x = calloc(1, sizeof *x);
	struct figures f = {.bound = calloc(SAMPLES, sizeof(double))};
	struct rng rng = rng_seed(SEED);

	ck_assert(x && f.bound && forward_eval_open(x, urdf, NULL, s, name));
	for (int i = 0; i < SAMPLES; i++) {
		forward_eval_run(x, &rng, NULL, i < REFERRED);
		add_sample(&f, x, i < REFERRED);
	}
	qsort(f.bound, (size_t)f.bounds, sizeof *f.bound, compare);
	printf("| %s%s | %d | %s | %u | %ld | %d of %d | %.1e | %.1e | %.1e |\n", name,
		s->floating ? ", floating" : "", x->solved.nv, s->precision == RNEAGEN_F32 ? "f32" : "f64",
		operations(urdf, s, "want qdd\n"), analysis_flops(&x->analysis), f.infinite, f.samples, f.error,
		f.bounds ? f.bound[f.bounds / 2] : 0, f.bounds ? f.bound[f.bounds - 1] : 0);
	fflush(stdout);
	forward_eval_close(x);
	free(f.bound);
	free(x);
}

static char *find(char **folders, const char *name)
{
	for (; *folders; folders++) {
		char path[512], *urdf;
		size_t length;

		snprintf(path, sizeof path, "%s/%s.urdf", *folders, name);
		urdf = read_file(path, &length);
		if (urdf)
			return urdf;
	}
	return NULL;
}

static char **given;

START_TEST(table)
{
	for (size_t i = 0; i < sizeof ROBOTS / sizeof *ROBOTS; i++) {
		char *urdf = find(given, ROBOTS[i].name);

		if (!urdf)
			continue;
		measure(urdf, ROBOTS[i].name, &(struct forward_scene){RNEAGEN_F32, ROBOTS[i].floating, "", 0, 0, 0, 0});
		if (i % 4 == 0 || i == 5)
			measure(urdf, ROBOTS[i].name, &(struct forward_scene){RNEAGEN_F64, ROBOTS[i].floating, "", 0, 0, 0, 0});
		free(urdf);
	}
}
END_TEST

/* What the tests share needs a test around it. */
int main(int argc, char **argv)
{
	Suite *suite = suite_create("measure");
	SRunner *runner = srunner_create(suite);
	int failed;

	given = argv + (argc > 0);
	printf("| robot | nv | precision | operations, qdd | and qdd_bound | infinite | error, largest | bound, middle | "
	       "bound, largest |\n"
	       "|---|---:|---|---:|---:|---:|---:|---:|---:|\n");
	suite_add(suite, "table", table, 1, 0);
	srunner_set_fork_status(runner, CK_NOFORK);
	srunner_run_all(runner, CK_SILENT);
	failed = srunner_ntests_failed(runner);
	srunner_free(runner);
	return failed != 0;
}
