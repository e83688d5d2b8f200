/* Names that a shell, a compiler's command line, a C text or a format would make something else of; and PATH, where there
   is none or it leads nowhere. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Each would leave a file "touched" in the working directory. */
static const char *const names[] = {"$(touch touched)", "`touch touched`", "; touch touched;", "a b\tc", "-otouched",
	"-Wl,-o,touched", "@touched", "quote\"and'quote", "back\\slash\\", "%s%n%d", "*/ int x; /*", "two\nlines",
	"\xff\xfe not UTF-8", "|touch touched", "&& touch touched", "*", "~", "?\?/", "a:b", "#hash", "$HOME"};

/* The same for one file or folder. */
static const char *leaf(int i)
{
	static char name[100];

	snprintf(name, sizeof name, "%s", names[i]);
	for (char *s = name; *s; s++)
		if (*s == '/')
			*s = '_';
	return name;
}

/* A folder for the working directory, so that what is touched is seen. */
static void enter(void)
{
	sandbox_make();
	ck_assert_int_eq(mkdir(inside("here"), 0700), 0);
	ck_assert_int_eq(chdir(inside("here")), 0);
}

static void leave(void)
{
	ck_assert_int_eq(count_entries(".", ""), 0);
	ck_assert_int_eq(chdir("/"), 0);
	sandbox_remove();
}

/* The message, in which control characters are spaces, calls the text by its name. */
static void assert_named(const char *file, const struct rnea_error *e)
{
	char wanted[400];

	snprintf(wanted, sizeof wanted, "%.300s:2:2: error: #error", file);
	for (char *s = wanted; *s; s++)
		if ((unsigned char)*s < 0x20)
			*s = ' ';
	assert_error(e, RNEA_COMPILE, wanted);
}

START_TEST(files)
{
	struct host_request r = pendulum_request("\n#error no\n");
	struct rnea_error e;
	char log[9000], name[5000];

	r.log = log;
	r.log_size = sizeof log;
	r.file = names[_i];
	e = fail_open(&r);
	assert_named(names[_i], &e);
	ck_assert_ptr_nonnull(strstr(log, names[_i]));
	memset(name, 'n', sizeof name);
	name[sizeof name - 1] = '\0';
	r.file = name;
	e = fail_open(&r);
	assert_named(name + sizeof name - 301, &e); /* its end */
	ck_assert_ptr_nonnull(strstr(log, name));
}
END_TEST

START_TEST(folders)
{
	struct host h;
	char path[1024];

	snprintf(path, sizeof path, "%s/%s", inside("tmp"), leaf(_i));
	ck_assert_int_eq(mkdir(path, 0700), 0);
	setenv("TMPDIR", path, 1);
	h = open_pendulum();
	assert_torques(&h, 0.5, 9.81);
	host_close(&h);
	ck_assert_int_eq(count_entries(path, ""), 0);
	ck_assert_int_eq(rmdir(path), 0); /* and nothing beside it: sandbox_remove looks */
}
END_TEST

START_TEST(compilers)
{
	struct host h;

	use_script(leaf(_i), "PATH=/usr/bin:/bin exec cc \"$@\"\n");
	h = open_pendulum();
	assert_torques(&h, 0.5, 9.81);
	ck_assert_ptr_nonnull(strstr(h.compiler, leaf(_i)));
	host_close(&h);
	setenv("RNEA_CC", leaf(_i), 1);
	setenv("PATH", sandbox, 1);
	h = open_pendulum();
	assert_torques(&h, 0.5, 9.81);
	host_close(&h);
}
END_TEST

START_TEST(caches)
{
	char *text = pendulum_with("", ""), path[1024];
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	struct cache c;
	struct host h;

	snprintf(path, sizeof path, "%s/%s", sandbox, leaf(_i));
	mkdir(path, 0700);
	cache_open(&c, path);
	r.cache = &c;
	for (int i = 0; i < 2; i++) {
		ck_assert_msg(host_open(&h, &r, &e) == RNEA_OK, "%s", e.message);
		ck_assert_int_eq(h.cached, i);
		host_close(&h);
	}
	free(text);
}
END_TEST

/* An option is one argument, whatever is in it. */
START_TEST(options)
{
	char *text = pendulum_with("0.5f", "TEXT[0] ? 0.25f : 0.5f"), define[400] = "-DTEXT=\"";
	struct host_request r = pendulum_request(text);
	const char *const list[] = {define};
	struct rnea_error e = {0};
	struct host h;

	for (const char *s = names[_i]; *s; s++)
		sprintf(define + strlen(define), *s == '\n' ? "\\n" : strchr("\"\\?", *s) ? "\\%c" : "%c", *s);
	strcat(define, "\"");
	r.options = list;
	r.option_count = 1;
	ck_assert_msg(host_open(&h, &r, &e) == RNEA_OK, "%s", e.message);
	assert_torques(&h, 0.25, 9.81);
	host_close(&h);
	free(text);
}
END_TEST

/* Catches a compiler that is found without PATH, and then does not find its linker: it is given the system's own. */
START_TEST(without_path)
{
	char standard[256], part[300];
	struct rnea_error e = {0};
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct host h;

	ck_assert_uint_le(confstr(_CS_PATH, standard, sizeof standard), sizeof standard);
	unsetenv("PATH");
	snprintf(part, sizeof part, "x: error: %s", standard);
	assert_script_fails("echo \"x: error: $PATH\"\nexit 1\n", RNEA_COMPILE, part);
	unsetenv("RNEA_CC");
	if (host_open(&h, &r, &e)) {
		snprintf(part, sizeof part, "tried cc, gcc, clang in PATH (%s)", standard);
		assert_error(&e, RNEA_NO_COMPILER, part);
		printf("skipped: without_path: no compiler in %s\n", standard);
	} else {
		assert_torques(&h, 0.5, 9.81);
		host_close(&h);
	}
	free(text);
}
END_TEST

/* What gcc and clang say where PATH leads nowhere; then it says where it led. */
START_TEST(without_parts)
{
	setenv("PATH", "/nowhere", 1);
	assert_script_fails("echo \"cc: fatal error: cannot execute 'as': execvp: No such file or directory\"\nexit 1\n",
		RNEA_COMPILER, "cannot execute 'as': execvp: No such file or directory; it looks in PATH (/nowhere)");
	assert_script_fails("echo \"collect2: fatal error: cannot find 'ld'\"\nexit 1\n", RNEA_COMPILER,
		"cannot find 'ld'; it looks in PATH (/nowhere)");
	assert_script_fails("echo 'clang: error: unable to execute command: Executable \"ld\" does not exist!'\nexit 1\n",
		RNEA_COMPILER, "does not exist!; it looks in PATH (/nowhere)");
}
END_TEST

Suite *suite_host_names(void)
{
	enum { COUNT = sizeof names / sizeof *names };
	Suite *s = suite_create("host: names");
	TCase *t = tcase_create("host: names");

	tcase_add_checked_fixture(t, enter, leave);
	tcase_set_timeout(t, 60);
	tcase_add_loop_test(t, files, 0, COUNT);
	tcase_add_loop_test(t, folders, 0, COUNT);
	tcase_add_loop_test(t, compilers, 0, COUNT);
	tcase_add_loop_test(t, caches, 0, COUNT);
	tcase_add_loop_test(t, options, 0, COUNT);
	tcase_add_test(t, without_path);
	tcase_add_test(t, without_parts);
	suite_add_tcase(s, t);
	return s;
}
