/* Several objects in one process, and the cache. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct host open_text(const char *from, const char *to)
{
	char *text = pendulum_with(from, to);
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	struct host h;

	ck_assert_msg(host_open(&h, &r, &e) == RNEA_OK, "%s", e.message);
	free(text);
	return h;
}

/* Robots of one name, equal and different ones, do not get into each other's way. */
static void several(void)
{
	struct host light = open_text("0.5f", "0.25f"), heavy = open_text("0.5f", "5.0f"),
		    twin = open_text("0.5f", "5.0f");

	assert_torques(&light, 0.25, 9.81);
	assert_torques(&heavy, 5, 9.81);
	assert_torques(&twin, 5, 9.81);
	ck_assert_ptr_ne(heavy.handle, twin.handle);
	ck_assert_ptr_ne(heavy.info, twin.info);
	host_close(&heavy);
	assert_torques(&light, 0.25, 9.81);
	assert_torques(&twin, 5, 9.81);
	heavy = open_text("9.81f", "1.62f");
	assert_torques(&heavy, 0.5, 1.62);
	assert_torques(&light, 0.25, 9.81);
	host_close(&light);
	host_close(&twin);
	assert_torques(&heavy, 0.5, 1.62);
	host_close(&heavy);
}

START_TEST(several_robots)
{
	several();
}
END_TEST

START_TEST(without_memfd)
{
	faults.no_memfd = ENOSYS;
	several();
}
END_TEST

START_TEST(other_text)
{
	struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .file = "text.c", .cache = ""};
	struct rnea_robot *robot;
	struct rnea_error e;
	char *text =
		pendulum_with("pendulum_rnea_slice(void *const *arrays, size_t count, size_t first, size_t end)\n{",
			"pendulum_other(void *const *arrays, size_t count, size_t first, size_t end)\n{");
	struct host_request r = pendulum_request(text);

	rnea_open(text, strlen(text), &o, &robot, &e);
	assert_error(&e, RNEA_TEXT, "text.c: compiled, but it has no pendulum_rnea_slice: write the text again");
	r.name = "other";
	e = fail_open(&r);
	assert_error(&e, RNEA_TEXT, "text.c: compiled, but it has no other_info");
	free(text);
}
END_TEST

/* Undefined functions are found missing when the text is opened, not when it runs. */
START_TEST(does_not_load)
{
	char *text = pendulum_with("sinf(", "rnea_no_such_function(");
	char *declared = calloc(1, strlen(text) + 100);
	struct host_request r = pendulum_request(declared);
	struct rnea_error e;

	strcat(strcpy(declared, "float rnea_no_such_function(float x);\n"), text);
	e = fail_open(&r);
	assert_error(&e, RNEA_COMPILER, "undefined symbol: rnea_no_such_function");
	faults.no_memfd = ENOSYS;
	e = fail_open(&r);
	assert_error(&e, RNEA_COMPILER, "undefined symbol: rnea_no_such_function");
	free(text);
	free(declared);
}
END_TEST

/* ---- the cache ---- */

/* How often the script was asked to compile; it passes everything on to cc. Another `comment` makes it another program, by
   its size, for the clock of a file system may not have moved on. */
static void use_counter(const char *comment)
{
	char script[200];

	snprintf(script, sizeof script, "case $* in *--version*) ;; *) echo >>\"${0%%/*}/count\" ;; esac\nexec cc \"$@\"\n%s",
		comment);
	use_script("counter", script);
}

static int compilations(void)
{
	int fd = open(inside("count"), O_RDONLY | O_CLOEXEC);
	char lines[1000];
	ssize_t n = fd < 0 ? 0 : read(fd, lines, sizeof lines);

	if (fd >= 0)
		close(fd);
	return (int)n;
}

START_TEST(cached)
{
	char *text = pendulum_with("", ""), *other = pendulum_with("0.5f", "0.25f");
	struct host h;

	use_counter("");
	h = open_cached(text);
	ck_assert_int_eq(h.cached, 0);
	ck_assert_ptr_nonnull(strstr(h.compiler, "counter)"));
	host_close(&h);
	h = open_cached(text);
	ck_assert_int_eq(h.cached, 1);
	ck_assert_str_eq(h.compiler, "");
	ck_assert_ptr_nonnull(host_find(&h, "pendulum", "bpass"));
	assert_torques(&h, 0.5, 9.81);
	host_close(&h);
	ck_assert_int_eq(compilations(), 1);
	h = open_cached(other);
	assert_torques(&h, 0.25, 9.81);
	host_close(&h);
	ck_assert_int_eq(compilations(), 2);
	use_counter("# written anew\n");
	h = open_cached(text);
	ck_assert_int_eq(h.cached, 0);
	host_close(&h);
	ck_assert_int_eq(compilations(), 3);
	free(text);
	free(other);
}
END_TEST

START_TEST(options_in_key)
{
	static const char *const lists[][2] = {{"-DA", "-DB"}, {"-DA-DB", ""}, {"-DA", ""}, {"-DB", "-DA"}};
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	struct cache c;
	struct host h;

	h = open_cached(text);
	host_close(&h);
	cache_open(&c, inside("cache"));
	r.cache = &c;
	for (int i = 0; i < 8; i++) {
		r.options = lists[i % 4];
		r.option_count = lists[i % 4][1][0] ? 2 : 1;
		ck_assert_int_eq(host_open(&h, &r, &e), RNEA_OK);
		ck_assert_int_eq(h.cached, i >= 4);
		host_close(&h);
	}
	free(text);
}
END_TEST

/* What lies in the cache and is of no use is made again. */
START_TEST(useless_entries)
{
	char *text = pendulum_with("", "");
	struct host h = open_cached(text);

	host_close(&h);
	for (faults.damage = 2; faults.damage; faults.damage--) {
		h = open_cached(text);
		ck_assert_int_eq(h.cached, 0);
		assert_torques(&h, 0.5, 9.81);
		host_close(&h);
	}
	h = open_cached(text);
	ck_assert_int_eq(h.cached, 1);
	host_close(&h);
	free(text);
}
END_TEST

static int worker(int i)
{
	struct rnea_error e = {0};
	char *text = pendulum_with("0.5f", i % 2 ? "0.25f" : "5.0f");
	struct host_request r = pendulum_request(text);
	struct cache c;
	struct host h;

	cache_open(&c, inside("cache"));
	r.cache = &c;
	for (int round = 0; round < 3; round++) {
		if (host_open(&h, &r, &e))
			return 1;
		assert_torques(&h, i % 2 ? 0.25 : 5, 9.81);
		if (round && !h.cached)
			return 2;
		host_close(&h);
	}
	free(text);
	return 0;
}

START_TEST(sixteen_processes)
{
	pid_t pids[16];
	int status;
	char *text = pendulum_with("", "");
	struct host h = open_cached(text);

	host_close(&h);
	for (int i = 0; i < 16; i++)
		if ((pids[i] = fork()) == 0)
			_exit(worker(i));
	for (int i = 0; i < 16; i++) {
		ck_assert_int_eq(waitpid(pids[i], &status, 0), pids[i]);
		ck_assert_int_eq(status, 0);
	}
	free(text);
}
END_TEST

/* Whatever cannot be had, an error or a robot that works comes of it, and nothing is left over. */
START_TEST(allocations)
{
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct rnea_error e;
	struct cache c;
	char log[100];
	struct host h;
	long k = -1;
	int failed;

	cache_open(&c, inside("cache"));
	r.cache = &c;
	r.log = log;
	r.log_size = sizeof log;
	do {
		e = (struct rnea_error){0};
		faults = (struct faults){.allocations = ++k, .damage = 1};
		host_open(&h, &r, &e);
		failed = faults.allocation_failed;
		faults.allocations = -1;
		if (!e.code)
			assert_torques(&h, 0.5, 9.81);
		else
			assert_error(&e, RNEA_MEMORY, "out of memory");
		host_close(&h);
	} while (failed);
	ck_assert_int_ge(k, 5);
	free(text);
}
END_TEST

Suite *suite_host_load(void)
{
	Suite *s = suite_create("host: load");
	TCase *t = tcase_create("host: load");

	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_set_timeout(t, 60);
	tcase_add_test(t, several_robots);
	tcase_add_test(t, without_memfd);
	tcase_add_test(t, other_text);
	tcase_add_test(t, does_not_load);
	tcase_add_test(t, cached);
	tcase_add_test(t, options_in_key);
	tcase_add_test(t, useless_entries);
	tcase_add_test(t, sixteen_processes);
	tcase_add_test(t, allocations);
	suite_add_tcase(s, t);
	return s;
}
