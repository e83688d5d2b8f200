/* Whole texts: equal input gives equal bytes, whatever the file's order, its names, or the locale. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/process.h"
#include "support/random_robot.h"
#include "rneagen.h"
#include "support/rng.h"
#include "support/generated.h"
#include "support/suite.h"
#include "base/text.h"
#include "support/urdf_text.h"
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LINKS = 12 };
#define ROBOTS (exhaustive() ? 24 : 12) /* random trees */

static struct arena arena;

static void open_arena(void)
{
	arena_init(&arena, NULL);
}

static void close_arena(void)
{
	arena_free(&arena);
}

static struct rneagen_options options_of(int i)
{
	struct rneagen_options o = rneagen_options_default();

	o.file = "here";
	o.name = "r";
	o.tell = RNEAGEN_TELL_ALL;
	o.target = (enum rneagen_target)(i % 3);
	o.base = i % 2 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.layout = i / 3 % 2 ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.trig = (enum rneagen_trig)(i / 2 % 3);
	o.precision = i % 5 ? RNEAGEN_PRECISION_DEFAULT : RNEAGEN_F64;
	o.dump = i % 4 == 3 ? (enum rneagen_dump)(1 + i / 4 % RNEAGEN_DUMP_PASSES) : RNEAGEN_DUMP_NONE;
	return o;
}

/* The text less its lines that hold a word, and less the line after one that holds `hash`. */
static const char *without(const char *s, const char *word, const char *hash)
{
	struct text t;
	int drop = 0;

	text_init(&t, &arena);
	while (*s) {
		size_t n = strcspn(s, "\n");
		const char *line = arena_string(&arena, s, n);

		n += s[n] == '\n';
		if (!drop && !strstr(line, word))
			text_putn(&t, s, n);
		drop = hash && strstr(line, hash);
		s += n;
	}
	return text_string(&t);
}

/* Less the numbers of headers' guards, which are of the head. */
static const char *without_guards(const char *s)
{
	return without(s, "_RNEA_H ", NULL);
}

/* All texts of a result in one, less the URDF's hash, the numbers of headers' guards, which are of it, and the warnings, which
   name lines of the file. */
static const char *all_texts(const struct rneagen_result *r, int with_lines)
{
	struct text t;

	text_init(&t, &arena);
	text_printf(&t, "%s%s%s%s%s%s", r->source ? r->source : "", r->header ? r->header : "", r->info,
		r->info_json, r->dot, r->dump ? r->dump : "");
	return without_guards(without(text_string(&t), with_lines ? "\n" : "here:", "SHA-256"));
}

/* What goes to a file: a text, and a dump instead of it where one is asked for. */
static const char *in_file(const struct rneagen_result *r)
{
	ck_assert_msg(!r->source == (r->dump != NULL), "a dump goes without a source, and a source without a dump");
	ck_assert_msg(!r->dump || !r->header, "a dump goes without a header");
	return r->source ? r->source : r->dump;
}

static void check_same(const char *a, const char *b, const char *what, uint64_t seed)
{
	int line = 1;

	for (const char *s = a, *t = b; *s && *s == *t; s++, t++)
		line += *s == '\n';
	ck_assert_msg(!strcmp(a, b), "%s: %llu: line %d differs", what, (unsigned long long)seed, line);
}

/* ---- equal bytes ---- */

START_TEST(equal_input_equal_bytes)
{
	for (int i = 0; i < ROBOTS; i++) {
		struct random_robot_knobs knobs = random_robot_knobs((uint64_t)i, LINKS);
		struct rneagen_options o = options_of(i);
		char *urdf = random_robot((uint64_t)i, &knobs);
		struct rneagen_result first, second;

		first = generated(urdf, &o);
		o.file = "/some/where/else/here";
		second = generated(urdf, &o);
		check_same(all_texts(&first, 0), all_texts(&second, 0), "again", (uint64_t)i);
		ck_assert(!strstr(in_file(&second), "some") && !strstr(in_file(&second), "else/"));
		rneagen_result_free(&first);
		rneagen_result_free(&second);
		free(urdf);
	}
}
END_TEST

/* What is told beside a text changes nothing in it; changed constants are told in its head. */
START_TEST(the_text_alone)
{
	static const char *const scenes[] = {NULL, "want tau,dtau_dq\ndamping\n", "snap-angle 1e-3\nround-constants 3\n"};

	for (int i = 0; i < 3 * ROBOTS; i++) {
		struct random_robot_knobs knobs = random_robot_knobs((uint64_t)i, LINKS);
		struct rneagen_options o = options_of(i);
		char *urdf = random_robot((uint64_t)i, &knobs);
		struct rneagen_result all, alone;

		o.scene = scenes[i % 3];
		all = generated(urdf, &o);
		o.tell = 0;
		alone = generated(urdf, &o);
		check_same(in_file(&all), in_file(&alone), "source", (uint64_t)i);
		check_same(all.header ? all.header : "", alone.header ? alone.header : "", "header", (uint64_t)i);
		ck_assert_uint_eq(all.warning_count, alone.warning_count);
		ck_assert(all.info && all.info_json && all.dot && !alone.info && !alone.info_json && !alone.dot);
		rneagen_result_free(&all);
		rneagen_result_free(&alone);
		free(urdf);
	}
}
END_TEST

/* random_robot writes one link or joint a line, between two lines before and one after. */
static char *shuffle_lines(const char *urdf, struct rng *rng)
{
	const char *lines[3 * LINKS + 8];
	int count = 0;
	struct text t;

	for (const char *s = urdf; *s; s += strcspn(s, "\n") + 1)
		lines[count++] = s;
	for (int i = count - 2; i > 2; i--) {
		int j = 2 + rng_below(rng, i - 1);
		const char *line = lines[i];

		lines[i] = lines[j];
		lines[j] = line;
	}
	text_init(&t, &arena);
	for (int i = 0; i < count; i++)
		text_putn(&t, lines[i], strcspn(lines[i], "\n") + 1);
	return t.s;
}

START_TEST(order_of_the_file)
{
	for (int i = 0; i < ROBOTS; i++) {
		struct random_robot_knobs knobs = random_robot_knobs((uint64_t)i, LINKS);
		struct rng rng = rng_seed((uint64_t)i);
		struct rneagen_options o = options_of(i);
		char *urdf = random_robot((uint64_t)i, &knobs), *shuffled = shuffle_lines(urdf, &rng);
		struct rneagen_result first = generated(urdf, &o), second = generated(shuffled, &o);

		ck_assert_uint_eq(strlen(shuffled), strlen(urdf));
		check_same(all_texts(&first, 0), all_texts(&second, 0), "shuffled file", (uint64_t)i);
		rneagen_result_free(&first);
		rneagen_result_free(&second);
		free(urdf);
	}
}
END_TEST

/* A name ends in '_' here, and a number follows: "joint_position" is none. */
static int is_name(const char *s, const char *from)
{
	size_t length = strlen(from);

	return !strncmp(s, from, length) && (from[length - 1] != '_' || (s[length] >= '0' && s[length] <= '9'));
}

static char *replace(const char *s, const char *from, const char *to)
{
	struct text t;

	text_init(&t, &arena);
	while (*s)
		if (is_name(s, from)) {
			text_put(&t, to);
			s += strlen(from);
		} else {
			text_putc(&t, *s++);
		}
	return t.s;
}

static char *translate(const char *s)
{
	return replace(replace(replace(s, "link_", "G-l. "), "joint_", "gel.k$"), "\"random\"", "\"zufall\"");
}

/* Other names in the same order and of the same lengths, so that lines break alike: nothing changes but the names. */
START_TEST(names_are_only_names)
{
	for (int i = 0; i < ROBOTS; i++) {
		struct random_robot_knobs knobs = random_robot_knobs((uint64_t)i, LINKS);
		struct rneagen_options o = options_of(i);
		struct rneagen_result first, second;
		char *urdf;

		knobs.odd_names = 0;
		urdf = random_robot((uint64_t)i, &knobs);
		first = generated(urdf, &o);
		second = generated(translate(urdf), &o);
		check_same(translate(replace(all_texts(&first, 1), "robot random", "robot zufall")), all_texts(&second, 1),
			"translated names", (uint64_t)i);
		rneagen_result_free(&first);
		rneagen_result_free(&second);
		free(urdf);
	}
}
END_TEST

/* What is told of numbers has the fewest digits that read back as the same: the user's own. */
START_TEST(numbers_are_short)
{
	static const char urdf[] = ROBOT("r",
		BARE("base") BALL("a") BALL("b") BALL("c") JOINT("ja", "continuous", "base", "a", "")
		JOINT("jb", "continuous", "a", "b", MIMIC("ja", "0.1", "0.3"))
		JOINT("jc", "continuous", "b", "c", ORIGIN("0 0 1", "1.5708 0 0")));
	static const char *const in_source[] = {" --gravity 0.573,-10,1e-05 ", "Gravity (0.573, -10, 1e-05) ",
		" * --snap-angle 0.0012345678 saves "};
	static const char *const in_json[] = {"\"multiplier\": 0.1, \"offset\": 0.3}", "\"name\": \"jc\", \"value\": [0.1]",
		"\"option\": \"snap-angle\", \"value\": 0.0012345678,"};
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;

	o.gravity[0] = 0.573;
	o.gravity[1] = -10;
	o.gravity[2] = 1e-5;
	o.tell = RNEAGEN_TELL_ALL;
	o.scene = "lock jc=0.1\nsnap-angle 0.0012345678";
	r = generated(urdf, &o);
	for (size_t i = 0; i < sizeof in_source / sizeof *in_source; i++)
		ck_assert_msg(strstr(r.source, in_source[i]) != NULL, "no '%s' in %.2000s", in_source[i], r.source);
	for (size_t i = 0; i < sizeof in_json / sizeof *in_json; i++)
		ck_assert_msg(strstr(r.info_json, in_json[i]) != NULL, "no '%s' in %s", in_json[i], r.info_json);
	ck_assert_msg(strstr(r.info, "gravity 0.573 -10 1e-05 in") != NULL, "%s", r.info);
	rneagen_result_free(&r);
}
END_TEST

/* ---- locale ---- */

/* A locale with a decimal comma: the system's, or one made in a folder of our own. 0: there is none. */
static int comma_locale(const char *folder)
{
	char path[64], *in = path;
	const char *argv[] = {"localedef", "-i", "de_DE", "-f", "UTF-8", in, NULL};
	struct process p;

	if (setlocale(LC_ALL, "de_DE.UTF-8") || setlocale(LC_ALL, "de_DE.utf8"))
		return 1;
	snprintf(path, sizeof path, "%s/de_DE.UTF-8", folder);
	p = process_run(argv);
	process_free(&p);
	setenv("LOCPATH", folder, 1);
	return setlocale(LC_ALL, "de_DE.UTF-8") != NULL;
}

START_TEST(same_in_every_locale)
{
	char folder[] = "/tmp/rneagen-locale-XXXXXX", comma[16];
	const char *argv[] = {"rm", "-rf", folder, NULL}, *before[10];
	struct random_robot_knobs knobs = random_robot_knobs(5, LINKS);
	char *urdf = random_robot(5, &knobs);
	struct process p;
	int found;

	ck_assert_ptr_nonnull(mkdtemp(folder));
	for (int i = 0; i < 10; i++) {
		struct rneagen_options o = options_of(i);
		struct rneagen_result r = generated(urdf, &o);

		before[i] = all_texts(&r, 1);
		rneagen_result_free(&r);
	}
	found = comma_locale(folder);
	p = process_run(argv);
	process_free(&p);
	snprintf(comma, sizeof comma, "%.1f", 0.5);
	if (!found || strcmp(comma, "0,5")) {
		printf("skipped: no locale with a decimal comma\n");
		free(urdf);
		return;
	}
	for (int i = 0; i < 10; i++) {
		struct rneagen_options o = options_of(i);
		struct rneagen_result r = generated(urdf, &o);

		check_same(before[i], all_texts(&r, 1), "in German", (uint64_t)i);
		rneagen_result_free(&r);
	}
	snprintf(comma, sizeof comma, "%.1f", 0.5);
	ck_assert_str_eq(comma, "0,5"); /* and the caller's locale is as it was */
	free(urdf);
}
END_TEST

/* ---- one code, one text ---- */

/* Where no GPU's own unit computes, --trig fast writes the text of bounded: rnearun takes texts that are the same for one
   variant. Would catch a text that calls a sine of its own there, or none where there is one. */
START_TEST(fast_without_a_unit_is_bounded)
{
	struct random_robot_knobs knobs = random_robot_knobs(3, LINKS);
	char *urdf = random_robot(3, &knobs);

	for (int target = RNEAGEN_TARGET_CUDA; target <= RNEAGEN_TARGET_HEADER; target++)
		for (int precision = RNEAGEN_F32; precision <= RNEAGEN_F32X2; precision++) {
			int unit = precision == RNEAGEN_F32 && target != RNEAGEN_TARGET_C;
			struct rneagen_options o = options_of(0);
			struct rneagen_result bounded, fast;

			o.target = (enum rneagen_target)target;
			o.precision = (enum rneagen_precision)precision;
			o.trig = RNEAGEN_BOUNDED;
			bounded = generated(urdf, &o);
			o.trig = RNEAGEN_FAST;
			fast = generated(urdf, &o);
			ck_assert_ptr_nonnull(strstr(bounded.source, "sincos"));
			ck_assert_msg(unit == (strcmp(without_guards(without(bounded.source, "trig", NULL)),
				without_guards(without(fast.source, "trig", NULL))) != 0),
				"target %d, precision %d", target, precision);
			ck_assert_msg(unit == (strstr(fast.source, "__sincosf") != NULL), "target %d, precision %d",
				target, precision);
			rneagen_result_free(&bounded);
			rneagen_result_free(&fast);
		}
	free(urdf);
}
END_TEST

static void note_pass(void *context, const char *makes)
{
	text_printf(context, "%s\n", makes);
}

/* Who waits is told of every pass, in the order of --dump passes. */
START_TEST(passes_are_told)
{
	struct random_robot_knobs knobs = random_robot_knobs(3, LINKS);
	char *urdf = random_robot(3, &knobs);
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct text told;
	const char *s;
	int passes = 0;

	text_init(&told, &arena);
	o.dump = RNEAGEN_DUMP_PASSES;
	o.progress = note_pass;
	o.progress_context = &told;
	r = generated(urdf, &o);
	s = text_string(&told);
	for (const char *line = r.dump; *line; line = strchr(line, '\n') + 1, s = strchr(s, '\n') + 1, passes++)
		ck_assert_msg(!strncmp(line + 17, s, strcspn(s, "\n")), "told '%s', listed '%s'", s, line);
	ck_assert(!*s && passes > 15);
	rneagen_result_free(&r);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("generate");
	TCase *c = tcase_create("texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_checked_fixture(c, open_arena, close_arena);
	tcase_add_test(c, equal_input_equal_bytes);
	tcase_add_test(c, the_text_alone);
	tcase_add_test(c, order_of_the_file);
	tcase_add_test(c, names_are_only_names);
	tcase_add_test(c, numbers_are_short);
	tcase_add_test(c, same_in_every_locale);
	tcase_add_test(c, fast_without_a_unit_is_bounded);
	tcase_add_test(c, passes_are_told);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
