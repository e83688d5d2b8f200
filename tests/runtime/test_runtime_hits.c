/* What is taken from the cache when a text is opened, and what not. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int compilations(void)
{
	int (*count)(void);

	fake_function(FAKE_NVRTC, "fake_nvrtc_compilations", &count);
	return count();
}

/* Open the pendulum, whose block and target are told; 1 if it came from the cache. */
static int opened_from_cache(const struct rnea_options *o, unsigned block, const char *target)
{
	int before = compilations(), cached;
	const struct rnea_build *b;
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(rnea_open_file(TEST_DIR "/runtime/pendulum.cu", o, &robot, &e) == RNEA_OK, "%s", e.message);
	b = rnea_build(robot);
	cached = b->cached;
	ck_assert_int_eq(b->backend, RNEA_BACKEND_CUDA);
	ck_assert_uint_eq(rnea_info(robot)->block, block);
	ck_assert_str_eq(b->target, target);
	ck_assert_str_eq(b->device, "pretended device 0");
	ck_assert_str_eq(b->note, "");
	ck_assert_str_eq(b->compiler, cached ? "" : "NVRTC 0.1 (" FAKE_NVRTC ")");
	ck_assert(b->seconds > 0);
	ck_assert(cached ? compilations() == before : compilations() > before);
	pendulum_computes(robot);
	return cached;
}

START_TEST(second_opening_is_a_hit)
{
	static const char *const define[] = {"-DX=1"};
	char folder[64];
	struct rnea_options option = {.compile = define, .compile_count = 1},
			    occupancy = {.block = RNEA_BLOCK_OCCUPANCY}, block = {.block = 32}, none = {.cache = ""},
			    other = {.cache = "/proc/nowhere"};

	snprintf(folder, sizeof folder, "%s", getenv("RNEA_CACHE"));
	setenv("RNEA_FAKE_CUDA_RESIDENT", "2048 1024 1024", 1);
	ck_assert(!opened_from_cache(NULL, 128, "sm_90"));
	ck_assert(opened_from_cache(NULL, 128, "sm_90"));
	ck_assert(!opened_from_cache(&none, 128, "sm_90"));
	ck_assert(!opened_from_cache(&other, 128, "sm_90"));
	ck_assert(!opened_from_cache(&option, 128, "sm_90"));
	ck_assert(opened_from_cache(&option, 128, "sm_90"));
	ck_assert(!opened_from_cache(&block, 32, "sm_90"));
	ck_assert(opened_from_cache(&block, 32, "sm_90"));
	ck_assert(!opened_from_cache(&occupancy, 64, "sm_90"));
	ck_assert(opened_from_cache(&occupancy, 64, "sm_90"));
	setenv("RNEA_FAKE_CUDA_ARCH", "80", 1);
	ck_assert(!opened_from_cache(NULL, 128, "sm_80"));
	setenv("RNEA_FAKE_CUDA_ARCH", "120", 1);
	ck_assert(!opened_from_cache(NULL, 128, "compute_90"));
	ck_assert(opened_from_cache(NULL, 128, "compute_90"));
	setenv("RNEA_CACHE", "", 1);
	ck_assert(!opened_from_cache(NULL, 128, "compute_90"));
	ck_assert(opened_from_cache(&(struct rnea_options){.cache = folder}, 128, "compute_90"));
}
END_TEST

START_TEST(another_text_is_a_miss)
{
	char *text = pendulum_with("9.81f*sinf", "9.82f*sinf");
	struct rnea_robot *robot;

	ck_assert(!opened_from_cache(NULL, 128, "sm_90"));
	ck_assert_int_eq(open_text(text, NULL, &robot, NULL), RNEA_OK);
	ck_assert_int_eq(rnea_build(robot)->cached, 0);
	rnea_close(robot);
	ck_assert_int_eq(open_text(text, NULL, &robot, NULL), RNEA_OK);
	ck_assert_int_eq(rnea_build(robot)->cached, 1);
	rnea_close(robot);
	free(text);
}
END_TEST

/* The one entry of the cache. */
static char *find_entry(void)
{
	char pattern[256], *path;
	glob_t found;

	snprintf(pattern, sizeof pattern, "%s/rnea-*", getenv("RNEA_CACHE"));
	ck_assert_int_eq(glob(pattern, 0, NULL, &found), 0);
	ck_assert_uint_eq(found.gl_pathc, 1);
	path = strdup(found.gl_pathv[0]);
	globfree(&found);
	return path;
}

static void open_and_say(const struct rnea_options *o, int cached, const char *unkept)
{
	const char *file = o->backend == RNEA_BACKEND_HOST ? TEST_DIR "/runtime/pendulum.c" : TEST_DIR "/runtime/pendulum.cu";
	const struct rnea_build *b;
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(rnea_open_file(file, o, &robot, &e) == RNEA_OK, "%s", e.message);
	b = rnea_build(robot);
	ck_assert_int_eq(b->cached, cached);
	ck_assert_msg(strstr(b->unkept, unkept) && !*b->unkept == !*unkept, "\"%s\", not \"%s\"", b->unkept, unkept);
	rnea_close(robot);
}

/* Catches an entry that is disabled for good without a word, on either backend: an empty folder in its place is replaced,
   one that holds something is told of. */
START_TEST(folder_in_place_of_an_entry)
{
	const struct rnea_options o = {.backend = _i ? RNEA_BACKEND_HOST : RNEA_BACKEND_CUDA},
				  none = {.backend = o.backend, .cache = ""};
	char *path, below[300];

	open_and_say(&none, 0, "");
	open_and_say(&o, 0, "");
	open_and_say(&o, 1, "");
	path = find_entry();
	ck_assert_int_eq(unlink(path), 0);
	ck_assert_int_eq(mkdir(path, 0700), 0);
	open_and_say(&o, 0, "");
	open_and_say(&o, 1, "");
	ck_assert_int_eq(unlink(path), 0);
	ck_assert_int_eq(mkdir(path, 0700), 0);
	snprintf(below, sizeof below, "%s/below", path);
	ck_assert_int_eq(mkdir(below, 0700), 0);
	open_and_say(&o, 0, path);
	open_and_say(&o, 0, "not empty");
	free(path);
}
END_TEST

/* Whether the name of the file is told apart only matters where an option could put it into the image. */
START_TEST(moved_texts_are_hits)
{
	struct rnea_options moved = {.file = "elsewhere.cu"};

	ck_assert(!opened_from_cache(NULL, 128, "sm_90"));
	ck_assert(opened_from_cache(&moved, 128, "sm_90"));
}
END_TEST

/* What was chosen among several compilations is a hit as a whole. */
START_TEST(choices_are_kept)
{
	char *text = pendulum_with("__launch_bounds__(RNEA_BLOCK)\npendulum_rnea",
		     "__launch_bounds__(RNEA_BLOCK, RNEA_MIN_BLOCKS)\npendulum_rnea"),
	     *whole;
	struct rnea_robot *robot;

	ck_assert_int_gt(asprintf(&whole, "\n#ifndef RNEA_MIN_BLOCKS\n#define RNEA_MIN_BLOCKS 3\n#endif\n%s", text), 0);
	setenv("RNEA_FAKE_CUDA_LOCAL", _i ? "48 96" : "48 0", 1);
	for (int i = 0; i < 2; i++) {
		ck_assert_int_eq(open_text(whole, NULL, &robot, NULL), RNEA_OK);
		ck_assert_int_eq(rnea_build(robot)->cached, i);
		ck_assert_uint_eq(rnea_build(robot)->min_blocks, _i ? 3 : 0);
		ck_assert_int_eq(compilations(), 2);
		pendulum_computes(robot);
	}
	free(whole);
	free(text);
}
END_TEST

/* An image that the driver refuses is compiled again; if the device has no memory, or the context is lost, that would
   not help. */
START_TEST(refused_images)
{
	static const struct {
		int status;
		enum rnea_code code;
	} table[] = {{200, RNEA_OK}, {218, RNEA_OK}, {2, RNEA_DEVICE_MEMORY}, {719, RNEA_CONTEXT}};
	void (*fail_call)(long, int);
	const char *(*failed)(void), *call = "";
	struct rnea_robot *robot;
	struct rnea_error e;

	fake_function(FAKE_CUDA, "fake_cuda_fail", &fail_call);
	fake_function(FAKE_CUDA, "fake_cuda_failed", &failed);
	ck_assert(!opened_from_cache(NULL, 128, "sm_90"));
	for (long n = 0; strcmp(call, "cuModuleLoadDataEx") != 0; n++) {
		fail_call(n, table[_i].status);
		rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e);
		call = failed();
		ck_assert_ptr_nonnull(call);
		fail_call(-1, 0);
		if (e.code == RNEA_OK && strcmp(call, "cuModuleLoadDataEx") != 0)
			rnea_close(robot);
	}
	ck_assert_msg(e.code == table[_i].code, "%s", e.message);
	ck_assert_int_eq(compilations(), e.code == RNEA_OK ? 2 : 1);
	if (e.code == RNEA_OK) {
		ck_assert_int_eq(rnea_build(robot)->cached, 0);
		pendulum_computes(robot);
	}
	ck_assert(opened_from_cache(NULL, 128, "sm_90"));
}
END_TEST

/* Without NVRTC nobody knows what it would have made. */
START_TEST(no_compiler_no_hit)
{
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert(!opened_from_cache(NULL, 128, "sm_90"));
	setenv("RNEA_NVRTC", "/nowhere/libnvrtc.so", 1);
	rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e);
	assert_error(&e, RNEA_NO_COMPILER, "tried /nowhere/libnvrtc.so (from RNEA_NVRTC)");
}
END_TEST

START_TEST(allocation_failures)
{
	struct rnea_error e = {0};
	struct rnea_robot *robot;
	long n = 0;

	ck_assert(!opened_from_cache(NULL, 128, "sm_90"));
	for (;; n++) {
		fail_allocation(n);
		rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e);
		if (!allocation_failed())
			break;
		fail_allocation(-1);
		assert_error(&e, RNEA_MEMORY, "out of memory");
		ck_assert_int_eq(fake_live(), 0);
	}
	fail_allocation(-1);
	ck_assert_int_eq(rnea_build(robot)->cached, 1);
	ck_assert_int_gt(n, 4);
	pendulum_computes(robot);
}
END_TEST

Suite *suite_hits(void)
{
	Suite *s = suite_create("hits");
	TCase *t = tcase_create("hits");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, use_folder, drop_folder);
	tcase_add_test(t, second_opening_is_a_hit);
	tcase_add_test(t, another_text_is_a_miss);
	tcase_add_loop_test(t, folder_in_place_of_an_entry, 0, 2);
	tcase_add_test(t, moved_texts_are_hits);
	tcase_add_loop_test(t, choices_are_kept, 0, 2);
	tcase_add_loop_test(t, refused_images, 0, 4);
	tcase_add_test(t, no_compiler_no_hit);
	tcase_add_test(t, allocation_failures);
	suite_add_tcase(s, t);
	return s;
}
