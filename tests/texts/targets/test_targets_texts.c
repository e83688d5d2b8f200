/* What a text is, apart from what it computes: no C compiler has anything to say about it, be it for target c or cuda;
   objects of target c show the documented symbols and need nothing; and what all_zero_torque stores is zero. Where all
   is asked for, every text of ours by gcc and by clang, each at one of two levels in turn; else by one of them in turn,
   and every second robot of ours, every third real one. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/process.h"
#include "support/suite.h"
#include "target/target.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void compile_object(const struct target *t, const char *command, const char *level, struct target_path source,
	struct target_path object)
{
	/* the algorithm is compiled once, and not in line wherever it is called, where nothing is optimised anyway */
	const char *once = strcmp(level, "-O0") ? NULL : "-Dalways_inline=unused";
	const char *const argv[] = {
		command, "-std=c11", WARNING_FLAGS, "-Wshadow", level, "-c", "-o", object.s, source.s, once, NULL};

	target_compile(t, argv);
}

/* nm says `name type ...`: is the name NAME with one of the suffixes? */
static int is_documented(const struct target *t, const char *symbol, size_t length)
{
	static const char *const suffixes[] = {"_rnea", "_rnea_batch", "_rnea_slice", "_fpass", "_fpass_slice", "_bpass",
		"_bpass_slice", "_info"};
	size_t own = strlen(t->text.name);

	for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++)
		if (length == own + strlen(suffixes[i]) && !strncmp(symbol, t->text.name, own) &&
			!strncmp(symbol + own, suffixes[i], strlen(suffixes[i])))
			return 1;
	return 0;
}

/* What compilers add of themselves. */
static int is_machinery(const char *symbol, size_t length)
{
	static const char *const known[] = {"_GLOBAL_OFFSET_TABLE_", "memset", "memcpy", "memmove"};

	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (length == strlen(known[i]) && !strncmp(symbol, known[i], length))
			return 1;
	return 0;
}

static void check_symbols(const struct target *t, struct target_path object)
{
	const char *const argv[] = {"nm", "-g", "-P", object.s, NULL};
	struct process p = process_run(argv);
	int defined = 0;

	ck_assert_msg(p.status == 0, "%s: nm: %s", t->what, p.output);
	for (const char *line = p.output; *line; line = strchr(line, '\n') + 1) {
		size_t length = strcspn(line, " ");
		char type = line[length + 1];

		if (is_machinery(line, length))
			continue;
		ck_assert_msg(type != 'U' && is_documented(t, line, length), "%s: symbol '%.*s' (%c)", t->what,
			(int)length, line, type);
		defined++;
	}
	ck_assert_msg(defined == 8, "%s: %d symbols", t->what, defined);
	process_free(&p);
}

struct tally {
	const char *clang; /* NULL: none here */
	int own, robots, turn;
};

/* What looks at control flow needs optimising, which takes long over long texts. */
static void compile_by_all(const struct tally *tally, const struct target *t, const char *stem)
{
	static const char *const commands[] = {"clang", "gcc", "clang"}, *const levels[] = {"-O0", "-O1", "-O1"};
	int is_long = strlen(t->text.source) > (exhaustive() ? 120000 : 80000);

	for (int i = 0; i < 3; i++) {
		const char *command = tally->clang ? commands[i] : "gcc";
		struct target_path object = target_path(stem, ".o");

		if (tally->own && exhaustive() ? i == tally->turn % 2 * 2 : i != (tally->own ? tally->turn % 3 : 0))
			continue;
		compile_object(t, command, is_long ? "-O0" : exhaustive() &&
			(i == 2 || (i && tally->turn % 4 < 2)) ? "-O2" : levels[i],
			target_path(stem, ".c"), object);
		check_symbols(t, object);
		unlink(object.s);
	}
}

/* The text for CUDA as C: of the warnings that need no optimising. */
static void check_cuda_as_c(const struct tally *tally, const char *urdf, size_t length, const char *name,
	struct rneagen_options o, const char *stem)
{
	struct target_path source = target_path(stem, ".cu");
	struct target t;

	o.target = RNEAGEN_TARGET_CUDA;
	target_generate(&t, urdf, length, &o, name);
	target_write(source, t.text.source);
	for (int i = 0; i < (tally->clang ? 2 : 1); i++) {
		if (tally->clang && !(tally->own && exhaustive()) && i != tally->turn % 2)
			continue;
		const char *const argv[] = {i ? "clang" : "gcc", "-std=c11", WARNING_FLAGS, "-Wshadow", "-fsyntax-only",
			"-x", "c", source.s, NULL};

		target_compile(&t, argv);
	}
	unlink(source.s);
	target_close(&t);
}

/* One text; precision, layout and mode take turns. */
static void check_text(struct tally *tally, const char *urdf, size_t length, const char *name, enum rneagen_base base)
{
	struct rneagen_options o = rneagen_options_default();
	struct target t;
	char stem[128];

	o.target = RNEAGEN_TARGET_C;
	o.base = base;
	o.precision = tally->turn % 2 ? RNEAGEN_F32 : RNEAGEN_F64;
	o.layout = tally->turn / 2 % 2 ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.trig = (enum rneagen_trig)(tally->turn % 3);
	tally->turn++;
	snprintf(stem, sizeof stem, "text_%.*s_%d", (int)(strlen(name) - 5), name, base);
	target_generate(&t, urdf, length, &o, name);
	target_write(target_path(stem, ".c"), t.text.source);
	compile_by_all(tally, &t, stem);
	unlink(target_path(stem, ".c").s);
	target_close(&t);
	check_cuda_as_c(tally, urdf, length, name, o, stem);
}

static void check_robot(const char *path, const char *name, void *context)
{
	struct tally *tally = context;
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail_", 6))
		return;
	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	if (tally->robots % (tally->own ? 2 : 3) == 0 || exhaustive())
		check_text(tally, urdf, length, name, RNEAGEN_FIXED);
	if (tally->robots % 3 == 0)
		check_text(tally, urdf, length, name, RNEAGEN_FLOATING);
	tally->robots++;
	free(urdf);
}

static void check_folder(const char *folder, int own)
{
	struct tally tally = {.own = own, .clang = process_exists("clang") ? "clang" : NULL};

	if (!tally.clang)
		printf("skipped: no clang\n");
	for_each_urdf(folder, check_robot, &tally);
	ck_assert_int_gt(tally.robots, 0);
	printf("%d texts of %d robots, each for CUDA too: no warning, no symbol too many\n", tally.turn, tally.robots);
}

START_TEST(own_robots)
{
	check_folder(TEST_DIR "/robots", 1);
}
END_TEST

START_TEST(real_robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");

	if (folder)
		check_folder(folder, 0);
	else
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
}
END_TEST

/* Arrays of one row that are filled by a call: gcc knows that they are. */
START_TEST(one_joint_aos)
{
	struct target_path source = target_path("one_joint", ".c"), object = target_path("one_joint", ".o");
	struct rneagen_options o = rneagen_options_default();
	struct target t;
	size_t length;
	char *urdf = target_robot("pendulum", &length);

	o.target = RNEAGEN_TARGET_C;
	o.layout = RNEAGEN_AOS;
	o.scene = "want gravity";
	target_generate(&t, urdf, length, &o, "pendulum");
	target_write(source, t.text.source);
	compile_object(&t, "gcc", "-O2", source, object);
	compile_object(&t, "gcc", "-O3", source, object);
	unlink(source.s);
	unlink(object.s);
	target_close(&t);
	free(urdf);
}
END_TEST

/* Where all angles are small, a batch has no table of sines: clang traps where its place would be counted from NULL. */
START_TEST(no_offset_of_null)
{
	static const struct compiler clang = {"clang", {"-O1", "-fsanitize=undefined", "-fsanitize-trap=undefined"}};
	enum { SAMPLES = 40, ROWS = 2 };
	struct rneagen_options o = rneagen_options_default();
	struct array in[3], tau = array_new(0, SAMPLES * ROWS);
	struct target t;
	size_t length;
	char *urdf = target_robot("double_pendulum", &length);

	if (!compiler_serves(&clang, 0))
		return;
	o.target = RNEAGEN_TARGET_C;
	o.precision = RNEAGEN_F64;
	o.layout = _i ? RNEAGEN_AOS : RNEAGEN_SOA;
	target_open(&t, urdf, length, &o, &clang, "null");
	for (int k = 0; k < 3; k++) {
		in[k] = array_new(0, SAMPLES * ROWS);
		for (size_t i = 0; i < SAMPLES * ROWS; i++)
			array_set(&in[k], i, 0.5);
	}
	target_batch(&t, &in[0], &in[1], &in[2], &tau, SAMPLES);
	ck_assert(same_number(array_get(&tau, 0), array_get(&tau, o.layout == RNEAGEN_AOS ? ROWS : 1)));
	for (int k = 0; k < 3; k++)
		array_free(&in[k]);
	array_free(&tau);
	target_close(&t);
	free(urdf);
}
END_TEST

/* Exactly +0, and said so. */
START_TEST(zero_is_stored)
{
	static const struct compiler gcc = {"gcc", {"-O2"}};
	struct rneagen_options o = rneagen_options_default();
	struct array in[3], tau = array_new(0, 6);
	struct target t;
	size_t length;
	char *urdf = target_robot("all_zero_torque", &length);

	o.target = RNEAGEN_TARGET_C;
	o.precision = RNEAGEN_F64;
	target_open(&t, urdf, length, &o, &gcc, "zero");
	for (int k = 0; k < 3; k++) {
		in[k] = array_new(0, 6);
		for (size_t i = 0; i < 6; i++)
			array_set(&in[k], i, -1.5);
	}
	target_rnea(&t, &in[0], &in[1], &in[2], &tau);
	for (size_t i = 0; i < 6; i++) {
		char line[64];

		ck_assert_msg(same_number(array_get(&tau, i), 0), "torque %zu is %g", i, array_get(&tau, i));
		if (i < 2)
			snprintf(line, sizeof line, "tau[%s] = 0.0;", i ? "stride" : "0");
		else
			snprintf(line, sizeof line, "tau[%zu*stride] = 0.0;", i);
		ck_assert_msg(strstr(t.text.source, line) != NULL, "no line '%s'", line);
	}
	for (int k = 0; k < 3; k++)
		array_free(&in[k]);
	array_free(&tau);
	target_close(&t);
	free(urdf);
}
END_TEST

/* Constants beyond float are refused where they are floats, and taken where they are doubles: mixed stores the torque that
   f64 finds, or infinity where no float holds it. A pendulum of 1e-100 kg under 1e101 m/s^2, and of 1 kg. */
START_TEST(constants_beyond_float)
{
	static const enum rneagen_precision precisions[] = {RNEAGEN_F32, RNEAGEN_F32X2, RNEAGEN_F64, RNEAGEN_MIXED};
	static const struct compiler gcc = {"gcc", {"-O1"}};
	struct rneagen_options o = rneagen_options_default();
	struct array q = array_new(1, 1), zero = array_new(1, 1), tau = array_new(1, 1);
	char urdf[1024];
	struct target t;

	o.target = RNEAGEN_TARGET_C;
	o.gravity[2] = -1e101;
	for (int heavy = 0; heavy < 2; heavy++) {
		snprintf(urdf, sizeof urdf,
			"<robot name='p'><link name='a'/><link name='b'><inertial><origin xyz='0 0 -2'/><mass value='%s'/>"
			"<inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial></link><joint name='j' type='continuous'>"
			"<parent link='a'/><child link='b'/></joint></robot>", heavy ? "1" : "1e-100");
		for (int i = 0; i < 4; i++) {
			struct rneagen_result r;
			struct rneagen_error e;

			o.precision = precisions[i];
			if (rneagen_generate(urdf, strlen(urdf), &o, &r, &e) == RNEAGEN_OK)
				rneagen_result_free(&r);
			ck_assert_int_eq(e.code, i < 2 ? RNEAGEN_NUMBER : RNEAGEN_OK);
			ck_assert_msg(i >= 2 || strstr(e.message, "take --precision f64, or mixed") != NULL, "%s", e.message);
		}
		target_open(&t, urdf, strlen(urdf), &o, &gcc, "beyond");
		array_set(&q, 0, 0.5);
		array_set(&zero, 0, 0);
		target_rnea(&t, &q, &zero, &zero, &tau);
		ck_assert_msg(heavy ? isinf(array_get(&tau, 0)) : fabs(array_get(&tau, 0) / (20 * sin(0.5)) - 1) < 1e-7, "tau %g",
			array_get(&tau, 0));
		target_close(&t);
	}
	array_free(&q);
	array_free(&zero);
	array_free(&tau);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "own", own_robots, 1, 1200);
	suite_add(suite, "real", real_robots, 1, 1200);
	suite_add(suite, "one joint", one_joint_aos, 1, 60);
	suite_add(suite, "null", no_offset_of_null, 2, 60);
	suite_add(suite, "zero", zero_is_stored, 1, 1200);
	suite_add(suite, "constants", constants_beyond_float, 1, 60);
	return suite_run(suite);
}
