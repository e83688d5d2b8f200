/* The regressor: column by column the reference's torques for a unit of one inertial parameter of one link and no other mass, in
   extended precision; and with the parameters that --info=json lists it gives the torques. Random trees with floating bases,
   followers, held joints, odd axes and base parameters, and robots. Would catch a wrong element, place, frame or order. */
#include "support/rng.h"
#include "support/scene_model.h"
#include "support/suite.h"
#include "tree/lumps.h"
#include "tree/pattern.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TREES = 60, LINKS = 8, SAMPLES = 2, FORWARD_STATES = 20 };

/* Of the largest element, or of the magnitudes summed: the URDF's numbers are doubles, and zeros stand for the rounding of
   such. */
static const real NOISE = 64 * 0x1p-53L;

struct subject {
	char what[300];
	struct scene_model model;
	struct reference *reference;
	struct rng rng;
	struct pattern p;
	struct lumps lumps;
	int held;                              /* entry of the reference; -1: none */
	double at;                             /* where */
	int v_row[ROWS];                       /* of what is left, in the whole */
	double q[ROWS], qd[ROWS], qdd[ROWS];   /* of the whole */
	real in[4][ROWS], tau[ROWS], found[ROWS], *y, *pi;
};

/* Returns 0 where no joint is left. */
static int subject_open(struct subject *s, const char *urdf, const struct rneagen_options *o, uint64_t seed)
{
	const struct tree *t = &s->model.tree;

	s->rng = rng_seed(seed);
	if (scene_open(&s->model, urdf, o)) {
		ck_assert_msg(s->model.error.code == RNEAGEN_NO_JOINTS, "%s: %s", s->what, s->model.error.message);
		scene_close(&s->model);
		reference_close(s->reference);
		return 0;
	}
	scene_rows(t, s->reference, s->v_row);
	ck_assert(pattern_lumps(&s->p, t, s->model.analysis.request.dense, &s->model.arena) &&
		lumps_make(&s->lumps, t, &s->model.arena));
	s->y = calloc((size_t)s->p.rows, sizeof *s->y);
	s->pi = calloc((size_t)s->p.cols, sizeof *s->pi);
	for (int l = 0; l < s->lumps.count; l++) {
		struct inertia I = lumps_inertia(&s->lumps, &s->model.analysis.stated, l);

		s->pi[10 * l] = I.mass.x;
		for (int i = 0; i < 3; i++)
			s->pi[10 * l + 1 + i] = I.h[i].x;
		for (int i = 0; i < 6; i++)
			s->pi[10 * l + 4 + i] = I.I[i].x;
	}
	return 1;
}

static void subject_close(struct subject *s)
{
	scene_close(&s->model);
	reference_close(s->reference);
	free(s->y);
	free(s->pi);
}

/* ---- a state ---- */

static void settle(struct subject *s)
{
	scene_settle(&s->model.tree, s->reference, s->held, s->at, s->q, s->qd, s->qdd, s->in);
}

static void evaluate(struct subject *s)
{
	static const char *const names[] = {"q", "qd", "qdd", "tau"};
	const struct dag *d = &s->model.dag;
	const real *in[DAG_ARGUMENTS] = {NULL};
	real *out[DAG_ARGUMENTS] = {NULL};

	for (int a = 0; a < d->argument_count; a++) {
		int k = 0;

		if (d->arguments[a].is_output) {
			out[a] = !strcmp(d->arguments[a].name, "regressor") ? s->y : !strcmp(d->arguments[a].name, "tau")
				? s->tau : s->found;
			ck_assert(out[a] != s->y || d->arguments[a].rows == s->p.rows);
			continue;
		}
		while (strcmp(names[k], d->arguments[a].name))
			k++;
		in[a] = s->in[k];
	}
	ck_assert(eval_real(d, in, out, NULL));
}

static real element(const struct subject *s, int row, int col)
{
	int at = s->p.row[row * s->p.cols + col];

	return at < 0 ? 0 : s->y[at];
}

/* ---- against the reference ---- */

static int entry_of_link(const struct subject *s, const char *link)
{
	for (int j = 0; j < s->reference->nj; j++)
		if (!strcmp(s->reference->joints[j].link, link))
			return j;
	ck_abort_msg("%s: no link '%s' in the reference", s->what, link);
	return -1;
}

/* Column by column; the reference has lost its masses after it. */
static void check_columns(struct subject *s)
{
	static const wide none[10];
	int nv = s->model.tree.nv;
	wide *want = calloc((size_t)nv * (size_t)s->p.cols, sizeof *want), tau[ROWS];
	real largest = 0;

	for (int j = 0; j < s->reference->nj; j++)
		reference_set_inertia(s->reference, j, none);
	for (int c = 0; c < s->p.cols; c++) {
		int entry = entry_of_link(s, s->model.tree.bodies[s->lumps.body[c / 10]].link);
		wide unit[10] = {0};

		unit[c % 10] = 1;
		reference_set_inertia(s->reference, entry, unit);
		reference_rnea(s->reference, s->q, s->qd, s->qdd, tau);
		reference_set_inertia(s->reference, entry, none);
		for (int i = 0; i < nv; i++) {
			want[i * s->p.cols + c] = tau[s->v_row[i]];
			largest = fmaxl(largest, fabsl((real)tau[s->v_row[i]]));
		}
	}
	for (int e = 0; e < nv * s->p.cols; e++)
		ck_assert_msg(fabsl(element(s, e / s->p.cols, e % s->p.cols) - (real)want[e]) <= NOISE * largest,
			"%s: element %d,%d is %.17Lg, not %.17Lg, of at most %Lg", s->what, e / s->p.cols, e % s->p.cols,
			element(s, e / s->p.cols, e % s->p.cols), (real)want[e], largest);
	free(want);
}

/* Y pi = tau, by the reference's torques of the robot as it is. */
static void check_product(struct subject *s)
{
	wide tau[ROWS], size[ROWS];

	reference_rnea(s->reference, s->q, s->qd, s->qdd, tau);
	reference_magnitude(s->reference, s->q, s->qd, s->qdd, size);
	for (int i = 0; i < s->model.tree.nv; i++) {
		real sum = 0, most = (real)size[s->v_row[i]];

		for (int c = 0; c < s->p.cols; c++) {
			sum += element(s, i, c) * s->pi[c];
			most += fabsl(element(s, i, c) * s->pi[c]);
		}
		ck_assert_msg(fabsl(sum - (real)tau[s->v_row[i]]) <= NOISE * most,
			"%s: row %d of Y pi is %.17Lg, not %.17Lg, of terms of %Lg", s->what, i, sum,
			(real)tau[s->v_row[i]], most);
	}
}

/* ---- random trees ---- */

/* A joint that is held, at no right angle. */
static void draw_held(struct subject *s, uint64_t seed, char *lines, size_t size)
{
	s->held = -1;
	s->at = 0.3125;
	for (int j = 0; j < s->reference->nj && seed % 2 && s->held < 0 && s->reference->nv > 1; j++) {
		const struct reference_joint *x = &s->reference->joints[j];

		if (x->nv != 1 || x->driver != j)
			continue;
		s->held = j;
		snprintf(lines, size, "lock %s=%.17g\n", x->name, s->at);
	}
}

START_TEST(trees)
{
	int matrices = 0, held = 0, followers = 0;

	for (uint64_t seed = 700; seed < 700 + TREES; seed++) {
		struct subject *s = calloc(1, sizeof *s);
		struct rneagen_options o = rneagen_options_default();
		char *urdf = torque_robot(seed, LINKS, NO_ODD_NAMES | (seed % 4 ? 0 : ALWAYS_MIMIC)),
			lines[512] = "", scene[1024];

		o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		snprintf(s->what, sizeof s->what, "seed %d", (int)seed);
		s->reference = scene_reference(urdf, &o);
		draw_held(s, seed, lines, sizeof lines);
		snprintf(scene, sizeof scene, "%swant regressor\n%sparams %s\n", lines, seed % 5 ? "" : "dense\n",
			seed % 4 > 1 ? "base" : "urdf");
		o.scene = scene;
		if (subject_open(s, urdf, &o, seed)) {
			held += s->held >= 0;
			followers += s->model.tree.mimic_count;
			for (int k = 0; k < SAMPLES; k++, matrices++) {
				reference_sample(s->reference, &s->rng, false, s->q, s->qd, s->qdd);
				settle(s);
				evaluate(s);
				if (k < SAMPLES - 1)
					check_product(s);
				else
					check_columns(s);
			}
			subject_close(s);
		}
		free(urdf);
		free(s);
	}
	printf("trees of seeds 700 to %d: %d matrices; %d joints held, %d followers\n", 700 + TREES - 1, matrices,
		held, followers);
	ck_assert(matrices > TREES && held > TREES / 4 && followers > TREES / 4);
}
END_TEST

/* ---- robots ---- */

static void open_robot(struct subject *s, const char *path, const char *name, enum rneagen_base base, const char *scene)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = read_file(path, &length);

	ck_assert_ptr_nonnull(urdf);
	snprintf(s->what, sizeof s->what, "%s, seed 5", name);
	o.base = base;
	o.scene = scene;
	s->held = -1;
	s->reference = scene_reference(urdf, &o);
	ck_assert(subject_open(s, urdf, &o, 5));
	free(urdf);
}

static void check_file(const char *path, const char *name, void *context)
{
	for (int floating = 0; floating < 2; floating++) {
		struct subject *s = calloc(1, sizeof *s);

		open_robot(s, path, name, floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED, "want regressor\n");
		reference_sample(s->reference, &s->rng, false, s->q, s->qd, s->qdd);
		settle(s);
		evaluate(s);
		check_product(s);
		*(int *)context += 1;
		subject_close(s);
		free(s);
	}
}

static void check_real(const char *path, const char *name, void *context)
{
	if (strncmp(name, "xfail", 5))
		check_file(path, name, context);
}

START_TEST(robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	int count = 0;

	for_each_urdf(TEST_DIR "/robots", check_file, &count);
	ck_assert_int_gt(count, 40);
	if (folder)
		for_each_urdf(folder, check_real, &count);
	else
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
	printf("%d robots and bases, seed 5\n", count);
}
END_TEST

/* A held joint whose link stays a body of its own, which costs less there, is in the columns of the body that carries it. */
START_TEST(held_body)
{
	struct subject *s = calloc(1, sizeof *s);
	int is_own = 0;

	open_robot(s, TEST_DIR "/robots/atlas.urdf", "atlas", _i ? RNEAGEN_FLOATING : RNEAGEN_FIXED,
		_i ? "lock back_bkx=0.3\nwant regressor,tau\n" : "lock back_bkx=0.3\nwant regressor\n");
	s->held = entry_named(s->reference, "back_bkx");
	s->at = 0.3;
	for (int k = 0; k < s->model.tree.body_count; k++)
		is_own |= s->model.tree.bodies[k].type == JOINT_FIXED;
	ck_assert(is_own);
	ck_assert_int_eq(s->p.cols, 10 * (29 + _i));
	reference_sample(s->reference, &s->rng, false, s->q, s->qd, s->qdd);
	settle(s);
	evaluate(s);
	check_product(s);
	check_columns(s);
	subject_close(s);
	free(s);
}
END_TEST

/* ---- at the qdd found ---- */

/* tau is an input there: Y pi is that again. */
START_TEST(forward)
{
	static const struct {
		const char *name;
		enum rneagen_base base;
	} of[] = {{"iiwa14", RNEAGEN_FIXED}, {"panda", RNEAGEN_FIXED}, {"hyq", RNEAGEN_FLOATING}};
	struct subject *s = calloc(1, sizeof *s);
	char path[512];

	snprintf(path, sizeof path, "%s/robots/%s.urdf", TEST_DIR, of[_i].name);
	open_robot(s, path, of[_i].name, of[_i].base, "want qdd,regressor\n");
	for (int k = 0; k < FORWARD_STATES; k++) {
		reference_sample(s->reference, &s->rng, false, s->q, s->qd, s->qdd);
		settle(s);
		for (int i = 0; i < s->model.tree.nv; i++)
			s->in[3][i] = (real)rng_uniform(&s->rng, -5, 5);
		evaluate(s);
		for (int i = 0; i < s->model.tree.nv; i++) {
			real sum = 0, most = 0;

			for (int c = 0; c < s->p.cols; c++) {
				sum += element(s, i, c) * s->pi[c];
				most += fabsl(element(s, i, c) * s->pi[c]);
			}
			ck_assert_msg(fabsl(sum - s->in[3][i]) <= 1e-12L * most,
				"%s: row %d of Y pi at the qdd found is %Lg, and tau %Lg", s->what, i, sum, s->in[3][i]);
		}
	}
	subject_close(s);
	free(s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("regressor");
	TCase *c = tcase_create("regressor");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_test(c, trees);
	tcase_add_test(c, robots);
	tcase_add_loop_test(c, held_body, 0, 2);
	tcase_add_loop_test(c, forward, 0, 3);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
