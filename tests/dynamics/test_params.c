/* Torques by base parameters in frames of their own: against the independent reference, within the running bound, and with no
   more operations than the URDF's constants take; of the robots from outside every fourth where not all is asked for. It would
   catch a part of an inertia that is regrouped though it is felt, a frame whose turn, slide or links are not taken along, and a
   frame so far away that it costs accuracy; and a long path that is counted as if it began at the ground. */
#define _POSIX_C_SOURCE 200809L
#include "passes/analysis.h"
#include "passes/path.h"
#include "passes/search.h"
#include "tally.h"
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIMIT_F64 5e-14
#define LIMIT_F32 8e-6

enum { SAMPLES = 100, RANDOM_ROBOTS = 60, RANDOM_SAMPLES = 8 };

struct cheaper {
	struct tally errors;
	int seen;
	long stated, base; /* flops */
};

static long flops_of(const struct dag *d)
{
	struct plan p = {.dag = d};

	return plan_flops(plan_operations(&p));
}

/* As the file states it and by base parameters. */
static void check_model(struct cheaper *t, const char *urdf, size_t length, struct rneagen_options o,
	const char *what, uint64_t seed, int samples)
{
	struct model_error f64, f32;
	struct model m;
	long stated, base;

	o.scene = "params urdf\n";
	model_open(&m, urdf, length, &o, what);
	stated = flops_of(&m.dag[ALGORITHM_rnea]);
	model_close(&m);
	o.scene = "params base\n";
	model_open(&m, urdf, length, &o, what);
	base = flops_of(&m.dag[ALGORITHM_rnea]);
	ck_assert_msg(base <= stated, "%s: %ld flops, more than %ld", what, base, stated);
	f64 = model_error_f64(&m, seed, samples);
	f32 = model_error_f32(&m, seed + 1, samples);
	tally_model(&t->errors, what, f64, f32, LIMIT_F64, LIMIT_F32);
	t->stated += stated;
	t->base += base;
	model_close(&m);
}

static void check_robot(const char *path, const char *name, void *context)
{
	struct rneagen_options o = rneagen_options_default();
	struct cheaper *t = context;
	size_t length;
	char *urdf;

	if (t->errors.real && !exhaustive() && t->seen++ % 4)
		return;
	if (!strncmp(name, "xfail_", 6) || !strncmp(name, "chain_", 6) || strstr(name, "brainco")) /* they take long */
		return;
	urdf = read_file(path, &length);
	for (int base = RNEAGEN_FIXED; base <= RNEAGEN_FLOATING; base++) {
		o.base = (enum rneagen_base)base;
		check_model(t, urdf, length, o, name, 11, SAMPLES);
	}
	free(urdf);
}

static void report(const struct cheaper *t, const char *what)
{
	printf("%d %s: %ld flops instead of %ld; worst f64 %.2e, f32 %.2e, %.2f eps of the magnitudes summed, "
	       "%.2f of the running bound\n",
		t->errors.count, what, t->base, t->stated, t->errors.f64, t->errors.f32, t->errors.terms, t->errors.bound);
	ck_assert_int_lt(t->base, t->stated);
}

START_TEST(test_robots)
{
	const char *folder = _i ? getenv("RNEAGEN_ROBOTS") : TEST_DIR "/robots";
	struct cheaper t = {.errors.real = _i};

	if (!folder) {
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
		return;
	}
	for_each_urdf(folder, check_robot, &t);
	ck_assert_int_ge(t.errors.count, _i ? 2 * 9 : 2 * 28);
	report(&t, _i ? "models of real robots, seeds 11 and 12" : "models of own robots, seeds 11 and 12");
}
END_TEST

START_TEST(test_random_trees)
{
	struct cheaper t = {.seen = 0};

	for (uint64_t seed = 1; seed <= RANDOM_ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, 2 + (int)(seed % 16));
		struct rneagen_options o = rneagen_options_default();
		char *urdf = random_robot(seed, &knobs), what[64];

		snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
		o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		o.mimic = seed % 5 ? RNEAGEN_MIMIC_HONOUR : RNEAGEN_MIMIC_INDEPENDENT;
		o.gravity[0] = seed % 2 ? 0 : 1.5;
		check_model(&t, urdf, strlen(urdf), o, what, seed, RANDOM_SAMPLES);
		free(urdf);
	}
	report(&t, "random trees, seeds from 1");
}
END_TEST

/* Axes 1e-7 rad apart, whose common normals are 700 km away, on a chain of links of 0.1 m; the last is skew. */
static char *nearly_parallel(void)
{
	size_t size;
	char *urdf;
	FILE *f = open_memstream(&urdf, &size);

	fprintf(f, "<robot name='near'><link name='l0'/>");
	for (int i = 1; i <= 6; i++) {
		fprintf(f, "<link name='l%d'><inertial><origin xyz='0.05 0.01 0.02'/><mass value='0.3'/><inertia ixx='0.001' iyy='0.002' "
			   "izz='0.0015' ixy='0.0001' ixz='0.0002' iyz='-0.0001'/></inertial></link>", i);
		fprintf(f, "<joint name='j%d' type='continuous'><parent link='l%d'/><child link='l%d'/>"
			   "<origin xyz='0.1 0.02 0.03' rpy='%s 0 0'/><axis xyz='%s 0 1'/></joint>", i, i - 1, i, i % 2 ? "0" : "1e-7", i == 6 ? "0.3"
				: i % 3 ? "0" : "1e-7");
	}
	fprintf(f, "</robot>");
	fclose(f);
	return urdf;
}

static real length(const struct within p[3])
{
	return sqrtl(p[0].x * p[0].x + p[1].x * p[1].x + p[2].x * p[2].x);
}

/* No frame is farther from its link than twice the longest distance between joints. */
START_TEST(test_nearly_parallel)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e = {0};
	struct cheaper t = {.errors.real = 1};
	struct restatement by[16] = {0};
	char *urdf = nearly_parallel(), keeps[16] = {0};
	struct model m;
	real most = 0;

	check_model(&t, urdf, strlen(urdf), o, "near", 1, SAMPLES);
	report(&t, "robot with axes that are nearly parallel");
	model_open(&m, urdf, strlen(urdf), &o, "near");
	ck_assert_int_eq(search_params(by, &m.tree, keeps, NULL, &e), RNEAGEN_OK);
	for (int k = 0; k < m.tree.body_count; k++)
		most = fmaxl(most, length(m.tree.bodies[k].X.p));
	for (int k = 0; k < m.tree.body_count; k++)
		ck_assert_msg(length(by[k].slide) <= 2 * most, "body %d slides by %Lg m", k, length(by[k].slide));
	model_close(&m);
	free(urdf);
}
END_TEST

/* Links that are alike, turned and shifted in every direction. */
static char *alike_links(int count)
{
	size_t size;
	char *urdf;
	FILE *f = open_memstream(&urdf, &size);

	fprintf(f, "<robot name='alike'><link name='l0'/>");
	for (int i = 1; i <= count; i++) {
		fprintf(f, "<link name='l%d'><inertial><origin xyz='0.05 0.01 0.02'/><mass value='0.3'/><inertia ixx='0.001' iyy='0.002' "
			   "izz='0.0015' ixy='0.0001' ixz='0.0002' iyz='-0.0001'/></inertial></link>", i);
		fprintf(f, "<joint name='j%d' type='continuous'><parent link='l%d'/><child link='l%d'/>"
			   "<origin xyz='0.1 0.02 0.03' rpy='0.3 0.4 0.5'/><axis xyz='0 0 1'/></joint>", i, i - 1, i);
	}
	fprintf(f, "</robot>");
	fclose(f);
	return urdf;
}

/* Of the body's path, as it is. */
static long path_flops(struct model *m, int body)
{
	struct restatement by[16];
	struct tree around;
	struct path p;

	for (int k = 0; k < 16; k++)
		by[k] = (struct restatement){.turn = TURN_NONE, .ahead = TURN_NONE};
	ck_assert(tree_restate_around(&around, &m->tree, by, body, &m->arena) && path_make(&p, &around, by, body, &m->arena));
	return path_cost(&p, &by[body], &PATH_COST_UNKNOWN, NULL).flops;
}

/* Along a chain of links that are alike, paths that reach the ground grow with each link, and cost what a chain of as many
   links does; those that do not, from the eighth link on, all cost the same, and more. */
START_TEST(test_path)
{
	enum { LINKS = 12, REACHING = 7 };
	struct rneagen_options o = rneagen_options_default();
	char *urdf = alike_links(LINKS);
	struct model m;
	long before = 0, flops;

	o.scene = "params urdf\n";
	model_open(&m, urdf, strlen(urdf), &o, "alike");
	for (int k = 0; k < REACHING; k++, before = flops) {
		char *shorter = alike_links(k + 2);
		struct model alone;
		struct dag d;

		model_open(&alone, shorter, strlen(shorter), &o, "shorter");
		flops = path_flops(&m, k);
		ck_assert_int_gt(flops, before);
		torques_build(&d, &alone.tree, &alone.arena);
		ck_assert_int_eq(flops, torques_flops(&d, &alone.arena));
		model_close(&alone);
		free(shorter);
	}
	flops = path_flops(&m, REACHING);
	ck_assert_int_gt(flops, before);
	for (int k = REACHING + 1; k < LINKS - 1; k++)
		ck_assert_int_eq(path_flops(&m, k), flops);
	model_close(&m);
	free(urdf);
}
END_TEST

/* Whatever joint: the tree restated by frames that nobody would choose has the same torques. */
static void check_restated(uint64_t seed)
{
	struct random_robot_knobs knobs = random_robot_knobs(seed, 9);
	struct rneagen_options o = rneagen_options_default();
	char *urdf = random_robot(seed, &knobs);
	struct rng rng = rng_seed(seed);
	struct restatement by[64] = {0};
	struct model_error e;
	struct model m;
	struct tree other;

	o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	model_open(&m, urdf, strlen(urdf), &o, "restated");
	ck_assert_int_lt(m.tree.body_count, 64);
	for (int k = 0; k < m.tree.body_count; k++) {
		const struct body *b = &m.tree.bodies[k];

		by[k] = (struct restatement){.turn = TURN_NONE, .ahead = TURN_NONE,
			.regroup = (enum regroup)rng_below(&rng, REGROUP_COUNT)};
		for (int i = 0; i < 3; i++)
			if (restate_slides(b) && (i == b->axis || b->type == JOINT_PRISMATIC))
				by[k].slide[i] = within_exact((real)rng_uniform(&rng, -1, 1));
		if (restate_turns(b))
			by[k].turn = turn_of((struct sum){within_exact((real)rng_uniform(&rng, -1, 1)), 1},
				(struct sum){within_exact(1), 1});
		if (restate_turns(b) && b->type != JOINT_PRISMATIC)
			by[k].ahead = turn_of((struct sum){within_exact((real)rng_uniform(&rng, -1, 1)), 1},
				(struct sum){within_exact(1), 1});
	}
	ck_assert(tree_restate(&other, &m.tree, by, &m.arena));
	dag_init(&m.dag[ALGORITHM_rnea], &m.arena);
	ALGORITHMS[ALGORITHM_rnea]->build(&m.dag[ALGORITHM_rnea], &other, &m.request);
	e = model_error_f64(&m, seed, RANDOM_SAMPLES);
	ck_assert_msg(e.terms <= LIMIT_TERMS && e.bound <= 1, "seed %llu: %g eps of the magnitudes, %g of the bound",
		(unsigned long long)seed, e.terms, e.bound);
	model_close(&m);
	free(urdf);
}

START_TEST(test_restated)
{
	for (uint64_t seed = 1; seed <= 2 * RANDOM_ROBOTS; seed++)
		check_restated(seed);
	printf("%d random trees in random frames, seeds from 1\n", 2 * RANDOM_ROBOTS);
}
END_TEST

/* What is taken where the scene does not say: base parameters where they save 7.5 %, 26 of iiwa14 and 3 of a hand, or of
   gradients in doubles 7 %, 7.4 of atlas; the URDF's where constants have few digits. */
START_TEST(test_unsaid)
{
	static const struct {
		const char *robot, *scene;
		int is_base;
		enum rneagen_precision precision; /* 0: the default */
	} cases[] = {{"iiwa14", NULL, 1, 0}, {"iiwa14", "params urdf", 0, 0}, {"iiwa14", "round-constants 5", 0, 0},
		{"iiwa14", "round-constants 5\nparams base", 1, 0}, {"allegro_right", NULL, 0, 0}, {"allegro_right", "params auto", 1, 0},
		{"hyq", NULL, 1, 0}, {"hyq", "want M", 0, 0}, {"hyq", "want M\nparams base", 1, 0},
		{"atlas", "want tau,dtau_dq,dtau_dqd", 1, RNEAGEN_F64}, {"atlas", "want tau,dtau_dq,dtau_dqd", 0, RNEAGEN_F32}};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct rneagen_options o = rneagen_options_default();
		struct rneagen_error e;
		struct analysis a;
		char path[1024], *urdf;
		size_t length;

		snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", cases[i].robot);
		urdf = read_file(path, &length);
		o.scene = cases[i].scene;
		o.precision = cases[i].precision;
		ck_assert_msg(!analysis_open(&a, urdf, length, &o, &e), "%s", e.message);
		ck_assert_msg(a.params.is_base == cases[i].is_base, "%s, %s: %s", cases[i].robot, o.scene ? o.scene : "no scene",
			a.params.is_base ? "base" : "urdf");
		analysis_free(&a);
		free(urdf);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("params");
	TCase *c = tcase_create("reference");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, test_robots, 0, 2);
	tcase_add_test(c, test_random_trees);
	tcase_add_test(c, test_nearly_parallel);
	tcase_add_test(c, test_restated);
	tcase_add_test(c, test_path);
	tcase_add_test(c, test_unsaid);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
