/* Texts with --refine, run by librnea on the host and on the pretended device: qdd is within a rounding of f32 of the
   same expressions in extended precision, in every layout, mode and target, angles of 1e5 rad among the drawn; what the
   evaluator makes of the refined expressions is as near. Compilers have nothing to say of the texts, nor of headers of
   all kinds in one file. It would catch a function or a constant of one type of numbers taken for that of the other,
   and an angle too large for the fast way of either. */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "support/scene_model.h"
#include "support/urdf_text.h"
#include "target/target.h"
#include "dag/eval.h"
#include "rnea.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* More than one block, and a last one that is not full. */
enum { COUNT = 300, MOST_NV = 7 };

static const struct combination {
	enum rneagen_target target;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum rneagen_trig trig;
	int strict;
	const char *refine, *robot;
	int nv;
} COMBINATIONS[] = {
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "1", "iiwa14", 7},
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_ACCURATE, 1, "1:f64", "fixed_tree", 3},
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_ACCURATE, 0, "1:f32x2", "fixed_tree", 3},
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_BOUNDED, 0, "2:f32x2", "fixed_tree", 3},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "1:f64", "fixed_tree", 3},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_FAST, 0, "1:f64", "fixed_tree", 3},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "1:f32x2", "fixed_tree", 3},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_BOUNDED, 1, "1:f64", "fixed_tree", 3},
	{RNEAGEN_TARGET_C, RNEAGEN_F64, RNEAGEN_AOS, RNEAGEN_ACCURATE, 0, "1", "fixed_tree", 3},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_MIXED, RNEAGEN_SOA, RNEAGEN_BOUNDED, 0, "1", "fixed_tree", 3},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32X2, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "1", "fixed_tree", 3},
};
enum { COMBINATION_COUNT = sizeof COMBINATIONS / sizeof *COMBINATIONS };

static struct rneagen_options options_of(const struct combination *t, char *scene, size_t size)
{
	struct rneagen_options o = rneagen_options_default();

	snprintf(scene, size, "want qdd\nrefine %s", t->refine);
	o.target = t->target;
	o.precision = t->precision;
	o.layout = t->layout;
	o.trig = t->trig;
	o.strict = t->strict;
	o.scene = scene;
	return o;
}

static int in_f32(const struct combination *t)
{
	return t->precision == RNEAGEN_F32 || t->precision == RNEAGEN_MIXED;
}

/* ---- states: q, qd and tau ---- */

struct state {
	double in[3][MOST_NV];
	real exact[MOST_NV];
	float refined[MOST_NV]; /* by the evaluator */
};

/* One in ten has large angles, where the mode has them. */
static void draw(struct state *s, const struct combination *t, struct rng *rng)
{
	double far = t->trig == RNEAGEN_ACCURATE && rng_uniform(rng, 0, 1) < 0.1 ? 1e5 : 2;

	for (int i = 0; i < t->nv; i++) {
		s->in[0][i] = rng_uniform(rng, -far, far);
		s->in[1][i] = rng_uniform(rng, -1, 1);
		s->in[2][i] = rng_uniform(rng, -20, 20);
		for (int k = 0; k < 3 && in_f32(t); k++)
			s->in[k][i] = (double)(float)s->in[k][i];
	}
}

static void evaluate(const struct combination *t, struct state *s, const struct dag *plain, const struct dag *refined)
{
	real in[3][MOST_NV];
	float narrow[3][MOST_NV];

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < t->nv; i++) {
			in[k][i] = (real)s->in[k][i];
			narrow[k][i] = (float)s->in[k][i];
		}
	ck_assert(eval_real(plain, (const real *[]){in[0], in[1], in[2], NULL}, (real *[]){NULL, NULL, NULL, s->exact}, NULL));
	ck_assert(eval_f32(refined, (const float *[]){narrow[0], narrow[1], narrow[2], NULL},
		(float *[]){NULL, NULL, NULL, s->refined}, NULL));
}

/* ---- runs ---- */

static void *arrays[4];

static size_t place(const struct combination *t, int sample, int row)
{
	return (size_t)(t->layout == RNEAGEN_AOS ? sample * t->nv + row : row * COUNT + sample);
}

static void put(const struct combination *t, int array, int sample, int row, double x)
{
	if (in_f32(t))
		((float *)arrays[array])[place(t, sample, row)] = (float)x;
	else
		((double *)arrays[array])[place(t, sample, row)] = x;
}

static double get(const struct combination *t, int sample, int row)
{
	return in_f32(t) ? (double)((float *)arrays[3])[place(t, sample, row)] : ((double *)arrays[3])[place(t, sample, row)];
}

/* Beside its own rounding, what the residual's leaves of the largest. */
static void compare(const struct combination *t, const struct state *states, const char *what)
{
	for (int sample = 0; sample < COUNT; sample++) {
		const struct state *s = &states[sample];
		real largest = 0;

		for (int i = 0; i < t->nv; i++)
			largest = fmaxl(largest, fabsl(s->exact[i]));
		for (int i = 0; i < t->nv; i++) {
			real allowed = (in_f32(t) ? 1.01L * 0x1p-24L * fabsl(s->exact[i]) : 0) + 1e-9L * largest;

			ck_assert_msg(fabsl((real)get(t, sample, i) - s->exact[i]) <= allowed,
				"%s: qdd[%d] of sample %d: %.17g, not %.17Lg", what, i, sample, get(t, sample, i),
				s->exact[i]);
			if (t->precision == RNEAGEN_F32)
				ck_assert_msg(fabsl((real)s->refined[i] - s->exact[i]) <= allowed,
					"%s: evaluated, qdd[%d] of sample %d: %.9g, not %.17Lg", what, i, sample,
					(double)s->refined[i], s->exact[i]);
		}
	}
}

static void run_on(const struct combination *t, const struct state *states, const struct target *text, enum rnea_backend backend)
{
	struct rnea_options o = {.backend = backend, .cache = ""};
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(!rnea_open(text->text.source, strlen(text->text.source), &o, &robot, &e), "%s: %s", text->what, e.message);
	for (int k = 0; k < 4; k++) {
		arrays[k] = calloc(COUNT * MOST_NV, sizeof(double));
		ck_assert_ptr_nonnull(arrays[k]);
		for (int sample = 0; sample < COUNT && k < 3; sample++)
			for (int i = 0; i < t->nv; i++)
				put(t, k, sample, i, states[sample].in[k][i]);
	}
	ck_assert_msg(!rnea_run(robot, arrays, COUNT, &e), "%s: %s", text->what, e.message);
	compare(t, states, text->what);
	for (int k = 0; k < 4; k++)
		free(arrays[k]);
	rnea_close(robot);
}

/* ---- compilers ---- */

static void compile(const struct target *t, const char *const *argv)
{
	const struct compiler c = {argv[0], {NULL}};

	if (compiler_serves(&c, 0))
		target_compile(t, argv);
}

static void compile_text(const struct combination *t, const struct target *text, const char *stem)
{
	struct target_path source = target_path(stem, t->target == RNEAGEN_TARGET_C ? ".c" : ".cu"),
		header = target_path(stem, ".h");
	struct target_path object = target_path(stem, ".o");

	target_write(source, text->text.source);
	if (text->text.header)
		target_write(header, text->text.header);
	compile(text, (const char *const[]){"gcc", "-std=c11", WARNING_FLAGS, "-Wshadow", "-x", "c", "-c", "-o",
			      object.s, source.s, NULL});
	compile(text, (const char *const[]){"clang", "-std=c11", WARNING_FLAGS, "-Wshadow", "-x", "c", "-c", "-o",
			      object.s, source.s, NULL});
	if (t->target == RNEAGEN_TARGET_CUDA && t->precision == RNEAGEN_F32 && t->layout == RNEAGEN_SOA)
		compile(text, (const char *const[]){"/usr/local/cuda/bin/nvcc", "-arch=sm_90", "-Werror",
				      "all-warnings", "-ptx", "-o", object.s, source.s, NULL});
	unlink(source.s);
	unlink(header.s);
	unlink(object.s);
}

static char *robot(const char *name)
{
	size_t length;

	return target_robot(name, &length);
}

START_TEST(texts)
{
	const struct combination *t = &COMBINATIONS[_i];
	char *urdf = robot(t->robot), scene[64], stem[64];
	struct rneagen_options o = options_of(t, scene, sizeof scene), bare = o;
	static struct state states[COUNT];
	struct rng rng = rng_seed((uint64_t)(700 + _i));
	struct scene_model plain, refined;
	struct target text;

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	snprintf(stem, sizeof stem, "refine_%d", _i);
	o.name = stem;
	bare.scene = "want qdd";
	ck_assert_msg(!scene_open(&plain, urdf, &bare), "%s", plain.error.message);
	ck_assert_msg(!scene_open(&refined, urdf, &o), "%s", refined.error.message);
	for (int i = 0; i < COUNT; i++) {
		draw(&states[i], t, &rng);
		evaluate(t, &states[i], &plain.dag, &refined.dag);
	}
	target_generate(&text, urdf, strlen(urdf), &o, stem);
	compile_text(t, &text, stem);
	run_on(t, states, &text, RNEA_BACKEND_HOST);
	if (t->target == RNEAGEN_TARGET_CUDA)
		run_on(t, states, &text, RNEA_BACKEND_CUDA);
	target_close(&text);
	scene_close(&plain);
	scene_close(&refined);
	free(urdf);
}
END_TEST

/* ---- headers ---- */

static const struct combination HEADERS[] = {
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "1:f64", "fixed_tree", 3},
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 1, "1:f64", "fixed_tree", 3},
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "0", "fixed_tree", 3},
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0, "1:f32x2", "fixed_tree", 3},
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F32X2, RNEAGEN_SOA, RNEAGEN_BOUNDED, 0, "1", "fixed_tree", 3}};
enum { HEADER_COUNT = sizeof HEADERS / sizeof *HEADERS };

/* All in one file, in this order or the other. */
START_TEST(headers)
{
	struct target_path source = target_path("refine_headers", ".cpp"), object = target_path("refine_headers", ".o");
	char *urdf = robot("fixed_tree"), scene[64], stem[64];
	struct target text[HEADER_COUNT];
	FILE *f = fopen(source.s, "w");

	ck_assert_ptr_nonnull(f);
	for (int k = 0; k < HEADER_COUNT; k++) {
		int i = _i ? HEADER_COUNT - 1 - k : k;
		struct rneagen_options o = options_of(&HEADERS[i], scene, sizeof scene);

		snprintf(stem, sizeof stem, "refine_header_%d", i);
		o.name = stem;
		target_generate(&text[k], urdf, strlen(urdf), &o, stem);
		fprintf(f, "%s\n%s %s_call(%s *x) { %s_fd(x, x + 3, x + 6, x + 9); }\n", text[k].text.source, "void", stem,
			i == 2 || i == 4 ? "double" : "float", stem);
	}
	fclose(f);
	compile(&text[0], (const char *const[]){"g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-c", "-o",
				  object.s, source.s, NULL});
	compile(&text[0], (const char *const[]){"clang++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-c", "-o",
				  object.s, source.s, NULL});
	for (int k = 0; k < HEADER_COUNT; k++)
		target_close(&text[k]);
	unlink(source.s);
	unlink(object.s);
	free(urdf);
}
END_TEST

/* ---- exclusions ---- */

START_TEST(refused)
{
	static const struct {
		int strict, bounded;
		const char *scene, *says;
	} cases[] = {{1, 0, "want qdd\nrefine 1:f32x2", "--strict and --refine 1:f32x2"},
		{0, 1, "want qdd\nrefine 1", "--bounded and --refine"}};
	char *urdf = robot("fixed_tree");
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result text;
	struct rneagen_error e;

	o.target = RNEAGEN_TARGET_C;
	o.precision = RNEAGEN_F32;
	o.strict = cases[_i].strict;
	o.bounded = cases[_i].bounded;
	o.scene = cases[_i].scene;
	ck_assert_int_eq(rneagen_generate(urdf, strlen(urdf), &o, &text, &e), RNEAGEN_USAGE);
	ck_assert_msg(strstr(e.message, cases[_i].says) != NULL, "%s", e.message);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("refine_texts");

	suite_add(suite, "texts", texts, COMBINATION_COUNT, 120);
	suite_add(suite, "headers", headers, 2, 60);
	suite_add(suite, "refused", refused, 2, 20);
	return suite_run(suite);
}
