/* Texts for target header, all in one file with each other, in C and in C++; and the .h that goes with a .c. Each text
   is called in C by gcc and in C++ by clang; also in C by clang and in C++ by gcc where all is asked for, else these
   compile half of them. */
#define _POSIX_C_SOURCE 200809L
#include "emit/emit.h"
#include "support/exhaustive.h"
#include "support/process.h"
#include "support/suite.h"
#include "target/target_check.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STATES = 300, SEED = 33 };

struct language {
	const char *command, *standard, *suffix, *level;
};

static const struct language LANGUAGES[] = {{"gcc", "-std=c11", ".c", "-O0"}, {"g++", "-std=c++17", ".cpp", "-O1"},
	{"clang", "-std=c11", ".c", "-O1"}, {"clang++", "-std=c++17", ".cpp", "-O0"}};

enum { LANGUAGE_COUNT = sizeof LANGUAGES / sizeof *LANGUAGES };

/* Every mode in both precisions, different robots. */
static const struct header {
	const char *name, *robot;
	enum rneagen_base base;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
} HEADERS[] = {
	{"arm_f32", "iiwa14", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_ACCURATE},
	{"arm_f64", "iiwa14", RNEAGEN_FIXED, RNEAGEN_F64, RNEAGEN_ACCURATE},
	{"dog_f32", "hyq", RNEAGEN_FLOATING, RNEAGEN_F32, RNEAGEN_FAST},
	{"dog_f64", "hyq", RNEAGEN_FLOATING, RNEAGEN_F64, RNEAGEN_BOUNDED},
	{"puck", "planar_tilted", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_BOUNDED},
	{"hand", "mimic_chain", RNEAGEN_FIXED, RNEAGEN_F64, RNEAGEN_FAST},
	{"slides", "gantry", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_ACCURATE},
	{"odd", "odd_names", RNEAGEN_FIXED, RNEAGEN_F64, RNEAGEN_ACCURATE},
};

enum { HEADER_COUNT = sizeof HEADERS / sizeof *HEADERS };

static struct rneagen_options options_of(const struct header *h, enum rneagen_target kind)
{
	struct rneagen_options o = rneagen_options_default();

	o.target = kind;
	o.base = h->base;
	o.precision = h->precision;
	o.trig = h->trig;
	o.name = h->name;
	return o;
}

static void generate(const struct header *h, enum rneagen_target kind, struct target *t)
{
	struct rneagen_options o = options_of(h, kind);
	size_t length;
	char *urdf = target_robot(h->robot, &length);

	target_generate(t, urdf, length, &o, h->name);
	free(urdf);
}

/* Ways from outside to the functions of one header. */
static void write_calls(FILE *f, const struct target *t)
{
	const char *n = t->text.name, *T = t->f32 ? "float" : "double";

	fprintf(f,
		"void call_%s_rnea(const %s *q, const %s *qd, const %s *qdd, %s *tau)\n{\n\t%s_rnea(q, qd, qdd, "
		"tau);\n}\n",
		n, T, T, T, T, n);
	fprintf(f,
		"void call_%s_fpass(const %s *q, const %s *qd, const %s *qdd, %s *v, %s *a, %s *f)\n{\n"
		"\t%s_fpass(q, qd, qdd, v, a, f);\n}\n",
		n, T, T, T, T, T, T, n);
	fprintf(f, "void call_%s_bpass(const %s *q, const %s *f, %s *tau)\n{\n\t%s_bpass(q, f, tau);\n}\n", n, T, T, T,
		n);
	if (strstr(t->text.source, "\trneagen_sincos"))
		fprintf(f, "void call_%s_sincos(%s x, %s *s, %s *c)\n{\n\trneagen_sincos%s_%s(x, s, c);\n}\n", n, T, T,
			T, t->f32 ? "f" : "", emit_trig_name(emit_trig_of(&t->options)));
	fprintf(f, "int call_%s_rows(int *nq, int *nv)\n{\n\t*nq = %s_nq;\n\t*nv = %s_nv;\n\treturn %s_nb;\n}\n", n, n,
		n, n);
}

/* One file that holds all headers and shows their functions; and one that holds them in the other order and shows
   nothing of them. */
static void write_users(struct target *t, int count, const struct language *l, struct target_path paths[2])
{
	for (int i = 0; i < 2; i++) {
		FILE *f;

		paths[i] = target_path(i ? "header_again" : "header_all", l->suffix);
		f = fopen(paths[i].s, "w");
		ck_assert_ptr_nonnull(f);
		for (int k = 0; k < count; k++)
			fprintf(f, "#include \"%s.h\"\n", t[i ? count - 1 - k : k].text.name);
		fprintf(f, "#include \"%s.h\"\n", t[0].text.name);
		fputs("#ifdef __cplusplus\nextern \"C\" {\n#endif\n", f);
		for (int k = 0; k < count && !i; k++)
			write_calls(f, &t[k]);
		fprintf(f, "int rows_%d(void)\n{\n\treturn %s_nv;\n}\n", i, t[0].text.name);
		fputs("#ifdef __cplusplus\n}\n#endif\n", f);
		ck_assert_int_eq(fclose(f), 0);
	}
}

/* With lanes, or without, where the bits are those of the text's DAG. */
static void *build(struct target *t, int count, const struct language *l, int has_lanes)
{
	struct target_path sources[2], library = target_path("header_all", ".so");
	const char *const argv[] = {l->command, l->standard, WARNING_FLAGS, "-Wshadow", l->level, "-fPIC", "-shared",
		has_lanes ? "-URNEA_NO_LANES" : "-DRNEA_NO_LANES", "-o", library.s, sources[0].s, sources[1].s, NULL};
	void *handle;

	write_users(t, count, l, sources);
	target_compile(&t[0], argv);
	handle = dlopen(library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(handle != NULL, "%s", dlerror());
	unlink(library.s);
	return handle;
}

static void find_functions(struct target *t, void *handle)
{
	static const char *const names[] = {"rnea", "fpass", "bpass", "sincos"};
	void *const slots[2][4] = {{&t->wide.rnea, &t->wide.fpass, &t->wide.bpass, &t->sincos_wide},
		{&t->single.rnea, &t->single.fpass, &t->single.bpass, &t->sincos_single}};
	char symbol[256];

	for (int i = 0; i < (strstr(t->text.source, "\trneagen_sincos") ? 4 : 3); i++) {
		snprintf(symbol, sizeof symbol, "call_%s_%s", t->text.name, names[i]);
		target_symbol(t, handle, symbol, slots[t->f32][i]);
	}
}

static void check_rows(const struct target *t, void *handle, const struct model *m)
{
	int (*rows)(int *nq, int *nv), nq, nv;
	char symbol[256];

	snprintf(symbol, sizeof symbol, "call_%s_rows", t->text.name);
	target_symbol(t, handle, symbol, &rows);
	ck_assert_int_eq(rows(&nq, &nv), m->tree.body_count);
	ck_assert_int_eq(nq, m->tree.nq);
	ck_assert_int_eq(nv, m->tree.nv);
}

static void check_header(const struct header *h, struct target *t, void *handle, int has_lanes, struct worst *worst)
{
	struct rneagen_options o = options_of(h, RNEAGEN_TARGET_HEADER);
	struct states states;
	struct model m;
	struct check c = {.target = t, .model = &m, .states = &states, .exact = !has_lanes, .worst = worst};
	size_t length;
	char *urdf = target_robot(h->robot, &length);

	model_open(&m, urdf, length, &o, h->robot);
	states = states_new(&m, SEED, STATES, t->f32, 1);
	if (h->trig != RNEAGEN_ACCURATE)
		states.count -= 100;
	find_functions(t, handle);
	check_rnea(&c);
	check_passes(&c);
	check_rows(t, handle, &m);
	states_free(&states);
	model_close(&m);
	free(urdf);
}

static void check_headers(const struct header *const *of, struct target *t, int count, const struct language *l, int has_lanes)
{
	void *handle = build(t, count, l, has_lanes);
	struct worst worst[2] = {0};

	for (int i = 0; i < count; i++)
		check_header(of[i], &t[i], handle, has_lanes, &worst[t[i].f32]);
	dlclose(handle);
	for (int f32 = 0; f32 < 2; f32++) {
		char what[64];

		snprintf(what, sizeof what, "header %s %s %s%s", l->command, l->standard, f32 ? "f32" : "f64", has_lanes ? ", lanes" : "");
		worst_report(&worst[f32], what);
	}
}

START_TEST(headers_together)
{
	const struct language *l = &LANGUAGES[_i];
	struct target t[HEADER_COUNT];
	const struct header *of[HEADER_COUNT];
	int all = _i % 3 == 0 || exhaustive(), count = 0;

	if (!process_exists(l->command)) {
		printf("skipped: no %s\n", l->command);
		return;
	}
	for (int i = 0; i < HEADER_COUNT; i++)
		if (all || i % 2)
			of[count++] = &HEADERS[i];
	for (int i = 0; i < count; i++) {
		generate(of[i], RNEAGEN_TARGET_HEADER, &t[i]);
		target_write(target_path(of[i]->name, ".h"), t[i].text.source);
	}
	for (int has_lanes = 0; has_lanes < 2; has_lanes++)
		check_headers(of, t, count, l, has_lanes);
	for (int i = 0; i < count; i++)
		rneagen_result_free(&t[i].text);
}
END_TEST

static const char USER[] =
	"#include \"plain_dog.h\"\n"
	"#include \"plain_dog.h\"\n"
	"#include \"plain_arm.h\"\n"
	"int main(void)\n{\n"
	"\tdouble q[plain_dog_nq] = {0}, qd[plain_dog_nv] = {0}, tau[plain_dog_nv], w[3*6*plain_dog_nb];\n"
	"\tfloat r[2*plain_arm_nq] = {0}, s[2*plain_arm_nv] = {0}, t[2*plain_arm_nv];\n\n"
	"\tq[6] = 1;\n"
	"\tplain_dog_rnea(q, qd, qd, tau);\n"
	"\tplain_dog_rnea_batch(q, qd, qd, w, 1);\n"
	"\tif (!(tau[2] > 100) || tau[2] != w[2])\n\t\treturn 1;\n"
	"\tplain_dog_fpass(q, qd, qd, w, w + 6*plain_dog_nb, w + 12*plain_dog_nb);\n"
	"\tplain_dog_bpass(q, w + 12*plain_dog_nb, tau);\n"
	"\tplain_arm_rnea_batch(r, s, s, t, 2);\n"
	"\tif (!(tau[2] > 100) || !(t[1] == t[1]))\n\t\treturn 2;\n"
	"\treturn plain_dog_info[0] == 'r' && plain_arm_info[0] == 'r' ? 0 : 3;\n}\n";

static const struct header PLAIN[] = {{"plain_dog", "hyq", RNEAGEN_FLOATING, RNEAGEN_F64, RNEAGEN_ACCURATE},
	{"plain_arm", "iiwa14", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_ACCURATE}};

/* NAME.c as an object, and NAME.h. */
static void build_plain(const struct header *h)
{
	struct target_path source = target_path(h->name, ".c"), object = target_path(h->name, ".o");
	const char *const compile[] = {"gcc", "-std=c11", WARNING_FLAGS, "-c", "-o", object.s, source.s, NULL};
	struct target t = {0};

	generate(h, RNEAGEN_TARGET_C, &t);
	target_write(source, t.text.source);
	target_write(target_path(h->name, ".h"), t.text.header);
	target_compile(&t, compile);
	target_close(&t);
}

static void check_declarations(const struct language *l, int is_cpp)
{
	struct target_path program = target_path("plain_user", ".exe"), user = target_path("plain_user", l->suffix);
	struct target_path dog = target_path("plain_dog", ".o"), arm = target_path("plain_arm", ".o");
	const char *const link[] = {l->command, l->standard, WARNING_FLAGS, "-o", program.s, user.s, dog.s, arm.s, "-lm", NULL},
			  *const run[] = {program.s, NULL};
	const struct target t = {.what = "declarations"};

	for (int i = 0; i < 2; i++) {
		struct target_path header = target_path(PLAIN[i].name, ".h");
		const char *const alone[] = {l->command, l->standard, WARNING_FLAGS, "-pedantic-errors", "-fsyntax-only", "-x",
			is_cpp ? "c++-header" : "c-header", header.s, NULL};

		target_compile(&t, alone);
	}
	target_write(user, USER);
	target_compile(&t, link);
	target_compile(&t, run);
}

/* The .h of target C: alone, twice, in C and C++, beside another; a program links with two texts. */
START_TEST(declarations)
{
	if (!process_exists("gcc")) {
		printf("skipped: no gcc\n");
		return;
	}
	for (int i = 0; i < 2; i++)
		build_plain(&PLAIN[i]);
	for (int i = 0; i < LANGUAGE_COUNT; i++)
		if (process_exists(LANGUAGES[i].command))
			check_declarations(&LANGUAGES[i], i % 2);
		else
			printf("skipped: no %s\n", LANGUAGES[i].command);
}
END_TEST

/* Two texts of one name in one file: a compiler stops, where the second would be skipped in silence. One text twice is fine. */
START_TEST(one_name)
{
	static const struct header both[] = {{"same", "iiwa14", RNEAGEN_FIXED, RNEAGEN_F64, RNEAGEN_ACCURATE},
		{"same", "iiwa14", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_ACCURATE}};
	enum rneagen_target kind = _i ? RNEAGEN_TARGET_HEADER : RNEAGEN_TARGET_C;
	struct target_path user = target_path("same_user", ".c");
	const char *const compile[] = {"gcc", "-std=c11", "-fsyntax-only", user.s, NULL};

	for (int i = 0; i < 2; i++) {
		struct target t = {0};

		generate(&both[i], kind, &t);
		target_write(target_path(i ? "same_1" : "same_0", ".h"), _i ? t.text.source : t.text.header);
		target_close(&t);
	}
	for (int i = 0; i < 2; i++) {
		struct process p;

		target_write(user, i ? "#include \"same_0.h\"\n#include \"same_1.h\"\n" : "#include \"same_0.h\"\n#include \"same_0.h\"\n");
		p = process_run(compile);
		ck_assert_msg((p.status != 0) == i && (strstr(p.output, "two texts are named same") != NULL) == i, "%s", p.output);
		process_free(&p);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("header");
	TCase *c = tcase_create("header");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("seed %d\n", SEED);
	tcase_set_timeout(c, 600);
	tcase_add_loop_test(c, headers_together, 0, LANGUAGE_COUNT);
	tcase_add_test(c, declarations);
	tcase_add_loop_test(c, one_name, 0, 2);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
