/* Which backend a text is opened on, and what is taken from the cache, and what not. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[64];

static void setup(void)
{
	use_fakes();
	unsetenv("RNEA_CC");
	strcpy(folder, "/tmp/test_runtime_backend_XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(folder));
	setenv("RNEA_CACHE", folder, 1);
}

static int remove_one(const char *path, const struct stat *s, int kind, struct FTW *f)
{
	(void)s, (void)kind, (void)f;
	return remove(path);
}

static void teardown(void)
{
	use_fakes();
	ck_assert_int_eq(fake_live(), 0);
	ck_assert_int_eq(nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS), 0);
}

static int compilations(void)
{
	int (*count)(void);

	fake_function(FAKE_NVRTC, "fake_nvrtc_compilations", &count);
	return count();
}

static char *read_text(const char *path)
{
	FILE *f = fopen(path, "rb");
	char *text = calloc(1, 1 << 16);

	ck_assert(f && text && fread(text, 1, (1 << 16) - 1, f) > 0);
	fclose(f);
	return text;
}

/* A text for both backends, as rneagen writes it for target cuda: the two pendulums in one. */
static char *both(void)
{
	char *cuda = read_text(TEST_DIR "/pendulum.cu"), *c = read_text(TEST_DIR "/pendulum.c"), *text;

	ck_assert_int_gt(asprintf(&text, "#if defined __CUDACC_RTC__\n%s\n#else\n%s\n#endif\n", cuda, c), 0);
	free(cuda);
	free(c);
	return text;
}

/* The robot computes; closed afterwards. */
static void assert_computes(struct rnea_robot *robot)
{
	float q = 0.25f, qd = 0, qdd = 2, tau[2] = {0, 0};
	void *arrays[] = {&q, &qd, &qdd, &tau[0]};
	struct rnea_error e;

	ck_assert_msg(rnea_launch(robot, arrays, 1, NULL, &e) == RNEA_OK, "%s", e.message);
	arrays[3] = &tau[1];
	ck_assert_msg(rnea_run(robot, arrays, 1, &e) == RNEA_OK, "%s", e.message);
	for (int i = 0; i < 2; i++)
		ck_assert(fabsf(tau[i] - (1 + 9.81f * sinf(0.25f))) < 1e-5f);
	rnea_close(robot);
}

/* ---- the cache ---- */

/* Open the pendulum, whose block and target are told; 1 if it came from the cache. */
static int opened_from_cache(const struct rnea_options *o, unsigned block, const char *target)
{
	int before = compilations(), cached;
	const struct rnea_build *b;
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(rnea_open_file(TEST_DIR "/pendulum.cu", o, &robot, &e) == RNEA_OK, "%s", e.message);
	b = rnea_build(robot);
	cached = b->cached;
	ck_assert_int_eq(b->backend, RNEA_BACKEND_CUDA);
	ck_assert_uint_eq(rnea_info(robot)->block, block);
	ck_assert_str_eq(b->target, target);
	ck_assert_str_eq(b->device, "pretended device 0");
	ck_assert_str_eq(b->note, "");
	ck_assert_str_eq(b->compiler, cached ? "" : "NVRTC 0.1 (" FAKE_NVRTC ")");
	ck_assert(b->seconds > 0 && b->seconds < 600);
	ck_assert(cached ? compilations() == before : compilations() > before);
	assert_computes(robot);
	return cached;
}

START_TEST(second_opening_is_a_hit)
{
	static const char *const define[] = {"-DX=1"};
	struct rnea_options option = {.compile = define, .compile_count = 1},
			    occupancy = {.block = RNEA_BLOCK_OCCUPANCY}, block = {.block = 32}, none = {.cache = ""},
			    other = {.cache = "/proc/nowhere"};

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
		assert_computes(robot);
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
		rnea_open_file(TEST_DIR "/pendulum.cu", NULL, &robot, &e);
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
		assert_computes(robot);
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
	rnea_open_file(TEST_DIR "/pendulum.cu", NULL, &robot, &e);
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
		rnea_open_file(TEST_DIR "/pendulum.cu", NULL, &robot, &e);
		if (!allocation_failed())
			break;
		fail_allocation(-1);
		assert_error(&e, RNEA_MEMORY, "out of memory");
		ck_assert_int_eq(fake_live(), 0);
	}
	fail_allocation(-1);
	ck_assert_int_eq(rnea_build(robot)->cached, 1);
	ck_assert_int_gt(n, 4);
	assert_computes(robot);
}
END_TEST

/* ---- the backend ---- */

/* Open a text, which must serve `backend`. */
static struct rnea_robot *open_on(
	const char *text, enum rnea_backend asked, enum rnea_backend backend, const char *note)
{
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert_msg(
		open_text(text, &(struct rnea_options){.backend = asked}, &robot, &e) == RNEA_OK, "%s", e.message);
	ck_assert_int_eq(rnea_build(robot)->backend, backend);
	ck_assert_msg(strstr(rnea_build(robot)->note, note) && !*rnea_build(robot)->note == !*note, "%s",
		rnea_build(robot)->note);
	return robot;
}

START_TEST(chooses_the_backend)
{
	char *c = read_text(TEST_DIR "/pendulum.c"), *cuda = both();

	assert_computes(open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_CUDA, ""));
	assert_computes(open_on(cuda, RNEA_BACKEND_CUDA, RNEA_BACKEND_CUDA, ""));
	assert_computes(open_on(cuda, RNEA_BACKEND_HOST, RNEA_BACKEND_HOST, ""));
	assert_computes(open_on(c, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, ""));
	assert_computes(open_on(c, RNEA_BACKEND_HOST, RNEA_BACKEND_HOST, ""));
	setenv("RNEA_FAKE_CUDA_DEVICES", "0", 1);
	assert_computes(open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, "cuInit: error 100, CUDA_ERROR_NO_DEVICE"));
	setenv("RNEA_FAKE_CUDA_FAIL", "cuInit=34", 1); /* the library that lies beside the compiler for linking */
	assert_computes(open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, "cuInit: error 34"));
	unsetenv("RNEA_FAKE_CUDA_FAIL");
	unsetenv("RNEA_LIBCUDA");
	if (system("ldconfig -p 2>/dev/null | grep -q libcuda.so.1") == 0 || access("/dev/nvidiactl", F_OK) == 0)
		puts("skipped: chooses_the_backend, without a driver: there is one");
	else
		assert_computes(
			open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, "no CUDA driver; tried libcuda.so.1"));
	free(c);
	free(cuda);
}
END_TEST

/* What is wrong, rather than not there, is an error: the caller may hold device pointers. */
static const struct {
	const char *variable, *value;
	enum rnea_code code;
	const char *message;
	struct rnea_options options;
} refusals[] = {
	{"RNEA_NVRTC", "/nowhere/libnvrtc.so", RNEA_NO_COMPILER, "no NVRTC; tried /nowhere/libnvrtc.so", {0}},
	{"RNEA_LIBCUDA", "/nowhere/libcuda.so", RNEA_NO_DRIVER, "tried /nowhere/libcuda.so (from RNEA_LIBCUDA)", {0}},
	{"RNEA_FAKE_CUDA_FAIL", "cuInit=999", RNEA_DRIVER, "cuInit: error 999", {0}},
	{"RNEA_FAKE_CUDA_FAIL", "cuDevicePrimaryCtxRetain=2", RNEA_DEVICE_MEMORY, "cuDevicePrimaryCtxRetain", {0}},
	{"RNEA_FAKE_CUDA_FAIL", "cuModuleGetFunction=709", RNEA_CONTEXT, "close this robot and open it again", {0}},
	{"RNEA_FAKE_NVRTC_FAIL", "6", RNEA_COMPILE, "NVRTC_ERROR_COMPILATION", {0}},
	{"X", "", RNEA_NO_DEVICE, "no CUDA device 1", {.device = 1}},
	{"RNEA_FAKE_CUDA_DEVICES", "0", RNEA_NO_DEVICE, "CUDA_ERROR_NO_DEVICE", {.backend = RNEA_BACKEND_CUDA}},
	{"RNEA_CC", "/nowhere/cc", RNEA_NO_COMPILER, "/nowhere/cc", {.backend = RNEA_BACKEND_HOST}},
	{"X", "", RNEA_ARGUMENT, "there is no backend 3", {.backend = (enum rnea_backend)3}},
};

START_TEST(refuses)
{
	char *text = both();
	struct rnea_robot *robot;
	struct rnea_error e;

	setenv(refusals[_i].variable, refusals[_i].value, 1);
	open_text(text, &refusals[_i].options, &robot, &e);
	assert_error(&e, refusals[_i].code, refusals[_i].message);
	ck_assert_ptr_null(robot);
	free(text);
}
END_TEST

START_TEST(refuses_c_on_cuda)
{
	char *text = read_text(TEST_DIR "/pendulum.c");
	struct rnea_robot *robot;
	struct rnea_error e;

	open_text(text, &(struct rnea_options){.backend = RNEA_BACKEND_CUDA}, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "pendulum.c: a text for target c has no kernel");
	free(text);
}
END_TEST

/* Neither backend serves: both reasons are told. */
START_TEST(tells_both_failures)
{
	char *text = both();
	struct rnea_robot *robot;
	struct rnea_error e;

	setenv("RNEA_FAKE_CUDA_DEVICES", "0", 1);
	setenv("RNEA_CC", "/nowhere/cc", 1);
	open_text(text, NULL, &robot, &e);
	assert_error(&e, RNEA_NO_COMPILER, "/nowhere/cc");
	assert_error(&e, RNEA_NO_COMPILER, "(the host was tried because: CUDA driver (");
	free(text);
}
END_TEST

START_TEST(block_by_option)
{
	static const char *const options[] = {"-DRNEA_BLOCK=64"};
	struct rnea_robot *robot;
	struct rnea_error e;

	rnea_open("", 0, &(struct rnea_options){.compile = options, .compile_count = 1}, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "option \"-DRNEA_BLOCK=64\" for the compiler: the block size is set by");
}
END_TEST

/* ---- a robot on the host ---- */

START_TEST(tells_about_the_host)
{
	char *text = read_text(TEST_DIR "/pendulum.c");
	struct rnea_options o = {.threads = 3, .block = 64};
	const struct rnea_build *b;
	struct rnea_robot *robot;
	struct rnea_resources r;
	struct rnea_error e;

	for (int i = 0; i < 2; i++) {
		ck_assert_msg(open_text(text, &o, &robot, &e) == RNEA_OK, "%s", e.message);
		b = rnea_build(robot);
		ck_assert_int_eq(b->cached, i);
		ck_assert_str_eq(b->target, "native");
		ck_assert_int_eq(*b->compiler == '\0', i);
		ck_assert(*b->device && b->threads >= 1 && b->threads <= 3 && b->min_blocks == 0);
		ck_assert_str_eq(rnea_info(robot)->joints[0].name, "swing of the rod");
		ck_assert_uint_eq(rnea_info(robot)->block, 128);
		ck_assert_int_eq(rnea_resources(robot, RNEA_KERNEL_RNEA, &r, &e), RNEA_OK);
		ck_assert(r.registers == 0 && r.max_block == 0 && r.local_bytes == 0);
		ck_assert_uint_eq(rnea_argument_count(robot, RNEA_KERNEL_RNEA), 4);
		assert_computes(robot);
	}
	free(text);
}
END_TEST

START_TEST(host_launches)
{
	char *text = read_text(TEST_DIR "/pendulum.c");
	struct rnea_robot *robot = open_on(text, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, "");
	float q = 0, qd = 0, qdd = 0, tau = 0;
	void *arrays[] = {&q, &qd, &qdd, &tau};
	struct rnea_error e;

	rnea_launch(robot, arrays, 1, &e, &e);
	assert_error(&e, RNEA_ARGUMENT, "pendulum_rnea_slice: a stream was given");
	ck_assert_int_eq(rnea_launch(robot, NULL, 0, NULL, &e), RNEA_OK);
	rnea_run(robot, NULL, 1, &e);
	assert_error(&e, RNEA_ARGUMENT, "pendulum_rnea_slice: there are no arrays");
	arrays[2] = (char *)&qdd + 1;
	rnea_run(robot, arrays, 1, &e);
	assert_error(&e, RNEA_POINTER, "pendulum_rnea_slice: array 2, \"qdd\", is not aligned");
	arrays[2] = NULL;
	rnea_launch(robot, arrays, 1, NULL, &e);
	assert_error(&e, RNEA_POINTER, "array 2, \"qdd\", is NULL");
	rnea_launch_kernel(robot, RNEA_KERNEL_FPASS, arrays, 1, NULL, &e);
	assert_error(&e, RNEA_KERNEL, "the text of \"pendulum\" has no kernel pendulum_fpass_slice");
	ck_assert_uint_eq(rnea_argument_count(robot, RNEA_KERNEL_BPASS), 3);
	rnea_close(robot);
	free(text);
}
END_TEST

Suite *suite_backend(void)
{
	Suite *s = suite_create("backend");
	TCase *t = tcase_create("backend");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, setup, teardown);
	tcase_add_test(t, second_opening_is_a_hit);
	tcase_add_test(t, another_text_is_a_miss);
	tcase_add_test(t, moved_texts_are_hits);
	tcase_add_loop_test(t, choices_are_kept, 0, 2);
	tcase_add_loop_test(t, refused_images, 0, 4);
	tcase_add_test(t, no_compiler_no_hit);
	tcase_add_test(t, allocation_failures);
	tcase_add_test(t, chooses_the_backend);
	tcase_add_loop_test(t, refuses, 0, (int)(sizeof refusals / sizeof *refusals));
	tcase_add_test(t, refuses_c_on_cuda);
	tcase_add_test(t, tells_both_failures);
	tcase_add_test(t, block_by_option);
	tcase_add_test(t, tells_about_the_host);
	tcase_add_test(t, host_launches);
	suite_add_tcase(s, t);
	return s;
}
