/* What rnearun report and choose judge by where a scene frees, folds and wants: what they draw, and the outputs that they
   compare with, against the independent reference changed for each sample; errors by array; what changed constants change. It
   would catch a bound of qdd that is judged as if it were an output like others. */
#include "tell/effect.h"
#include "dag/eval.h"
#include "judged.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 60, SEED = 20261121 };

#define IIWA TEST_DIR "/robots/iiwa14.urdf"
#define LINK "iiwa_link_7"

static const struct draw_options OPTIONS = {.seed = SEED, .count = COUNT};
static const char SCENE[] = "free payload." LINK "\nfree inertia.iiwa_link_6:sample\nfree mass.iiwa_link_5\nfree gravity:sample\n"
			    "free offset.iiwa_joint_2\nfext " LINK "\nfold qdd=0\nwant tau,power,twist." LINK "\n";

static void open_scene(struct judged *f, const char *scene, enum rneagen_precision precision)
{
	judged_open(f, IIWA, RNEAGEN_FIXED, scene, precision, &OPTIONS);
}

/* The rows of an input in sample k. */
static const double *rows(const struct judged *f, const char *name, size_t k)
{
	const struct dag *d = &f->analysis.dag;

	for (int i = 0; i < d->argument_count; i++)
		if (!strcmp(d->arguments[i].name, name))
			return draw_rows(&f->judge.inputs, &d->arguments[i], k);
	ck_abort_msg("no input %s", name);
	return NULL;
}

static int find_link(const struct reference *r, const char *link)
{
	for (int i = 0; i < r->nj; i++)
		if (!strcmp(r->joints[i].link, link))
			return i;
	ck_abort_msg("no link %s", link);
	return -1;
}

/* ---- what is drawn ---- */

/* A body that can be: the moments about its centre of mass are those of a box, its centre is near. */
static void assert_body(const double *p)
{
	double m = p[0], c[3] = {p[1] / m, p[2] / m, p[3] / m}, I[3], J[3] = {p[5], p[6], p[8]};

	ck_assert(m > 0 && m <= 1);
	for (int i = 0; i < 3; i++)
		ck_assert(fabs(c[i]) <= 0.1);
	I[0] = p[4] - m * (c[1] * c[1] + c[2] * c[2]);
	I[1] = p[7] - m * (c[0] * c[0] + c[2] * c[2]);
	I[2] = p[9] - m * (c[0] * c[0] + c[1] * c[1]);
	for (int i = 0; i < 3; i++)
		ck_assert(I[i] > 0 && I[i] <= I[(i + 1) % 3] + I[(i + 2) % 3] + 1e-15 && I[i] < 0.01 * m);
	ck_assert(fabs(J[0] + m * c[0] * c[1]) < 1e-15 && fabs(J[1] + m * c[0] * c[2]) < 1e-15 &&
		fabs(J[2] + m * c[1] * c[2]) < 1e-15);
}

static double length(const double *x)
{
	return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* The URDF's body and up to a tenth of the mass in a box: the rest of it is the URDF's. */
static void assert_near(const double *p, const wide *own)
{
	double off = 0, size = 0;

	for (int i = 4; i < 10; i++) {
		double rest = p[i] - p[0] * (double)(own[i] / own[0]);

		off = fmax(off, fabs(rest));
		size = fmax(size, 0.1 * p[0] * (0.04 + (double)wide_abs(own[i] / own[0])));
	}
	ck_assert(off > 0 && off <= size);
}

/* Near what the URDF says; the states are those of the plain robot. */
START_TEST(test_draws)
{
	struct judged f, plain;
	wide own[10];
	double most = 0, mass = 0;

	open_scene(&f, SCENE, RNEAGEN_F64);
	open_scene(&plain, NULL, RNEAGEN_F64);
	ck_assert(!memcmp(f.judge.inputs.arrays[DRAWN_DRIVE].values, plain.judge.inputs.arrays[DRAWN_DRIVE].values,
		COUNT * 7 * sizeof(double)));
	reference_inertia(f.model.reference, find_link(f.model.reference, "iiwa_link_6"), own);
	for (size_t k = 0; k < COUNT; k++) {
		const double *g = rows(&f, "gravity", k), *inertia = rows(&f, "inertia_iiwa_link_6", k);

		ck_assert(rows(&f, "q", k)[0] == rows(&plain, "q", k)[0]);
		ck_assert(fabs(g[0]) <= 9.81 && fabs(g[1]) <= 9.81 && fabs(g[2]) <= 9.81);
		ck_assert(fabs(inertia[0] / (double)own[0] - 1) <= 0.1);
		assert_near(inertia, own);
		assert_body(rows(&f, "payload_" LINK, k));
		ck_assert(rows(&f, "mass_iiwa_link_5", k) == rows(&f, "mass_iiwa_link_5", 0));
		ck_assert(fabs(rows(&f, "offset_iiwa_joint_2", k)[0]) <= 0.1);
		for (int i = 0; i < 6; i++)
			most = fmax(most, fabs(rows(&f, "fext_" LINK, k)[i]));
		mass = fmax(mass, rows(&f, "payload_" LINK, k)[0]);
	}
	ck_assert(most > 9 && most <= 10 && mass > 0.8);
	ck_assert(length(rows(&f, "gravity", 0)) != length(rows(&f, "gravity", 1)));
	judged_close(&f);
	judged_close(&plain);
	open_scene(&f, SCENE, RNEAGEN_F32);
	for (int i = 0; i < 10; i++)
		ck_assert((double)(float)rows(&f, "payload_" LINK, 3)[i] == rows(&f, "payload_" LINK, 3)[i]);
	judged_close(&f);
}
END_TEST

/* Vectors that derivatives are multiplied by are no constants of the URDF. */
START_TEST(test_vectors)
{
	struct judged f;
	double most = 0;

	open_scene(&f, "want tau,vjp\n", RNEAGEN_F64);
	for (size_t k = 0; k < COUNT; k++)
		for (int i = 0; i < 7; i++)
			most = fmax(most, fabs(rows(&f, "vjp_v", k)[i]));
	ck_assert(most > 0.9 && most <= 1);
	judged_close(&f);
}
END_TEST

/* ---- what is compared with ---- */

static void add_scaled(wide to[10], const double *x)
{
	for (int i = 0; i < 10; i++)
		to[i] += (wide)x[i];
}

/* Mass m instead of the link's own moves what goes with it, m and first moments, and not the inertia about the centre. */
static void set_mass(struct reference *r, const char *link, wide *own, double m)
{
	wide p[10], more = (wide)m - own[0], c[3];

	memcpy(p, own, sizeof p);
	for (int i = 0; i < 3; i++) {
		c[i] = own[1 + i] / own[0];
		p[1 + i] = (wide)m * c[i];
	}
	p[0] = (wide)m;
	p[4] += more * (c[1] * c[1] + c[2] * c[2]);
	p[5] -= more * c[0] * c[1];
	p[6] -= more * c[0] * c[2];
	p[7] += more * (c[0] * c[0] + c[2] * c[2]);
	p[8] -= more * c[1] * c[2];
	p[9] += more * (c[0] * c[0] + c[1] * c[1]);
	reference_set_inertia(r, find_link(r, link), p);
}

static void refer(const struct judged *f, size_t k, wide own[3][10], wide *tau, wide *twist)
{
	struct reference *r = f->model.reference;
	static const double zero[7];
	double q[7];
	wide p[10], push[6];

	memcpy(q, rows(f, "q", k), sizeof q);
	q[1] += rows(f, "offset_iiwa_joint_2", k)[0];
	memcpy(p, own[2], sizeof p);
	add_scaled(p, rows(f, "payload_" LINK, k));
	reference_set_inertia(r, find_link(r, LINK), p);
	memset(p, 0, sizeof p);
	add_scaled(p, rows(f, "inertia_iiwa_link_6", k));
	reference_set_inertia(r, find_link(r, "iiwa_link_6"), p);
	set_mass(r, "iiwa_link_5", own[0], rows(f, "mass_iiwa_link_5", k)[0]);
	for (int i = 0; i < 6; i++)
		push[i] = (wide)rows(f, "fext_" LINK, k)[i];
	reference_set_push(r, find_link(r, LINK), push, 0);
	for (int i = 0; i < 3; i++)
		r->gravity[i] = (wide)rows(f, "gravity", k)[i];
	reference_rnea(r, q, rows(f, "qd", k), zero, tau);
	reference_link(r, find_link(r, LINK), twist, NULL, NULL);
}

static double off(const exact *x, const wide *ref, int count)
{
	wide sum = 0, size = 0;

	for (int i = 0; i < count; i++) {
		wide by = (wide)x[i] - ref[i];

		sum += by * by;
		size += ref[i] * ref[i];
	}
	return (double)sqrtl((long double)(sum / size));
}

START_TEST(test_reference)
{
	struct judged f;
	wide own[3][10], tau[7], twist[6];
	static const char *const links[] = {"iiwa_link_5", "iiwa_link_6", LINK};

	open_scene(&f, SCENE, _i ? RNEAGEN_F32 : RNEAGEN_F64);
	for (int i = 0; i < 3; i++)
		reference_inertia(f.model.reference, find_link(f.model.reference, links[i]), own[i]);
	ck_assert(f.judge.rows == 14 && f.judge.output_count == 3);
	for (size_t k = 0; k < COUNT; k++) {
		const exact *out = f.judge.out + k * 14;
		wide power = 0, size = 0;

		refer(&f, k, own, tau, twist);
		for (int i = 0; i < 7; i++) {
			power += tau[i] * (wide)rows(&f, "qd", k)[i];
			size += wide_abs(tau[i] * (wide)rows(&f, "qd", k)[i]);
		}
		/* the offset was added in double precision: 1e-16 rad */
		ck_assert_msg(off(out, tau, 7) < 3e-15, "tau off by %g, sample %zu, seed %d", off(out, tau, 7), k, SEED);
		ck_assert_msg(wide_abs((wide)out[7] - power) < 3e-15L * size, "power, sample %zu, seed %d", k, SEED);
		ck_assert_msg(off(out + 8, twist, 6) < 3e-15, "twist off by %g, sample %zu", off(out + 8, twist, 6), k);
	}
	judged_close(&f);
}
END_TEST

/* ---- errors ---- */

/* One number off in one array of one sample: it is the array's norm that counts; and what is 0 does not. */
START_TEST(test_errors)
{
	struct judged f;
	double *out, least;
	struct judge_errors e;

	open_scene(&f, SCENE, RNEAGEN_F64);
	out = calloc(COUNT, 14 * sizeof *out);
	for (size_t i = 0; i < COUNT * 14; i++)
		out[i] = (double)f.judge.out[i];
	least = judge_results(&f.judge, out).max;
	ck_assert(least > 0 && least < 1e-15);
	out[5 * 14 + 7] *= 1 + 1e-6;
	e = judge_results(&f.judge, out);
	ck_assert_double_eq_tol(e.max, 1e-6, 1e-9);
	ck_assert_double_eq_tol(e.rms, 1e-6 / sqrt(COUNT), 1e-9);
	ck_assert_double_eq_tol(e.terms, 1e-6 * fabs(out[5 * 14 + 7]) / (0x1p-52 * f.judge.size[5 * 14 + 7]), 1e-3 * e.terms);
	out[9 * 14 + 10] = (double)NAN;
	ck_assert(isinf(judge_results(&f.judge, out).max));
	free(out);
	judged_close(&f);
}
END_TEST

/* The bound is of the worst array too; of 154 rows of derivatives as of others. */
START_TEST(test_bound)
{
	struct rneagen_options o = rneagen_options_default();
	struct judged f;
	double bound, *out;
	struct judge_errors e;

	o.precision = RNEAGEN_F64;
	open_scene(&f, _i ? "want tau,dtau_dq,dtau_dqd,M\ndense\n" : SCENE, RNEAGEN_F64);
	ck_assert_uint_eq(f.judge.rows, _i ? 154 : 14);
	out = calloc(COUNT, f.judge.rows * sizeof *out);
	for (size_t k = 0; k < COUNT; k++) {
		const struct dag *d = &f.analysis.dag;
		const double *in[DAG_ARGUMENTS];
		double *to[DAG_ARGUMENTS] = {NULL};

		for (int i = 0; i < d->argument_count; i++)
			in[i] = draw_rows(&f.judge.inputs, &d->arguments[i], k);
		for (int i = 0; i < f.judge.output_count; i++)
			to[f.judge.outputs[i].argument] = out + k * f.judge.rows + f.judge.outputs[i].first;
		ck_assert(eval_f64(d, in, to, NULL));
	}
	e = judge_results(&f.judge, out);
	ck_assert(judge_bound(&f.judge, &f.analysis, &o, 0, &bound));
	ck_assert_msg(e.max > 0 && e.max <= bound && bound < 1e3 * e.max, "error %g, bound %g, seed %d", e.max, bound, SEED);
	free(out);
	judged_close(&f);
}
END_TEST

/* ---- a bound among the outputs ---- */

/* All outputs of all samples, evaluated in f32. */
static double *evaluate_f32(const struct judged *f)
{
	const struct dag *d = &f->analysis.dag;
	double *out = calloc(COUNT * f->judge.rows, sizeof *out);

	for (size_t k = 0; k < COUNT; k++) {
		float narrow[DAG_ARGUMENTS][16];
		const float *in[DAG_ARGUMENTS];
		float *to[DAG_ARGUMENTS];

		for (int i = 0; i < d->argument_count; i++) {
			const double *x = draw_rows(&f->judge.inputs, &d->arguments[i], k);

			for (int r = 0; x && r < d->arguments[i].rows; r++)
				narrow[i][r] = (float)x[r];
			in[i] = to[i] = narrow[i];
		}
		ck_assert(eval_f32(d, in, to, NULL));
		for (int i = 0; i < f->judge.output_count; i++) {
			const struct judge_output *o = &f->judge.outputs[i];

			for (size_t r = 0; r < o->rows; r++)
				out[k * f->judge.rows + o->first + r] = (double)narrow[o->argument][r];
		}
	}
	return out;
}

/* qdd alone, and its bound beside it, at [sample][7 + row]. */
START_TEST(test_bound_of_qdd)
{
	struct rneagen_options o = rneagen_options_default();
	struct judged plain, f;
	double *out, *alone = calloc(COUNT, 7 * sizeof *alone), bound, bound_alone, kept;
	struct judge_errors e, e_alone;
	size_t at = 3 * 14 + 7 + 2;

	o.precision = RNEAGEN_F32;
	open_scene(&plain, "want qdd\n", RNEAGEN_F32);
	open_scene(&f, "want qdd,qdd_bound\n", RNEAGEN_F32);
	ck_assert(f.judge.rows == 14 && f.judge.outputs[1].is_bound && f.judge.outputs[1].first == 7);
	out = evaluate_f32(&f);
	for (size_t i = 0; i < COUNT * 7; i++)
		alone[i] = out[i / 7 * 14 + i % 7];
	e = judge_results(&f.judge, out);
	e_alone = judge_results(&plain.judge, alone);
	ck_assert_msg(e.max > 1e-8 && e.max < 1e-4, "error %g, seed %d", e.max, SEED);
	ck_assert_double_eq_tol(e.max, e_alone.max, 1e-9 * e.max);
	ck_assert_double_eq_tol(e.rms, e_alone.rms, 1e-9 * e.rms);
	ck_assert(judge_bound(&f.judge, &f.analysis, &o, 0, &bound));
	ck_assert(judge_bound(&plain.judge, &plain.analysis, &o, 0, &bound_alone));
	ck_assert_double_eq_tol(bound, bound_alone, 1e-3 * bound);
	kept = out[at];
	out[at] = (double)INFINITY;
	ck_assert(judge_results(&f.judge, out).max == e.max);
	out[at] = 0.999 * fabs((double)((exact)out[at - 7] - f.judge.out[at - 7]));
	ck_assert(out[at] < kept && isinf(judge_results(&f.judge, out).max));
	free(out);
	free(alone);
	judged_close(&plain);
	judged_close(&f);
}
END_TEST

/* A bound alone is not judged, nor is what it would be of. */
START_TEST(test_bound_alone)
{
	struct judged f;
	double *out;

	open_scene(&f, "want qdd_bound\n", RNEAGEN_F32);
	ck_assert(!judge_has_outputs(&f.analysis.dag));
	out = evaluate_f32(&f);
	ck_assert(isnan(judge_results(&f.judge, out).max));
	free(out);
	judged_close(&f);
	open_scene(&f, "want qdd_bound,M\n", RNEAGEN_F32);
	ck_assert(judge_has_outputs(&f.analysis.dag));
	judged_close(&f);
}
END_TEST

/* ---- changed constants ---- */

static double change_of_robot(const char *urdf, const char *scene)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	struct analysis a;
	double change = -1;

	o.scene = scene;
	ck_assert_msg(!analysis_open(&a, urdf, strlen(urdf), &o, &e), "%s", e.message);
	ck_assert(!effect_total(&change, &a, &OPTIONS, &e));
	analysis_free(&a);
	return change;
}

/* A point of 1.2345 kg turns about an upright axis: tau = m r^2 qdd, and two digits make it 1.2 kg. */
static double change_of(const char *scene)
{
	static const char urdf[] = "<robot name='r'><link name='a'/><link name='b'><inertial><origin xyz='1 0 0'/><mass value='1.2345'/>"
				   "<inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial></link>"
				   "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";

	return change_of_robot(urdf, scene);
}

/* Of an arm: what its bound changes by, as much as its size, is no change of the model. */
START_TEST(test_change_of_bound)
{
	size_t length;
	char *urdf = read_file(IIWA, &length);
	double change = change_of_robot(urdf, "round-constants 2\nwant qdd\n");
	double beside = change_of_robot(urdf, "round-constants 2\nwant qdd,qdd_bound\n");

	ck_assert_double_eq_tol(beside, change, 1e-9 * change);
	free(urdf);
}
END_TEST

START_TEST(test_change)
{
	ck_assert(isnan(change_of(NULL)) && isnan(change_of("want tau,power\n")));
	ck_assert_double_eq_tol(change_of("round-constants 2\n"), 0.0345 / 1.2345, 1e-15);
	ck_assert_double_eq_tol(change_of("round-constants 2\nwant kinetic,tau\n"), 0.0345 / 1.2345, 1e-15);
	ck_assert_double_eq_tol(change_of("round-constants 9\n"), 0, 1e-15);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("judge_task");
	TCase *c = tcase_create("judge_task");

	tcase_add_test(c, test_draws);
	tcase_add_test(c, test_vectors);
	tcase_add_loop_test(c, test_reference, 0, 2);
	tcase_add_test(c, test_errors);
	tcase_add_loop_test(c, test_bound, 0, 2);
	tcase_add_test(c, test_bound_of_qdd);
	tcase_add_test(c, test_bound_alone);
	tcase_add_test(c, test_change);
	tcase_add_test(c, test_change_of_bound);
	suite_add_tcase(s, c);
	return suite_run(s);
}
