/* Texts in two-float arithmetic, compiled and run: about every second of our robots, or all where all is
   asked for, and a few by every compiler setting, above all where a compiler may join products to sums (which once undid
   the error-free sum). All in one text each, those with followers in short segments, where one segment reads an input as
   an angle and another one otherwise. */
#define _POSIX_C_SOURCE 200809L
#include "dag/eval.h"
#include "emit/number_type.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include "target/target_check.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Every tenth of the last hundred states has angles up to 9425 rad: two floats hold those too coarsely, unless sine and
   cosine read all of them. */
enum { STATES = 200, ENLARGE = 3000, SEED = 31, SHORT = 50 };
static const double LIMIT = 1e-12;

struct setting {
	struct compiler compiler;
	int needs_fma, is_long; /* the latter: a robot that takes long to compile, too */
};

static const struct setting SETTINGS[] = {
	{{"gcc", {"-O0"}}, 0, 0},
	{{"gcc", {"-O2"}}, 0, 0},
	{{"gcc", {"-O3", "-mfma"}}, 1, 0},
	{{"gcc", {"-O3", "-march=x86-64-v3", "-std=gnu11", "-ffp-contract=fast"}}, 1, 1},
	{{"gcc", {"-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all"}}, 0, 0},
	{{"clang", {"-O0"}}, 0, 0},
	{{"clang", {"-O3"}}, 0, 0},
	{{"clang", {"-O3", "-march=x86-64-v3", "-ffp-contract=fast"}}, 1, 0},
};

enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS };

static struct array array_of(const double *x, int count)
{
	struct array a = array_new(0, (size_t)count);

	for (int i = 0; x && i < count; i++)
		array_set(&a, (size_t)i, x[i]);
	return a;
}

/* The bound of gen/eval_model holds. */
static void check_bound(const struct check *c, const struct rneagen_options *o)
{
	const struct states *s = c->states;
	struct eval_model model = eval_model_of(o, 0);
	double bound[256], *const out[] = {NULL, NULL, NULL, bound}, most = 0;

	ck_assert_int_le(s->nv, 256);
	for (int k = 0; k < s->count; k++) {
		const double *in[] = {s->q + k * s->nq, s->qd + k * s->nv, s->qdd + k * s->nv, NULL};
		struct array q = array_of(in[0], s->nq), qd = array_of(in[1], s->nv), qdd = array_of(in[2], s->nv),
			     tau = array_of(NULL, s->nv);

		target_rnea(c->target, &q, &qd, &qdd, &tau);
		ck_assert(eval_bound(&c->model->dag[ALGORITHM_rnea], &model, in, out));
		for (int i = 0; i < s->nv; i++) {
			double off = (double)fabsl((long double)array_get(&tau, (size_t)i) - s->tau[k * s->nv + i]) -
				     s->noise[k * s->nv + i];

			ck_assert_msg(off <= bound[i], "%s: state %d: torque %d is off by %g, bound %g", c->target->what, k, i,
				off, bound[i]);
			most = bound[i] > 0 ? fmax(most, off / bound[i]) : most;
		}
		array_free(&q), array_free(&qd), array_free(&qdd), array_free(&tau);
	}
	printf("%s: %.2g of the bound\n", c->target->what, most);
}

static void check_text(struct model *m, const struct states *states, const char *urdf, size_t length,
	const struct rneagen_options *o, const struct compiler *compiler, const char *stem, struct worst *worst)
{
	struct target t;
	struct check c = {.target = &t, .model = m, .states = states, .worst = worst};

	target_open(&t, urdf, length, o, compiler, stem);
	check_rnea(&c);
	check_batch(&c);
	check_passes(&c);
	check_bound(&c, o);
	check_nonfinite(&c);
	target_close(&t);
}

static void check_robot(const char *name, enum rneagen_base base, const struct compiler *compiler, int turn,
	struct worst *worst)
{
	struct rneagen_options o = rneagen_options_default();
	struct states states;
	struct model m;
	size_t length;
	char stem[128], *urdf = target_robot(name, &length);

	o.target = RNEAGEN_TARGET_C;
	o.precision = RNEAGEN_F32X2;
	o.layout = turn % 2 ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.trig = (enum rneagen_trig)(turn % 3);
	o.segments = strstr(name, "mimic") ? SHORT : RNEAGEN_SEGMENTS_AUTO;
	o.base = base;
	model_open(&m, urdf, length, &o, name);
	states = states_new_large(&m, SEED, STATES, 0, 1, ENLARGE);
	snprintf(stem, sizeof stem, "pairs_%s_%d_%d", name, base, turn);
	check_text(&m, &states, urdf, length, &o, compiler, stem, worst);
	ck_assert_msg(worst->norm <= LIMIT, "%s: off by %g", stem, worst->norm);
	states_free(&states);
	model_close(&m);
	free(urdf);
}

struct session {
	struct worst worst;
	int robots, turn;
};

static void check_own(const char *path, const char *file, void *context)
{
	/* every operation a call: what a compiler makes of them in line takes it long, and the others see below */
	static const struct compiler quick = {"gcc", {"-O0", "-Dalways_inline=unused"}};
	struct session *s = context;
	struct worst worst = {0};
	char name[128];

	(void)path;
	if (s->robots++ % 2 && !exhaustive() && !has_rare_joints(file))
		return;
	snprintf(name, sizeof name, "%.*s", (int)(strlen(file) - 5), file);
	for (int base = RNEAGEN_FIXED, only = s->turn / 3 % 2; base <= RNEAGEN_FLOATING; base++)
		if (base == only)
			check_robot(name, (enum rneagen_base)base, &quick, s->turn++, &worst);
	printf("%-20s %.1e\n", name, worst.norm);
	worst_merge(&s->worst, &worst);
}

START_TEST(own_robots)
{
	struct session s = {0};

	for_each_urdf(TEST_DIR "/robots", check_own, &s);
	printf("%d states a text, seed %d\n", STATES, SEED);
	worst_report(&s.worst, "c f32x2");
}
END_TEST

START_TEST(compilers)
{
	const struct setting *s = &SETTINGS[_i];
	struct worst worst = {0};

	if (!compiler_serves(&s->compiler, s->needs_fma))
		return;
	/* settings that join products to sums take both, the others one in turn, unless all is asked for */
	if (exhaustive() || s->needs_fma || _i % 2)
		check_robot("double_pendulum", RNEAGEN_FIXED, &s->compiler, 0, &worst);
	if (exhaustive() || s->needs_fma || _i % 2 == 0)
		check_robot("pendulum", RNEAGEN_FLOATING, &s->compiler, 1, &worst);
	if (s->is_long && exhaustive())
		check_robot("iiwa14", RNEAGEN_FIXED, &s->compiler, 0, &worst);
	worst_report(&worst, s->compiler.command);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("targets_f32x2");
	TCase *t = tcase_create("f32x2");

	suite_add_tcase(s, t);
	tcase_set_timeout(t, 1800);
	tcase_add_test(t, own_robots);
	tcase_add_loop_test(t, compilers, 0, SETTING_COUNT);
	return suite_run(s);
}
