/* --want qdd_bound: every qdd within its bound of the reference in quad precision, as evaluated and as compiled, and the bound of
   use. A rounding that the bound forgets would break it where it is the largest; a bound that is taken through all steps of the
   factors would be of no use. */
#define _POSIX_C_SOURCE 200809L
#include "forward_eval.h"
#include "support/exhaustive.h"
#include "plan/plan.h"
#include "support/numbers.h"
#include "support/read.h"
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

/* Of many samples: finite ones, the largest and the sum of logarithms of bound over error in the norm, the largest bound in the
   norm. */
struct tally {
	long samples, finite;
	double worst, over, norm;
};

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
		t->over += log(numbers_norm(n, x->bound) / (numbers_norm(n, error) + 1e-300));
		t->norm = fmax(t->norm, numbers_norm(n, x->bound) / numbers_norm(n, x->qdd));
	}
}

static void print_tally(const struct tally *t, const char *what, const struct forward_eval *x)
{
	struct operation_count c = plan_operations(&(struct plan){.dag = &x->analysis.dag});

	printf("%-36s nv %2d, %7u operations: %3.0f %% finite; error at most %.2g of a bound; bound %8.2g of the norm at most, "
		"%6.1f errors in the middle\n",
		what, x->solved.nv, plan_flops(c), 100.0 * (double)t->finite / (double)t->samples, t->worst, t->norm,
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
	snprintf(what, sizeof what, "%s %s%s", name,
		PRECISION_NAMES[s->precision == RNEAGEN_F32 ? 0 : s->precision == RNEAGEN_F64 ? 1 : 2],
		s->floating ? " floating" : "");
	if (forward_eval_open(x, urdf, reference, s, what)) {
		for (int i = 0; i < samples; i++) {
			forward_eval_run(x, &rng, more, 1);
			judge(x, &t, what);
		}
		print_tally(&t, what, x);
		forward_eval_close(x);
	}
	free(x);
	return t;
}

struct walk {
	int turn, floating, all;
};

static void check_file(const char *path, const char *name, void *context)
{
	struct walk *w = context;
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail", 5) || !strncmp(name, "chain_75", 8) ||
		(!exhaustive() && strstr("g1_29dof atlas fetch shadow_hand_right", name)))
		return;
	urdf = read_file(path, &length);
	for (int p = 0; p < 3; p++)
		if (w->all || p == w->turn % 3)
			check(urdf, NULL, &(struct forward_scene){PRECISIONS[p], w->floating, "", 0, 0, 0, 0},
				name, SAMPLES, NULL);
	w->turn++;
	free(urdf);
}

/* A precision for each robot in turn, or all for our own. */
START_TEST(own_robots)
{
	struct walk w = {.floating = _i, .all = exhaustive()};

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

/* ---- trees drawn by chance ---- */

/* Every joint has a rotor, since links without mass may be at the end; nothing follows another joint. */
static char *drawn(uint64_t seed, char **rotors)
{
	struct random_robot_knobs knobs = random_robot_knobs(seed, 9);
	struct reference *r;
	size_t size = 0;
	char message[256], *urdf;
	FILE *f;

	knobs.mimic = knobs.odd_names = knobs.floating = 0;
	urdf = random_robot(seed, &knobs);
	r = reference_open(urdf, strlen(urdf), NULL, message, sizeof message);
	f = open_memstream(rotors, &size);
	ck_assert(r && f);
	for (int j = 0; j < r->nj; j++)
		if (r->joints[j].nv == 1)
			fprintf(f, "armature %s=0.03125\n", r->joints[j].name);
	fclose(f);
	reference_close(r);
	return urdf;
}

START_TEST(random_trees)
{
	int trees = exhaustive() ? 80 : 16, finite = 0;

	for (uint64_t seed = 0; seed < (uint64_t)trees; seed++) {
		char *rotors, *urdf = drawn(seed, &rotors), name[32];
		struct forward_scene s = {PRECISIONS[seed % 2], seed / 2 % 3 == 0, rotors, 0, 0.03125Q, 0, 0};

		snprintf(name, sizeof name, "tree %d", (int)seed);
		finite += check(urdf, NULL, &s, name, 10, NULL).finite > 0;
		free(rotors);
		free(urdf);
	}
	ck_assert_int_gt(finite, trees / 2);
}
END_TEST

/* ---- what a scene adds ---- */

static char *robot(const char *name)
{
	char path[512], *urdf;
	size_t length;

	snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", name);
	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	return urdf;
}

/* 0.5 kg at (0.25, 0, -0.5) in a hand's frame, with 0.125 kg m^2 about each axis through it. */
static const double *payload(const char *name)
{
	static const double rows[] = {0.5, 0.125, 0, -0.25, 0.25, 0, 0.0625, 0.28125, 0, 0.15625};

	ck_assert_str_eq(name, "payload_iiwa_link_7");
	return rows;
}

START_TEST(carried)
{
	static const char more[] =
		"<link name='load'><inertial><origin xyz='0.25 0 -0.5'/><mass value='0.5'/><inertia ixx='0.125' iyy='0.125' "
		"izz='0.125' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='hold' type='fixed'><parent link='iiwa_link_7'/>"
		"<child link='load'/></joint></robot>";
	char *urdf = robot("iiwa14"), *loaded = calloc(1, strlen(urdf) + sizeof more), *end;

	ck_assert_ptr_nonnull(loaded);
	end = strstr(strcpy(loaded, urdf), "</robot>");
	strcpy(end, more);
	for (int p = 0; p < 3; p++)
		ck_assert_int_eq(check(urdf, loaded,
			&(struct forward_scene){PRECISIONS[p], 0, "free payload.iiwa_link_7\n", 0, 0, 0, 0},
			"iiwa14 with a payload", SAMPLES, payload).finite, SAMPLES);
	free(loaded);
	free(urdf);
}
END_TEST

/* Friction has a quotient and a root; articulated bodies make another qdd; arithmetic at its worst, of the bound too. */
START_TEST(scenes)
{
	static const struct {
		const char *robot;
		struct forward_scene scene;
	} cases[] = {{"cartpole", {RNEAGEN_F32, 0, "friction 0.25\n", 0.25Q, 0, 0, 0}},
		{"cartpole", {RNEAGEN_F64, 0, "friction 0.25\n", 0.25Q, 0, 0, 0}},
		{"hyq", {RNEAGEN_F32, 1, "dynamics articulated\n", 0, 0, 0, 0}},
		{"iiwa14", {RNEAGEN_F64, 0, "dynamics articulated\n", 0, 0, 0, 0}}, {"iiwa14", {RNEAGEN_F32, 0, "", 0, 0, 0, 1}},
		{"hyq", {RNEAGEN_F32, 1, "", 0, 0, 0, 1}}, {"cartpole", {RNEAGEN_F32, 0, "friction 0.25\n", 0.25Q, 0, 0, 1}},
		{"iiwa14", {RNEAGEN_F32, 0, "refine 1\n", 0, 0, 0, 0}}, {"hyq", {RNEAGEN_F32, 1, "refine 1\n", 0, 0, 0, 0}}};
	char *urdf = robot(cases[_i].robot);

	ck_assert_int_eq(check(urdf, NULL, &cases[_i].scene, cases[_i].robot, SAMPLES, NULL).finite, SAMPLES);
	free(urdf);
}
END_TEST

/* What a bound is worth: below 1e-6 of the norm in f64, and 1e-2 in f32, of an arm, a quadruped and a humanoid. */
START_TEST(of_use)
{
	static const struct {
		const char *robot;
		double f32, f64;
	} cases[] = {{"iiwa14", 2e-3, 4e-12}, {"hyq", 1e-4, 2e-13}, {"atlas", 6e-3, 1e-11}};
	char *urdf = robot(cases[_i].robot);

	for (int p = 0; p < 2; p++) {
		struct tally t = check(urdf, NULL, &(struct forward_scene){PRECISIONS[p], 0, "", 0, 0, 0, 0},
			cases[_i].robot, SAMPLES, NULL);

		ck_assert_int_eq(t.finite, t.samples);
		ck_assert_msg(t.norm < (p ? cases[_i].f64 : cases[_i].f32), "%s: a bound is %g of the norm",
			cases[_i].robot, t.norm);
	}
	free(urdf);
}
END_TEST

/* The first joint's acceleration is 1.25, whatever is right: the residual says so. */
START_TEST(wrong)
{
	char *urdf = robot("iiwa14");
	struct forward_eval *x = calloc(1, sizeof *x);
	struct rng rng = rng_seed(SEED);
	struct tally t = {0};
	struct dag *d;

	ck_assert(x && forward_eval_open(x, urdf, NULL, &(struct forward_scene){PRECISIONS[_i], 0, "", 0, 0, 0, 0}, "iiwa14"));
	d = &x->analysis.dag;
	for (size_t i = 0; i < d->output_count; i++)
		if (!strcmp(d->arguments[d->outputs[i].argument].name, "qdd") && d->outputs[i].row == 0)
			d->nodes[d->outputs[i].value.i] = (struct node){.op = OP_CONST, .value = 1.25L};
	for (int i = 0; i < SAMPLES; i++) {
		forward_eval_run(x, &rng, NULL, 1);
		ck_assert(x->qdd[0] == 1.25);
		judge(x, &t, "a wrong qdd");
	}
	print_tally(&t, "a wrong qdd", x);
	ck_assert_int_eq(t.finite, SAMPLES);
	forward_eval_close(x);
	free(x);
	free(urdf);
}
END_TEST

/* The evaluator's bound, whose sweeps go back through quotients and roots. */
START_TEST(swept)
{
	static const struct {
		const char *robot;
		struct forward_scene scene;
		double worth; /* of the norm */
	} cases[] = {{"iiwa14", {RNEAGEN_F32, 0, "", 0, 0, 1, 0}, 2e-3}, {"iiwa14", {RNEAGEN_F64, 0, "", 0, 0, 1, 0}, 4e-12},
		{"hyq", {RNEAGEN_F32, 1, "", 0, 0, 1, 0}, 1e-3},
		{"ur5", {RNEAGEN_F64, 0, "dynamics articulated\n", 0, 0, 1, 0}, 1e-12},
		{"mimic_chain", {RNEAGEN_MIXED, 1, "", 0, 0, 1, 0}, 1e-7},
		{"cartpole", {RNEAGEN_F32, 0, "friction 0.25\n", 0.25Q, 0, 1, 0}, 1e-4},
		{"iiwa14", {RNEAGEN_F32, 0, "", 0, 0, 1, 1}, 2e-3},
		{"cartpole", {RNEAGEN_F32, 0, "friction 0.25\n", 0.25Q, 0, 1, 1}, 1e-4}};
	char *urdf = robot(cases[_i].robot);
	struct tally t = check(urdf, NULL, &cases[_i].scene, cases[_i].robot, SAMPLES, NULL);

	ck_assert_int_eq(t.finite, SAMPLES);
	ck_assert_msg(t.norm < cases[_i].worth, "%s: a bound is %g of the norm", cases[_i].robot, t.norm);
	free(urdf);
}
END_TEST

/* ---- where there is none ---- */

/* A weight on two rods, next to stretched out: M is singular but for 1e-18 of it, or for 1e-4. */
static const char RODS[] =
	"<robot name='rods'><link name='a'/><link name='b'/><link name='c'><inertial><origin xyz='1 0 0'/><mass value='0.7'/>"
	"<inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial></link>"
	"<joint name='one' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>"
	"<joint name='two' type='revolute'><parent link='b'/><child link='c'/><origin xyz='1 0 0'/><axis xyz='0 0 1'/>"
	"<limit lower='%g' upper='%g' effort='1' velocity='1'/></joint></robot>";

START_TEST(nearly_singular)
{
	static const double limits[2][2] = {{1e-10, 1e-9}, {0.005, 0.05}};
	const double *limit = limits[_i / 2];
	char urdf[1024], stretched[1024]; /* states are drawn from the latter's limits */
	struct tally t;

	snprintf(urdf, sizeof urdf, RODS, -3.0, 3.0);
	snprintf(stretched, sizeof stretched, RODS, limit[0], limit[1]);
	t = check(urdf, stretched, &(struct forward_scene){PRECISIONS[_i % 2], 0, "", 0, 0, 0, 0}, "rods", 5 * SAMPLES, NULL);
	ck_assert_int_eq(t.samples, 5 * SAMPLES);
	ck_assert(_i < 2 ? t.finite == 0 : t.finite > t.samples / 2);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("qdd_bound");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("qdd within its bound, seed %d, %d states each\n", SEED, SAMPLES);
	suite_add(suite, "own_robots", own_robots, 2, 120);
	suite_add(suite, "real_robots", real_robots, 1, 600);
	suite_add(suite, "random_trees", random_trees, 1, 300);
	suite_add(suite, "carried", carried, 1, 60);
	suite_add(suite, "scenes", scenes, 9, 60);
	suite_add(suite, "of_use", of_use, 3, 60);
	suite_add(suite, "swept", swept, 8, 60);
	suite_add(suite, "wrong", wrong, 2, 60);
	suite_add(suite, "nearly_singular", nearly_singular, 4, 60);
	return suite_run(suite);
}
