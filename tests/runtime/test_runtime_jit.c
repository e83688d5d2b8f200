/* jit_compile with the real NVRTC, which needs no GPU. Without one, each test says that it is skipped. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include "cuda/compile/jit.h"
#include <elf.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SM = 90 };

static enum rnea_code compile(const char *text, int arch, struct jit_image *image, struct rnea_error *e)
{
	struct jit_request r = {.source = text, .file = "pendulum.cu", .arch = arch};

	unsetenv("RNEA_NVRTC");
	*e = (struct rnea_error){0};
	return jit_compile(&r, image, e);
}

static int skipped(const char *test, const struct rnea_error *e)
{
	if (e->code != RNEA_NO_COMPILER)
		return 0;
	assert_error(e, RNEA_NO_COMPILER, "libnvrtc.so.12");
	printf("skipped: %s: %s\n", test, e->message);
	return 1;
}

START_TEST(makes_a_cubin)
{
	char *text = pendulum(NULL);
	struct jit_image image;
	struct rnea_error e;

	compile(text, SM, &image, &e);
	free(text);
	if (skipped("makes_a_cubin", &e))
		return;
	ck_assert_msg(e.code == RNEA_OK, "%s", e.message);
	ck_assert(!image.is_ptx && image.size > sizeof(Elf64_Ehdr));
	ck_assert_int_eq(((const Elf64_Ehdr *)(const void *)image.data)->e_machine, EM_CUDA);
	/* the table and the kernels are in it under their plain names */
	ck_assert_ptr_nonnull(memmem(image.data, image.size, "rneagen-info 1\nname pendulum\n", 29));
	ck_assert_ptr_nonnull(memmem(image.data, image.size, "\0pendulum_info", 15));
	ck_assert_ptr_nonnull(memmem(image.data, image.size, ".text.pendulum_rnea_kernel", 27));
	ck_assert_ptr_nonnull(memmem(image.data, image.size, ".text.pendulum_bpass_kernel", 28));
	jit_free(&image);
}
END_TEST

START_TEST(makes_ptx_for_the_unknown)
{
	char *text = pendulum(NULL);
	struct jit_image image;
	struct rnea_error e;

	compile(text, SM + 2, &image, &e);
	free(text);
	if (skipped("makes_ptx_for_the_unknown", &e))
		return;
	ck_assert_msg(e.code == RNEA_OK, "%s", e.message);
	ck_assert(image.is_ptx);
	ck_assert_ptr_nonnull(strstr(image.data, ".target sm_90"));
	ck_assert_ptr_nonnull(strstr(image.data, ".entry pendulum_rnea_kernel"));
	jit_free(&image);
}
END_TEST

START_TEST(refuses_an_old_device)
{
	char *text = pendulum(NULL);
	struct jit_image image;
	struct rnea_error e;

	compile(text, 20, &image, &e);
	free(text);
	if (skipped("refuses_an_old_device", &e))
		return;
	assert_error(&e, RNEA_COMPILER, "the device is sm_20; RNEA_NVRTC may name an older one");
	ck_assert_ptr_null(image.data);
}
END_TEST

START_TEST(names_the_line)
{
	char *text = pendulum_with("fmaf(0.5f, qdd[k]", "fmaf(0.5f, qddd[k]");
	struct jit_image image;
	struct rnea_error e;

	compile(text, SM, &image, &e);
	free(text);
	if (skipped("names_the_line", &e))
		return;
	assert_error(&e, RNEA_COMPILE,
		"pendulum.cu(42): error: identifier \"qddd\" is undefined: tau[k] = fmaf(0.5f, qddd[k]");
	ck_assert_ptr_null(image.data);
}
END_TEST

START_TEST(passes_options_on)
{
	const char *const options[] = {"-DRNEA_BLOCK=64", "--nonsense=1"};
	char *text = pendulum(NULL), log[2048];
	struct jit_request r = {.source = text,
		.file = "p.cu",
		.arch = SM,
		.options = options,
		.option_count = 1,
		.log = log,
		.log_size = sizeof log};
	struct jit_image image;
	struct rnea_error e = {0};

	unsetenv("RNEA_NVRTC");
	jit_compile(&r, &image, &e);
	if (!skipped("passes_options_on", &e)) {
		ck_assert_msg(e.code == RNEA_OK, "%s", e.message);
		jit_free(&image);
		r.option_count = 2;
		jit_compile(&r, &image, &e);
		assert_error(&e, RNEA_COMPILER, "nonsense");
		ck_assert_ptr_nonnull(strstr(log, "nonsense"));
	}
	free(text);
}
END_TEST

/* Every text that is committed compiles. */
START_TEST(compiles_what_is_committed)
{
	struct jit_image image;
	struct rnea_error e;
	glob_t found;
	char *text;

	if (glob(TEST_DIR "/../generated/*.cu", 0, NULL, &found) != 0) {
		puts("skipped: compiles_what_is_committed: no generated/*.cu");
		return;
	}
	for (size_t i = 0; i < found.gl_pathc; i++) {
		text = read_text(found.gl_pathv[i], NULL);
		compile(text, SM, &image, &e);
		free(text);
		if (skipped("compiles_what_is_committed", &e))
			break;
		ck_assert_msg(e.code == RNEA_OK, "%s: %s", found.gl_pathv[i], e.message);
		ck_assert(!image.is_ptx);
		jit_free(&image);
	}
	globfree(&found);
}
END_TEST

Suite *suite_jit(void)
{
	Suite *s = suite_create("jit");
	TCase *t = tcase_create("jit");

	tcase_set_timeout(t, 600);
	tcase_add_test(t, makes_a_cubin);
	tcase_add_test(t, makes_ptx_for_the_unknown);
	tcase_add_test(t, refuses_an_old_device);
	tcase_add_test(t, names_the_line);
	tcase_add_test(t, passes_options_on);
	tcase_add_test(t, compiles_what_is_committed);
	suite_add_tcase(s, t);
	return s;
}
