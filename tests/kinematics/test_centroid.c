/* The same quantity of two scenes that must agree: constants or inputs, the URDF's or base parameters, alone or beside
   what it shares sums with, by factors or by articulated bodies. Would catch mass that is left at the ground, a freed
   one that one sum forgets, a column that a follower does not join, a rate that keeps the weight, two ways that do not
   mean the same frame. Prints its seed. */
#include "dag/eval.h"
#include "passes/analysis.h"
#include "support/read.h"
#include "support/rng.h"
#include "support/suite.h"
#include "tree/pattern.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 1806, STATES = 3 };

static const struct pair {
	const char *robot;
	int floats;
	const char *words; /* that are compared */
	const char *one, *other;
} PAIRS[] = {
#define MASSES "com,vcom,com_jacobian,momentum,momentum_matrix,dmomentum"
	{"iiwa14", 0, MASSES ",coriolis", "", "params base\n"},
	{"hyq", 0, MASSES ",coriolis", "", "params base\n"},
	{"hyq", 1, MASSES ",coriolis", "", "params base\n"},
	{"mimic_chain", 0, MASSES ",coriolis", "", "params base\n"},
	{"planar_tilted", 1, MASSES ",coriolis", "", "params base\n"},
	{"gantry", 0, MASSES, "", "params base\n"},
	{"panda", 0, MASSES, "free mass.panda_link4\n", ""},
	{"panda", 0, MASSES, "free inertia.panda_hand\n", "params base\n"},
	{"hyq", 1, MASSES, "free mass.trunk\nfree inertia.lf_upperleg\n", ""},
	{"iiwa14", 0, MASSES ",coriolis", "lock iiwa_joint_1=0.5\n",
		"lock iiwa_joint_1=0.5\nfree inertia.iiwa_link_3\nparams base\n"},
	{"iiwa14", 0, "momentum", "", "want momentum_matrix\n"},
	{"mimic_chain", 0, "momentum,vcom", "", "want momentum_matrix\n"},
	{"hyq", 1, "momentum,vcom", "", "want momentum_matrix,M\n"},
	{"hyq", 0, "vcom,com_jacobian", "", "want momentum\n"},
	{"iiwa14", 0, "dmomentum", "", "want tau\n"},
	{"hyq", 0, "dmomentum", "", "want tau\n"},
	{"hyq", 1, "dmomentum", "", "want tau\nfree gravity\n"},
	{"mimic_chain", 0, "dmomentum", "", "want tau\n"},
	{"hyq", 1, "dmomentum", "", "want tau\nfext lf_foot\n"},
	{"hyq", 0, "dmomentum", "lock lf_haa_joint=0.5\n", "lock lf_haa_joint=0.5\nwant tau\n"},
	{"iiwa14", 0, MASSES ",coriolis", "", "armature iiwa_joint_3=2\ndamping\n"},
	{"iiwa14", 0, "opspace_inv.iiwa_link_7,opspace.iiwa_link_7", "dynamics factor\n", "dynamics articulated\n"},
	{"iiwa14", 0, "opspace.iiwa_link_7", "dynamics factor\nframe world\n",
		"dynamics articulated\nframe world\nwant qdd\n"},
	{"hyq", 1, "opspace_inv.lf_foot,opspace.lf_foot", "dynamics factor\nframe world-aligned\n",
		"dynamics articulated\nframe world-aligned\n"},
	{"hyq", 1, "opspace_inv.lf_foot", "dynamics factor\narmature lf_kfe_joint=0.3\n",
		"dynamics articulated\narmature lf_kfe_joint=0.3\nparams base\n"},
	{"planar_tilted", 1, "coriolis", "", "derivatives forward\nwant dtau_dqd\n"},
};
enum { COUNT = sizeof PAIRS / sizeof *PAIRS };

static void open_scene(struct analysis *a, const char *urdf, int floats, const char *words, const char *more)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	char scene[512];

	snprintf(scene, sizeof scene, "want %s\n%s", words, more);
	o.base = floats ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.scene = scene;
	ck_assert_msg(!analysis_open(a, urdf, strlen(urdf), &o, &e), "%s: %s", scene, e.message);
}

/* An input is drawn by its name, so that both scenes have it; what is free is as the URDF says. */
static void draw(const struct analysis *a, const struct argument *x, int state, real *rows)
{
	struct rng r = rng_seed((uint64_t)(SEED + 100 * state + (int)strlen(x->name)));

	for (int i = 0; i < x->rows; i++)
		rows[i] = (real)rng_uniform(&r, -2, 2);
	for (int k = 0; k < a->request.freed_count; k++)
		if (!strcmp(x->name, a->request.freed[k].argument))
			memcpy(rows, a->request.freed[k].nominal, (size_t)x->rows * sizeof *rows);
	if (!strcmp(x->name, "q") && a->tree.floating)
		memcpy(rows + 3, (real[]){0.5L, -0.5L, 0.5L, 0.5L}, 4 * sizeof *rows);
}

struct values {
	real *of[DAG_ARGUMENTS];
};

static void evaluate(const struct analysis *a, int state, struct values *v)
{
	const real *in[DAG_ARGUMENTS] = {NULL};
	real *out[DAG_ARGUMENTS] = {NULL};

	for (int i = 0; i < a->dag.argument_count; i++) {
		const struct argument *x = &a->dag.arguments[i];

		v->of[i] = calloc((size_t)x->rows, sizeof(real));
		if (x->is_output) {
			out[i] = v->of[i];
		} else {
			draw(a, x, state, v->of[i]);
			in[i] = v->of[i];
		}
	}
	ck_assert(eval_real(&a->dag, in, out, NULL));
}

static void release(const struct analysis *a, struct values *v)
{
	for (int i = 0; i < a->dag.argument_count; i++)
		free(v->of[i]);
}

static double compare_want(const struct want *w, const struct analysis *a, const struct values *x,
	const struct analysis *b, const struct values *y)
{
	const real *one = x->of[dag_find_argument(&a->dag, w->argument)], *other = y->of[dag_find_argument(&b->dag, w->argument)];
	real largest = 0, off = 0;

	for (int i = 0; i < w->rows; i++) {
		ck_assert_msg(isfinite((double)one[i]) && isfinite((double)other[i]), "%s, row %d is not finite", w->word, i);
		largest = fmaxl(largest, fabsl(one[i]));
		off = fmaxl(off, fabsl(one[i] - other[i]));
	}
	ck_assert_msg(largest > 0, "%s: nothing is compared", w->word);
	return (double)(off / largest);
}

START_TEST(agree)
{
	const struct pair *p = &PAIRS[_i];
	char *urdf = robot_text(p->robot);
	struct analysis a, b;
	double worst = 0, limit = strstr(p->words, "opspace.") ? 1e-11 : 1e-15;

	open_scene(&a, urdf, p->floats, p->words, p->one);
	open_scene(&b, urdf, p->floats, p->words, p->other);
	for (int state = 0; state < STATES; state++) {
		struct values x, y;

		evaluate(&a, state, &x);
		evaluate(&b, state, &y);
		for (int i = 0; i < a.request.want_count; i++)
			worst = fmax(worst, strstr(p->words, a.request.wants[i].word) ? compare_want(&a.request.wants[i], &a,
				&x, &b, &y) : 0);
		release(&a, &x);
		release(&b, &y);
	}
	printf("%s, seed %d: %s of '%s' and '%s' are off by %.1e\n", p->robot, SEED, p->words, p->one, p->other, worst);
	ck_assert_msg(worst < limit, "%s: %s of '%s' and '%s' are off by %.1e", p->robot, p->words, p->one, p->other, worst);
	analysis_free(&a);
	analysis_free(&b);
	free(urdf);
}
END_TEST

/* Angular momentum by slides of a floating base is zero in all states, and is not stored. */
START_TEST(stored)
{
	static const struct {
		const char *robot;
		int floats, zeros;
	} robots[] = {{"hyq", 1, 9}, {"hyq", 0, 0}, {"gantry", 0, 3}, {"iiwa14", 0, 0}};
	char *urdf = robot_text(robots[_i].robot);
	struct analysis a, dense;
	struct values x;
	int nv;

	open_scene(&a, urdf, robots[_i].floats, "momentum_matrix", "");
	open_scene(&dense, urdf, robots[_i].floats, "momentum_matrix", "dense\n");
	nv = a.tree.nv;
	ck_assert_int_eq(dense.request.wants[0].rows, 6 * nv);
	ck_assert_int_eq(a.request.wants[0].rows, 6 * nv - robots[_i].zeros);
	evaluate(&dense, 0, &x);
	for (int i = 0, zeros = 0; i <= 6 * nv; i++) {
		if (i == 6 * nv)
			ck_assert_int_ge(zeros, robots[_i].zeros);
		else
			zeros += x.of[dag_find_argument(&dense.dag, "momentum_matrix")][i] == 0;
	}
	release(&dense, &x);
	analysis_free(&a);
	analysis_free(&dense);
	free(urdf);
}
END_TEST

/* Six parallel axes, which do not leave their plane. */
static void parallel_axes(char *out, size_t size, const char *axis)
{
	size_t n = (size_t)snprintf(out, size, "<robot name='flat'><link name='l0'/>");

	for (int i = 1; i <= 6; i++)
		n += (size_t)snprintf(out + n, size - n,
			"<link name='l%d'><inertial><origin xyz='0.1 0.02 0.03'/><mass value='%d'/><inertia ixx='0.2' ixy='0.01' ixz='0' iyy='0.3' "
			"iyz='0' izz='0.4'/></inertial></link><joint name='j%d' type='revolute'><parent link='l%d'/><child link='l%d'/>"
			"<origin xyz='0.3 0.05 0.17'/><axis xyz='%s'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>",
			i, i, i, i - 1, i, axis);
	snprintf(out + n, size - n, "</robot>");
}

START_TEST(never_in_all_directions)
{
	static const char *const axes[] = {"0 0 1", "0.3 0.5 0.7"};
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result text;
	struct rneagen_error e;
	char urdf[8192];

	parallel_axes(urdf, sizeof urdf, axes[_i % 2]);
	o.scene = _i < 2 ? "want opspace.l6\ndynamics factor\n" : "want opspace.l6\ndynamics articulated\n";
	ck_assert_int_eq(rneagen_generate(urdf, strlen(urdf), &o, &text, &e), RNEAGEN_TREE);
	ck_assert_msg(strstr(e.message, "do not move 'l6' in all six directions: want opspace_inv.l6") != NULL,
		"says: %s", e.message);
	o.scene = "want opspace_inv.l6\n";
	ck_assert_int_eq(rneagen_generate(urdf, strlen(urdf), &o, &text, &e), RNEAGEN_OK);
	rneagen_result_free(&text);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("centroid");

	suite_add(suite, "agree", agree, COUNT, 120);
	suite_add(suite, "stored", stored, 4, 60);
	suite_add(suite, "directions", never_in_all_directions, 4, 60);
	return suite_run(suite);
}
