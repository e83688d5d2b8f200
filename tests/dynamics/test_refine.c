/* --refine: with a residual in f64, qdd in f32 is off by its own rounding and little else, and at least 20 times less than
   without, beside the same expressions in extended precision; whatever a scene frees, pulls or damps; by factors and by
   articulated bodies. No number of one type is taken for one of the other. It would catch a term that the residual lacks, an
   input that it reads in f32, a constant of f32 in it, and refinement without an effect. */
#include "support/suite.h"
#include "support/scene_model.h"
#include "dag/eval.h"
#include "draw/draw.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 30, GAIN = 20 };

static const struct draw_options DRAWN = {.seed = 1, .count = SAMPLES, .each = 1};

static struct scene_model open_scene(const char *urdf, const char *scene, int is_floating)
{
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.scene = scene;
	o.precision = RNEAGEN_F32;
	o.base = is_floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s", m.error.message);
	return m;
}

/* ---- values: [argument][row], NULL: none ---- */

struct values {
	float *f32[DAG_ARGUMENTS];
	real *exact[DAG_ARGUMENTS];
};

static void alloc_values(struct values *v, const struct dag *d, struct arena *a)
{
	for (int k = 0; k < d->argument_count; k++) {
		v->f32[k] = arena_alloc(a, (size_t)d->arguments[k].rows, sizeof(float));
		v->exact[k] = arena_alloc(a, (size_t)d->arguments[k].rows, sizeof(real));
	}
}

static void set(struct values *v, int argument, int row, real x)
{
	v->f32[argument][row] = (float)x;
	v->exact[argument][row] = (real)v->f32[argument][row];
}

static void draw(struct values *v, const struct dag *d, const struct drawn *x, size_t sample)
{
	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; i < d->arguments[k].rows && !d->arguments[k].is_output; i++)
			set(v, k, i, (real)draw_rows(x, &d->arguments[k], sample)[i]);
}

static void split(const struct dag *d, void *const *all, void **in, void **out)
{
	for (int k = 0; k < d->argument_count; k++) {
		in[k] = d->arguments[k].is_output ? NULL : all[k];
		out[k] = d->arguments[k].is_output ? all[k] : NULL;
	}
}

static void evaluate(const struct dag *d, const struct values *v, int is_exact)
{
	void *in[DAG_ARGUMENTS], *out[DAG_ARGUMENTS], *all[DAG_ARGUMENTS];

	for (int k = 0; k < d->argument_count; k++)
		all[k] = is_exact ? (void *)v->exact[k] : (void *)v->f32[k];
	split(d, all, in, out);
	if (is_exact)
		ck_assert(eval_real(d, (const real *const *)in, (real *const *)out, NULL));
	else
		ck_assert(eval_f32(d, (const float *const *)in, (float *const *)out, NULL));
}

/* Of an output, by the norm. */
static double error_of(const struct dag *d, const struct values *v, int argument)
{
	real off = 0, size = 0;

	for (int i = 0; i < d->arguments[argument].rows; i++) {
		real e = (real)v->f32[argument][i] - v->exact[argument][i];

		off += e * e;
		size += v->exact[argument][i] * v->exact[argument][i];
	}
	return (double)sqrtl(off / size);
}

/* ---- robots ---- */

static const struct {
	const char *name;
	int is_floating;
} ROBOTS[] = {{"iiwa14", 0}, {"panda", 0}, {"hyq", 0}, {"hyq", 1}, {"atlas", 0}, {"allegro_right", 0}, {"shadow_hand_right", 0}};
enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS };

/* tau of joints that accelerate by up to 10, as motions have it: torques that are drawn by themselves throw a wrist away, and its
   acceleration then is the norm. */
static void draw_motion(struct values *v, const struct scene_model *fd, const struct scene_model *id,
	const struct drawn *x, size_t sample)
{
	struct values w;
	const struct dag *d = &id->dag;
	struct arena a;

	arena_init(&a, NULL);
	alloc_values(&w, d, &a);
	draw(&w, d, x, sample);
	evaluate(d, &w, 1);
	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0, to = dag_find_argument(&fd->dag, d->arguments[k].name); i < d->arguments[k].rows && to >= 0; i++)
			if (!fd->dag.arguments[to].is_output)
				set(v, to, i, w.exact[k][i]);
	arena_free(&a);
}

START_TEST(robots)
{
	char *urdf = robot_text(ROBOTS[_i].name);
	struct scene_model id = open_scene(urdf, NULL, ROBOTS[_i].is_floating),
		plain = open_scene(urdf, "want qdd", ROBOTS[_i].is_floating);
	struct scene_model refined = open_scene(urdf, "want qdd\nrefine 1:f64", ROBOTS[_i].is_floating);
	double worst = 0, worst_refined = 0;
	struct values v;
	struct drawn x;
	int qdd = dag_find_argument(&plain.dag, "qdd");

	ck_assert(draw_inputs(&x, &id.tree, &id.analysis.request, &DRAWN, &id.arena));
	draw_round(&x);
	alloc_values(&v, &plain.dag, &plain.arena);
	for (size_t s = 0; s < SAMPLES; s++) {
		draw_motion(&v, &plain, &id, &x, s);
		evaluate(&plain.dag, &v, 1);
		evaluate(&plain.dag, &v, 0);
		worst = fmax(worst, error_of(&plain.dag, &v, qdd));
		evaluate(&refined.dag, &v, 0);
		worst_refined = fmax(worst_refined, error_of(&plain.dag, &v, qdd));
	}
	printf("%s%s: %.1e, refined %.1e\n", ROBOTS[_i].name, ROBOTS[_i].is_floating ? ", floating" : "", worst, worst_refined);
	ck_assert_msg(worst_refined <= 1.1 * 0x1p-24, "%s: refined %.2e", ROBOTS[_i].name, worst_refined);
	ck_assert_msg(GAIN * worst_refined <= worst, "%s: %.2e, refined %.2e", ROBOTS[_i].name, worst, worst_refined);
	scene_close(&id);
	scene_close(&plain);
	scene_close(&refined);
	free(urdf);
}
END_TEST

/* ---- scenes ---- */

/* A body that floats between others goes by articulated bodies: its quaternion in f32 has no norm of one, which M by factors
   takes it to have, and ID does not. */
static const struct {
	const char *robot, *scene;
} SCENES[] = {
	{"iiwa14", "want qdd\nfree gravity,payload.iiwa_link_ee,mass.iiwa_link_3:batch,inertia.iiwa_link_5,offset.iiwa_joint_4"},
	{"iiwa14", "want qdd\nfext iiwa_link_ee,iiwa_link_4\nfext-frame world\nfold qd.iiwa_joint_2=0.5\nfold tau.iiwa_joint_7=0.1"},
	{"iiwa14", "want qdd\ndamping\nfriction 0.1\narmature iiwa_joint_3=0.2\nfext iiwa_link_ee\ndynamics articulated"},
	{"mimic_chain", "want qdd\nfriction 0.1\ndamping\nfext hand\nfree payload.hand"},
	{"planar_joint", "want qdd\nfree gravity\ndynamics factor"},
	{"floating_joint", "want qdd\nfree payload.body\ndynamics articulated"},
	{"floating_joint", "want qdd\nlock c_left=0.3\nfext body\ndynamics articulated"}};
enum { SCENE_COUNT = sizeof SCENES / sizeof *SCENES };

/* Only WIDEN and NARROW go from one type to the other. */
static void check_types(const struct dag *d, const char *what)
{
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		for (int k = 0; k < op_arity[n->op]; k++) {
			const struct node *a = &d->nodes[n->arg[k].i];
			int reads_wide = n->op == OP_WIDEN ? 0 : n->op == OP_NARROW ? 1 : (int)n->is_wide;

			ck_assert_msg((int)a->is_wide == reads_wide || n->arg[k].i == 0,
				"%s: operand %d of node %zu, %s, is of the other type", what, k, i, op_name[n->op]);
		}
	}
	for (size_t i = 0; i < d->output_count; i++)
		ck_assert(!d->nodes[d->outputs[i].value.i].is_wide);
	ck_assert(dag_has_wide(d));
}

START_TEST(scenes)
{
	char *urdf = robot_text(SCENES[_i].robot), scene[512];
	struct scene_model plain = open_scene(urdf, SCENES[_i].scene, 0), refined;
	double worst = 0, worst_refined = 0;
	struct values v;
	struct drawn x;
	int qdd = dag_find_argument(&plain.dag, "qdd");

	snprintf(scene, sizeof scene, "%s\nrefine 1", SCENES[_i].scene);
	refined = open_scene(urdf, scene, 0);
	check_types(&refined.dag, SCENES[_i].robot);
	ck_assert(draw_inputs(&x, &plain.tree, &plain.analysis.request, &DRAWN, &plain.arena));
	alloc_values(&v, &plain.dag, &plain.arena);
	for (size_t s = 0; s < SAMPLES; s++) {
		draw(&v, &plain.dag, &x, s);
		evaluate(&plain.dag, &v, 1);
		evaluate(&plain.dag, &v, 0);
		worst = fmax(worst, error_of(&plain.dag, &v, qdd));
		evaluate(&refined.dag, &v, 0);
		worst_refined = fmax(worst_refined, error_of(&plain.dag, &v, qdd));
	}
	printf("%s: %.1e, refined %.1e\n", SCENES[_i].robot, worst, worst_refined);
	ck_assert_msg(worst_refined <= 1.1 * 0x1p-24, "%s: refined %.2e", SCENES[_i].scene, worst_refined);
	scene_close(&plain);
	scene_close(&refined);
	free(urdf);
}
END_TEST

/* What is wanted beside qdd is taken at the qdd that is refined: power = tau.qd of the torques of that qdd. */
START_TEST(others)
{
	char *urdf = robot_text("iiwa14");
	struct scene_model m = open_scene(urdf, "want qdd,accel.iiwa_link_1\nrefine 1", 0);
	int qdd = dag_find_argument(&m.dag, "qdd"), accel = dag_find_argument(&m.dag, "accel_iiwa_link_1");
	struct values v;
	struct drawn x;

	ck_assert(accel >= 0 && draw_inputs(&x, &m.tree, &m.analysis.request, &DRAWN, &m.arena));
	alloc_values(&v, &m.dag, &m.arena);
	for (size_t s = 0; s < SAMPLES; s++) {
		draw(&v, &m.dag, &x, s);
		evaluate(&m.dag, &v, 0);
		ck_assert(v.f32[accel][5] == v.f32[qdd][0]); /* about the axis of the first joint */
	}
	scene_close(&m);
	free(urdf);
}
END_TEST

/* ---- bounds ---- */

/* The bound of the evaluator holds, and sees that refinement pays: at most a tenth of that without. */
START_TEST(bounds)
{
	char *urdf = robot_text("iiwa14");
	struct scene_model plain = open_scene(urdf, "want qdd", 0), refined = open_scene(urdf, "want qdd\nrefine 1", 0);
	const struct dag *dags[] = {&plain.dag, &refined.dag};
	int qdd = dag_find_argument(&plain.dag, "qdd");
	double bound[2][ROWS], sum[2] = {0, 0};
	struct values v;
	struct drawn x;

	ck_assert(draw_inputs(&x, &plain.tree, &plain.analysis.request, &DRAWN, &plain.arena));
	alloc_values(&v, &plain.dag, &plain.arena);
	for (size_t s = 0; s < SAMPLES; s++) {
		draw(&v, &plain.dag, &x, s);
		evaluate(&plain.dag, &v, 1);
		for (int i = 0; i < 2; i++) {
			const float *in[] = {v.f32[0], v.f32[1], v.f32[2], NULL};
			float *out[] = {NULL, NULL, NULL, v.f32[qdd]};

			ck_assert(eval_f32(dags[i], in, out, &(struct eval_terms){.bound = bound[i]}));
			for (size_t k = 0; k < dags[i]->output_count; k++) {
				int row = dags[i]->outputs[k].row;

				ck_assert(fabsl((real)v.f32[qdd][row] - v.exact[qdd][row]) <= (real)bound[i][k]);
				sum[i] += bound[i][k];
			}
		}
	}
	printf("mean bound %.1e, refined %.1e\n", sum[0] / SAMPLES, sum[1] / SAMPLES);
	ck_assert(sum[1] <= sum[0] / 10);
	scene_close(&plain);
	scene_close(&refined);
	free(urdf);
}
END_TEST

/* ---- what is refused ---- */

static const struct {
	enum rneagen_precision precision;
	const char *scene, *says;
} REFUSED[] = {
	{RNEAGEN_F32, "refine 1", "--want qdd"}, {RNEAGEN_F32, "want qdd\nrefine 4", "0 to 3 steps"},
	{RNEAGEN_F32, "want qdd\nrefine 1:f16", "not '1:f16'"}, {RNEAGEN_F32, "want qdd\nrefine f64", "not 'f64'"},
	{RNEAGEN_F32, "want qdd\nrefine 1\ndrop-below 1e-6", "drop-below"},
	{RNEAGEN_F64, "want qdd\nrefine 1:f32x2", "take 1:same"}, {RNEAGEN_MIXED, "want qdd\nrefine 2:f32x2", "take 2:same"},
	{RNEAGEN_F32X2, "want qdd\nrefine 1:f64", "take 1:same"}};
enum { REFUSED_COUNT = sizeof REFUSED / sizeof *REFUSED };

START_TEST(refused)
{
	char *urdf = robot_text("double_pendulum");
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.scene = REFUSED[_i].scene;
	o.precision = REFUSED[_i].precision;
	ck_assert_int_eq(scene_open(&m, urdf, &o), RNEAGEN_SCENE);
	ck_assert_msg(strstr(m.error.message, REFUSED[_i].says) != NULL, "%s", m.error.message);
	scene_close(&m);
	free(urdf);
}
END_TEST

/* In f64 and mixed texts the residual is in the text's own numbers: no others. */
START_TEST(same)
{
	static const enum rneagen_precision precisions[] = {RNEAGEN_F64, RNEAGEN_MIXED, RNEAGEN_F32X2, RNEAGEN_F64};
	char *urdf = robot_text("double_pendulum");
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;

	o.scene = _i == 3 ? "want qdd\nrefine 1:f64" : "want qdd\nrefine 1";
	o.precision = precisions[_i];
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s", m.error.message);
	ck_assert(!dag_has_wide(&m.dag) && m.analysis.request.refine_steps == 1);
	scene_close(&m);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("refine");

	suite_add(suite, "robots", robots, ROBOT_COUNT, 20);
	suite_add(suite, "scenes", scenes, SCENE_COUNT, 20);
	suite_add(suite, "others", others, 1, 20);
	suite_add(suite, "bounds", bounds, 1, 60);
	suite_add(suite, "refused", refused, REFUSED_COUNT, 20);
	suite_add(suite, "same", same, 4, 20);
	return suite_run(suite);
}
