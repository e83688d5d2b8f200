/* Which of several compilations is kept: the choice alone, and what rnea_open makes of it. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include "cuda/compile/compilation.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
	struct compilation choices[6];
	size_t count, best;
	unsigned own;
} table[] = {
	{{{0, 3, 0, 0}}, 1, 0, 128},		     /* nothing to choose */
	{{{0, 3, 48, 0}, {0, 0, 16, 0}}, 2, 1, 128}, /* less local memory */
	{{{0, 3, 48, 0}, {0, 0, 96, 0}}, 2, 0, 128},
	{{{0, 3, 48, 0}, {0, 0, 48, 0}}, 2, 0, 128},			       /* equal: the text's bound */
	{{{64, 0, 0, 1024}, {128, 0, 0, 1280}, {256, 0, 0, 1024}}, 3, 1, 64},  /* the most threads */
	{{{64, 0, 0, 1024}, {128, 0, 0, 1024}, {256, 0, 0, 1024}}, 3, 1, 128}, /* equal: the text's own */
	{{{64, 0, 0, 1024}, {128, 0, 0, 1024}, {256, 0, 0, 1024}}, 3, 0, 64},
	{{{64, 0, 0, 1024}, {128, 0, 0, 1024}, {256, 0, 0, 1024}}, 3, 2, 32},  /* or the largest */
	{{{64, 0, 0, 2048}, {128, 0, 0, 1024}, {256, 0, 0, 2048}}, 3, 2, 128}, /* own is not among the most */
	{{{128, 0, 0, 0}, {256, 0, 0, 0}}, 2, 0, 128},			       /* none fits */
	{{{64, 3, 8, 2048}, {64, 0, 0, 512}, {128, 3, 0, 1024}}, 3, 2, 64},    /* bounds before blocks */
	{{{64, 3, 8, 512}, {64, 0, 0, 2048}, {128, 3, 8, 1024}, {128, 0, 8, 4096}}, 4, 1, 128},
	{{{256, 3, 8, 512}, {256, 0, 0, 256}, {128, 3, 8, 256}, {128, 0, 9, 512}, {64, 3, 0, 256}}, 5, 1, 0},
};

START_TEST(chooses)
{
	ck_assert_uint_eq(compilation_best(table[_i].choices, table[_i].count, table[_i].own), table[_i].best);
}
END_TEST

/* The pendulum with a launch bound. */
static struct rnea_robot *open_bounded(const struct rnea_options *o, const char *bound, const char *local, const char *resident)
{
	char *text = pendulum_with("__launch_bounds__(RNEA_BLOCK)\npendulum_rnea",
		"__launch_bounds__(RNEA_BLOCK, RNEA_MIN_BLOCKS)\npendulum_rnea");
	char *whole;
	struct rnea_robot *robot;
	struct rnea_error e;

	use_fakes();
	setenv("RNEA_FAKE_CUDA_LOCAL", local, 1);
	setenv("RNEA_FAKE_CUDA_RESIDENT", resident, 1);
	ck_assert_int_gt(asprintf(&whole, "\n#ifndef RNEA_MIN_BLOCKS\n#define RNEA_MIN_BLOCKS %s\n#endif\n%s", bound, text), 0);
	ck_assert_msg(open_text(whole, o, &robot, &e) == RNEA_OK, "%s", e.message);
	free(whole);
	free(text);
	return robot;
}

static int compilations(void)
{
	int (*count)(void);

	fake_function(FAKE_NVRTC, "fake_nvrtc_compilations", &count);
	return count();
}

static const char *const bound_0[] = {"-DRNEA_MIN_BLOCKS=0"}, *const bound_5[] = {"--nothing", "-DRNEA_MIN_BLOCKS=5"};

static const struct {
	struct rnea_options options;
	const char *local, *resident; /* as the environment of fake_cuda.c has it */
	unsigned block, min_blocks;
	int compilations;
} openings[] = {
	{{0}, "0 0", "2048 2048 2048", 128, 3, 1},
	{{0}, "48 0", "2048 2048 2048", 128, 0, 2},
	{{0}, "48 96", "2048 2048 2048", 128, 3, 2},
	{{.block = 32}, "48 8", "2048 2048 2048", 32, 0, 2},
	{{.block = RNEA_BLOCK_OCCUPANCY}, "0 0", "2048 1024 1536", 64, 3, 3},
	{{.block = RNEA_BLOCK_OCCUPANCY}, "0 0", "1024 1024 1024", 128, 3, 3},
	{{.block = RNEA_BLOCK_OCCUPANCY}, "8 0", "1024 1024 2048", 256, 0, 6},
	{{.compile = bound_0, .compile_count = 1}, "48 8", "0 0 0", 128, 0, 1},
	{{.compile = bound_5 + 1, .compile_count = 1}, "48 8", "0 0 0", 128, 5, 1},
};

START_TEST(opens_the_best)
{
	struct rnea_robot *robot = open_bounded(&openings[_i].options, "3", openings[_i].local, openings[_i].resident);
	float q = 0.25f, qd = 0, qdd = 2, tau = 0;
	struct rnea_resources r;

	ck_assert_uint_eq(rnea_info(robot)->block, openings[_i].block);
	ck_assert_uint_eq(rnea_build(robot)->min_blocks, openings[_i].min_blocks);
	ck_assert_int_eq(compilations(), openings[_i].compilations);
	ck_assert_int_eq(rnea_launch(robot, (void *[]){&q, &qd, &qdd, &tau}, 1, NULL, NULL), RNEA_OK);
	ck_assert(tau > 3.4f && tau < 3.5f);
	rnea_resources(robot, "rnea", &r, NULL);
	rnea_close(robot);
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

/* A bound of as many threads in blocks of any size. */
static const struct {
	unsigned block, min_blocks;
	int compilations;
} threads[] = {{0, 3, 2}, {32, 0, 1}, {64, 6, 2}, {100, 3, 2}, {256, 1, 2}, {512, 0, 1}};

START_TEST(bounds_threads)
{
	static const char bound[] = "(RNEA_BLOCK < 64 ? 0 : 384/RNEA_BLOCK)";
	const struct rnea_options o = {.block = threads[_i].block};
	struct rnea_robot *robot =
		open_bounded(&o, bound, "48 96", "0 0 0"); /* what spills is tried without its bound, and spills more */

	ck_assert_uint_eq(rnea_build(robot)->min_blocks, threads[_i].min_blocks);
	ck_assert_int_eq(compilations(), threads[_i].compilations);
	rnea_close(robot);
}
END_TEST

/* Catches the text's own tables of sines taken for spilled registers: only what is beyond them is tried without the bound. */
START_TEST(knows_tables_of_sines)
{
	static const char bound[] = "3\n#endif\n#define RNEA_SINES_BYTES 48\n#if 0";
	const struct rnea_options o = {0};
	struct rnea_robot *robot = open_bounded(&o, bound, _i ? "56 48" : "48 0", "0 0 0");

	ck_assert_uint_eq(rnea_build(robot)->min_blocks, _i ? 0 : 3);
	ck_assert_int_eq(compilations(), _i ? 2 : 1);
	rnea_close(robot);
}
END_TEST

/* A block size that does not compile is passed over, unless none does. */
START_TEST(passes_over_what_does_not_compile)
{
	char *text = pendulum_with(
		"extern \"C\" {", "#if RNEA_BLOCK != 64\n#error too much shared memory\n#endif\nextern \"C\" {");
	struct rnea_options o = {.block = RNEA_BLOCK_OCCUPANCY};
	struct rnea_robot *robot;
	struct rnea_error e;

	use_fakes();
	ck_assert_msg(open_text(text, &o, &robot, &e) == RNEA_OK, "%s", e.message);
	ck_assert_uint_eq(rnea_info(robot)->block, 64);
	rnea_close(robot);
	memcpy(strstr(text, "!= 64"), "!= 65", 5);
	open_text(text, &o, &robot, &e);
	assert_error(&e, RNEA_COMPILE, "too much shared memory");
	ck_assert_int_eq(compilations(), 6);
	ck_assert_int_eq(fake_live(), 0);
	free(text);
}
END_TEST

Suite *suite_choose(void)
{
	Suite *s = suite_create("choose");
	TCase *t = tcase_create("choose");

	tcase_set_timeout(t, 120);
	tcase_add_loop_test(t, chooses, 0, (int)(sizeof table / sizeof *table));
	tcase_add_loop_test(t, opens_the_best, 0, (int)(sizeof openings / sizeof *openings));
	tcase_add_loop_test(t, bounds_threads, 0, (int)(sizeof threads / sizeof *threads));
	tcase_add_loop_test(t, knows_tables_of_sines, 0, 2);
	tcase_add_test(t, passes_over_what_does_not_compile);
	suite_add_tcase(s, t);
	return s;
}
