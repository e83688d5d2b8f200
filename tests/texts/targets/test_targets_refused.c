/* Texts that are compiled as they must not be, by flags or as another language, say so in the compiler's first error; and where
   clang tells a text nothing of its flags they change nothing. */
#define _POSIX_C_SOURCE 200809L
#include "support/process.h"
#include "support/suite.h"
#include "target/target.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The text of a pendulum in `source`, by a command that compiles it: refused, by an error that has these words, or taken. */
static void check_refused(const struct rneagen_options *o, struct target_path source, const char *const *argv, int is_refused,
	const char *words)
{
	size_t length;
	char *urdf = target_robot("pendulum", &length);
	const char *error, *found;
	struct process p;
	struct target t;

	target_generate(&t, urdf, length, o, "pendulum");
	target_write(source, t.text.source);
	p = process_run(argv);
	ck_assert_msg((p.status != 0) == is_refused, "%s: %d: %s", t.what, p.status, p.output);
	error = strstr(p.output, "error");
	found = error ? strstr(error, words) : NULL;
	ck_assert_msg(!is_refused || (found && found < strchr(error, '\n')), "%s: %s", t.what, p.output);
	process_free(&p);
	target_close(&t);
	unlink(source.s);
	free(urdf);
}

/* A compiler that may reorder sums would make nonsense of sine and cosine. */
START_TEST(fast_math)
{
	static const enum rneagen_target targets[] = {RNEAGEN_TARGET_C, RNEAGEN_TARGET_HEADER, RNEAGEN_TARGET_CUDA};
	static const char *const flags[] = {"-ffast-math", "-funsafe-math-optimizations"};
	struct rneagen_options o = rneagen_options_default();
	struct target_path source = target_path("fast", ".c");
	const char *const argv[] = {"gcc", "-std=c11", "-O2", flags[_i / 3], "-fsyntax-only", source.s, NULL};

	o.target = targets[_i % 3];
	for (int precision = RNEAGEN_F32; precision <= RNEAGEN_F64; precision++) {
		o.precision = (enum rneagen_precision)precision;
		check_refused(&o, source, argv, 1, "without -ffast-math");
	}
}
END_TEST

/* A text with batches has words that C++ lacks. */
START_TEST(batches_as_cxx)
{
	struct rneagen_options o = rneagen_options_default();
	struct target_path source = target_path("as_cxx", ".c");
	const char *const argv[] = {"c++", "-x", "c++", "-std=c++17", "-fsyntax-only", source.s, NULL};

	o.target = RNEAGEN_TARGET_C;
	for (o.only = 0; o.only <= RNEAGEN_ONLY_MAIN; o.only++)
		check_refused(&o, source, argv, !o.only, "this text is C:");
}
END_TEST

/* Numbers without a suffix would be floats. A text whose numbers all have one is the same. */
START_TEST(short_constants)
{
	static const enum rneagen_target targets[] = {RNEAGEN_TARGET_C, RNEAGEN_TARGET_HEADER};
	static const enum rneagen_precision precisions[] = {RNEAGEN_F32, RNEAGEN_F32X2, RNEAGEN_F64, RNEAGEN_MIXED};
	struct rneagen_options o = rneagen_options_default();
	struct target_path source = target_path("short", ".c");
	const char *const argv[] = {"gcc", "-std=c11", "-fsingle-precision-constant", "-fsyntax-only", source.s, NULL};

	o.target = targets[_i];
	for (int i = 0; i < 4; i++) {
		o.precision = precisions[i];
		check_refused(&o, source, argv, o.precision != RNEAGEN_F32, "constants_are_double");
	}
}
END_TEST

/* Where nothing is infinite, a bound that is would be taken for one that is not. */
START_TEST(finite_math)
{
	struct rneagen_options o = rneagen_options_default();
	struct target_path source = target_path("finite", ".c");
	const char *const argv[] = {"gcc", "-std=c11", "-O2", "-ffinite-math-only", "-fsyntax-only", source.s, NULL};

	o.target = RNEAGEN_TARGET_C;
	for (o.bounded = 0; o.bounded <= RNEAGEN_BOUNDS_RUNNING; o.bounded++)
		check_refused(&o, source, argv, o.bounded != 0, "without -ffinite-math-only");
}
END_TEST

/* clang tells a text nothing of these flags: by reordered sums tau of this robot was off by more than itself. */
START_TEST(clang_reorders_nothing)
{
	static const char program[] = "#include <stdio.h>\n#include TEXT\nint main(void)\n{\n\tdouble q[1] = {0.7}, qd[1] = {0.3}, "
		"qdd[1] = {1.1}, tau[1];\n\tpendulum_rnea(q, qd, qdd, tau);\n\tprintf(\"%.12e\", tau[0]);\n\treturn 0;\n}\n";
	static const char *const flags[] = {"-O2", "-ffast-math -fno-finite-math-only", "-funsafe-math-optimizations"};
	struct rneagen_options o = rneagen_options_default();
	struct target_path source = target_path("reordered", ".c"), main_source = target_path("reordered_main", ".c"),
			   binary = target_path("reordered", ".out");
	double first = 0;
	size_t length;
	struct target t;
	char *urdf;

	if (!process_exists("clang")) {
		printf("skipped: no clang\n");
		return;
	}
	o.precision = RNEAGEN_F64;
	urdf = target_robot("pendulum", &length);
	target_generate(&t, urdf, length, &o, "pendulum");
	target_write(source, t.text.source);
	target_write(main_source, program);
	for (int i = 0; i < 3; i++) {
		char command[4096];
		const char *const argv[] = {"sh", "-c", command, NULL};
		struct process p;

		snprintf(command, sizeof command, "clang -std=c11 -O2 %s -DTEXT='\"%s\"' %s -o %s -lm && %s", flags[i], source.s,
			main_source.s, binary.s, binary.s);
		p = process_run(argv);
		ck_assert_msg(p.status == 0, "%s", p.output);
		if (i == 0)
			first = strtod(p.output, NULL);
		ck_assert_msg(first != 0 && fabs(strtod(p.output, NULL) / first - 1) < 1e-12, "%s: %s", flags[i], p.output);
		process_free(&p);
	}
	target_close(&t);
	unlink(source.s);
	unlink(main_source.s);
	unlink(binary.s);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("refused compilers");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "fast", fast_math, 6, 1200);
	suite_add(suite, "batches", batches_as_cxx, 1, 60);
	suite_add(suite, "short constants", short_constants, 2, 1200);
	suite_add(suite, "finite", finite_math, 1, 1200);
	suite_add(suite, "reordered", clang_reorders_nothing, 1, 60);
	return suite_run(suite);
}
