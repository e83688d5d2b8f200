/* What rnearun report and choose judge by: the states that they draw and the torques that they compare with, against the
   independent reference in extended precision; and their arithmetic of errors, against the same computed here. */
#define _DEFAULT_SOURCE /* M_PI */
#include "dag/eval.h"
#include "judged.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 100, SEED = 20261121 };

#define ROBOTS TEST_DIR "/robots/"

static const struct {
	const char *urdf;
	enum rneagen_base base;
} CASES[] = {{ROBOTS "iiwa14.urdf", RNEAGEN_FIXED}, {ROBOTS "panda.urdf", RNEAGEN_FIXED}, {ROBOTS "hyq.urdf", RNEAGEN_FLOATING}};

enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

static const struct draw_options OPTIONS = {.seed = SEED, .count = COUNT};

static void open_case(struct judged *f, int i, enum rneagen_precision precision)
{
	judged_open(f, CASES[i].urdf, CASES[i].base, NULL, precision, &OPTIONS);
}

/* The reference's torques of state k; returns their norm. */
static double refer(struct judged *f, size_t k, wide *tau)
{
	const struct states s = states_of(&f->judge.inputs);
	double sum = 0;

	reference_rnea(f->model.reference, s.q + k * s.nq, s.qd + k * s.nv, s.qdd + k * s.nv, tau);
	for (size_t i = 0; i < s.nv; i++)
		sum += (double)(tau[i] * tau[i]);
	return sqrt(sum);
}

/* The judge's torques are the reference's, for rounded states too. */
START_TEST(test_reference)
{
	struct judged f;
	wide tau[64];
	double worst = 0;

	open_case(&f, _i / 2, _i % 2 ? RNEAGEN_F32 : RNEAGEN_F64);
	for (size_t k = 0; k < COUNT; k++) {
		double size = refer(&f, k, tau);

		for (size_t i = 0; i < f.judge.rows; i++)
			worst = fmax(worst, fabs((double)((wide)f.judge.out[k * f.judge.rows + i] - tau[i])) / size);
	}
	ck_assert_msg(worst < 1e-17, "%s: off by %g, seed %d", CASES[_i / 2].urdf, worst, SEED);
	judged_close(&f);
}
END_TEST

static void assert_within(const struct joint *j, double q, double qd)
{
	int angle = j->type == JOINT_REVOLUTE && j->has_limits && j->lower < j->upper;

	ck_assert_msg(q >= (angle ? j->lower : -M_PI) && q <= (angle ? j->upper : M_PI), "%s: q = %g", j->name, q);
	ck_assert_msg(fabs(qd) <= (j->has_limits && j->velocity > 0 ? j->velocity : 3), "%s: qd = %g", j->name, qd);
}

/* Within the limits, and all over them; single precision where the numbers in memory are. */
START_TEST(test_states)
{
	struct judged f;
	struct states s;
	double most = 0;

	open_case(&f, _i, RNEAGEN_F64);
	s = states_of(&f.judge.inputs);
	for (size_t k = 0; k < COUNT; k++)
		for (int i = 0; i < f.analysis.tree.joint_count; i++) {
			const struct tree_joint *t = &f.analysis.tree.joints[i];
			const double *q = s.q + k * s.nq + t->iq;

			if (t->type == JOINT_FLOATING)
				ck_assert_double_eq_tol(q[3] * q[3] + q[4] * q[4] + q[5] * q[5] + q[6] * q[6], 1, 1e-15);
			else
				assert_within(tree_joint_of(&f.analysis.robot, &f.analysis.tree, i), q[0],
					s.qd[k * s.nv + (size_t)t->iv]);
			most = fmax(most, fabs(s.qdd[k * s.nv + (size_t)t->iv]));
		}
	ck_assert(most > 9.5 && most <= 10);
	judged_close(&f);
	open_case(&f, _i, RNEAGEN_MIXED);
	s = states_of(&f.judge.inputs);
	for (size_t i = 0; i < COUNT * s.nq; i++)
		ck_assert(s.q[i] == (double)(float)s.q[i]);
	judged_close(&f);
}
END_TEST

/* The same seed the same states, another one others. */
START_TEST(test_seed)
{
	struct draw_options other = OPTIONS;
	struct judged f;
	struct drawn x;
	size_t size;
	const double *q;

	open_case(&f, 0, RNEAGEN_F64);
	q = f.judge.inputs.arrays[DRAWN_Q].values;
	size = COUNT * states_of(&f.judge.inputs).nq * sizeof *q;
	ck_assert(draw_inputs(&x, &f.analysis.tree, &f.analysis.request, &OPTIONS, f.analysis.arena));
	ck_assert(!memcmp(x.arrays[DRAWN_Q].values, q, size));
	other.seed++;
	ck_assert(draw_inputs(&x, &f.analysis.tree, &f.analysis.request, &other, f.analysis.arena));
	ck_assert(memcmp(x.arrays[DRAWN_Q].values, q, size));
	judged_close(&f);
}
END_TEST

/* Torques off by a known amount in one joint of one sample, of the judge's and computed here from the reference. */
START_TEST(test_errors)
{
	struct judged f;
	size_t nv, joint = 2, sample = 7;
	double *tau, size, worst = 0;
	struct judge_errors e;
	wide wanted[64];

	open_case(&f, 0, RNEAGEN_F64);
	nv = f.judge.rows;
	tau = calloc(COUNT * nv, sizeof *tau);
	for (size_t k = 0; k < COUNT; k++) {
		double sum = 0;

		size = refer(&f, k, wanted);
		for (size_t i = 0; i < nv; i++) {
			tau[k * nv + i] = (double)wanted[i] + (k == sample && i == joint ? 1e-3 : 0);
			sum += (tau[k * nv + i] - (double)wanted[i]) * (tau[k * nv + i] - (double)wanted[i]);
		}
		worst = fmax(worst, sqrt(sum) / size);
	}
	e = judge_results(&f.judge, tau);
	ck_assert_double_eq_tol(e.max, worst, 1e-9 * worst);
	ck_assert_double_eq_tol(e.rms, worst / sqrt(COUNT), 1e-9 * worst);
	ck_assert_double_eq_tol(e.terms, 1e-3 / (0x1p-52 * f.judge.size[sample * nv + joint]), 1e-3 * e.terms);
	tau[0] = (double)NAN;
	ck_assert(isinf(judge_results(&f.judge, tau).max));
	free(tau);
	judged_close(&f);
}
END_TEST

/* What is summed is no less than the result, and the bound no less than the error of the evaluated DAG. */
START_TEST(test_bound)
{
	struct rneagen_options o = rneagen_options_default();
	struct judged f;
	double bound, *tau;
	struct judge_errors e;

	o.precision = _i % 2 ? RNEAGEN_F64 : RNEAGEN_MIXED;
	open_case(&f, _i / 2, o.precision);
	tau = calloc(COUNT * f.judge.rows, sizeof *tau);
	for (size_t k = 0; k < COUNT; k++) {
		const struct states s = states_of(&f.judge.inputs);
		const double *in[] = {s.q + k * s.nq, s.qd + k * s.nv, s.qdd + k * s.nv, NULL};

		ck_assert(eval_f64(&f.analysis.dag, in, (double *[]){NULL, NULL, NULL, tau + k * s.nv}, NULL));
		for (size_t i = k * s.nv; i < (k + 1) * s.nv; i++) {
			ck_assert(f.judge.size[i] >= 0.999999 * fabs((double)f.judge.out[i]));
			tau[i] = o.precision == RNEAGEN_MIXED ? (double)(float)tau[i] : tau[i];
		}
	}
	e = judge_results(&f.judge, tau);
	ck_assert(judge_bound(&f.judge, &f.analysis, &o, 0, &bound));
	ck_assert_msg(e.max > 0 && e.max <= bound && bound < 1e3 * e.max, "error %g, bound %g, seed %d", e.max, bound, SEED);
	free(tau);
	judged_close(&f);
}
END_TEST

/* Without gravity and at rest no torque is anything but 0: one that is 0 is right, and others have nothing to compare with. */
START_TEST(test_zero)
{
	static const char urdf[] = "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/>"
				   "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
				   "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error error;
	struct analysis a;
	struct judge j;
	double tau = 0, bound;
	struct judge_errors e;
	const struct draw_options none = {.count = 1};

	o.scene = "range qdd=0,0";
	ck_assert(!analysis_open(&a, urdf, sizeof urdf - 1, &o, &error));
	ck_assert(judge_open(&j, &a, RNEAGEN_F64, &none, 1));
	e = judge_results(&j, &tau);
	ck_assert(e.max == 0 && e.rms == 0 && e.terms == 0);
	tau = 1e-9;
	e = judge_results(&j, &tau);
	ck_assert(isnan(e.max) && isnan(e.rms));
	tau = (double)NAN;
	ck_assert(isinf(judge_results(&j, &tau).max));
	ck_assert(judge_bound(&j, &a, &o, 0, &bound) && bound == 0);
	judge_free(&j);
	analysis_free(&a);
}
END_TEST

/* Where all torques are 0 for all states each variant is exact, and so are bounds: what is 0 does not underflow when mixed
   stores it. */
START_TEST(test_all_zero)
{
	static const enum rneagen_precision precisions[] = {RNEAGEN_F32, RNEAGEN_F64, RNEAGEN_MIXED};
	struct rneagen_options o = rneagen_options_default();
	struct judged f;
	double bound = -1, tau[COUNT * 6] = {0};

	o.precision = precisions[_i];
	judged_open(&f, ROBOTS "all_zero_torque.urdf", RNEAGEN_FIXED, NULL, o.precision, &OPTIONS);
	ck_assert_uint_eq(f.judge.rows, 6);
	ck_assert(judge_bound(&f.judge, &f.analysis, &o, 0, &bound));
	ck_assert_msg(bound == 0, "precision %d: the bound is %g", (int)o.precision, bound);
	ck_assert(judge_results(&f.judge, tau).max == 0);
	judged_close(&f);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("judge");
	TCase *c = tcase_create("judge");

	tcase_add_loop_test(c, test_reference, 0, 2 * CASE_COUNT);
	tcase_add_loop_test(c, test_states, 0, CASE_COUNT);
	tcase_add_test(c, test_seed);
	tcase_add_test(c, test_errors);
	tcase_add_loop_test(c, test_bound, 0, 2 * CASE_COUNT);
	tcase_add_test(c, test_zero);
	tcase_add_loop_test(c, test_all_zero, 0, 3);
	suite_add_tcase(s, c);
	return suite_run(s);
}
