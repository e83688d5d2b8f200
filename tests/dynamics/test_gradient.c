/* Derivatives of the torques and the mass matrix, against differences of the independent reference in extended precision,
   over random trees and the robots of this folder. */
#include "support/exhaustive.h"
#include "support/model.h"
#include "tree/pattern.h"
#include "reference/differences.h"
#include "support/torque.h"
#include "support/suite.h"
#include "test_gradient.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 9, SMALL_ROWS = 40 };
#define TREES (exhaustive() ? 60 : 36)

/* Above truncation and rounding of the reference's differences. */
static const double TOLERANCE = 2e-9;

/* One robot with one state: the model that gives, and what the differences say. */
struct probe {
	struct model m;
	const char *what;
	int nq, nv;
	double q[ROWS], qd[ROWS], qdd[ROWS];
	wide dq[SMALL_ROWS][SMALL_ROWS], dqd[SMALL_ROWS][SMALL_ROWS], M[SMALL_ROWS][SMALL_ROWS]; /* [torque][by] */
	double scale; /* the largest of the torques and of all elements */
};

/* ---- the reference's ---- */

static void grow(double *scale, wide x)
{
	*scale = fmax(*scale, fabs((double)x));
}

/* The reference's matrices, which are nv x nv. */
static void unpack(struct probe *p)
{
	size_t size = (size_t)p->nv * (size_t)p->nv;
	wide *x = calloc(3 * size + REFERENCE_WORK(p->m.reference), sizeof *x);

	reference_differences(p->m.reference, p->q, p->qd, p->qdd, x, x + size, x + 2 * size, x + 3 * size);
	for (int i = 0; i < p->nv; i++)
		for (int j = 0; j < p->nv; j++) {
			size_t e = (size_t)(i * p->nv + j);

			p->dq[i][j] = x[e];
			p->dqd[i][j] = x[size + e];
			p->M[i][j] = x[2 * size + e];
		}
	free(x);
}

static void probe_differences(struct probe *p)
{
	wide tau[ROWS];

	reference_rnea(p->m.reference, p->q, p->qd, p->qdd, tau);
	p->scale = 1e-3;
	unpack(p);
	for (int j = 0; j < p->nv; j++)
		grow(&p->scale, tau[j]);
	for (int i = 0; i < p->nv; i++)
		for (int j = 0; j < p->nv; j++) {
			grow(&p->scale, p->dq[i][j]);
			grow(&p->scale, p->dqd[i][j]);
			grow(&p->scale, p->M[i][j]);
		}
}

/* ---- the generator's ---- */

static const real *input(const struct probe *p, const char *name, real *to, const real *v)
{
	const double *from = !strcmp(name, "q") ? p->q : !strcmp(name, "qd") ? p->qd : !strcmp(name, "qdd") ? p->qdd : NULL;

	for (int i = 0; from && i < (from == p->q ? p->nq : p->nv); i++)
		to[i] = from[i];
	return from ? to : v;
}

/* Evaluate; out[i] gets the rows of the i-th output, v is what jvp_v and vjp_v are. */
static void evaluate(const struct probe *p, const real *v, real *const *out)
{
	const struct dag *d = &p->m.dag[ALGORITHM_rnea];
	const real *in[DAG_ARGUMENTS] = {NULL};
	real *to[DAG_ARGUMENTS] = {NULL}, *rows = calloc(3 * ROWS, sizeof *rows);
	int next = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output)
			to[i] = out[next++];
		else
			in[i] = input(p, d->arguments[i].name, rows + (size_t)(i % 3) * ROWS, v);
	ck_assert(eval_real(d, in, to, NULL));
	free(rows);
}

static void compare(const struct probe *p, const char *name, int i, int j, real got, wide want, wide size)
{
	ck_assert_msg(fabs((double)(got - want)) <= TOLERANCE * (double)size, "%s: %s[%d][%d] is %.12Lg, not %.12Lg",
		p->what, name, i, j, got, (real)want);
}

static void probe_open(struct probe *p, const char *urdf, struct rneagen_options *o, const char *scene, const char *what)
{
	o->scene = scene;
	model_open(&p->m, urdf, strlen(urdf), o, what);
	p->what = what;
	p->nq = p->m.tree.nq;
	p->nv = p->m.tree.nv;
}

/* All matrices with their zeros, and M symmetric; made as `derivatives` says. */
static void check_dense(struct probe *p, const char *urdf, struct rneagen_options *o, const char *derivatives, const char *params,
	const char *what)
{
	size_t size = SMALL_ROWS * SMALL_ROWS;
	char scene[80];
	real *x = calloc(3 * size, sizeof *x);
	int nv;

	snprintf(scene, sizeof scene, "want dtau_dq,dtau_dqd,M\ndense\nderivatives %s\nparams %s\n", derivatives, params);
	probe_open(p, urdf, o, scene, what);
	nv = p->nv;
	evaluate(p, NULL, (real *[]){x, x + size, x + 2 * size});
	for (int i = 0; i < nv; i++)
		for (int j = 0; j < nv; j++) {
			compare(p, "dtau_dq", i, j, x[i * nv + j], p->dq[i][j], p->scale);
			compare(p, "dtau_dqd", i, j, x[size + (size_t)(i * nv + j)], p->dqd[i][j], p->scale);
			compare(p, "M", i, j, x[2 * size + (size_t)(i * nv + j)], p->M[i][j], p->scale);
		}
	free(x);
	model_close(&p->m);
}

/* What is not stored is zero, and what is has its place: row by row, of M the lower triangle. */
static void check_packed(struct probe *p, const char *urdf, struct rneagen_options *o, const char *what)
{
	size_t size = SMALL_ROWS * SMALL_ROWS;
	real *x = calloc(2 * size, sizeof *x);
	const struct request *k;
	struct pattern full, low;

	probe_open(p, urdf, o, "want M,dtau_dq\n", what);
	k = &p->m.request;
	ck_assert(pattern_make(&full, &p->m.tree, 0, 0, &p->m.arena) && pattern_make(&low, &p->m.tree, 1, 0, &p->m.arena));
	ck_assert_int_eq(k->wants[0].rows, low.rows);
	ck_assert_int_eq(k->wants[1].rows, full.rows);
	evaluate(p, NULL, (real *[]){x, x + size});
	for (int i = 0; i < p->nv; i++)
		for (int j = 0; j < p->nv; j++) {
			int at = full.row[i * p->nv + j], at_low = low.row[i * p->nv + j];

			ck_assert(at_low < 0 || j <= i);
			compare(p, "packed dtau_dq", i, j, at < 0 ? 0 : x[size + (size_t)at], p->dq[i][j], p->scale);
			if (j <= i)
				compare(p, "packed M", i, j, at_low < 0 ? 0 : x[at_low], p->M[i][j], p->scale);
		}
	free(x);
	model_close(&p->m);
}

/* The matrices times v, and v times the matrices. */
static void check_products(struct probe *p, const char *urdf, struct rneagen_options *o, struct rng *rng, const char *what)
{
	real *v = calloc(3 * SMALL_ROWS, sizeof *v), *x = calloc(4 * SMALL_ROWS, sizeof *x), *y = x + SMALL_ROWS;
	wide sum[4];
	int nv;

	probe_open(p, urdf, o, "want jvp,vjp\n", what);
	nv = p->nv;
	for (int i = 0; i < 3 * nv; i++)
		v[i] = rng_uniform(rng, -1, 1);
	evaluate(p, v, (real *[]){x, y});
	for (int i = 0; i < nv; i++) {
		memset(sum, 0, sizeof sum);
		for (int j = 0; j < nv; j++) {
			sum[0] += p->dq[i][j] * v[j] + p->dqd[i][j] * v[nv + j] + p->M[i][j] * v[2 * nv + j];
			sum[1] += p->dq[j][i] * v[j];
			sum[2] += p->dqd[j][i] * v[j];
			sum[3] += p->M[j][i] * v[j];
		}
		compare(p, "jvp", i, 0, x[i], sum[0], p->scale * 3 * nv);
		for (int k = 0; k < 3; k++)
			compare(p, "vjp", i, k, y[k * nv + i], sum[1 + k], p->scale * nv);
	}
	free(v);
	free(x);
	model_close(&p->m);
}

static void check(const char *urdf, struct rneagen_options *o, uint64_t seed, const char *what)
{
	struct probe *p = calloc(1, sizeof *p);
	struct rng rng = rng_seed(seed);

	probe_open(p, urdf, o, NULL, what);
	if (p->nv <= SMALL_ROWS) {
		reference_sample(p->m.reference, &rng, false, p->q, p->qd, p->qdd);
		probe_differences(p);
		model_close(&p->m);
		check_dense(p, urdf, o, "forward", "urdf", what);
		check_dense(p, urdf, o, "recursion", "urdf", what);
		check_dense(p, urdf, o, "recursion", "base", what);
		check_packed(p, urdf, o, what);
		check_products(p, urdf, o, &rng, what);
	} else {
		model_close(&p->m);
	}
	free(p);
}

START_TEST(test_trees)
{
	struct rneagen_options o = rneagen_options_default();
	uint64_t seed = 700 + (uint64_t)_i;
	char *urdf = torque_robot(seed, LINKS, _i % 4 ? 0 : ALWAYS_MIMIC), what[64];
	struct rneagen_result r;
	struct rneagen_error e;

	snprintf(what, sizeof what, "seed %d", (int)seed);
	o.base = _i % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	if (!rneagen_generate(urdf, strlen(urdf), &o, &r, &e)) {
		rneagen_result_free(&r);
		check(urdf, &o, seed, what);
	} else {
		ck_assert_int_eq(e.code, RNEAGEN_NO_JOINTS);
	}
	free(urdf);
}
END_TEST

static const char *const robots[] = {"iiwa14", "panda", "hyq", "planar_joint", "planar_tilted", "floating_joint", "mimic_chain",
	"prismatic_skew"};

START_TEST(test_robots)
{
	struct rneagen_options o = rneagen_options_default();
	char *urdf = robot_text(robots[_i]);

	for (int floating = 0; floating < 2; floating++) {
		o.base = floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
		check(urdf, &o, 40 + (uint64_t)_i, robots[_i]);
	}
	free(urdf);
}
END_TEST

/* By what is freed, the torque being linear in it: the identification's regressor times the parameters is what they add. */
START_TEST(test_freed)
{
	struct rneagen_options o = rneagen_options_default();
	struct probe *p = calloc(1, sizeof *p);
	struct rng rng = rng_seed(5);
	real v[FREED_ROWS], tau[SMALL_ROWS], none[SMALL_ROWS], Y[SMALL_ROWS * FREED_ROWS];
	size_t length;
	char *urdf = read_file(TEST_DIR "/robots/iiwa14.urdf", &length);

	probe_open(p, urdf, &o, "free payload.iiwa_link_6\nwant tau,dtau_dpayload.iiwa_link_6\n", "iiwa14");
	reference_sample(p->m.reference, &rng, false, p->q, p->qd, p->qdd);
	for (int i = 0; i < FREED_ROWS; i++)
		v[i] = rng_uniform(&rng, 0.1, 1);
	evaluate(p, v, (real *[]){tau, Y});
	evaluate(p, (real[FREED_ROWS]){0}, (real *[]){none, Y});
	for (int i = 0; i < p->nv; i++) {
		real sum = none[i];

		for (int j = 0; j < FREED_ROWS; j++)
			sum += Y[i * FREED_ROWS + j] * v[j];
		compare(p, "regressor", i, 0, sum, tau[i], 1);
	}
	model_close(&p->m);
	free(p);
	free(urdf);
}
END_TEST

/* ---- with joints' own terms, external wrenches and a freed payload ---- */

static const struct {
	const char *robot, *scene;
} TERMS[] = {
	{"iiwa14", "damping\nfriction 0.3\narmature iiwa_joint_3=0.2\n"},
	{"iiwa14", "fext iiwa_link_5\n"},
	{"iiwa14", "fext iiwa_link_5\nfext-frame world\n"},
	{"iiwa14", "free payload.iiwa_link_6\n"},
	{"mimic_chain", "damping\nfriction 0.2\narmature pinion=0.1\n"},
	{"hyq", "fext lf_foot,lf_hipassembly\n"},
	{"panda", "free offset.panda_joint4\ndamping\n"},
};

/* The matrices of a scene, made in a way, beside differences of the torques of the same scene, which other tests hold against the
   reference. */
static void check_terms(const char *urdf, const char *terms, const char *how, struct rng *rng)
{
	struct rneagen_options o = rneagen_options_default();
	struct probe *p = calloc(1, sizeof *p);
	real *x = calloc(3 * ROWS + 4 * ROWS * ROWS, sizeof *x), *tau[2] = {x, x + ROWS}, *v = x + 2 * ROWS, *to[3];
	const real h = 1e-5L;
	char scene[400];

	for (int i = 0; i < 3; i++)
		to[i] = x + 3 * ROWS + (size_t)i * ROWS * ROWS;
	for (int i = 0; i < ROWS; i++)
		v[i] = rng_uniform(rng, -1, 1);
	snprintf(scene, sizeof scene, "%swant dtau_dq,dtau_dqd,M\ndense\nderivatives %s\n", terms, how);
	probe_open(p, urdf, &o, scene, terms);
	for (int i = 0; i < p->nv; i++) {
		p->q[i] = rng_uniform(rng, -2, 2);
		p->qd[i] = rng_uniform(rng, -1, 1);
		p->qdd[i] = rng_uniform(rng, -3, 3);
	}
	evaluate(p, v, to);
	model_close(&p->m);
	snprintf(scene, sizeof scene, "%swant tau\n", terms);
	probe_open(p, urdf, &o, scene, terms);
	for (int b = 0; b < 3; b++) {
		double *state = b == 0 ? p->q : b == 1 ? p->qd : p->qdd;

		for (int j = 0; j < p->nv; j++) {
			double at = state[j];

			for (int side = 0; side < 2; side++) {
				state[j] = at + (side ? -1 : 1) * (double)h;
				evaluate(p, v, (real *[]){tau[side]});
			}
			state[j] = at;
			for (int i = 0; i < p->nv; i++)
				compare(p, how, i, j, to[b][i * p->nv + j], (tau[0][i] - tau[1][i]) / (2 * h), 100);
		}
	}
	model_close(&p->m);
	free(x);
	free(p);
}

START_TEST(test_terms)
{
	struct rng rng = rng_seed(900 + (uint64_t)_i);
	char *urdf = robot_text(TERMS[_i].robot);

	for (int k = 0; k < 4; k++)
		check_terms(urdf, TERMS[_i].scene, k % 2 ? "forward" : "recursion", &rng);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("gradient");

	suite_add(s, "trees", test_trees, TREES, 120);
	suite_add(s, "robots", test_robots, (int)(sizeof robots / sizeof *robots), 120);
	suite_add(s, "terms", test_terms, (int)(sizeof TERMS / sizeof *TERMS), 120);
	suite_add(s, "freed", test_freed, 1, 120);
	suite_add_tcase(s, gradient_refused());
	return suite_run(s);
}
