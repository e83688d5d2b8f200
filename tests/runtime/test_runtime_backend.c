/* Which backend a text is opened on. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A text for both backends, as rneagen writes it for target cuda: the two pendulums in one. */
static char *both(void)
{
	char *cuda = pendulum(NULL), *c = read_text(TEST_DIR "/runtime/pendulum.c", NULL), *text;

	ck_assert_int_gt(asprintf(&text, "#if defined __CUDACC_RTC__\n%s\n#else\n%s\n#endif\n", cuda, c), 0);
	free(cuda);
	free(c);
	return text;
}

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
	char *c = read_text(TEST_DIR "/runtime/pendulum.c", NULL), *cuda = both();

	pendulum_computes(open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_CUDA, ""));
	pendulum_computes(open_on(cuda, RNEA_BACKEND_CUDA, RNEA_BACKEND_CUDA, ""));
	pendulum_computes(open_on(cuda, RNEA_BACKEND_HOST, RNEA_BACKEND_HOST, ""));
	pendulum_computes(open_on(c, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, ""));
	pendulum_computes(open_on(c, RNEA_BACKEND_HOST, RNEA_BACKEND_HOST, ""));
	setenv("RNEA_FAKE_CUDA_DEVICES", "0", 1);
	pendulum_computes(open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, "cuInit: error 100, CUDA_ERROR_NO_DEVICE"));
	setenv("RNEA_FAKE_CUDA_FAIL", "cuInit=34", 1); /* the library that lies beside the compiler for linking */
	pendulum_computes(open_on(cuda, RNEA_BACKEND_ANY, RNEA_BACKEND_HOST, "cuInit: error 34"));
	unsetenv("RNEA_FAKE_CUDA_FAIL");
	unsetenv("RNEA_LIBCUDA");
	if (system("ldconfig -p 2>/dev/null | grep -q libcuda.so.1") == 0 || access("/dev/nvidiactl", F_OK) == 0)
		puts("skipped: chooses_the_backend, without a driver: there is one");
	else
		pendulum_computes(
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
	char *text = read_text(TEST_DIR "/runtime/pendulum.c", NULL);
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
	char *text = read_text(TEST_DIR "/runtime/pendulum.c", NULL);
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
		ck_assert_int_eq(rnea_resources(robot, "rnea", &r, &e), RNEA_OK);
		ck_assert(r.registers == 0 && r.max_block == 0 && r.local_bytes == 0);
		ck_assert_uint_eq(rnea_argument_count(robot, "rnea"), 4);
		pendulum_computes(robot);
	}
	free(text);
}
END_TEST

START_TEST(host_launches)
{
	char *text = read_text(TEST_DIR "/runtime/pendulum.c", NULL);
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
	rnea_launch_kernel(robot, "fpass", arrays, 1, NULL, &e);
	assert_error(&e, RNEA_KERNEL, "the text of \"pendulum\" has no function \"fpass\"; it has rnea, bpass");
	ck_assert_uint_eq(rnea_argument_count(robot, "bpass"), 3);
	rnea_close(robot);
	free(text);
}
END_TEST

Suite *suite_backend(void)
{
	Suite *s = suite_create("backend");
	TCase *t = tcase_create("backend");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, use_folder, drop_folder);
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
