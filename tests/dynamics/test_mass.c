/* The mass matrix that a scene asks for: symmetric to the bit, positive definite, and what the torques add for an
   acceleration; and products with derivatives beside the matrices. Random trees with floating bases, followers, held joints
   and rotors' inertias, and robots of this folder, against the reference or against each other. */
#include "support/scene_model.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TREES = 60, LINKS = 8, SAMPLES = 4, MOST = 40, STATES = 200 };
enum { Q, QD, QDD, JVP_V, VJP_V, INPUTS };
enum { TAU, MASS, DQ, DQD, JVP, VJP, OUTPUTS };

static const char WANTS[] = "want tau,M,dtau_dq,dtau_dqd,jvp,vjp\ndense\n";
static const char *const INPUT_NAMES[INPUTS] = {"q", "qd", "qdd", "jvp_v", "vjp_v"};
static const char *const OUTPUT_NAMES[OUTPUTS] = {"tau", "M", "dtau_dq", "dtau_dqd", "jvp", "vjp"};

/* Of the magnitudes: the URDF's numbers are doubles, and zeros stand for the rounding of such. */
static const real NOISE = 8 * 0x1p-53L, ROUNDING = 256 * 0x1p-64L;

struct subject {
	char what[128];
	struct scene_model model;
	struct reference *reference;
	struct rng rng;
	int nv, held; /* entry of the reference; -1: none */
	double at;
	int v_row[ROWS];                           /* of what is left, in the whole */
	double q[ROWS], qd[ROWS], qdd[ROWS];       /* of the whole */
	real in[INPUTS][ROWS], out[OUTPUTS][MOST * MOST];
	double size[OUTPUTS][MOST * MOST];         /* magnitudes that were summed */
};

/* Returns 0 where no joint is left. */
static int subject_open(struct subject *s, const char *urdf, const struct rneagen_options *options,
	const char *lines, uint64_t seed)
{
	struct rneagen_options o = *options;
	char scene[4096];

	snprintf(scene, sizeof scene, "%s%s", lines, WANTS);
	o.scene = scene;
	s->rng = rng_seed(seed);
	if (scene_open(&s->model, urdf, &o)) {
		ck_assert_msg(s->model.error.code == RNEAGEN_NO_JOINTS, "%s: %s", s->what, s->model.error.message);
		scene_close(&s->model);
		return 0;
	}
	s->nv = s->model.tree.nv;
	ck_assert_int_le(s->nv, MOST);
	scene_rows(&s->model.tree, s->reference, s->v_row);
	return 1;
}

static void subject_close(struct subject *s)
{
	scene_close(&s->model);
	reference_close(s->reference);
}

/* ---- a state ---- */

static void settle(struct subject *s)
{
	scene_settle(&s->model.tree, s->reference, s->held, s->at, s->q, s->qd, s->qdd, s->in);
}

static void draw(struct subject *s)
{
	reference_sample(s->reference, &s->rng, false, s->q, s->qd, s->qdd);
	for (int i = 0; i < 3 * s->nv; i++)
		s->in[JVP_V][i] = (real)rng_uniform(&s->rng, -1, 1);
	for (int i = 0; i < s->nv; i++)
		s->in[VJP_V][i] = (real)rng_uniform(&s->rng, -1, 1);
	settle(s);
}

static int number_of(const char *const *names, const char *name)
{
	int i = 0;

	while (strcmp(names[i], name))
		i++;
	return i;
}

static void evaluate(struct subject *s)
{
	const struct dag *d = &s->model.dag;
	const real *in[DAG_ARGUMENTS] = {NULL};
	real *out[DAG_ARGUMENTS] = {NULL};
	double *size = calloc(d->output_count, sizeof *size);

	for (int a = 0; a < d->argument_count; a++)
		if (d->arguments[a].is_output)
			out[a] = s->out[number_of(OUTPUT_NAMES, d->arguments[a].name)];
		else
			in[a] = s->in[number_of(INPUT_NAMES, d->arguments[a].name)];
	ck_assert(eval_real(d, in, out, &(struct eval_terms){.size = size}));
	for (size_t i = 0; i < d->output_count; i++)
		s->size[number_of(OUTPUT_NAMES, d->arguments[d->outputs[i].argument].name)][d->outputs[i].row] = size[i];
	free(size);
}

/* ---- the mass matrix ---- */

/* Element (i, j) is element (j, i), not just equal to it: every text has the same bits. */
static void check_symmetric(const struct subject *s)
{
	const struct dag *d = &s->model.dag;
	struct ref at[MOST][MOST];

	for (size_t i = 0; i < d->output_count; i++)
		if (!strcmp(d->arguments[d->outputs[i].argument].name, "M"))
			at[d->outputs[i].row / s->nv][d->outputs[i].row % s->nv] = d->outputs[i].value;
	for (int i = 0; i < s->nv; i++)
		for (int j = 0; j < i; j++) {
			ck_assert_msg(at[i][j].i == at[j][i].i, "%s: M[%d][%d] is not made as M[%d][%d]", s->what, i, j, j, i);
			ck_assert(s->out[MASS][i * s->nv + j] == s->out[MASS][j * s->nv + i]);
		}
}

/* tau = M qdd + ID(q, qd, 0), both torques the reference's. */
static void check_torque(struct subject *s)
{
	static const double zero[ROWS];
	wide tau[ROWS], bias[ROWS], size[ROWS];

	reference_rnea(s->reference, s->q, s->qd, zero, bias);
	reference_rnea(s->reference, s->q, s->qd, s->qdd, tau);
	reference_magnitude(s->reference, s->q, s->qd, s->qdd, size);
	for (int i = 0; i < s->nv; i++) {
		real sum = (real)(bias[s->v_row[i]] - tau[s->v_row[i]]), most = (real)size[s->v_row[i]];

		for (int j = 0; j < s->nv; j++) {
			sum += s->out[MASS][i * s->nv + j] * s->in[QDD][j];
			most += (real)s->size[MASS][i * s->nv + j] * fabsl(s->in[QDD][j]);
		}
		ck_assert_msg(fabsl(sum) <= NOISE * most, "%s: row %d of M qdd + bias - tau is %Lg, of terms of %Lg",
			s->what, i, sum, most);
	}
}

/* The least pivot of the Cholesky factorisation, of the matrix scaled to ones on its diagonal; 0 where one is not positive. */
static real least_pivot(int n, const real *m)
{
	real L[MOST][MOST], least = 1;

	for (int i = 0; i < n; i++)
		for (int j = 0; j <= i; j++) {
			real sum = m[i * n + j] / sqrtl(m[i * n + i] * m[j * n + j]);

			for (int k = 0; k < j; k++)
				sum -= L[i][k] * L[j][k];
			if (i > j) {
				L[i][j] = sum / L[j][j];
				continue;
			}
			if (!(sum > 0))
				return 0;
			L[i][i] = sqrtl(sum);
			least = sum < least ? sum : least;
		}
	return least;
}

/* By columns of the reference. */
static void refer_mass(struct subject *s, real *m)
{
	double unit[ROWS] = {0};
	static const double zero[ROWS];
	wide with[ROWS], without[ROWS];

	reference_rnea(s->reference, s->q, zero, zero, without);
	for (int j = 0; j < s->nv; j++) {
		unit[s->v_row[j]] = 1;
		reference_rnea(s->reference, s->q, zero, unit, with);
		unit[s->v_row[j]] = 0;
		for (int i = 0; i < s->nv; i++)
			m[i * s->nv + j] = (real)(with[s->v_row[i]] - without[s->v_row[i]]);
	}
}

/* Positive definite where the reference's is, by more than the noise. Returns whether it is. */
static int check_definite(struct subject *s)
{
	static real m[MOST * MOST];
	real right, pivot;

	refer_mass(s, m);
	right = least_pivot(s->nv, m);
	pivot = least_pivot(s->nv, s->out[MASS]);
	ck_assert_msg(right < 1e-12L || fabsl(pivot / right - 1) < 1e-14L * (real)(s->nv * s->nv) / right,
		"%s: the least pivot is %Lg, not %Lg", s->what, pivot, right);
	return pivot > 0;
}

/* ---- products ---- */

/* vjp(lambda) . v = lambda . jvp(v) */
static void check_transposed(const struct subject *s)
{
	real sum = 0, most = 0;

	for (int i = 0; i < 3 * s->nv; i++) {
		sum += s->out[VJP][i] * s->in[JVP_V][i];
		most += (real)s->size[VJP][i] * fabsl(s->in[JVP_V][i]);
	}
	for (int i = 0; i < s->nv; i++) {
		sum -= s->in[VJP_V][i] * s->out[JVP][i];
		most += (real)s->size[JVP][i] * fabsl(s->in[VJP_V][i]);
	}
	ck_assert_msg(fabsl(sum) <= ROUNDING * most, "%s: vjp and jvp differ by %Lg, of terms of %Lg", s->what, sum, most);
}

/* jvp(v) = (d tau/d q) v_q + (d tau/d qd) v_qd + M v_qdd */
static void check_jvp(const struct subject *s)
{
	static const int matrices[] = {DQ, DQD, MASS};

	for (int i = 0; i < s->nv; i++) {
		real sum = -s->out[JVP][i], most = (real)s->size[JVP][i];

		for (int k = 0; k < 3 * s->nv; k++) {
			int at = i * s->nv + k % s->nv, matrix = matrices[k / s->nv];

			sum += s->out[matrix][at] * s->in[JVP_V][k];
			most += (real)s->size[matrix][at] * fabsl(s->in[JVP_V][k]);
		}
		ck_assert_msg(fabsl(sum) <= NOISE * most, "%s: row %d of jvp differs by %Lg, of terms of %Lg",
			s->what, i, sum, most);
	}
}

static int check_state(struct subject *s)
{
	evaluate(s);
	check_torque(s);
	check_transposed(s);
	check_jvp(s);
	return check_definite(s);
}

/* ---- robots ---- */

/* A rotor in every third joint with one row, and one that is held. */
static void draw_scene(struct subject *s, uint64_t seed, char *lines, size_t size)
{
	size_t length = 0;

	s->held = -1;
	s->at = 0.3125;
	for (int j = 0; j < s->reference->nj; j++) {
		const struct reference_joint *x = &s->reference->joints[j];
		struct reference_own own = {.armature = 0.25L};

		if (x->nv != 1)
			continue;
		if (seed % 2 && s->held < 0 && s->reference->nv > 1 && x->driver == j) {
			length += (size_t)snprintf(lines + length, size - length, "lock %s=%.17g\n", x->name, s->at);
			s->held = j;
		} else if (((uint64_t)j + seed) % 3 == 0) {
			length += (size_t)snprintf(lines + length, size - length, "armature %s=0.25\n", x->name);
			reference_set_own(s->reference, j, &own);
		}
	}
	ck_assert_uint_lt(length, size);
}

START_TEST(trees)
{
	int definite = 0, held = 0;

	for (uint64_t seed = 500; seed < 500 + TREES; seed++) {
		struct subject *s = calloc(1, sizeof *s);
		struct rneagen_options o = rneagen_options_default();
		char *urdf = torque_robot(seed, LINKS, NO_ODD_NAMES | (seed % 4 ? 0 : ALWAYS_MIMIC)), lines[2048] = "";

		o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		snprintf(s->what, sizeof s->what, "seed %d", (int)seed);
		s->reference = scene_reference(urdf, &o);
		draw_scene(s, seed, lines, sizeof lines);
		if (!subject_open(s, urdf, &o, lines, seed)) {
			reference_close(s->reference);
		} else {
			for (int k = 0; k < SAMPLES; k++) {
				draw(s);
				definite += check_state(s);
			}
			check_symmetric(s);
			held += s->held >= 0;
			subject_close(s);
		}
		free(urdf);
		free(s);
	}
	printf("trees of seeds 500 to %d: %d with a joint held; %d matrices positive definite\n",
		500 + TREES - 1, held, definite);
	ck_assert(definite > TREES && held > TREES / 4);
}
END_TEST

static const struct robot_file {
	const char *name;
	int floating;
} ROBOTS[] = {{"iiwa14", 0}, {"ur5", 0}, {"panda", 1}, {"hyq", 1}, {"mimic_chain", 0}};

/* Angles of quarter turns or within 1e-8 rad of them: arms are stretched or folded, axes are parallel. */
static void make_singular(struct subject *s)
{
	for (int j = 0; j < s->reference->nj; j++)
		if (s->reference->joints[j].nq == 1)
			s->q[s->reference->joints[j].iq] = 1.5707963267948966 * (rng_below(&s->rng, 5) - 2) +
				rng_uniform(&s->rng, -1e-8, 1e-8);
	settle(s);
}

START_TEST(robots)
{
	const struct robot_file *f = &ROBOTS[_i];
	struct subject *s = calloc(1, sizeof *s);
	struct rneagen_options o = rneagen_options_default();
	real least = 1;
	char *urdf = robot_text(f->name);

	snprintf(s->what, sizeof s->what, "%s, seed %d", f->name, 600 + _i);
	o.base = f->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	s->held = -1;
	s->reference = scene_reference(urdf, &o);
	ck_assert(subject_open(s, urdf, &o, "", 600 + (uint64_t)_i));
	for (int k = 0; k < STATES; k++) {
		draw(s);
		if (k % 2)
			make_singular(s);
		ck_assert_msg(check_state(s), "%s: M is not positive definite in state %d", s->what, k);
		least = fminl(least, least_pivot(s->nv, s->out[MASS]));
	}
	check_symmetric(s);
	printf("%s: %d states, half of them singular: least scaled pivot %.2Lg\n", s->what, STATES, least);
	subject_close(s);
	free(urdf);
	free(s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("mass");
	TCase *c = tcase_create("mass");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_test(c, trees);
	tcase_add_loop_test(c, robots, 0, (int)(sizeof ROBOTS / sizeof *ROBOTS));
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
