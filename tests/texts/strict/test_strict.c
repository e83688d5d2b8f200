/* --strict: the same bits from every compiler at every setting, also where it may join products and sums, and those of
   the DAG computed operation by operation; in ordinary states, at large angles, where numbers are subnormal or
   overflow. Once found: a negation of a joined sum (gcc, the sign of a zero), a product left in fma(1, x, y) (clang):
   check_dags names both. */
#define _POSIX_C_SOURCE 200809L
#include "target/rerun.h"
#include "target/states.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STATES = 96, KINDS = 8, SEED = 29, DEEP = 40 }; /* compilers take long over the texts of DEEP robots */

/* The first one sets the bits; where the machine has no fused multiply-add, only the first three can be run. */
static const struct compiler SETTINGS[] = {
	{"gcc", {"-O0"}},
	{"gcc", {"-O3"}},
	{"clang", {"-O2"}},
	{"gcc", {"-O1", "-march=x86-64-v3", "-std=gnu11", "-ffp-contract=fast"}},
	{"clang", {"-O1", "-march=x86-64-v3", "-ffp-contract=fast"}},
	{"gcc", {"-O1"}},
	{"gcc", {"-O2", "-march=x86-64-v3", "-std=gnu11", "-ffp-contract=fast"}},
	{"gcc", {"-O3", "-march=native", "-std=gnu11", "-ffp-contract=fast", "-mprefer-vector-width=512"}},
	{"clang", {"-O0"}},
	{"clang", {"-O2", "-march=x86-64-v3", "-ffp-contract=fast"}},
	{"clang", {"-O3", "-march=native", "-ffp-contract=fast"}},
};

enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS, FUSING = 3, QUICK = 8 };

static int is_possible(const struct compiler *c)
{
	static int told;
	const char *why = compiler_lacks(c, c->flags[1] != NULL);

	if (why && !told++)
		printf("skipped: some settings: %s: %s\n", c->command, why);
	return !why;
}

/* ---- states ---- */

static double draw(struct rng *r, double scale)
{
	return rng_uniform(r, -scale, scale);
}

/* What is hard is in one of q, qd and qdd, or in all of them. */
static void draw_state(struct rng *r, int kind, int f32, int nq, int nv, double *x)
{
	const double scales[KINDS][3] = {{3, 2, 5}, {1e5, 1, 1}, {f32 ? 1e6 : 1e9, 1, 1}, {3, f32 ? 1e-20 : 1e-160, 1e-30},
		{f32 ? 1e-42 : 1e-312, f32 ? 1e-40 : 1e-310, f32 ? 1e-43 : 1e-320}, {3, f32 ? 1e19 : 1e154, 1},
		{0, 0, 0}, {3, 2, 5}};

	for (int i = 0; i < nq + 2 * nv; i++) {
		double value = draw(r, scales[kind][i < nq ? 0 : i < nq + nv ? 1 : 2]);

		x[i] = f32 ? (double)(float)value : value;
	}
	if (kind == KINDS - 1)
		x[rng_below(r, nq + 2 * nv)] = INFINITY;
}

/* Inputs of all states, and what a text makes of them: torques one by one, of a batch, and by the two passes. */
struct run {
	int nq, nv, nb;
	double *in;			  /* [state][q, qd, qdd] */
	double *one, *batch, *passes, *back; /* passes: v, a, f */
};

static struct run run_new(const struct model *m, int f32)
{
	struct run r = {m->tree.nq, m->tree.nv, m->tree.body_count, NULL, NULL, NULL, NULL, NULL};
	size_t states = STATES, nv = (size_t)r.nv, row = (size_t)r.nq + 2 * nv;
	struct rng rng = rng_seed(SEED);

	r.in = calloc(states * row, sizeof(double));
	r.one = calloc(states * nv, sizeof(double));
	r.batch = calloc(states * nv, sizeof(double));
	r.back = calloc(states * nv, sizeof(double));
	r.passes = calloc(states * 18 * (size_t)r.nb, sizeof(double));
	ck_assert(r.in && r.one && r.batch && r.back && r.passes);
	for (int k = 0; k < STATES; k++)
		draw_state(&rng, k / (STATES / KINDS), f32, r.nq, r.nv, r.in + (size_t)k * row);
	return r;
}

static void run_free(struct run *r)
{
	free(r->in);
	free(r->one);
	free(r->batch);
	free(r->passes);
	free(r->back);
}

static struct array taken(const struct target *t, const double *x, int n)
{
	struct array a = array_new(t->f32, (size_t)n);

	for (int i = 0; i < n; i++)
		array_set(&a, (size_t)i, x ? x[i] : (double)NAN);
	return a;
}

static void given(struct array *a, double *x)
{
	for (size_t i = 0; x && i < a->count; i++)
		x[i] = array_get(a, i);
	array_free(a);
}

static void run_state(const struct target *t, struct run *r, int k)
{
	const double *x = r->in + (size_t)k * (size_t)(r->nq + 2 * r->nv);
	struct array q = taken(t, x, r->nq), qd = taken(t, x + r->nq, r->nv), qdd = taken(t, x + r->nq + r->nv, r->nv);
	struct array tau = taken(t, NULL, r->nv), back = taken(t, NULL, r->nv), out[3];

	target_rnea(t, &q, &qd, &qdd, &tau);
	for (int i = 0; i < 3; i++)
		out[i] = taken(t, NULL, 6 * r->nb);
	target_fpass(t, &q, &qd, &qdd, out);
	target_bpass(t, &q, &out[2], &back);
	given(&tau, r->one + (size_t)k * (size_t)r->nv);
	given(&back, r->back + (size_t)k * (size_t)r->nv);
	for (int i = 0; i < 3; i++)
		given(&out[i], r->passes + (size_t)(3 * k + i) * 6 * (size_t)r->nb);
	given(&q, NULL);
	given(&qd, NULL);
	given(&qdd, NULL);
}

/* Where sample k has its row in a batch. */
static size_t place(const struct target *t, int k, int row, int rows)
{
	return (size_t)(t->options.layout == RNEAGEN_SOA ? row * STATES + k : k * rows + row);
}

static struct array gathered(const struct target *t, const struct run *r, int first, int rows)
{
	struct array a = array_new(t->f32, (size_t)(STATES * rows));

	for (int k = 0; k < STATES; k++)
		for (int i = 0; i < rows; i++)
			array_set(&a, place(t, k, i, rows), r->in[k * (r->nq + 2 * r->nv) + first + i]);
	return a;
}

static void run_batch(const struct target *t, struct run *r)
{
	struct array q = gathered(t, r, 0, r->nq), qd = gathered(t, r, r->nq, r->nv),
		     qdd = gathered(t, r, r->nq + r->nv, r->nv), tau = array_new(t->f32, (size_t)(STATES * r->nv));

	target_batch(t, &q, &qd, &qdd, &tau, STATES);
	for (int k = 0; k < STATES; k++)
		for (int i = 0; i < r->nv; i++)
			r->batch[k * r->nv + i] = array_get(&tau, place(t, k, i, r->nv));
	given(&q, NULL);
	given(&qd, NULL);
	given(&qdd, NULL);
	given(&tau, NULL);
}

static void run_all(const struct target *t, struct run *r)
{
	for (int k = 0; k < STATES; k++)
		run_state(t, r, k);
	run_batch(t, r);
}

/* ---- comparison ---- */

static long compared, not_numbers;

static void same(const struct target *t, const char *what, const double *a, const double *b, int rows)
{
	for (int i = 0; i < STATES * rows; i++) {
		ck_assert_msg(same_number(a[i], b[i]), "%s: %s: state %d, kind %d, row %d: %a, not %a", t->what, what,
			i / rows, i / rows / (STATES / KINDS), i % rows, a[i], b[i]);
		not_numbers += isnan(a[i]);
		compared++;
	}
}

/* Against the DAG, rounded once for each operation. */
static void same_as_dag(const struct target *t, const struct model *m, const struct run *r)
{
	double *tau = calloc((size_t)(STATES * r->nv), sizeof *tau);

	ck_assert_ptr_nonnull(tau);
	for (int k = 0; k < STATES; k++) {
		const double *x = r->in + k * (r->nq + 2 * r->nv);
		const double *in[] = {x, x + r->nq, x + r->nq + r->nv, NULL};
		double *out[] = {NULL, NULL, NULL, tau + k * r->nv};

		rerun(&m->dag[ALGORITHM_rnea], t, 1, in, out);
	}
	same(t, "the DAG", r->one, tau, r->nv);
	free(tau);
}

/* fma(1, x, y) is x + y to a compiler, which may join the product that y is to it; a float's 1 is more than one number. */
static int is_hidden_sum(const struct dag *d, const struct node *n)
{
	const struct node *a = &d->nodes[n->arg[0].i];

	return n->op == OP_FMA && a->op == OP_CONST && fabsf((float)a->value) == 1 && d->nodes[n->arg[2].i].op == OP_MUL &&
		fabsf((float)d->nodes[d->nodes[n->arg[2].i].arg[0].i].value) != 1;
}

/* A sum that has a product for an operand is what a compiler may round once instead of twice; the sign of a zero changes
   where gcc makes one instruction of a fused multiply-add and the negation that alone uses it. */
static void check_dags(const struct model *m, const char *what)
{
	for (int pass = 0; pass < MODEL_DAGS; pass++) {
		const struct dag *d = &m->dag[pass];
		uint32_t *uses = calloc(d->count, sizeof *uses);

		dag_uses(d, uses);
		for (size_t i = 0; i < d->count; i++)
			ck_assert_msg(!uses[i] || d->nodes[i].op != OP_NEG || uses[d->nodes[i].arg[0].i] > 1 ||
				d->nodes[d->nodes[i].arg[0].i].op != OP_FMA, "%s: a joined sum is negated", what);
		free(uses);
		for (size_t i = 0; i < d->count; i++)
			ck_assert_msg(!is_hidden_sum(d, &d->nodes[i]),
				"%s: a product is left in a sum that is written as a fused one", what);
		for (size_t i = 0; i < d->count; i++)
			for (int k = 0; k < 2 && (d->nodes[i].op == OP_ADD || d->nodes[i].op == OP_SUB); k++) {
				struct ref a = d->nodes[i].arg[k];

				while (d->nodes[a.i].op == OP_NEG)
					a = d->nodes[a.i].arg[0];
				ck_assert_msg(d->nodes[a.i].op != OP_MUL, "%s: a product is left in a sum", what);
			}
	}
}

/* `settings`: which of SETTINGS, ended by a number that is none; NULL: nothing is compiled. */
static void check_text(const char *urdf, size_t length, const struct rneagen_options *o, const char *name, const int *settings)
{
	struct model m;
	struct run first, r;
	struct target t;
	char stem[128];

	model_open(&m, urdf, length, o, name);
	check_dags(&m, name);
	if (!settings) {
		model_close(&m);
		return;
	}
	first = run_new(&m, o->precision != RNEAGEN_F64);
	r = run_new(&m, o->precision != RNEAGEN_F64);
	for (int i = 0; settings[i] < SETTING_COUNT; i++) {
		const struct compiler *c = &SETTINGS[i &&
			m.tree.body_count >= (exhaustive() ? DEEP : DEEP / 2) ? QUICK : settings[i]];
		struct run *now = i ? &r : &first;

		if (!is_possible(c))
			continue;
		snprintf(stem, sizeof stem, "strict_%.60s_%d%d%d%d", name, o->base, o->precision, o->layout, settings[i]);
		target_open(&t, urdf, length, o, c, stem);
		run_all(&t, now);
		same(&t, "batch and alone", now->batch, now->one, now->nv);
		if (i == 0)
			same_as_dag(&t, &m, now);
		same(&t, "rnea", now->one, first.one, now->nv);
		same(&t, "fpass", now->passes, first.passes, 18 * now->nb);
		same(&t, "bpass", now->back, first.back, now->nv);
		target_close(&t);
	}
	run_free(&first);
	run_free(&r);
	model_close(&m);
}

/* ---- texts ---- */

static void check_file(const char *path, const char *file, struct rneagen_options *o, const int *settings)
{
	char name[64], *urdf;
	size_t length;

	snprintf(name, sizeof name, "%.*s", (int)strcspn(file, "."), file);
	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	o->target = RNEAGEN_TARGET_C;
	o->strict = 1;
	check_text(urdf, length, o, name, settings);
	free(urdf);
}

static void report(const char *what)
{
	printf("%s: %ld numbers have the same bits, %ld of them are NaN; seed %d\n", what, compared, not_numbers, SEED);
	ck_assert_int_lt(not_numbers, compared / 2);
}

/* A few texts by every setting. */
static const struct choice {
	const char *name;
	enum rneagen_base base;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum rneagen_trig trig;
} CHOICES[] = {{"iiwa14", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE},
	{"iiwa14", RNEAGEN_FIXED, RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_BOUNDED},
	{"iiwa14", RNEAGEN_FIXED, RNEAGEN_MIXED, RNEAGEN_AOS, RNEAGEN_ACCURATE},
	{"hyq", RNEAGEN_FLOATING, RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_ACCURATE},
	{"mimic_chain", RNEAGEN_FLOATING, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_BOUNDED}};

START_TEST(every_setting)
{
	/* of the others every fifth, which they take in turns; where all is asked for, every precision meets every one */
	int step = !exhaustive() ? 5 : CHOICES[_i].precision == RNEAGEN_MIXED ? 1 : 2, count = 1, all[SETTING_COUNT + 1] = {0};
	const struct choice *c = &CHOICES[_i];
	struct rneagen_options o = rneagen_options_default();
	char path[512];

	for (int i = 1 + (step == 2 ? _i / 3 : _i) % step; i < SETTING_COUNT; i += step)
		all[count++] = i;
	all[count] = SETTING_COUNT;
	o.base = c->base;
	o.precision = c->precision;
	o.layout = c->layout;
	o.trig = c->trig;
	snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", c->name);
	check_file(path, c->name, &o, all);
	report(c->name);
}
END_TEST

struct tour {
	int step, robots, turn;
};

/* The DAGs of each robot; one in `step` in one text by two settings; options and settings take turns. */
static void check_robot(const char *path, const char *file, void *context)
{
	struct tour *tour = context;
	int turn = tour->turn, settings[] = {0, FUSING + turn % 2, SETTING_COUNT};
	int left = tour->robots++ % tour->step;
	struct rneagen_options o = rneagen_options_default();

	if (!strncmp(file, "xfail_", 6))
		return;
	o.precision = turn % 3 == 0 ? RNEAGEN_F32 : turn % 3 == 1 ? RNEAGEN_F64 : RNEAGEN_MIXED;
	o.layout = (enum rneagen_layout)(turn / 2 % 2);
	o.trig = turn % 5 ? RNEAGEN_ACCURATE : RNEAGEN_BOUNDED;
	o.base = turn % 4 == 3 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	for (int base = RNEAGEN_FIXED; base <= RNEAGEN_FLOATING; base++) {
		struct rneagen_options other = o;

		other.base = (enum rneagen_base)base;
		check_file(path, file, &other, left || other.base != o.base ? NULL : settings);
	}
	tour->turn += !left;
}

START_TEST(own_robots)
{
	struct tour tour = {.step = exhaustive() ? 2 : 3};

	for_each_urdf(TEST_DIR "/robots", check_robot, &tour);
	ck_assert_int_ge(tour.turn, exhaustive() ? 16 : 11);
	report("own robots");
}
END_TEST

START_TEST(real_robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	struct tour tour = {.step = exhaustive() ? 2 : 6};

	if (!folder) {
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
		return;
	}
	for_each_urdf(folder, check_robot, &tour);
	ck_assert_int_gt(tour.turn, 0);
	report("real robots");
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("strict");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "settings", every_setting, sizeof CHOICES / sizeof *CHOICES, 1200);
	suite_add(suite, "own", own_robots, 1, 1200);
	suite_add(suite, "real", real_robots, 1, 1200);
	return suite_run(suite);
}
