/* A robot that is open: what it tells, and its launches. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 1000, GUARD = 16 };

static struct rnea_robot *robot;
static float q[LIMIT], qd[LIMIT], qdd[LIMIT], tau[LIMIT + GUARD], v[6 * LIMIT], a[6 * LIMIT], f[6 * LIMIT];
static void *const arrays[] = {q, qd, qdd, tau};

static void setup(void)
{
	struct rnea_error e;

	use_fakes();
	ck_assert_msg(rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &robot, &e) == RNEA_OK, "%s", e.message);
	for (int k = 0; k < LIMIT; k++) {
		q[k] = 0.01f * (float)k - 3;
		qd[k] = 1 - 0.003f * (float)k;
		qdd[k] = 0.5f + 0.02f * (float)k;
	}
	memset(tau, 0xff, sizeof tau);
}

static void teardown(void)
{
	use_fakes();
	rnea_close(robot);
	ck_assert_int_eq(fake_live(), 0);
}

/* The torque of sample k, as it should be. */
static int is_right(float torque, size_t k)
{
	return fabsf(torque - (0.5f * qdd[k] + 9.81f * sinf(q[k]))) < 1e-5f;
}

static void assert_torques(size_t count)
{
	for (size_t k = 0; k < count; k++)
		ck_assert_msg(is_right(tau[k], k), "sample %zu of %zu is wrong", k, count);
	for (size_t k = count; k < count + GUARD; k++)
		ck_assert_msg(isnan(tau[k]), "sample %zu of %zu was written", k, count);
}

START_TEST(tells_about_itself)
{
	const struct rnea_info *info = rnea_info(robot);
	struct rnea_resources r;
	struct rnea_error e;

	ck_assert_str_eq(info->name, "pendulum");
	ck_assert_uint_eq(info->block, 128);
	ck_assert_str_eq(info->joints[0].name, "swing of the rod");
	ck_assert_int_eq(rnea_bind(robot, "q"), 0);
	ck_assert_int_eq(rnea_bind(robot, "qdd"), 2);
	ck_assert_int_eq(rnea_bind(robot, "tau"), 3);
	ck_assert_int_eq(rnea_bind(robot, "gravity"), -1);
	ck_assert_int_eq(rnea_bind(robot, NULL), -1);
	ck_assert_uint_eq(rnea_argument_count(robot, RNEA_KERNEL_RNEA), 4);
	ck_assert_uint_eq(rnea_argument_count(robot, RNEA_KERNEL_FPASS), 6);
	ck_assert_uint_eq(rnea_argument_count(robot, RNEA_KERNEL_BPASS), 3);
	ck_assert_uint_eq(rnea_argument_count(robot, "aba"), 0);
	ck_assert_uint_eq(rnea_argument_count(robot, NULL), 0);
	ck_assert_int_eq(rnea_resources(robot, RNEA_KERNEL_BPASS, &r, &e), RNEA_OK);
	ck_assert(r.registers == 42 && r.local_bytes == 0 && r.shared_bytes == 8 && r.max_block == 1024);
	ck_assert_uint_eq(r.busy_block, 256);
	ck_assert_int_eq(rnea_resources(robot, "aba", &r, &e), RNEA_KERNEL);
	assert_error(&e, RNEA_KERNEL, "the text of \"pendulum\" has no function \"aba\"; it has rnea, fpass, bpass");
}
END_TEST

START_TEST(computes)
{
	static const size_t counts[] = {1, 2, 127, 128, 129, 256, 1000 - GUARD};
	struct rnea_error e;

	ck_assert_msg(rnea_launch(robot, arrays, counts[_i], NULL, &e) == RNEA_OK, "%s", e.message);
	ck_assert(e.code == RNEA_OK && e.message[0] == '\0');
	assert_torques(counts[_i]);
}
END_TEST

/* By the names of before, too. */
START_TEST(passes_agree)
{
	void *const forward[] = {q, qd, qdd, v, a, f}, *const backward[] = {q, f, tau};

	ck_assert_int_eq(rnea_launch_kernel(robot, RNEA_KERNEL_FPASS, forward, 500, NULL, NULL), RNEA_OK);
	ck_assert_int_eq(rnea_launch_kernel(robot, "bpass", backward, 500, NULL, NULL), RNEA_OK);
	assert_torques(500);
}
END_TEST

START_TEST(nothing_to_do)
{
	struct rnea_error e;

	ck_assert_int_eq(rnea_launch(robot, NULL, 0, NULL, &e), RNEA_OK);
	setenv("RNEA_FAKE_CUDA_FAIL", "cuLaunchKernel=1", 1);
	ck_assert_int_eq(rnea_launch(robot, arrays, 0, NULL, &e), RNEA_OK);
	assert_torques(0);
}
END_TEST

START_TEST(bad_arguments)
{
	void *wrong[] = {q, qd, qdd, tau};
	struct rnea_error e;

	rnea_launch(robot, NULL, 1, NULL, &e);
	assert_error(&e, RNEA_ARGUMENT, "pendulum_rnea_kernel: there are no arrays");
	wrong[1] = NULL;
	rnea_launch(robot, wrong, 1, NULL, &e);
	assert_error(&e, RNEA_POINTER, "pendulum_rnea_kernel: array 1, \"qd\", is NULL");
	wrong[1] = (char *)qd + 2;
	rnea_launch(robot, wrong, 1, NULL, &e);
	assert_error(&e, RNEA_POINTER, "array 1, \"qd\", is not aligned to 4 bytes");
	ck_assert_int_eq(rnea_launch(robot, wrong, 1, NULL, NULL), RNEA_POINTER);
	wrong[1] = NULL;
	rnea_launch_kernel(robot, RNEA_KERNEL_BPASS, wrong, 1, NULL, &e);
	assert_error(&e, RNEA_POINTER, "pendulum_bpass_kernel: array 1, \"f\", is NULL");
	wrong[1] = qd;
	rnea_launch_kernel(robot, RNEA_KERNEL_FPASS, (void *[]){q, qd, qdd, v, NULL, f}, 1, NULL, &e);
	assert_error(&e, RNEA_POINTER, "pendulum_fpass_kernel: array 4, \"a\", is NULL");
	rnea_launch_kernel(robot, NULL, wrong, 1, NULL, &e); /* what a number of before, 0, becomes */
	assert_error(&e, RNEA_KERNEL, "no function is named (function is NULL): a name is wanted, such as \"rnea\"");
	assert_torques(0);
}
END_TEST

START_TEST(too_many_samples)
{
	struct rnea_error e;

	rnea_launch(robot, arrays, (size_t)INT_MAX * 128 + 1, NULL, &e);
	assert_error(&e, RNEA_LIMIT, "274877906817 samples are more than 2147483647 blocks of 128");
	rnea_launch(robot, arrays, SIZE_MAX, NULL, &e);
	assert_error(&e, RNEA_LIMIT, "18446744073709551615 samples");
	assert_torques(0);
}
END_TEST

START_TEST(driver_failures)
{
	static const struct {
		const char *fail, *message;
	} failures[] = {
		{"cuLaunchKernel=400", "cuLaunchKernel of pendulum_rnea_kernel: error 400, CUDA_ERROR_INVALID_HANDLE"},
		{"cuCtxGetCurrent=3", "cuCtxGetCurrent: error 3"},
		{"cuCtxPushCurrent_v2=3", "cuCtxPushCurrent: error 3"},
	};
	struct rnea_error e;

	for (size_t i = 0; i < sizeof failures / sizeof *failures; i++) {
		setenv("RNEA_FAKE_CUDA_FAIL", failures[i].fail, 1);
		rnea_launch(robot, arrays, 10, NULL, &e);
		assert_error(&e, RNEA_DRIVER, failures[i].message);
	}
	use_fakes();
	ck_assert_int_eq(rnea_launch(robot, arrays, 10, NULL, &e), RNEA_OK); /* and the next one works */
	assert_torques(10);
}
END_TEST

START_TEST(allocates_nothing)
{
	struct rnea_error e;

	fail_allocation(0); /* an allocation would show as RNEA_MEMORY, or as a crash */
	rnea_launch(robot, arrays, 100, NULL, &e);
	fail_allocation(-1);
	ck_assert_int_eq(e.code, RNEA_OK);
	assert_torques(100);
}
END_TEST

/* The launch of a capture runs with the graph, as often as that is replayed, and not before. */
START_TEST(captures)
{
	void *driver = dlopen(FAKE_CUDA, RTLD_NOW), *stream, *graph, *executable, *context = NULL;
	int (*push)(void *), (*pop)(void **), (*create)(void **, unsigned), (*begin)(void *, int),
		(*end)(void *, void **), (*instantiate)(void **, void *, unsigned long long), (*replay)(void *, void *),
		(*destroy)(void *), (*destroy_graph)(void *), (*retain)(void **, int), (*release)(int);
	struct {
		const char *name;
		void *slot;
	} table[] = {{"cuCtxPushCurrent_v2", &push}, {"cuCtxPopCurrent_v2", &pop}, {"cuStreamCreate", &create},
		{"cuStreamBeginCapture_v2", &begin}, {"cuStreamEndCapture", &end}, {"cuGraphLaunch", &replay},
		{"cuGraphInstantiateWithFlags", &instantiate}, {"cuStreamDestroy_v2", &destroy},
		{"cuGraphDestroy", &destroy_graph}, {"cuDevicePrimaryCtxRetain", &retain},
		{"cuDevicePrimaryCtxRelease_v2", &release}};

	for (size_t i = 0; i < sizeof table / sizeof *table; i++)
		ck_assert_ptr_nonnull(*(void **)table[i].slot = dlsym(driver, table[i].name));
	retain(&context, 0);
	push(context); /* as a program with the CUDA runtime has it: the context is current already */
	create(&stream, 0);
	begin(stream, 0);
	ck_assert_int_eq(rnea_launch(robot, arrays, 64, stream, NULL), RNEA_OK);
	end(stream, &graph);
	instantiate(&executable, graph, 0);
	assert_torques(0);
	for (int k = 0; k < 64; k++)
		qdd[k] += 1;
	replay(executable, stream);
	assert_torques(64);
	destroy_graph(graph);
	destroy_graph(executable);
	destroy(stream);
	pop(&context);
	release(0);
	dlclose(driver);
}
END_TEST

START_TEST(other_blocks)
{
	static const unsigned blocks[] = {1, 32, 33, 1024};
	struct rnea_robot *other;
	struct rnea_error e;

	ck_assert_msg(rnea_open_file(TEST_DIR "/runtime/pendulum.cu", &(struct rnea_options){.block = blocks[_i]}, &other,
			      &e) == RNEA_OK,
		"%s", e.message);
	ck_assert_uint_eq(rnea_info(other)->block, blocks[_i]);
	ck_assert_int_eq(rnea_launch(other, arrays, 500, NULL, &e), RNEA_OK);
	assert_torques(500);
	rnea_close(other);
}
END_TEST

/* Catches a pass that is asked for though the table does not name it, which the pretended driver does not survive; the
   table of the second, older text names none, and may be asked for all. */
START_TEST(text_without_passes)
{
	char *text = _i ? pendulum_with("\t\"kernels rnea fpass bpass\\n\"\n", "")
		: pendulum_with("kernels rnea fpass", "kernels rnea");
	struct rnea_robot *other;
	struct rnea_resources r;
	struct rnea_error e;

	memcpy(strstr(text, "pendulum_fpass_kernel"), "hidden_by_other_words", strlen("pendulum_fpass_kernel"));
	if (_i)
		setenv("RNEA_FAKE_CUDA_MAY_MISS", "1", 1);
	ck_assert_msg(open_text(text, NULL, &other, &e) == RNEA_OK, "%s", e.message);
	ck_assert_uint_eq(rnea_argument_count(other, RNEA_KERNEL_FPASS), 0);
	rnea_resources(other, RNEA_KERNEL_FPASS, &r, &e);
	assert_error(&e, RNEA_KERNEL, "the text of \"pendulum\" has no function \"fpass\"; it has rnea, bpass");
	rnea_launch_kernel(other, RNEA_KERNEL_FPASS, NULL, 0, NULL, &e);
	assert_error(&e, RNEA_KERNEL, "\"fpass\"");
	ck_assert_uint_eq(rnea_argument_count(other, RNEA_KERNEL_BPASS), 3);
	rnea_close(other);
	free(text);
}
END_TEST

START_TEST(alignment_by_array)
{
	char *text = pendulum_with("input qd 1 f32", "input qd 1 f64");
	void *wrong[] = {q + 1, (char *)((uintptr_t)(v + 2) & ~(uintptr_t)7) + 4, qdd, tau};
	struct rnea_robot *other;
	struct rnea_error e;

	ck_assert_int_eq(open_text(text, NULL, &other, &e), RNEA_OK);
	rnea_launch(other, wrong, 1, NULL, &e);
	assert_error(&e, RNEA_POINTER, "array 1, \"qd\", is not aligned to 8 bytes");
	rnea_close(other);
	free(text);
}
END_TEST

static void *open_and_launch(void *result)
{
	float *torque = result;
	struct rnea_robot *mine;
	void *const own[] = {q, qd, qdd, torque};

	if (rnea_open_file(TEST_DIR "/runtime/pendulum.cu", NULL, &mine, NULL) != RNEA_OK)
		return NULL;
	for (int i = 0; i < 50; i++)
		if (rnea_launch(mine, own, 10, NULL, NULL) != RNEA_OK ||
			rnea_launch(robot, own, 20, NULL, NULL) != RNEA_OK)
			return NULL;
	rnea_close(mine);
	return result;
}

START_TEST(several_threads)
{
	pthread_t threads[4];
	static float torques[4][20];
	void *result;

	for (int i = 0; i < 4; i++)
		ck_assert_int_eq(pthread_create(&threads[i], NULL, open_and_launch, torques[i]), 0);
	for (int i = 0; i < 4; i++) {
		pthread_join(threads[i], &result);
		ck_assert_ptr_eq(result, torques[i]);
		ck_assert(is_right(torques[i][19], 19));
	}
}
END_TEST

Suite *suite_launch(void)
{
	Suite *s = suite_create("launch");
	TCase *t = tcase_create("launch");

	tcase_set_timeout(t, 120);
	tcase_add_checked_fixture(t, setup, teardown);
	tcase_add_test(t, tells_about_itself);
	tcase_add_loop_test(t, computes, 0, 7);
	tcase_add_test(t, passes_agree);
	tcase_add_test(t, nothing_to_do);
	tcase_add_test(t, bad_arguments);
	tcase_add_test(t, too_many_samples);
	tcase_add_test(t, driver_failures);
	tcase_add_test(t, allocates_nothing);
	tcase_add_test(t, captures);
	tcase_add_loop_test(t, other_blocks, 0, 4);
	tcase_add_loop_test(t, text_without_passes, 0, 2);
	tcase_add_test(t, alignment_by_array);
	tcase_add_test(t, several_threads);
	suite_add_tcase(s, t);
	return s;
}
