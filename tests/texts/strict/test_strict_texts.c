/* --strict: what a text does with its surroundings. A header gives its bits within whatever is computed around it, no
   compiler for GPUs joins a product to a sum, and settings that would change bits are refused. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/process.h"
#include "support/rng.h"
#include "support/suite.h"
#include "target/target.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 7, SEED = 31, SAMPLES = 200 };

/* The text of the arm; `what` is its name. */
static void generate(struct target *t, enum rneagen_target kind, enum rneagen_precision precision, int strict, const char *what)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot("iiwa14", &length);

	o.target = kind;
	o.precision = precision;
	o.strict = strict;
	o.name = what;
	target_generate(t, urdf, length, &o, what);
	free(urdf);
}

/* ---- a header within other arithmetic ---- */

/* Inputs are products and torques go into sums: whatever may be joined, is. */
static const char USER[] =
	"#include \"strict_arm.h\"\n"
	"#ifdef __cplusplus\nextern \"C\"\n#endif\n"
	"void use(const double *x, const double *y, double *out);\n"
	"void use(const double *x, const double *y, double *out)\n{\n"
	"\tdouble q[7], qd[7], qdd[7], tau[7];\n\n"
	"\tfor (int i = 0; i < 7; i++) {\n"
	"\t\tq[i] = x[i]*y[i];\n\t\tqd[i] = x[i]*y[i + 7];\n\t\tqdd[i] = x[i + 7]*y[i];\n\t}\n"
	"\tstrict_arm_rnea(q, qd, qdd, tau);\n"
	"\tfor (int i = 0; i < 7; i++)\n\t\tout[i] = tau[i] + x[i];\n}\n";

/* The first sets the bits. */
static const struct user {
	struct compiler compiler;
	const char *suffix;
	int after_plain; /* a header of the same functions that is not strict stands before it */
} USERS[] = {{{"gcc", {"-O0", "-std=c11"}}, ".c", 0}, {{"gcc", {"-O0", "-std=c11"}}, ".c", 1},
	{{"gcc", {"-O2", "-std=c11"}}, ".c", 0},
	{{"gcc", {"-O3", "-std=gnu11", "-ffp-contract=fast", "-march=x86-64-v3"}}, ".c", 0},
	{{"clang", {"-O3", "-std=c11", "-ffp-contract=fast", "-march=x86-64-v3"}}, ".c", 1},
	{{"g++", {"-O3", "-std=gnu++17", "-ffp-contract=fast", "-march=x86-64-v3"}}, ".cpp", 1}};

static void use_all(const struct target *t, void *library, double *out)
{
	void (*use)(const double *x, const double *y, double *out);
	struct rng r = rng_seed(SEED);

	target_symbol(t, library, "use", &use);
	for (int k = 0; k < SAMPLES; k++) {
		double x[2 * ROWS], y[2 * ROWS], scale = k % 4 ? 2 : 1e4;

		for (int i = 0; i < 2 * ROWS; i++) {
			x[i] = rng_uniform(&r, -scale, scale);
			y[i] = rng_uniform(&r, -scale, scale);
		}
		use(x, y, out + (size_t)k * ROWS);
	}
}

static void run_user(const struct target *t, const struct user *u, double *out)
{
	struct target_path source = target_path("strict_user", u->suffix), library = target_path("strict_user", ".so");
	const char *argv[20] = {u->compiler.command, WARNING_FLAGS, "-fPIC", "-shared", "-o", library.s, source.s};
	char text[2048];
	void *handle;
	int n = 11;

	snprintf(text, sizeof text, "%s%s", u->after_plain ? "#include \"plain_arm.h\"\n" : "", USER);
	target_write(source, text);
	for (int i = 0; u->compiler.flags[i]; i++)
		argv[n++] = u->compiler.flags[i];
	argv[n] = "-lm";
	target_compile(t, argv);
	handle = dlopen(library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(handle != NULL, "%s", dlerror());
	use_all(t, handle, out);
	dlclose(handle);
	unlink(library.s);
	unlink(source.s);
}

START_TEST(header_keeps_its_bits)
{
	static double first[SAMPLES * ROWS], now[SAMPLES * ROWS];
	struct target strict, plain;

	generate(&strict, RNEAGEN_TARGET_HEADER, RNEAGEN_F64, 1, "strict_arm");
	generate(&plain, RNEAGEN_TARGET_HEADER, RNEAGEN_F64, 0, "plain_arm");
	target_write(target_path("strict_arm", ".h"), strict.text.source);
	target_write(target_path("plain_arm", ".h"), plain.text.source);
	for (size_t i = 0; i < sizeof USERS / sizeof *USERS; i++) {
		if (!compiler_serves(&USERS[i].compiler, USERS[i].compiler.flags[3] != NULL))
			continue;
		run_user(&strict, &USERS[i], i ? now : first);
		for (int k = 0; k < SAMPLES * ROWS && i; k++)
			ck_assert_msg(same_number(first[k], now[k]), "%s %s: sample %d, row %d: %a, not %a",
				USERS[i].compiler.command, USERS[i].compiler.flags[1], k / ROWS, k % ROWS, now[k], first[k]);
	}
	unlink(target_path("strict_arm", ".h").s);
	unlink(target_path("plain_arm", ".h").s);
	target_close(&strict);
	target_close(&plain);
}
END_TEST

/* ---- refusals ---- */

START_TEST(refuses_other_arithmetic)
{
	static const char *const flags[] = {"-ffast-math", "-ffinite-math-only", "-fno-signed-zeros", "-mfpmath=387"};
	struct target_path source = target_path("strict_refused", ".c");
	const char *argv[] = {"gcc", "-std=c11", NULL, "-fsyntax-only", source.s, NULL};
	struct target t;

#if !defined __x86_64__
	printf("skipped: -mfpmath=387: not on this processor\n");
#endif
	generate(&t, RNEAGEN_TARGET_C, RNEAGEN_F64, 1, "strict_refused");
	target_write(source, t.text.source);
#if defined __x86_64__
	for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
#else
	for (size_t i = 0; i + 1 < sizeof flags / sizeof *flags; i++) {
#endif
		struct process p;

		argv[2] = flags[i];
		p = process_run(argv);
		ck_assert_msg(p.status != 0 && strstr(p.output, "this text"), "%s is not refused: %.500s", flags[i], p.output);
		process_free(&p);
	}
	unlink(source.s);
	target_close(&t);
}
END_TEST

/* A source that includes or is a text, and whether a compiler takes it with these flags. */
static int takes(const char *command, const char *const flags[4], const char *source, char said[1000])
{
	const char *const argv[] = {command, "-c", "-o", "/dev/null", source, flags[0], flags[1], flags[2], flags[3], NULL};
	struct process p = process_run(argv);
	int status = p.status;

	snprintf(said, 1000, "%s", p.output);
	process_free(&p);
	return status == 0;
}

/* Catches a text that a compiler for a processor with instructions for _Float16 refuses: gcc's default mode then sets
   __FLT_EVAL_METHOD__ to 16. Nothing is run, so the processor need not be there. */
START_TEST(for_processors_that_are_not_here)
{
#if defined __x86_64__
	static const char *const cpus[] = {"-mavx512fp16", "-march=sapphirerapids", "-march=native"};
#else
	static const char *const cpus[] = {"-mcpu=native"};
#endif
	static const struct {
		const char *command, *mode, *suffix;
	} modes[] = {{"gcc", "-std=gnu11", ".c"}, {"gcc", "-std=c11", ".c"}, {"clang", "-std=gnu11", ".c"},
		{"g++", "-std=gnu++17", ".cpp"}};
	struct target_path c = target_path("strict_cpu", ".c"), h = target_path("strict_cpu", ".h"),
			   cpp = target_path("strict_cpu", ".cpp"), nothing = target_path("strict_nothing", ".c");
	struct target source, header;
	char said[1000];

	generate(&source, RNEAGEN_TARGET_C, _i ? RNEAGEN_F64 : RNEAGEN_F32, 1, "strict_cpu");
	generate(&header, RNEAGEN_TARGET_HEADER, _i ? RNEAGEN_F64 : RNEAGEN_F32, 1, "strict_cpu");
	target_write(c, source.text.source);
	target_write(h, header.text.source);
	target_write(cpp, "#include \"strict_cpu.h\"\n");
	target_write(nothing, "");
	for (size_t k = 0; k < sizeof modes / sizeof *modes * (sizeof cpus / sizeof *cpus); k++) {
		const char *command = modes[k % 4].command, *flags[4] = {exhaustive() ? "-O2" : "-O0", cpus[k / 4]};

		if (!takes(command, flags, nothing.s, said)) {
			printf("skipped: %s %s: %.60s\n", command, flags[1], said);
			continue;
		}
		flags[2] = modes[k % 4].mode;
		ck_assert_msg(takes(command, flags, modes[k % 4].suffix[2] ? cpp.s : c.s, said), "%s %s %s: %s", command,
			flags[1], flags[2], said);
	}
	unlink(c.s), unlink(h.s), unlink(cpp.s), unlink(nothing.s);
	target_close(&source);
	target_close(&header);
}
END_TEST

/* Catches a text that is compiled where more digits are kept, or refused where none are, whatever the machine has: 0
   rounds to the type, 16 does for all types but _Float16; 1 and 2 keep more, -1 does not say. */
START_TEST(methods_of_evaluation)
{
	static const struct {
		const char *method;
		int taken;
	} methods[] = {{"0", 1}, {"16", 1}, {"1", 0}, {"2", 0}, {"-1", 0}};
	struct target_path path = target_path("strict_method", ".c");
	struct target t;
	char define[64], said[1000];

	generate(&t, RNEAGEN_TARGET_C, _i ? RNEAGEN_F32X2 : RNEAGEN_F32, !_i, "strict_method");
	target_write(path, t.text.source);
	for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
		const char *const flags[4] = {"-std=c11", "-U__FLT_EVAL_METHOD__", define, "-fsyntax-only"};

		snprintf(define, sizeof define, "-D__FLT_EVAL_METHOD__=%s", methods[i].method);
		ck_assert_msg(takes("gcc", flags, path.s, said) == methods[i].taken, "%s: %s", define, said);
		ck_assert_msg(methods[i].taken || strstr(said, "-mfpmath=sse"), "%s: %s", define, said);
	}
	unlink(path.s);
	target_close(&t);
}
END_TEST

START_TEST(refuses_the_fast_sine)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result result;
	struct rneagen_error e;
	size_t length;
	char *urdf = target_robot("iiwa14", &length);

	o.strict = 1;
	o.trig = RNEAGEN_FAST;
	ck_assert_int_eq(rneagen_generate(urdf, length, &o, &result, &e), RNEAGEN_USAGE);
	ck_assert_msg(strstr(e.message, "--strict") && strstr(e.message, "bounded"), "%s", e.message);
	free(urdf);
}
END_TEST

/* ---- for GPUs ---- */

static const char KERNEL[] =
	"#include \"strict_ptx.h\"\n"
	"extern \"C\" __global__ void use(const T *x, const T *y, T *out)\n{\n"
	"\tT q[7], qd[7], qdd[7], tau[7];\n\n"
	"\tfor (int i = 0; i < 7; i++) {\n"
	"\t\tq[i] = x[i]*y[i];\n\t\tqd[i] = x[i]*y[i + 7];\n\t\tqdd[i] = x[i + 7]*y[i];\n\t}\n"
	"\tstrict_ptx_rnea(q, qd, qdd, tau);\n"
	"\tfor (int i = 0; i < 7; i++)\n\t\tout[i] = tau[i] + x[i];\n}\n";

static int occurrences(const char *s, const char *word)
{
	int n = 0;

	for (; (s = strstr(s, word)) != NULL; s += strlen(word))
		n++;
	return n;
}

/* Fused multiply-adds in the PTX that nvcc makes of the source with the flag, and in `joinable` the products and sums
   whose rounding is left to whoever reads it. */
static int fused_in_ptx(const struct target *t, const char *nvcc, const char *source, const char *flag, int *joinable)
{
	struct target_path ptx = target_path("strict_ptx", ".ptx");
	const char *const argv[] = {nvcc, "-arch=sm_90", "-Werror", "all-warnings", flag, "-ptx", "-o", ptx.s, source, NULL};
	char *text;
	size_t length;
	int fused;

	target_compile(t, argv);
	text = read_file(ptx.s, &length);
	ck_assert_ptr_nonnull(text);
	fused = occurrences(text, "fma.rn.f32") + occurrences(text, "fma.rn.f64");
	*joinable = occurrences(text, "mul.f32") + occurrences(text, "mul.f64");
	free(text);
	unlink(ptx.s);
	return fused;
}

/* Where contraction is allowed there are as many as where it is not. */
static void check_ptx(const struct target *t, const char *nvcc, const char *source, const char *what)
{
	int joinable, open = fused_in_ptx(t, nvcc, source, "-fmad=true", &joinable), unused,
		      shut = fused_in_ptx(t, nvcc, source, "-fmad=false", &unused);

	printf("%s: %d fused multiply-adds, %d where nvcc must not join; %d products without a rounding of their own\n", what,
		open, shut, joinable);
	ck_assert_int_eq(open, shut);
	ck_assert_int_gt(open, 100);
}

START_TEST(nothing_joined_for_gpus)
{
	enum rneagen_precision precision = _i ? RNEAGEN_F64 : RNEAGEN_F32;
	struct target_path source = target_path("strict_ptx", ".cu"), header = target_path("strict_ptx", ".h");
	const char *nvcc = target_nvcc();
	struct target t;
	char text[1024];

	if (!nvcc)
		return;
	generate(&t, RNEAGEN_TARGET_CUDA, precision, 1, "strict_ptx");
	target_write(source, t.text.source);
	check_ptx(&t, nvcc, source.s, _i ? "kernels, f64" : "kernels, f32");
	target_close(&t);
	generate(&t, RNEAGEN_TARGET_HEADER, precision, 1, "strict_ptx");
	target_write(header, t.text.source);
	snprintf(text, sizeof text, "typedef %s T;\n%s", _i ? "double" : "float", KERNEL);
	target_write(source, text);
	check_ptx(&t, nvcc, source.s, _i ? "header, f64" : "header, f32");
	target_close(&t);
	unlink(source.s);
	unlink(header.s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("strict_texts");
	TCase *c = tcase_create("strict_texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("seed %d\n", SEED);
	tcase_set_timeout(c, 600);
	tcase_add_test(c, header_keeps_its_bits);
	tcase_add_test(c, refuses_other_arithmetic);
	tcase_add_loop_test(c, for_processors_that_are_not_here, 0, 2);
	tcase_add_loop_test(c, methods_of_evaluation, 0, 2);
	tcase_add_test(c, refuses_the_fast_sine);
	tcase_add_loop_test(c, nothing_joined_for_gpus, 0, 2);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
