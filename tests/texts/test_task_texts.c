/* Texts of tasks, run by librnea on the host and on the pretended device, against the evaluated DAG: precisions, layouts,
   modes, both targets, inputs by sample and by batch; compilers have nothing to say of them; and how arrays are bound. */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "support/task/task.h"
#include "target/target.h"
#include "support/urdf_text.h"
#include "rnea.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* More than one block, and a last one that is not full. */
enum { COUNT = 300, LINKS = 7 };

static const struct combination {
	enum rneagen_target target;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum rneagen_trig trig;
	int strict, bounded;
} COMBINATIONS[] = {
	{RNEAGEN_TARGET_C, RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, 0},
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_FAST, 0, 0},
	{RNEAGEN_TARGET_C, RNEAGEN_MIXED, RNEAGEN_SOA, RNEAGEN_BOUNDED, 0, 0},
	{RNEAGEN_TARGET_C, RNEAGEN_F64, RNEAGEN_AOS, RNEAGEN_ACCURATE, 1, 0},
	{RNEAGEN_TARGET_C, RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, 1},
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 1, 1},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_ACCURATE, 0, 0},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, 0},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F64, RNEAGEN_AOS, RNEAGEN_BOUNDED, 0, 0},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_MIXED, RNEAGEN_AOS, RNEAGEN_ACCURATE, 0, 0},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_BOUNDED, 1, 0},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32X2, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, 0},
};
enum { COMBINATION_COUNT = sizeof COMBINATIONS / sizeof *COMBINATIONS };

/* ---- states ---- */

static void *arrays[DAG_ARGUMENTS];
static real expected[DAG_ARGUMENTS][ROWS][COUNT], allowed[DAG_ARGUMENTS][ROWS][COUNT];

/* Another state, and other values of the inputs by sample; given rows stay. */
static void draw_sample(struct task_case *c)
{
	double q[ROWS], qd[ROWS], qdd[ROWS];

	reference_sample(c->r, &c->rng, true, q, qd, qdd);
	for (int i = 0; i < c->r->nq; i++)
		c->q[i] = c->q_given[i] ? c->q[i] : q[i];
	for (int i = 0; i < c->r->nv; i++) {
		c->qd[i] = c->qd_given[i] ? c->qd[i] : qd[i];
		c->qdd[i] = c->qdd_given[i] ? c->qdd[i] : qdd[i];
	}
	for (int i = 0; i < c->in_count; i++)
		for (int k = 0; k < c->in[i].rows && !c->in[i].per_batch; k++)
			c->in[i].value[k] = (double)(float)rng_uniform(&c->rng, 0, 2);
}

static void put(const struct rnea_info *info, int argument, int rows, int sample, int row, double value)
{
	int at = info->arguments[argument].per_batch ? row : info->layout == RNEA_AOS ? sample * rows + row
		: row * COUNT + sample;

	if (info->precision == RNEA_F64)
		((double *)arrays[argument])[at] = value;
	else
		((float *)arrays[argument])[at] = (float)value;
}

static real get(const struct rnea_info *info, int argument, int rows, int sample, int row)
{
	int at = info->layout == RNEA_AOS ? sample * rows + row : row * COUNT + sample;

	return info->precision == RNEA_F64 ? (real)((double *)arrays[argument])[at] : (real)((float *)arrays[argument])[at];
}

/* What the text computes, within twice the evaluator's own bound. */
static void expect_sample(const struct dag *d, const struct combination *t, const struct task_arrays *x, int sample)
{
	static double in[DAG_ARGUMENTS][ROWS], out[DAG_ARGUMENTS][ROWS], bound[DAG_ARGUMENTS * ROWS];
	static float in_f32[DAG_ARGUMENTS][ROWS], out_f32[DAG_ARGUMENTS][ROWS];
	const double *ins[DAG_ARGUMENTS] = {0};
	const float *ins_f32[DAG_ARGUMENTS] = {0};
	double *outs[DAG_ARGUMENTS] = {0};
	float *outs_f32[DAG_ARGUMENTS] = {0};
	int is_f32 = t->precision == RNEAGEN_F32, in_memory_f32 = is_f32 || t->precision == RNEAGEN_MIXED;
	real more = t->precision == RNEAGEN_F32X2 ? 64 : t->trig == RNEAGEN_FAST ? 16 : 2;

	for (int k = 0; k < d->argument_count; k++) {
		for (int i = 0; i < d->arguments[k].rows; i++) {
			in_f32[k][i] = (float)x->in[k][i];
			in[k][i] = in_memory_f32 ? (double)in_f32[k][i] : x->in[k][i];
		}
		*(d->arguments[k].is_output ? (const double **)&outs[k] : &ins[k]) = d->arguments[k].is_output ? out[k] : in[k];
		*(d->arguments[k].is_output ? (const float **)&outs_f32[k] : &ins_f32[k]) = d->arguments[k].is_output
			? out_f32[k] : in_f32[k];
	}
	if (is_f32)
		ck_assert(eval_f32(d, ins_f32, outs_f32, &(struct eval_terms){.bound = bound}));
	else
		ck_assert(eval_f64(d, ins, outs, &(struct eval_terms){.bound = bound}));
	for (size_t i = 0; i < d->output_count; i++) {
		int k = d->outputs[i].argument, row = d->outputs[i].row;

		expected[k][row][sample] = is_f32 ? (real)out_f32[k][row] : (real)out[k][row];
		allowed[k][row][sample] = more * (real)bound[i] +
			(in_memory_f32 && !is_f32 ? fabsl(expected[k][row][sample]) * 0x1p-23L : 0);
	}
}

static void fill(struct task_case *c, const struct scene_model *m, const struct combination *t, const struct rnea_info *info)
{
	static struct task_arrays x;
	const struct dag *d = &m->dag;

	ck_assert_int_eq((int)(info->input_count + info->output_count), d->argument_count);
	for (int k = 0; k < d->argument_count; k++) {
		ck_assert_str_eq(info->arguments[k].name, d->arguments[k].name);
		ck_assert_int_eq(info->arguments[k].per_batch, d->arguments[k].per_batch);
		arrays[k] = calloc((size_t)(COUNT * d->arguments[k].rows), sizeof(double));
	}
	for (int sample = 0; sample < COUNT; sample++) {
		draw_sample(c);
		case_feed(c, m, &x);
		expect_sample(d, t, &x, sample);
		for (int k = 0; k < d->argument_count; k++)
			for (int i = 0; i < d->arguments[k].rows && !d->arguments[k].is_output; i++)
				put(info, k, d->arguments[k].rows, sample, i, x.in[k][i]);
	}
}

/* Nothing of what was run before stays. */
static void spoil(const struct dag *d)
{
	for (int k = 0; k < d->argument_count; k++)
		if (d->arguments[k].is_output)
			memset(arrays[k], 0xff, (size_t)(COUNT * d->arguments[k].rows) * sizeof(double));
}

static void compare(const struct rnea_info *info, const struct dag *d, const char *what)
{
	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; i < d->arguments[k].rows && d->arguments[k].is_output; i++)
			for (int sample = 0; sample < COUNT; sample++) {
				real got = get(info, k, d->arguments[k].rows, sample, i);

				ck_assert_msg(fabsl(got - expected[k][i][sample]) <= allowed[k][i][sample],
					"%s: %s row %d of sample %d: %.17Lg, not %.17Lg (%.3Lg)", what,
					d->arguments[k].name, i, sample, got, expected[k][i][sample],
					allowed[k][i][sample]);
			}
}

/* ---- texts ---- */

/* An input by batch, one by sample, a row that is given, a force, and more outputs than one, beside what is drawn. */
static struct task_case *draw_case(const struct combination *t, uint64_t seed)
{
	struct task_case *c = case_random(seed, LINKS, seed % 3 ? NO_ODD_NAMES : 0);

	ck_assert(c != NULL);
	c->options.target = t->target;
	c->options.precision = t->precision;
	c->options.layout = t->layout;
	c->options.trig = t->trig;
	c->options.strict = t->strict;
	c->options.bounded = t->bounded;
	case_draw_folds(c);
	case_free_gravity(c, 0);
	case_free_inertia(c, case_pick(c, case_moves), 0);
	case_add_payload(c, case_pick(c, case_moves), 0);
	case_draw_frees(c, 0);
	case_draw_pushes(c);
	if (t->bounded)
		case_damping(c);
	else
		case_draw_own(c);
	case_want(c, TASK_TAU, 0);
	for (int i = 0; i < 2 && !t->bounded; i++)
		case_draw_wants(c);
	return c;
}

static void run_on(struct task_case *c, const struct scene_model *m, const struct combination *t, const struct target *text,
	enum rnea_backend backend, const char *what)
{
	struct rnea_options o = {.backend = backend, .cache = ""};
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(!rnea_open(text->text.source, strlen(text->text.source), &o, &robot, &e), "%s: %s", what, e.message);
	fill(c, m, t, rnea_info(robot));
	for (int i = 0; i < c->in_count; i++)
		ck_assert_msg(rnea_bind(robot, c->in[i].word) == rnea_bind(robot,
			m->dag.arguments[rnea_bind(robot, c->in[i].word)].name), "%s",
			c->in[i].word);
	for (int launch = backend != RNEA_BACKEND_HOST; launch < 2; launch++) {
		spoil(&m->dag);
		ck_assert_msg(
			!(launch ? rnea_run(robot, arrays, COUNT, &e) : rnea_launch(robot, arrays, COUNT, NULL, &e)),
			"%s: %s", what, e.message);
		compare(rnea_info(robot), &m->dag, what);
	}
	for (int k = 0; k < m->dag.argument_count; k++)
		free(arrays[k]);
	rnea_close(robot);
}

static void compile_c(const struct target *t, const char *stem)
{
	static const char *const compilers[] = {"gcc", "clang"};
	struct target_path source = target_path(stem, ".c"), header = target_path(stem, ".h"), object = target_path(stem, ".o");

	target_write(source, t->text.source);
	target_write(header, t->text.header);
	for (int i = 0; i < 2; i++) {
		const char *const argv[] = {compilers[i], "-std=c11", WARNING_FLAGS, "-Wshadow", "-c", "-o",
			object.s, source.s, NULL};
		const struct compiler c = {compilers[i], {NULL}};

		if (compiler_serves(&c, 0))
			target_compile(t, argv);
	}
	unlink(source.s);
	unlink(header.s);
	unlink(object.s);
}

static void compile_cuda(const struct target *t, const char *stem)
{
	struct target_path source = target_path(stem, ".cu"), object = target_path(stem, ".ptx");
	const char *const argv[] = {target_nvcc(), "-arch=sm_90", "-Werror", "all-warnings", "-ptx", "-o", object.s, source.s, NULL};

	if (!argv[0])
		return;
	target_write(source, t->text.source);
	target_compile(t, argv);
	unlink(source.s);
	unlink(object.s);
}

START_TEST(texts)
{
	const struct combination *t = &COMBINATIONS[_i];
	uint64_t seed = (uint64_t)(300 + _i);
	struct task_case *c = draw_case(t, seed);
	struct scene_model m;
	struct target text;
	char stem[64];

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	snprintf(stem, sizeof stem, "task_%d", _i);
	c->options.name = stem;
	ck_assert_msg(!scene_open(&m, c->urdf, &c->options), "seed %d: %s", (int)seed, m.error.message);
	target_generate(&text, c->urdf, strlen(c->urdf), &c->options, stem);
	snprintf(text.what + strlen(text.what), sizeof text.what - strlen(text.what), ", seed %d", (int)seed);
	if (t->target == RNEAGEN_TARGET_C)
		compile_c(&text, stem);
	else if (_i % 2 == 0)
		compile_cuda(&text, stem);
	run_on(c, &m, t, &text, RNEA_BACKEND_HOST, text.what);
	if (t->target == RNEAGEN_TARGET_CUDA)
		run_on(c, &m, t, &text, RNEA_BACKEND_CUDA, text.what);
	printf("%s: %d arrays in, %d out\n", text.what, m.dag.argument_count - c->out_count, c->out_count);
	target_close(&text);
	scene_close(&m);
	case_close(c);
}
END_TEST

/* ---- binding ---- */

static struct rnea_robot *open_bound(const char *scene)
{
	static const char urdf[] =
		ROBOT("r", BALL("world") BALL("left hand") BALL("left_hand") BALL("tool_")
				   JOINT("turn", "revolute", "world", "left hand", AXIS("0 0 1"))
					   JOINT("a=\xc3\xb6", "revolute", "left hand", "left_hand", AXIS("0 1 0"))
						   JOINT("weld", "fixed", "left_hand", "tool_", ""));
	struct rneagen_options o = rneagen_options_default();
	struct rnea_options host = {.backend = RNEA_BACKEND_HOST, .cache = ""};
	struct rneagen_result text;
	struct rneagen_error wrong;
	struct rnea_robot *robot;
	struct rnea_error e;

	o.target = RNEAGEN_TARGET_C;
	o.scene = scene;
	ck_assert_msg(!rneagen_generate(urdf, sizeof urdf - 1, &o, &text, &wrong), "%s", wrong.message);
	ck_assert_msg(!rnea_open(text.source, strlen(text.source), &host, &robot, &e), "%s", e.message);
	rneagen_result_free(&text);
	return robot;
}

/* A scene's word does for its array. */
START_TEST(bound)
{
	static const struct {
		const char *word;
		int index;
	} words[] = {{"payload.left hand", 3}, {"payload_left_hand", 3}, {"offset.a=\xc3\xb6", 4},
		{"mass.left_hand", 5}, {"inertia.tool_", 6}, {"fext.left hand", 7}, {"fext.tool_", 8},
		{"twist.tool_", 9}, {"tau", 10}, {"payload.left", -1}, {"payload.left hands", -1}, {"mass.tool_", -1},
		{"", -1}, {NULL, -1}};
	struct rnea_robot *robot = open_bound("free payload.left hand\nfree offset.a=\xc3\xb6\nfree mass.left_hand\nfree inertia.tool_\n"
					      "fext left hand,tool_\nwant twist.tool_,tau");

	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		ck_assert_msg(rnea_bind(robot, words[i].word) == words[i].index, "%s: %d", words[i].word,
			rnea_bind(robot, words[i].word));
	rnea_close(robot);
}
END_TEST

/* But not where another word comes out the same: the wrong array would be worse than none. */
START_TEST(bound_twice)
{
	struct rnea_robot *robot = open_bound("free payload.left hand\nfree payload.left_hand\nfree mass.tool_");

	ck_assert_int_eq(rnea_bind(robot, "payload.left hand"), -1);
	ck_assert_int_eq(rnea_bind(robot, "payload.left_hand"), -1);
	ck_assert_int_eq(rnea_bind(robot, "payload_left_hand"), 3);
	ck_assert_int_eq(rnea_bind(robot, "payload_left_hand_2"), 4);
	ck_assert_int_eq(rnea_bind(robot, "mass.tool_"), 5);
	rnea_close(robot);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("task_texts");
	TCase *c = tcase_create("texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_loop_test(c, texts, 0, COMBINATION_COUNT);
	tcase_add_test(c, bound);
	tcase_add_test(c, bound_twice);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
