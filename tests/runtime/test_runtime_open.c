/* rnea_open and all that can go wrong in it. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Open, which must fail, and leave nothing behind. */
static struct rnea_error fail_open(const char *text, const struct rnea_options *o)
{
	struct rnea_robot *robot = (struct rnea_robot *)&robot;
	struct rnea_error e;

	ck_assert_int_ne(open_text(text, o, &robot, &e), RNEA_OK);
	ck_assert_ptr_null(robot);
	return e;
}

/* The same with the pendulum's own text. */
static struct rnea_error fail_pendulum(const struct rnea_options *o)
{
	size_t length;
	char *text = pendulum(&length);
	struct rnea_error e = fail_open(text, o);

	free(text);
	return e;
}

START_TEST(code_texts)
{
	for (int i = 0; i < RNEA_ERROR_COUNT; i++)
		ck_assert_str_ne(rnea_code_text((enum rnea_code)i), "unknown error");
	ck_assert_str_eq(rnea_code_text(RNEA_ERROR_COUNT), "unknown error");
}
END_TEST

START_TEST(arguments)
{
	struct rnea_robot *robot;
	struct rnea_error e;
	const char *const none[] = {"-DX", NULL};

	rnea_open("", 0, NULL, NULL, &e);
	assert_error(&e, RNEA_ARGUMENT, "robot is NULL");
	rnea_open(NULL, 0, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "source is NULL");
	rnea_open_file(NULL, NULL, &robot, &e);
	assert_error(&e, RNEA_ARGUMENT, "path is NULL");
	e = fail_open("", &(struct rnea_options){.block = 1025});
	assert_error(&e, RNEA_ARGUMENT, "a block of 1025 threads");
	e = fail_open("", &(struct rnea_options){.compile_count = 1});
	assert_error(&e, RNEA_ARGUMENT, "option 0 for the compiler is NULL");
	e = fail_open("", &(struct rnea_options){.compile = none, .compile_count = 2});
	assert_error(&e, RNEA_ARGUMENT, "option 1 for the compiler is NULL");
	ck_assert_int_eq(rnea_open(NULL, 0, NULL, &robot, NULL), RNEA_ARGUMENT); /* no struct wanted */
	rnea_close(NULL);
}
END_TEST

START_TEST(not_a_text)
{
	static const char nul[] = "RNEA_INFO const char a_info[] =\n\0";
	struct rnea_robot *robot;
	struct rnea_error e = fail_open("int main(void) { return 0; }\n", NULL);
	char name[400] = "RNEA_INFO const char ";

	assert_error(&e, RNEA_TEXT,
		"<memory>: not a text of rneagen for target cuda or c: no line starts with \"RNEA_INFO const char");
	e = fail_open("", &(struct rnea_options){.file = "empty.cu"});
	assert_error(&e, RNEA_TEXT, "empty.cu: not a text of rneagen");
	e = fail_open("  RNEA_INFO const char a_info[] =", NULL);
	assert_error(&e, RNEA_TEXT, "no line starts with");
	e = fail_open("RNEA_INFO const char _info[] =", NULL);
	assert_error(&e, RNEA_TEXT, "no identifier that ends in _info");
	e = fail_open("\nRNEA_INFO const char a-b_info[] =", NULL);
	assert_error(&e, RNEA_TEXT, "no identifier that ends in _info");
	memset(name + strlen(name), 'x', 256);
	strcat(name, "_info[] =");
	e = fail_open(name, NULL);
	assert_error(&e, RNEA_TEXT, "more than 255 characters");
	rnea_open(nul, sizeof nul - 1, NULL, &robot, &e);
	assert_error(&e, RNEA_TEXT, "byte 32 is a NUL");
}
END_TEST

START_TEST(files)
{
	struct rnea_robot *robot;
	struct rnea_error e;

	rnea_open_file("/nowhere/at/all.cu", NULL, &robot, &e);
	assert_error(&e, RNEA_READ, "/nowhere/at/all.cu: No such file");
	rnea_open_file("/tmp", NULL, &robot, &e);
	assert_error(&e, RNEA_READ, "/tmp: Is a directory");
	rnea_open_file("/dev/null", NULL, &robot, &e);
	assert_error(&e, RNEA_TEXT, "/dev/null: not a text of rneagen");
	use_fakes();
	ck_assert_msg(rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e) == RNEA_OK, "%s", e.message);
	rnea_close(robot);
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

START_TEST(no_driver)
{
	struct rnea_error e;

	use_fakes();
	setenv("RNEA_LIBCUDA", "/nowhere/libcuda.so.1", 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_NO_DRIVER, "no CUDA driver; tried /nowhere/libcuda.so.1 (from RNEA_LIBCUDA)");
	setenv("RNEA_LIBCUDA", TEST_DIR "/runtime/pendulum.cu", 1); /* there, and no library: the reason is told */
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_NO_DRIVER, "pendulum.cu (");
	setenv("RNEA_LIBCUDA", FAKE_NVRTC, 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_NO_DRIVER, "it has no function cu");
}
END_TEST

/* Without an override, on a machine without a driver, every place is named. */
START_TEST(no_driver_anywhere)
{
	struct rnea_error e;

	use_fakes();
	unsetenv("RNEA_LIBCUDA");
	if (system("ldconfig -p 2>/dev/null | grep -q libcuda.so.1") == 0 || access("/dev/nvidiactl", F_OK) == 0) {
		puts("skipped: no_driver_anywhere: there is a driver");
		return;
	}
	e = fail_pendulum(&(struct rnea_options){.backend = RNEA_BACKEND_CUDA});
	assert_error(&e, RNEA_NO_DRIVER,
		"tried libcuda.so.1; /usr/lib/wsl/lib/libcuda.so.1; "
		"/usr/local/nvidia/lib64/libcuda.so.1 (RNEA_LIBCUDA names another)");
}
END_TEST

START_TEST(no_device)
{
	struct rnea_error e;

	use_fakes();
	e = fail_pendulum(&(struct rnea_options){.device = 1});
	assert_error(&e, RNEA_NO_DEVICE, "no CUDA device 1: the driver (" FAKE_CUDA ") shows 1");
	e = fail_pendulum(&(struct rnea_options){.device = -1});
	assert_error(&e, RNEA_NO_DEVICE, "no CUDA device -1");
	setenv("RNEA_FAKE_CUDA_DEVICES", "0", 1);
	e = fail_pendulum(&(struct rnea_options){.backend = RNEA_BACKEND_CUDA});
	assert_error(&e, RNEA_NO_DEVICE, "cuInit: error 100, CUDA_ERROR_NO_DEVICE: no CUDA-capable device is detected");
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

static const struct failure {
	const char *fail, *message;
	enum rnea_code code;
} failures[] = {
	{"cuInit=999", "cuInit: error 999, unnamed: no description", RNEA_DRIVER},
	{"cuInit=34", "cuInit: error 34", RNEA_NO_DRIVER},
	{"cuDriverGetVersion=1", "cuDriverGetVersion", RNEA_DRIVER},
	{"cuDeviceGetCount=3", "cuDeviceGetCount", RNEA_DRIVER},
	{"cuDeviceGet=101", "cuDeviceGet:", RNEA_NO_DEVICE},
	{"cuDeviceGetName=1", "cuDeviceGetName", RNEA_DRIVER},
	{"cuDeviceGetAttribute=1", "cuDeviceGetAttribute", RNEA_DRIVER},
	{"cuDevicePrimaryCtxRetain=2", "cuDevicePrimaryCtxRetain: error 2, CUDA_ERROR_OUT_OF_MEMORY",
		RNEA_DEVICE_MEMORY},
	{"cuCtxGetCurrent=3", "cuCtxGetCurrent", RNEA_DRIVER},
	{"cuCtxPushCurrent_v2=201", "close this robot and open it again", RNEA_CONTEXT},
	{"cuModuleLoadDataEx=218", "cuModuleLoadDataEx of pendulum: error 218", RNEA_DRIVER},
	{"cuModuleLoadDataEx=2", "cuModuleLoadDataEx", RNEA_DEVICE_MEMORY},
	{"cuModuleGetGlobal_v2=1", "cuModuleGetGlobal", RNEA_DRIVER},
	{"cuModuleGetGlobal_v2=500", "no device variable pendulum_info", RNEA_TEXT},
	{"cuMemcpyDtoH_v2=700", "cuMemcpyDtoH: error 700", RNEA_CONTEXT},
	{"cuModuleGetFunction=209", "cuModuleGetFunction", RNEA_DRIVER},
	{"cuFuncLoad=2", "cuFuncLoad", RNEA_DEVICE_MEMORY},
	{"cuFuncGetAttribute=1", "cuFuncGetAttribute", RNEA_DRIVER},
	{"cuStreamCreate=2", "cuStreamCreate", RNEA_DEVICE_MEMORY},
	{"cuLaunchKernel=701", "cuLaunchKernel of pendulum_rnea_kernel: error 701", RNEA_DRIVER},
	{"cuStreamSynchronize=700", "cuStreamSynchronize: error 700", RNEA_CONTEXT},
	{"cuStreamDestroy_v2=1", "cuStreamDestroy", RNEA_DRIVER},
};

START_TEST(driver_failures)
{
	struct rnea_error e;

	use_fakes();
	setenv("RNEA_FAKE_CUDA_FAIL", failures[_i].fail, 1);
	e = fail_pendulum(&(struct rnea_options){.backend = RNEA_BACKEND_CUDA});
	unsetenv("RNEA_FAKE_CUDA_FAIL");
	assert_error(&e, failures[_i].code, failures[_i].message);
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

START_TEST(compiler_failures)
{
	const char *const unknown[] = {"--nonsense"};
	struct rnea_error e;

	use_fakes();
	setenv("RNEA_FAKE_NVRTC_FAIL", "1", 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_MEMORY, "out of memory");
	setenv("RNEA_FAKE_NVRTC_FAIL", "7", 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_COMPILER, "NVRTC 0.1 (" FAKE_NVRTC "): pendulum.cu: NVRTC_ERROR_FAKE");
	unsetenv("RNEA_FAKE_NVRTC_FAIL");
	e = fail_pendulum(&(struct rnea_options){.compile = unknown, .compile_count = 1});
	assert_error(&e, RNEA_COMPILER, "unrecognized option --nonsense");
	setenv("RNEA_FAKE_CUDA_ARCH", "70", 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_COMPILER, "compiles for sm_75 and later, the device is sm_70");
	setenv("RNEA_NVRTC", FAKE_CUDA, 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_COMPILER, "it has no function nvrtc");
	setenv("RNEA_NVRTC", "/nowhere/libnvrtc.so", 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_NO_COMPILER, "tried /nowhere/libnvrtc.so (from RNEA_NVRTC)");
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

START_TEST(falls_back_to_ptx)
{
	struct rnea_robot *robot;
	struct rnea_error e;

	use_fakes();
	/* the compiler knows 90: it makes PTX, which it hands out only if asked for it */
	setenv("RNEA_FAKE_CUDA_ARCH", "120", 1);
	ck_assert_msg(rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e) == RNEA_OK, "%s", e.message);
	rnea_close(robot);
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

static const struct wrong {
	const char *from, *to;
	enum rnea_code code;
	const char *message;
} wrongs[] = {
	{"fmaf(0.5f", "fmaf(0.5f +* x", RNEA_COMPILE, "pendulum.cu:42:"},
	{"name pendulum", "name arm", RNEA_TABLE, "pendulum_info calls the robot \"arm\""},
	{"nq 1\\n", "nq one\\n", RNEA_TABLE, "line 7: not a number: \"one\""},
	{"pendulum_rnea_kernel", "other_rnea_kernel", RNEA_TEXT, "defines no kernel pendulum_rnea_kernel"},
	{"pendulum_bpass_kernel", "other_bpass_kernel", RNEA_TEXT,
		"defines no kernel pendulum_bpass_kernel, which pendulum_info names"},
	{"_info[] =\n", "_info[] =\n;static const char hidden[] =\n", RNEA_COMPILE, "pendulum.cu:15:"},
};

START_TEST(wrong_texts)
{
	const struct wrong *w = &wrongs[_i];
	char *text = pendulum_with(w->from, w->to), log[4096] = "untouched";
	struct rnea_error e;

	use_fakes();
	setenv("RNEA_FAKE_CUDA_MAY_MISS", "1", 1);
	e = fail_open(text, &(struct rnea_options){.log = log, .log_size = sizeof log});
	assert_error(&e, w->code, w->message);
	if (w->code == RNEA_COMPILE)
		ck_assert_ptr_nonnull(strstr(log, "error"));
	else
		ck_assert_str_eq(log, "");
	ck_assert_int_eq(fake_live(), 0);
	free(text);
}
END_TEST

START_TEST(block_beyond_the_kernel)
{
	struct rnea_error e;

	use_fakes();
	setenv("RNEA_FAKE_CUDA_MAX_BLOCK", "96", 1);
	e = fail_pendulum(NULL);
	assert_error(&e, RNEA_ARGUMENT,
		"pendulum_rnea_kernel cannot run in blocks of 128 threads: its 42 registers allow 96");
	ck_assert_int_eq(fake_live(), 0);
}
END_TEST

/* Whatever allocation is the first to fail, open says so and leaves nothing behind. */
START_TEST(allocation_failures)
{
	struct rnea_error e = {0};
	struct rnea_robot *robot;
	long n = 0;

	use_fakes();
	for (;; n++) {
		fail_allocation(n);
		rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e);
		if (!allocation_failed())
			break;
		fail_allocation(-1);
		assert_error(&e, RNEA_MEMORY, "out of memory");
		ck_assert_ptr_null(robot);
		ck_assert_int_eq(fake_live(), 0);
	}
	fail_allocation(-1);
	ck_assert_int_eq(e.code, RNEA_OK);
	ck_assert_int_gt(n, 5);
	rnea_close(robot);
}
END_TEST

Suite *suite_open(void)
{
	Suite *s = suite_create("open");
	TCase *t = tcase_create("open");

	tcase_set_timeout(t, 120);
	tcase_add_test(t, code_texts);
	tcase_add_test(t, arguments);
	tcase_add_test(t, not_a_text);
	tcase_add_test(t, files);
	tcase_add_test(t, no_driver);
	tcase_add_test(t, no_driver_anywhere);
	tcase_add_test(t, no_device);
	tcase_add_loop_test(t, driver_failures, 0, (int)(sizeof failures / sizeof *failures));
	tcase_add_test(t, compiler_failures);
	tcase_add_test(t, falls_back_to_ptx);
	tcase_add_loop_test(t, wrong_texts, 0, (int)(sizeof wrongs / sizeof *wrongs));
	tcase_add_test(t, block_beyond_the_kernel);
	tcase_add_test(t, allocation_failures);
	suite_add_tcase(s, t);
	return s;
}
