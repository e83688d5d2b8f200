/* Pieces of the text: numbers, templates, identifiers, the names of values. */
#define _DEFAULT_SOURCE
#include "emit/emit.h"
#include "base/identifier.h"
#include "support/exhaustive.h"
#include "support/model.h"
#include "support/random_robot.h"
#include "support/rng.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include "base/template.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { RANDOM_NUMBERS = 30000 };
#define RANDOM_ROBOTS (exhaustive() ? 60u : 20u)

static struct arena arena;
static struct rneagen_error error;
static struct rneagen_options options;

static void set_up(void)
{
	arena_init(&arena, NULL);
	error = (struct rneagen_error){0};
	options = rneagen_options_default();
	options.file = "here";
}

static void tear_down(void)
{
	arena_free(&arena);
}

/* ---- numbers ---- */

static const char *number(real value, enum rneagen_precision precision)
{
	static struct written_number written[EMIT_WRITTEN];
	static char buffer[64], again[64];
	struct emission e = {.options = &options, .arena = &arena, .error = &error};
	struct text t = {.arena = &arena, .s = buffer, .capacity = sizeof buffer};
	struct text same = {.arena = &arena, .s = again, .capacity = sizeof again};

	options.precision = precision;
	emit_set_precision(&e);
	emit_number(&e, e.arithmetic, value, &t);
	ck_assert(!t.failed && t.s == buffer);
	e.written = written; /* as it was written for whatever came before */
	for (int i = 0; i < 2; i++) {
		text_clear(&same);
		emit_number(&e, e.arithmetic, value, &same);
		ck_assert_str_eq(again, buffer);
	}
	return buffer;
}

/* Significant digits written: without zeros before and, in an integer, after. */
static int digits_of(const char *s)
{
	const char *point = strchr(s, '.');
	int digits = 0, zeros = 0, started = 0, fraction = point && !strchr(s, 'e') && strcmp(point, ".0") &&
		strcmp(point, ".0f");

	for (; *s && *s != 'e' && *s != 'f'; s++) {
		if (*s < '0' || *s > '9')
			continue;
		started |= *s != '0';
		digits += started;
		zeros = *s == '0' ? zeros + 1 : 0;
	}
	return fraction ? digits : digits - (digits ? zeros : 0);
}

/* A constant of C for the type: digits, with a point or an exponent, and the suffix. */
static void check_form(const char *s, int f32)
{
	size_t length = strlen(s), mantissa = strspn(s, "-"), all;

	mantissa += strspn(s + mantissa, "0123456789.");
	all = mantissa;
	if (s[all] == 'e')
		all += 2 + strspn(s + all + 2, "0123456789");
	ck_assert_msg(strpbrk(s, ".e") && all + (f32 ? 1 : 0) == length && (!f32 || s[all] == 'f'), "%s", s);
}

static void check_f64(double x)
{
	const char *s = number((real)x, RNEAGEN_F64);
	char fewer[64];
	int digits = digits_of(s);

	check_form(s, 0);
	ck_assert_msg(strtod(s, NULL) == x && !signbit(strtod(s, NULL)) == !signbit(x), "%s for %a", s, x);
	ck_assert_msg(digits <= 17, "%s", s);
	if (digits > 1) {
		snprintf(fewer, sizeof fewer, "%.*e", digits - 2, x);
		ck_assert_msg(strtod(fewer, NULL) != x, "%s, and %s would do", s, fewer);
	}
}

static void check_f32(float x)
{
	const char *s = number((real)x, RNEAGEN_F32);
	char fewer[64];
	int digits = digits_of(s);

	check_form(s, 1);
	ck_assert_msg(strtof(s, NULL) == x && !signbit(strtof(s, NULL)) == !signbit(x), "%s for %a", s, (double)x);
	ck_assert_msg(digits <= 9, "%s", s);
	if (digits > 1) {
		snprintf(fewer, sizeof fewer, "%.*e", digits - 2, (double)x);
		ck_assert_msg(strtof(fewer, NULL) != x, "%s, and %s would do", s, fewer);
	}
}

START_TEST(numbers_of_random_bits)
{
	struct rng rng = rng_seed(21);

	for (int i = 0; i < RANDOM_NUMBERS; i++) {
		uint64_t bits = rng_next(&rng);
		uint32_t half = (uint32_t)(bits >> 32);
		double x;
		float y;

		memcpy(&x, &bits, sizeof x);
		memcpy(&y, &half, sizeof y);
		if (isfinite(x))
			check_f64(x);
		if (isfinite(y))
			check_f32(y);
		if (i % 16 == 0) { /* denormals */
			bits &= 0xfffffffffffffu;
			half &= 0x7fffff;
			memcpy(&x, &bits, sizeof x);
			memcpy(&y, &half, sizeof y);
			check_f64(x);
			check_f32(y);
		}
	}
}
END_TEST

START_TEST(numbers_at_the_ends)
{
	static const double f64[] = {0, DBL_MAX, DBL_MIN, DBL_TRUE_MIN, DBL_EPSILON, 1 - DBL_EPSILON / 2, 1 + DBL_EPSILON,
		9007199254740991, 0.1, 0.2, 0.3, 1.0 / 3, 9.81, 5e-324, 2.2250738585072011e-308, 123456789012345680, 1e22, 1e23};
	static const float f32[] = {0, FLT_MAX, FLT_MIN, FLT_TRUE_MIN, FLT_EPSILON, 1 + FLT_EPSILON, 16777215, 0.1f, 9.81f,
		1.0f / 3, 8388608.5f, 3.4e38f};

	for (size_t i = 0; i < sizeof f64 / sizeof *f64; i++) {
		check_f64(f64[i]);
		check_f64(-f64[i]);
	}
	for (size_t i = 0; i < sizeof f32 / sizeof *f32; i++) {
		check_f32(f32[i]);
		check_f32(-f32[i]);
	}
	for (int k = -323; k <= 308; k++)
		check_f64(pow(10, k));
	for (int k = -45; k <= 38; k++)
		check_f32((float)pow(10, k));
	for (int k = -1074; k < 1024; k++)
		check_f64(ldexp(1, k));
	for (int k = -149; k < 128; k++)
		check_f32((float)ldexp(1, k));
}
END_TEST

static const struct written {
	real value;
	const char *f32, *f64;
} written[] = {
	{0, "0.0f", "0.0"}, {1, "1.0f", "1.0"}, {-1, "-1.0f", "-1.0"}, {0.5L, "0.5f", "0.5"}, {9.81, "9.81f", "9.81"},
	{0.1, "0.1f", "0.1"}, {1e-31, "1e-31f", "1e-31"}, {-2.5e-7, "-2.5e-07f", "-2.5e-07"},
	{1 / 3.0L, "0.33333334f", "0.3333333333333333"}, {16777217, "16777216.0f", "16777217.0"}, {1e-50, "0.0f", "1e-50"},
	/* rounded once, from the extended value: half an ulp and a little */
	{1 + 0x1p-24L + 0x1p-60L, "1.0000001f", "1.0000000596046448"}, {1 + 0x1p-24L, "1.0f", "1.0000000596046448"},
};

START_TEST(number_as_written)
{
	ck_assert_str_eq(number(written[_i].value, RNEAGEN_F32), written[_i].f32);
	ck_assert_str_eq(number(written[_i].value, RNEAGEN_F64), written[_i].f64);
	ck_assert_int_eq(error.code, RNEAGEN_OK);
}
END_TEST

START_TEST(number_too_large)
{
	number(FLT_MAX, RNEAGEN_F32);
	ck_assert_int_eq(error.code, RNEAGEN_OK);
	number(-1e39L, RNEAGEN_F32);
	ck_assert_int_eq(error.code, RNEAGEN_NUMBER);
	ck_assert_str_eq(error.message,
		"here: a constant of the model, -1e+39, is no finite number in f32; take --precision f64, or mixed, whose constants are f64");
	error = (struct rneagen_error){0};
	number(1e39L, RNEAGEN_F64);
	ck_assert_int_eq(error.code, RNEAGEN_OK);
	number(1e400L, RNEAGEN_F64);
	ck_assert_int_eq(error.code, RNEAGEN_NUMBER);
	ck_assert_str_eq(error.message, "here: a constant of the model, 1e+400, is no finite number in f64");
}
END_TEST

/* ---- templates ---- */

static const struct slot slots[] = {{"A", "alpha"}, {"EMPTY", ""}, {"LINES", "one\ntwo"}, {"NAME_2", "@A@"}, {"B", "b@"}};

static const struct expansion {
	const char *tmpl, *want; /* NULL: fails */
} expansions[] = {
	{"", ""}, {"plain\n", "plain\n"}, {"@A@", "alpha"}, {"x @A@ y @A@\n", "x alpha y alpha\n"}, {"@A@@A@", "alphaalpha"},
	{"@LINES@\n", "one\ntwo\n"}, {"@NAME_2@", "@A@"}, {"@B@A@", "b@A@"},
	/* an empty slot takes its line along, if it has one */
	{"a\n@EMPTY@\nb\n", "a\nb\n"}, {"@EMPTY@\nb\n", "b\n"}, {"@EMPTY@\n", ""}, {"@EMPTY@", ""}, {"a\n@EMPTY@", "a\n"},
	{"a @EMPTY@\nb\n", "a \nb\n"}, {"@EMPTY@ b\n", " b\n"}, {"\t@EMPTY@\nb\n", "\t\nb\n"}, {"@EMPTY@@EMPTY@\nb", "\nb"},
	{"@A@\n@EMPTY@\n@A@", "alpha\nalpha"}, {"@EMPTY@\n@EMPTY@\nb", "b"},
	/* no slots: left as they are */
	{"a@b", "a@b"}, {"@", "@"}, {"@@", "@@"}, {"@a@", "@a@"}, {"@A B@", "@A B@"}, {"me@A.org", "me@A.org"}, {"@A", "@A"},
	{"@@A@", "@alpha"},
	/* no such slot */
	{"@C@", NULL}, {"a @AA@ b", NULL}, {"@NAME@", NULL}, {"@_@", NULL}, {"@A@ @EMPT@", NULL},
};

START_TEST(templates)
{
	const struct expansion *x = &expansions[_i];
	struct text t;

	text_init(&t, &arena);
	template_expand(&t, x->tmpl, slots, sizeof slots / sizeof *slots);
	ck_assert_msg(t.failed == !x->want, "%s", x->tmpl);
	if (x->want)
		ck_assert_str_eq(text_string(&t), x->want);
}
END_TEST

/* In two goes, with the long part written in between; a template without its slot fails. */
START_TEST(templates_in_two)
{
	struct slot all[sizeof slots / sizeof *slots + 1] = {{"LONG", "the long\npart"}};
	size_t count = sizeof slots / sizeof *slots;
	struct text one, two;
	const char *rest;

	memcpy(all + 1, slots, sizeof slots);
	text_init(&one, &arena);
	text_init(&two, &arena);
	template_expand(&one, "a@A@\n@LONG@\n@EMPTY@\nb@A@", all, count + 1);
	rest = template_expand_to(&two, "a@A@\n@LONG@\n@EMPTY@\nb@A@", "LONG", slots, count);
	text_put(&two, "the long\npart");
	template_expand(&two, rest, slots, count);
	ck_assert(!one.failed && !two.failed);
	ck_assert_str_eq(text_string(&one), text_string(&two));
	ck_assert_str_eq(template_expand_to(&two, "a@A@", "LONG", slots, count), "");
	ck_assert(two.failed);
}
END_TEST

static void check_template_error(enum rneagen_code code, const char *message)
{
	struct rneagen_error e = {0};

	ck_assert_int_eq(template_error(&e, &arena), code);
	ck_assert_str_eq(e.message, message);
	arena_free(&arena);
	arena_init(&arena, NULL);
}

/* The first slot that fails is told, with the file; a lack of memory before it stays one. */
START_TEST(templates_at_fault)
{
	const struct slot each = {"EACH", "a, b"};
	const char *rest;
	struct text t;

	text_init(&t, &arena);
	template_expand(&t, template_call_any_in, NULL, 0);
	template_expand(&t, "@LATER@", NULL, 0);
	check_template_error(RNEAGEN_TEMPLATE, "nothing fills slot @INDENT@ in template sincos/call_any.in");
	text_init(&t, &arena);
	rest = template_expand_to(&t, template_header_lanes_in, "FILLED", &each, 1);
	template_expand_to(&t, rest, "NO_SUCH", &each, 1);
	check_template_error(RNEAGEN_TEMPLATE, "there is no slot @NO_SUCH@ in template header/header_lanes.in");
	text_init(&t, &arena);
	template_expand(&t, "@A@", NULL, 0);
	check_template_error(RNEAGEN_TEMPLATE, "nothing fills slot @A@ in template of no file");
	text_init(&t, &arena);
	ck_assert_ptr_null(arena_take(&arena, SIZE_MAX, 2));
	template_expand(&t, template_call_any_in, NULL, 0);
	check_template_error(RNEAGEN_MEMORY, "out of memory");
}
END_TEST

/* Of a whole text: the frame is changed where it stands in this program. */
START_TEST(text_of_a_frame_with_a_new_slot)
{
	static const char urdf[] = ROBOT("r", BALL("a") BALL("b") JOINT("j", "revolute", "a", "b", AXIS("0 0 1")));
	static const char slot[] = "@NEW_PLACE@";
	size_t page = (size_t)sysconf(_SC_PAGESIZE);
	char *frame = (char *)(uintptr_t)template_head_c_in, *begin = frame - (uintptr_t)frame % page;
	char before[sizeof slot];
	struct rneagen_result result;

	ck_assert_int_eq(mprotect(begin, page + (size_t)(frame - begin), PROT_READ | PROT_WRITE), 0);
	memcpy(before, frame, strlen(slot));
	memcpy(frame, slot, strlen(slot));
	options.target = RNEAGEN_TARGET_C;
	ck_assert_int_eq(rneagen_generate(urdf, sizeof urdf - 1, &options, &result, &error), RNEAGEN_TEMPLATE);
	ck_assert_str_eq(error.message, "nothing fills slot @NEW_PLACE@ in template c/head_c.in");
	memcpy(frame, before, strlen(slot));
}
END_TEST

/* ---- identifiers ---- */

static const struct name {
	const char *name, *made; /* made NULL: it is one already */
} names[] = {
	{"a", NULL}, {"A", NULL}, {"_", NULL}, {"_a", NULL}, {"iiwa14", NULL}, {"a_b", NULL}, {"a__b", NULL},
	{"If", NULL}, {"ints", NULL}, {"main", NULL}, {"z9_", NULL}, {"", "robot"}, {"1", "robot_1"}, {"9lives", "robot_9lives"},
	{"a b", "a_b"}, {"a-b", "a_b"},
	{"a.b", "a_b"}, {" ", "_"}, {"-", "_"}, {".", "_"}, {"é", "robot___"}, {"aé", "a__"}, {"*/", "robot___"}, {"\"", "_"},
	{"a\"b", "a_b"}, {"\\", "_"}, {"%d", "_d"}, {"a\nb", "a_b"}, {"?\?/", "robot____"}, {"int", "robot_int"},
	{"for", "robot_for"}, {"class", "robot_class"}, {"double", "robot_double"}, {"restrict", "robot_restrict"},
	{"xor_eq", "robot_xor_eq"}, {"nullptr", "robot_nullptr"}, {"alignas", "robot_alignas"},
	{"__global__", "robot___global__"}, {"_Bool", "robot__Bool"}, {"__x", "robot___x"}, {"_X", "robot__X"},
	{"--", "robot___"}, {"-X", "robot__X"}, {"$a", "_a"}, {"@NAME@", "robot__NAME_"}, {"\x7f", "_"}, {"\xff", "_"},
};

START_TEST(identifier)
{
	const struct name *n = &names[_i];

	ck_assert_msg(identifier_is(n->name) == !n->made, "'%s'", n->name);
	ck_assert_str_eq(identifier_from(n->name, &arena), n->made ? n->made : n->name);
	ck_assert(identifier_is(identifier_from(n->name, &arena)));
}
END_TEST

START_TEST(identifier_of_any_bytes)
{
	struct rng rng = rng_seed(22);

	for (int i = 0; i < 2000; i++) {
		char s[12] = "";

		for (int k = rng_below(&rng, 11); k > 0; k--)
			s[strlen(s)] = (char)(1 + rng_below(&rng, 255));
		ck_assert_msg(identifier_is(identifier_from(s, &arena)), "'%s'", s);
	}
}
END_TEST

/* ---- names of values ---- */

static int compare_names(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Legal, each once, and none that the function uses otherwise. */
static void check_names(struct model *m, int which, const char *what)
{
	static const char *const taken[] = {"q", "qd", "qdd", "tau", "v", "a", "f", "stride", "small", "k", "count"};
	size_t count = 0;
	struct plan p;

	ck_assert(plan_build(&p, &m->dag[which], &m->tree, &m->arena));
	for (size_t i = 0; i < m->dag[which].count; i++) {
		const char *s = p.names[i];

		if (!s)
			continue;
		ck_assert_msg(identifier_is(s), "%s: %s", what, s);
		for (size_t k = 0; k < sizeof taken / sizeof *taken; k++)
			ck_assert_msg(strcmp(s, taken[k]), "%s: %s", what, s);
		p.names[count++] = s;
	}
	qsort(p.names, count, sizeof *p.names, compare_names);
	for (size_t i = 1; i < count; i++)
		ck_assert_msg(strcmp(p.names[i - 1], p.names[i]), "%s: %s twice", what, p.names[i]);
}

static void check_names_of(const char *text, size_t length, enum rneagen_base base, const char *what)
{
	struct rneagen_options o = rneagen_options_default();
	struct model m;

	o.base = base;
	model_open(&m, text, length, &o, what);
	for (int i = 0; i < MODEL_DAGS; i++)
		check_names(&m, i, what);
	model_close(&m);
}

static void own_robot(const char *path, const char *name, void *context)
{
	int *count = context;
	size_t length;
	char *text = read_file(path, &length);

	check_names_of(text, length, ++*count % 2 ? RNEAGEN_FIXED : RNEAGEN_FLOATING, name);
	free(text);
}

START_TEST(names_of_values)
{
	int count = 0;

	for_each_urdf(TEST_DIR "/robots", own_robot, &count);
	ck_assert_int_ge(count, 28);
	for (uint64_t seed = 1; seed <= RANDOM_ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, 20);
		char *text = random_robot(seed, &knobs), what[64];

		snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
		check_names_of(text, strlen(text), seed % 2 ? RNEAGEN_FIXED : RNEAGEN_FLOATING, what);
		free(text);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("emit");
	TCase *c = tcase_create("pieces");

	tcase_set_timeout(c, 60);
	tcase_add_checked_fixture(c, set_up, tear_down);
	tcase_add_test(c, numbers_of_random_bits);
	tcase_add_test(c, numbers_at_the_ends);
	tcase_add_loop_test(c, number_as_written, 0, sizeof written / sizeof *written);
	tcase_add_test(c, number_too_large);
	tcase_add_loop_test(c, templates, 0, sizeof expansions / sizeof *expansions);
	tcase_add_test(c, templates_in_two);
	tcase_add_test(c, templates_at_fault);
	tcase_add_test(c, text_of_a_frame_with_a_new_slot);
	tcase_add_loop_test(c, identifier, 0, sizeof names / sizeof *names);
	tcase_add_test(c, identifier_of_any_bytes);
	tcase_add_test(c, names_of_values);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
