/* How C compilers take the texts: they make vectors of the loops over samples, and C++ without CUDA is refused. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/model.h"
#include "support/process.h"
#include "support/suite.h"
#include "target/target.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void generate(struct target *t, const char *robot, struct rneagen_options o, enum rneagen_target target)
{
	size_t length;
	char *urdf = target_robot(robot, &length);

	o.target = target;
	target_generate(t, urdf, length, &o, robot);
	free(urdf);
}

static const char *const COMPILERS[] = {"gcc", "clang"};

/* The compiler says FILE:LINE of every loop that it made vectors of: is it the line of the n-th loop of independent
   samples? */
static int is_vectorised(const char *said, const char *file, const char *text, int n)
{
	static const char mark[] = "\tRNEA_INDEPENDENT\n";
	const char *loop = text;
	char place[600];
	int line = 1;

	for (int i = 0; i <= n; i++) {
		loop = strstr(loop, mark);
		ck_assert_msg(loop != NULL, "%s: no loop %d of independent samples", file, n);
		loop += strlen(mark);
	}
	for (const char *s = text; s < loop; s++)
		line += *s == '\n';
	snprintf(place, sizeof place, "%s:%d:", strrchr(file, '/'), line);
	return strstr(said, place) != NULL;
}

/* loops: so many from the first on; except: but for this one. */
static void check_loops(enum rneagen_target target, const struct rneagen_options *o, const char *compiler, int loops, int except)
{
	struct target_path source = target_path("vectors", target == RNEAGEN_TARGET_C ? ".c" : ".cu"),
			   object = target_path("vectors", ".o");
	int is_clang = !strcmp(compiler, "clang");
	const char *report = is_clang ? "-Rpass=loop-vectorize" : "-fopt-info-vec-optimized";
	const char *const argv[] = {
		compiler, "-std=c11", "-O3", "-g", report, "-c", "-o", object.s, "-x", "c", source.s, NULL};
	struct process p;
	struct target t;

	generate(&t, "iiwa14", *o, target);
	target_write(source, t.text.source);
	p = process_run(argv);
	ck_assert_msg(p.status == 0, "%s: %s: %.2000s", t.what, compiler, p.output);
	for (int n = 0; n < loops; n++)
		ck_assert_msg(n == except || is_vectorised(p.output, source.s, t.text.source, n),
			"%s: %s: loop %d stays scalar: %.2000s", t.what, compiler, n, p.output);
	process_free(&p);
	target_close(&t);
	unlink(source.s);
	unlink(object.s);
}

static void check_vectors(enum rneagen_target target, const struct rneagen_options *o, const char *compiler)
{
	check_loops(target, o, compiler, MODEL_DAGS, strcmp(compiler, "clang") ? -1 : ALGORITHM_fpass);
}

/* Rows of neighbouring samples lie together: every loop, of slices and batches alike. Only clang 14 leaves fpass's
   scalar in some f32 texts: it says that it cannot prove it safe to reorder its accesses. */
START_TEST(vectors)
{
	struct rneagen_options o = rneagen_options_default();

	if (!process_exists(COMPILERS[_i])) {
		printf("skipped: no %s\n", COMPILERS[_i]);
		return;
	}
	for (int precision = RNEAGEN_F32; precision <= RNEAGEN_F64; precision++)
		for (int trig = RNEAGEN_ACCURATE; trig <= RNEAGEN_FAST; trig++) {
			o.precision = (enum rneagen_precision)precision;
			o.trig = (enum rneagen_trig)trig;
			if (!exhaustive() && trig == (precision == RNEAGEN_F32 ? RNEAGEN_BOUNDED : RNEAGEN_FAST))
				continue;
			/* one target for each, the other one for the other compiler, unless all is asked for */
			if (exhaustive() || (precision + trig + _i) % 2)
				check_vectors(RNEAGEN_TARGET_C, &o, COMPILERS[_i]);
			if (exhaustive() || (precision + trig + _i) % 2 == 0)
				check_vectors(RNEAGEN_TARGET_CUDA, &o, COMPILERS[_i]);
		}
}
END_TEST

/* Matrices too, in segments: clang leaves the whole of them scalar. */
START_TEST(segments)
{
	struct rneagen_options o = rneagen_options_default();

	if (!process_exists(COMPILERS[_i])) {
		printf("skipped: no %s\n", COMPILERS[_i]);
		return;
	}
	o.scene = "want tau,dtau_dq,dtau_dqd\n";
	o.segments = 500;
	check_loops(RNEAGEN_TARGET_C, &o, COMPILERS[_i], 4, -1);
}
END_TEST

/* C++ without CUDA is neither. */
START_TEST(plain_cpp_is_refused)
{
	struct target_path source = target_path("plain", ".cu");
	const char *const argv[] = {"g++", "-x", "c++", "-fsyntax-only", source.s, NULL};
	struct rneagen_options o = rneagen_options_default();
	struct process p;
	struct target t;

	generate(&t, "pendulum", o, RNEAGEN_TARGET_CUDA);
	target_write(source, t.text.source);
	p = process_run(argv);
	ck_assert_msg(p.status && strstr(p.output, "compile this text as CUDA, by nvcc or NVRTC, or as C"), "%d: %.500s",
		p.status, p.output);
	process_free(&p);
	target_close(&t);
	unlink(source.s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("vectors");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "vectors", vectors, 2, 1200);
	suite_add(suite, "segments", segments, 2, 1200);
	suite_add(suite, "plain", plain_cpp_is_refused, 1, 1200);
	return suite_run(suite);
}
