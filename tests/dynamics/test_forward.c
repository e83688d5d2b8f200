/* qdd, M^-1 and derivatives of qdd of random trees and scenes, by both ways, against a solve of the independent reference in
   extended precision: a term that is lost or has the wrong sign, and what is differentiated through the qdd that is found. */
#include "test_forward.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 10 };
#define TREES (exhaustive() ? 150 : 90)

/* Of the magnitudes: the URDF's numbers are doubles, and zeros stand for the rounding of such. */
static const wide NOISE = 32 * 0x1p-53L;

/* Least scaled pivots of M: below the first, M may be taken for singular; above the other, differences say something. */
static const wide NONE = 1e-12L, FAIR = 1e-5L;

static const char *const WAYS[] = {"dynamics factor\nderivatives forward\n",
	"dynamics articulated\nderivatives recursion\nparams base\n", "dynamics factor\nderivatives recursion\nparams base\n",
	"dynamics articulated\nderivatives forward\n"};

/* Of what is solved with M, and above truncation and rounding of the reference's differences. */
static wide solved(const struct forward_case *f, wide size)
{
	return size * (1e-12L + 1e-14L / f->pivot);
}

static wide differed(const struct forward_case *f, wide size)
{
	return size * (1e-8L + 1e-12L / f->pivot);
}

static void fail_at(const struct forward_case *f, const char *name, int i, int j, real got, wide want, wide off)
{
	ck_abort_msg("%s: %s[%d][%d] is %.15Lg, not %.15Lg (%.3Lg allowed); scene:\n%s", f->what, name, i, j, got, (real)want, (real)off,
		f->c->scene);
}

static void compare(const struct forward_case *f, const char *name, int i, int j, real got, wide want, wide off)
{
	if (!(fabsl(got - (real)want) <= (real)off))
		fail_at(f, name, i, j, got, want, off);
}

/* ---- qdd and the inverse ---- */

/* |qdd - ref| <= |X| e S, with S the magnitudes of ID(q, qd, qdd). */
static void check_qdd(struct forward_case *f)
{
	struct task_case *c = f->c;
	double q[ROWS], qdd[ROWS];
	wide size[ROWS];

	for (int i = 0; i < c->r->nq; i++)
		q[i] = (double)f->q[i];
	for (int i = 0; i < c->r->nv; i++)
		qdd[i] = (double)f->qdd[i];
	reference_magnitude(c->r, q, c->qd, qdd, size);
	for (int i = 0; i < f->nv; i++) {
		wide off = 0;

		for (int j = 0; j < f->nv; j++)
			off += NOISE * wide_abs(forward_case_at(f, f->X, i, j)) * (size[f->from[j]] + wide_abs(f->tau[f->from[j]]));
		compare(f, "qdd", i, 0, f->out[OUT_QDD][i], f->qdd[f->from[i]], off);
	}
}

/* |X - ref| <= |X| e S |X|, with S the magnitudes of M's columns. */
static void check_inverse(struct forward_case *f)
{
	static const double zero[ROWS];
	double q[ROWS], unit[ROWS] = {0};
	wide (*S)[ROWS] = calloc(MOST, sizeof *S), off;

	for (int i = 0; i < f->c->r->nq; i++)
		q[i] = (double)f->q[i];
	for (int l = 0; l < f->nv; l++) {
		unit[f->from[l]] = 1;
		reference_magnitude(f->c->r, q, zero, unit, S[l]);
		unit[f->from[l]] = 0;
	}
	for (int i = 0; i < f->nv; i++)
		for (int j = 0; j < f->nv; j++) {
			off = 0;
			for (int k = 0; k < f->nv; k++)
				for (int l = 0; l < f->nv; l++)
					off += NOISE * wide_abs(forward_case_at(f, f->X, i, k) * S[l][f->from[k]] * forward_case_at(f, f->X, l, j));
			compare(f, "Minv", i, j, f->out[OUT_MINV][i * f->nv + j], forward_case_at(f, f->X, i, j), off);
			ck_assert(f->out[OUT_MINV][i * f->nv + j] == f->out[OUT_MINV][j * f->nv + i]);
		}
	free(S);
}

/* ---- derivatives ---- */

static wide largest(const struct forward_case *f, const wide *matrix)
{
	wide most = 1;

	for (int i = 0; i < f->nv; i++)
		for (int j = 0; j < f->nv; j++)
			most = wide_abs(forward_case_at(f, matrix, i, j)) > most ? wide_abs(forward_case_at(f, matrix, i, j)) : most;
	for (int i = 0; i < f->nv; i++)
		most = wide_abs(f->qdd[f->from[i]]) > most ? wide_abs(f->qdd[f->from[i]]) : most;
	return most;
}

static void check_matrices(struct forward_case *f)
{
	static const int outs[4] = {OUT_DQ, OUT_DQD, OUT_TAU_DQ, OUT_TAU_DQD};
	static const char *const names[4] = {"dqdd_dq", "dqdd_dqd", "dtau_dq", "dtau_dqd"};

	for (int m = 0; m < 4; m++)
		for (int i = 0; i < f->nv; i++)
			for (int j = 0; j < f->nv; j++)
				compare(f, names[m], i, j, f->out[outs[m]][i * f->nv + j], forward_case_at(f, f->D[m], i, j),
					differed(f, largest(f, f->D[m])));
}

/* jvp = (d qdd/d q) v_q + (d qdd/d qd) v_qd + X v_tau, and vjp = lambda^T of the same matrices, which
   differences have checked. */
static void check_products(struct forward_case *f)
{
	const real *blocks[3] = {f->out[OUT_DQ], f->out[OUT_DQD], f->out[OUT_MINV]};
	int n = f->nv;

	for (int i = 0; i < n; i++) {
		wide sum = 0, size = 0;

		for (int k = 0; k < 3 * n; k++) {
			sum += (wide)blocks[k / n][i * n + k % n] * (wide)f->v[k];
			size += wide_abs((wide)blocks[k / n][i * n + k % n]);
		}
		compare(f, "jvp", i, 0, f->out[OUT_JVP][i], sum, solved(f, size));
	}
	for (int k = 0; k < 3 * n; k++) {
		wide sum = 0, size = 0;

		for (int i = 0; i < n; i++) {
			sum += (wide)blocks[k / n][i * n + k % n] * (wide)f->lambda[i];
			size += wide_abs((wide)blocks[k / n][i * n + k % n]);
		}
		for (int i = 0; i < n * n; i++) /* forward mode and recursion round in other places */
			size += 1e-3L * wide_abs((wide)blocks[k / n][i]);
		compare(f, "vjp", k, 0, f->out[OUT_VJP][k], sum, solved(f, size));
	}
}

/* lambda . jvp(v) = vjp(lambda) . v */
static void check_transposed(struct forward_case *f)
{
	wide sum = 0, size = 0;

	for (int i = 0; i < f->nv; i++) {
		sum += (wide)f->lambda[i] * f->out[OUT_JVP][i];
		size += wide_abs((wide)f->out[OUT_JVP][i]);
	}
	for (int k = 0; k < 3 * f->nv; k++) {
		sum -= (wide)f->v[k] * f->out[OUT_VJP][k];
		size += wide_abs((wide)f->out[OUT_VJP][k]);
	}
	compare(f, "jvp - vjp", 0, 0, (real)sum, 0, solved(f, size));
}

/* ---- by what is freed: ID is linear in it, so d qdd = -X (ID(p + 1) - ID(p)) at this qdd ---- */

static int entry_of_link(const struct task_case *c, const char *link)
{
	int e = 0;

	while (strcmp(c->r->joints[e].link, link))
		e++;
	return e;
}

/* One more unit of a mass at its centre of mass. */
static void add_mass(const struct task_case *c, int entry, wide *p)
{
	const struct raw_link *l = c->oracle.raw.links;
	wide r[3];

	while (strcmp(l->name, c->r->joints[entry].link))
		l++;
	for (int i = 0; i < 3; i++)
		r[i] = l->xyz[i];
	p[0] += 1;
	for (int i = 0, k = 4; i < 3; i++) {
		p[1 + i] += r[i];
		for (int j = i; j < 3; j++, k++)
			p[k] += (i == j ? r[0] * r[0] + r[1] * r[1] + r[2] * r[2] : 0) - r[i] * r[j];
	}
}

/* Whose term a row is: that of a joint that is named, or that has the row alone; -1: nobody's. */
static int entry_of_own(const struct forward_case *f, const struct task_in *in, int row)
{
	const struct reference *r = f->c->r;

	if (!in->is_of_all)
		return entry_named(r, strchr(in->word, '.') + 1);
	for (int e = 0; e < r->nj; e++)
		if (r->joints[e].nq == 1 && r->joints[e].iv == f->from[row])
			return e;
	return -1;
}

static void torques_with_own(const struct forward_case *f, const struct task_in *in, enum task_term term, int row, wide *tau)
{
	int entry = entry_of_own(f, in, row);

	if (entry >= 0) {
		*case_own(f->c, term, entry) += 1;
		reference_set_own(f->c->r, entry, &f->c->own[entry]);
	}
	reference_rnea_wide(f->c->r, f->q, f->qd, f->qdd, tau);
	if (entry >= 0) {
		*case_own(f->c, term, entry) -= 1;
		reference_set_own(f->c->r, entry, &f->c->own[entry]);
	}
}

static void torques_with(struct task_case *c, const struct forward_case *f, const struct task_in *in, int row, wide *tau)
{
	const char *word = in->word;
	enum task_term term;
	const char *name = strchr(word, '.') ? strchr(word, '.') + 1 : "";
	int entry;
	wide was[10], p[10];

	if (task_is_own(in, &term)) {
		torques_with_own(f, in, term, row, tau);
		return;
	}
	if (!strcmp(word, "gravity")) {
		c->r->gravity[row] += 1;
		reference_rnea_wide(c->r, f->q, f->qd, f->qdd, tau);
		c->r->gravity[row] -= 1;
		return;
	}
	entry = entry_of_link(c, name);
	reference_inertia(c->r, entry, was);
	memcpy(p, was, sizeof p);
	if (!strncmp(word, "mass.", 5))
		add_mass(c, entry, p);
	else
		p[row] += 1;
	reference_set_inertia(c->r, entry, p);
	reference_rnea_wide(c->r, f->q, f->qd, f->qdd, tau);
	reference_set_inertia(c->r, entry, was);
}

/* An offset is added to q. */
static wide by_offset(const struct forward_case *f, const char *word, int i)
{
	int j = 0, row = f->c->r->joints[entry_named(f->c->r, strchr(word, '.') + 1)].iv;

	while (f->from[j] != row)
		j++;
	return forward_case_at(f, f->D[0], i, j);
}

static int check_freed(struct forward_case *f, int which)
{
	const struct task_in *in = &f->c->in[which];
	wide tau[ROWS], with[ROWS];
	int is_offset = !strncmp(in->word, "offset.", 7);

	if (in->is_push)
		return 0;
	reference_rnea_wide(f->c->r, f->q, f->qd, f->qdd, tau);
	for (int k = 0; k < in->rows; k++) {
		if (!is_offset)
			torques_with(f->c, f, in, k, with);
		for (int i = 0; i < f->nv; i++) {
			wide sum = 0, size = 1;

			for (int j = 0; j < f->nv && !is_offset; j++) {
				sum -= forward_case_at(f, f->X, i, j) * (with[f->from[j]] - tau[f->from[j]]);
				size += wide_abs(forward_case_at(f, f->X, i, j)) * (wide_abs(with[f->from[j]]) + wide_abs(tau[f->from[j]]));
			}
			compare(f, in->word, i, k, f->freed[which][i * in->rows + k], is_offset ? by_offset(f, in->word, i) : sum,
				is_offset ? differed(f, largest(f, f->D[0])) : solved(f, size));
		}
	}
	return 1;
}

/* ---- trees ---- */

struct tally {
	int trees, fair, refused, mimic, freed, left_out;
};

static int has_followers(const struct forward_case *f)
{
	for (int j = 0; j < f->c->r->nj; j++)
		if (f->c->r->joints[j].driver != j)
			return 1;
	return 0;
}

static void check(struct forward_case *f, struct tally *t)
{
	enum rneagen_code code = forward_case_evaluate(f);

	forward_case_refer(f, 0);
	if (code) {
		ck_assert_msg(code == RNEAGEN_NO_JOINTS || f->pivot < NONE, "%s: %s; scene:\n%s", f->what, f->m.error.message, f->c->scene);
		t->refused++;
		return;
	}
	if (f->pivot < NONE)
		return;
	check_qdd(f);
	check_inverse(f);
	t->trees++;
	t->mimic += has_followers(f);
	t->left_out += forward_case_left_out(f);
	if (f->pivot < FAIR)
		return;
	free(f->X);
	forward_case_refer(f, 1);
	check_matrices(f);
	check_products(f);
	check_transposed(f);
	t->fair++;
	for (int i = 0; i < f->c->in_count; i++)
		t->freed += check_freed(f, i);
}

START_TEST(trees)
{
	struct tally t = {0};

	for (uint64_t seed = 8000; seed < 8000 + (uint64_t)TREES; seed++) {
		char what[64];
		const char *way = WAYS[seed % 4];
		struct forward_case *f;

		snprintf(what, sizeof what, "seed %d", (int)seed);
		f = forward_case_random(seed, LINKS, "", what);
		if (!f)
			continue;
		case_say(f->c, "%s", has_followers(f) ? strchr(way, '\n') + 1 : way);
		check(f, &t);
		scene_close(&f->m);
		forward_case_close(f);
	}
	printf("seeds 8000 to %d: %d trees, %d with derivatives, %d with followers, %d refused as singular; by %d freed constants\n",
		8000 + TREES - 1, t.trees, t.fair, t.mimic, t.refused, t.freed);
	ck_assert(t.left_out > TREES && t.trees > TREES / 2 && t.fair > TREES / 4 && t.freed > TREES / 10);
}
END_TEST

/* ---- one sample's mass ---- */

static const char SLIDES[] =
	"<robot name='r'><link name='rail'/><link name='cart'><inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='1' "
	"ixy='0' ixz='0' iyz='0'/>"
	"</inertial></link><link name='tool'><inertial><mass value='1'/><inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' "
	"iyz='0'/></inertial></link>"
	"<joint name='a' type='prismatic'><parent link='rail'/><child link='cart'/><axis xyz='1 0 0'/><limit effort='1' "
	"velocity='1' lower='-1' upper='1'/></joint>"
	"<joint name='b' type='prismatic'><parent link='cart'/><child link='tool'/><axis xyz='0.6 0 0.8'/><limit effort='1' "
	"velocity='1' lower='-1' upper='1'/></joint></robot>";

/* qdd of both joints for a mass of the tool: not finite where it is nothing, and else M qdd = tau. */
START_TEST(freed_mass)
{
	struct rneagen_options o = rneagen_options_default();
	char scene[128];
	struct scene_model m;

	snprintf(scene, sizeof scene, "free mass.tool\nwant qdd\nfold gravity=0,0,0\ndynamics %s\n", _i ? "factor" : "articulated");
	o.scene = scene;
	ck_assert_msg(!scene_open(&m, SLIDES, &o), "%s", m.error.message);
	for (int empty = 0; empty < 2; empty++) {
		double mass = empty ? 0 : 0.5, in[2] = {0}, tau[2] = {1, 0.25}, qdd[2];

		ck_assert(eval_f64(&m.dag, (const double *[]){in, in, tau, &mass, NULL}, (double *[]){NULL, NULL, NULL, NULL, qdd}, NULL));
		if (empty) {
			ck_assert_msg(!isfinite(qdd[1]), "%g of a joint that moves nothing", qdd[1]);
			continue;
		}
		ck_assert_double_eq_tol(2.5 * qdd[0] + 0.3 * qdd[1], 1, 1e-15);
		ck_assert_double_eq_tol(0.3 * qdd[0] + 0.5 * qdd[1], 0.25, 1e-15);
	}
	scene_close(&m);
}
END_TEST

/* ---- the cheaper way ---- */

static size_t operations_by(const char *urdf, enum rneagen_base base, const char *want, const char *way)
{
	struct rneagen_options o = rneagen_options_default();
	char scene[64];
	struct scene_model m;
	size_t n;

	snprintf(scene, sizeof scene, "want %s\ndynamics %s\n", want, way);
	o.scene = scene;
	o.base = base;
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s", m.error.message);
	n = operation_total(&m);
	scene_close(&m);
	return n;
}

/* Factors where branches are short, articulated bodies where they are long. */
START_TEST(cheaper)
{
	static const char *const robots[] = {"iiwa14", "hyq", "chain_75"};
	size_t factor, articulated, taken;
	char *urdf = robot_text(robots[_i]);

	factor = operations_by(urdf, RNEAGEN_FIXED, "qdd", "factor");
	articulated = operations_by(urdf, RNEAGEN_FIXED, "qdd", "articulated");
	taken = operations_by(urdf, RNEAGEN_FIXED, "qdd", "auto");
	printf("%s: %zu operations by factors, %zu by articulated bodies\n", robots[_i], factor, articulated);
	ck_assert_int_eq(articulated < factor, _i == 2);
	ck_assert_uint_eq(taken, articulated < factor ? articulated : factor);
	free(urdf);
}
END_TEST

/* tau is there: its power takes a sum of products, and no torques anew. */
START_TEST(power_of_inputs)
{
	char *urdf = robot_text("iiwa14");
	size_t alone = operations_by(urdf, RNEAGEN_FIXED, "qdd", "auto"), both = operations_by(urdf, RNEAGEN_FIXED, "qdd,power", "auto");

	ck_assert_uint_le(both, alone + 2 * 7);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("forward");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "trees", trees, 1, 300);
	suite_add(suite, "a mass of nothing", freed_mass, 2, 60);
	suite_add(suite, "the cheaper way", cheaper, 3, 60);
	suite_add(suite, "power", power_of_inputs, 1, 60);
	return suite_run(suite);
}
