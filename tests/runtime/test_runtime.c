/* The runtime library without a GPU: the pretended driver of fake_cuda.c and the pretended NVRTC of fake_nvrtc.c stand
   in, and the real NVRTC is used for compiling where there is one. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include <dlfcn.h>
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- allocations that fail; linked with --wrap ---- */

static long left = -1;
static int failed;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);

void fail_allocation(long n)
{
	left = n;
	failed = 0;
}

int allocation_failed(void)
{
	return failed;
}

static int may_allocate(void)
{
	if (left < 0)
		return 1;
	if (left == 0)
		failed = 1;
	else
		left--;
	return !failed;
}

void *__wrap_malloc(size_t size)
{
	return may_allocate() ? __real_malloc(size) : NULL;
}

void *__wrap_calloc(size_t count, size_t size)
{
	return may_allocate() ? __real_calloc(count, size) : NULL;
}

void *__wrap_realloc(void *block, size_t size)
{
	return may_allocate() ? __real_realloc(block, size) : NULL;
}

/* ---- shared ---- */

void use_fakes(void)
{
	unsetenv("RNEA_FAKE_CUDA_FAIL");
	unsetenv("RNEA_FAKE_NVRTC_FAIL");
	unsetenv("RNEA_FAKE_ARCHS");
	unsetenv("RNEA_FAKE_CUDA_DEVICES");
	unsetenv("RNEA_FAKE_CUDA_ARCH");
	unsetenv("RNEA_FAKE_CUDA_MAX_BLOCK");
	unsetenv("RNEA_FAKE_CUDA_LOCAL");
	unsetenv("RNEA_FAKE_CUDA_RESIDENT");
	unsetenv("RNEA_FAKE_CUDA_MAY_MISS");
	setenv("RNEA_CACHE", "", 1);
	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
}

void fake_function(const char *library, const char *name, void *slot)
{
	void *handle = dlopen(library, RTLD_NOW | RTLD_NODELETE), *function;

	ck_assert_ptr_nonnull(handle);
	function = dlsym(handle, name);
	ck_assert_msg(function != NULL, "%s", name);
	memcpy(slot, &function, sizeof function);
	dlclose(handle);
}

int fake_live(void)
{
	int (*live)(void);

	fake_function(FAKE_CUDA, "fake_cuda_live", &live);
	return live();
}

static char folder[64];

void use_folder(void)
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

void drop_folder(void)
{
	use_fakes();
	ck_assert_int_eq(fake_live(), 0);
	ck_assert_int_eq(nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS), 0);
}

char *read_text(const char *path, size_t *length)
{
	enum { ROOM = 1 << 23 };
	FILE *f = fopen(path, "rb");
	char *text = calloc(1, ROOM);
	size_t size;

	ck_assert_msg(f && text, "%s cannot be read", path);
	size = fread(text, 1, ROOM - 1, f);
	fclose(f);
	ck_assert(size > 0 && size < ROOM - 1);
	if (length)
		*length = size;
	return text;
}

char *pendulum(size_t *length)
{
	return read_text(TEST_DIR "/runtime/pendulum.cu", length);
}

char *pendulum_with(const char *from, const char *to)
{
	size_t length;
	char *text = pendulum(&length), *at = strstr(text, from);
	char *changed = calloc(1, length + strlen(to) + 1);

	ck_assert_msg(at != NULL, "\"%s\" is not in the text", from);
	memcpy(changed, text, (size_t)(at - text));
	strcat(changed, to);
	strcat(changed, at + strlen(from));
	free(text);
	return changed;
}

void pendulum_computes(struct rnea_robot *robot)
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

enum rnea_code open_text(
	const char *text, const struct rnea_options *o, struct rnea_robot **robot, struct rnea_error *e)
{
	return rnea_open(text, strlen(text), o, robot, e);
}

void assert_error(const struct rnea_error *e, enum rnea_code code, const char *part)
{
	ck_assert_msg(e->code == code, "code %d where %d is right: %s", (int)e->code, (int)code, e->message);
	ck_assert_msg(strstr(e->message, part) != NULL, "\"%s\" is not in \"%s\"", part, e->message);
	ck_assert_ptr_null(strchr(e->message, '\n'));
	ck_assert_str_ne(rnea_code_text(code), "unknown error");
}

int main(void)
{
	SRunner *r = srunner_create(suite_info());
	int bad;

	srunner_add_suite(r, suite_open());
	srunner_add_suite(r, suite_launch());
	srunner_add_suite(r, suite_run());
	srunner_add_suite(r, suite_threads());
	srunner_add_suite(r, suite_choose());
	srunner_add_suite(r, suite_backend());
	srunner_add_suite(r, suite_hits());
	srunner_add_suite(r, suite_jit());
	srunner_add_suite(r, suite_nvrtc());
	srunner_run_all(r, CK_ENV);
	bad = srunner_ntests_failed(r);
	srunner_free(r);
	return bad != 0;
}
