/* Which folder is chosen, made and used. */
#define _GNU_SOURCE
#include "test_runtime_cache.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static void set(const char *name, const char *value)
{
	if (value)
		setenv(name, value, 1);
	else
		unsetenv(name);
}

/* "~" stands for the sandbox. */
START_TEST(chooses)
{
	static const struct {
		const char *folder, *rnea, *xdg, *home, *chosen;
	} cases[] = {
		{"/f", "/r", "/x", "~", "/f"},
		{"", "/r", "/x", "~", ""},
		{NULL, "/r", "/x", "~", "/r"},
		{NULL, "", "/x", "~", ""},
		{NULL, NULL, "/x", "~", "/x/rnea"},
		{NULL, NULL, "/x", NULL, "/x/rnea"},
		{NULL, NULL, "", "~", "~/.cache/rnea"},
		{NULL, NULL, "x", "~", "~/.cache/rnea"},
		{NULL, NULL, "./x", NULL, ""},
		{NULL, NULL, NULL, "~", "~/.cache/rnea"},
		{NULL, NULL, NULL, NULL, ""},
		{NULL, NULL, NULL, "", ""},
		{NULL, NULL, NULL, ".", ""},
		{NULL, NULL, NULL, "~/missing", ""},
		{"f/g", "/r", NULL, NULL, "~/f/g"},
		{NULL, "r", NULL, NULL, "~/r"},
	};
	char want[512], *here;
	struct cache c;

	/* the sandbox by the name that getcwd gives it */
	ck_assert_int_eq(chdir(sandbox), 0);
	here = getcwd(NULL, 0);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const char *home = cases[i].home, *chosen = cases[i].chosen;
		char place[512];

		snprintf(place, sizeof place, "%s%s", here, home && *home ? home + 1 : "");
		set("RNEA_CACHE", cases[i].rnea);
		set("XDG_CACHE_HOME", cases[i].xdg);
		set("HOME", home && *home == '~' ? place : home);
		memset(&c, 'x', sizeof c);
		cache_open(&c, cases[i].folder);
		snprintf(want, sizeof want, "%s%s", *chosen == '~' ? here : "", *chosen == '~' ? chosen + 1 : chosen);
		ck_assert_msg(strcmp(c.folder, want) == 0, "case %zu: %s, not %s", i, c.folder, want);
	}
	free(here);
	ck_assert_int_eq(chdir("/"), 0);
}
END_TEST

/* The longest that fits, and one more. */
START_TEST(refuses_long_names)
{
	char name[sizeof((struct cache *)0)->folder + 1];
	struct cache c;

	memset(name, 'a', sizeof name);
	name[0] = '/';
	name[sizeof name - 2] = '\0';
	cache_open(&c, name);
	ck_assert_str_eq(c.folder, name);
	name[sizeof name - 2] = 'a';
	name[sizeof name - 1] = '\0';
	cache_open(&c, name);
	ck_assert_str_eq(c.folder, "");
	setenv("XDG_CACHE_HOME", name, 1);
	cache_open(&c, NULL);
	ck_assert_str_eq(c.folder, "");
	setenv("RNEA_CACHE", name + 1, 1); /* relative: longer with what is before it */
	cache_open(&c, NULL);
	ck_assert_str_eq(c.folder, "");
	ck_assert_int_eq(put_text(&c, "key", "image"), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
}
END_TEST

static unsigned mode_of(const char *path)
{
	struct stat s;

	ck_assert_msg(stat(path, &s) == 0, "%s: %s", path, strerror(errno));
	return s.st_mode & 07777;
}

START_TEST(makes_the_folder_private)
{
	struct cache c = cache_in("a/b/c");

	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	ck_assert_msg(access(inside("a"), F_OK) != 0, "a get made the folder");
	umask(0);
	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	ck_assert_uint_eq(mode_of(inside("a")), 0700);
	ck_assert_uint_eq(mode_of(inside("a/b")), 0700);
	ck_assert_uint_eq(mode_of(inside("a/b/c")), 0700);
	ck_assert_uint_eq(mode_of(entry_path(&c, "key", 3)), 0600);
	ck_assert_int_eq(get_is(&c, "key", "image"), 1);
	ck_assert_int_eq(count_files(c.folder, "", ""), 3); /* . and .. */
}
END_TEST

START_TEST(stays_where_it_was)
{
	struct cache c;

	ck_assert_int_eq(chdir(sandbox), 0);
	cache_open(&c, "here");
	ck_assert_int_eq(chdir("/"), 0);
	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	ck_assert_int_eq(access(inside("here"), F_OK), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 1);
}
END_TEST

START_TEST(does_not_make_a_home)
{
	struct cache c;

	setenv("HOME", inside("gone"), 1);
	cache_open(&c, NULL);
	ck_assert_int_eq(put_text(&c, "key", "image"), 0);
	ck_assert_int_ne(access(inside("gone"), F_OK), 0);
	ck_assert_int_eq(mkdir(inside("home"), 0755), 0);
	setenv("HOME", inside("home"), 1);
	cache_open(&c, NULL);
	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	ck_assert_int_eq(access(inside("home/.cache/rnea"), F_OK), 0);
}
END_TEST

/* What is put into a folder that is not ours alone would be run. */
START_TEST(refuses_what_others_can_write)
{
	static const mode_t modes[] = {0702, 0720, 0777, 01777, 0770};
	struct cache c = cache_in("c");

	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
		ck_assert_int_eq(chmod(c.folder, modes[i]), 0);
		ck_assert_msg(!get_is(&c, "key", "image"), "mode %o", (unsigned)modes[i]);
		ck_assert_int_eq(put_text(&c, "other", "image"), 0);
	}
	ck_assert_int_eq(chmod(c.folder, 0755), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 1);
	ck_assert_int_eq(get_is(&c, "other", "image"), 0);
	ck_assert_int_eq(put_text(&c, "other", "image"), 1);
}
END_TEST

START_TEST(refuses_another_users)
{
	struct cache c = cache_in("c"), link = cache_in("link");

	if (geteuid() != 0) {
		cache_open(&c, "/");
		ck_assert_int_eq(put_text(&c, "key", "image"), 0);
		puts("skipped: refuses_another_users: giving a folder away takes root");
		return;
	}
	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	ck_assert_int_eq(symlink("c", link.folder), 0);
	ck_assert_int_eq(get_is(&link, "key", "image"), 1);
	ck_assert_int_eq(chown(c.folder, 12345, 12345), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	ck_assert_int_eq(put_text(&c, "other", "image"), 0);
	ck_assert_int_eq(get_is(&link, "key", "image"), 0);
	ck_assert_int_eq(put_text(&link, "other", "image"), 0);
	ck_assert_int_eq(count_entries(c.folder), 1);
	/* nor a HOME that sudo left */
	ck_assert_int_eq(mkdir(inside("home"), 0755), 0);
	ck_assert_int_eq(chown(inside("home"), 12345, 12345), 0);
	setenv("HOME", inside("home"), 1);
	cache_open(&c, NULL);
	ck_assert_int_eq(put_text(&c, "key", "image"), 0);
	ck_assert_int_ne(access(inside("home/.cache"), F_OK), 0);
}
END_TEST

START_TEST(is_no_folder)
{
	struct cache file = cache_in("file"), below = cache_in("file/below"), link = cache_in("link");

	entry_write(file.folder, "text", 4);
	ck_assert_int_eq(symlink("nowhere/at/all", link.folder), 0);
	for (int i = 0; i < 3; i++) {
		const struct cache *c = i == 0 ? &file : i == 1 ? &below : &link;

		ck_assert_int_eq(get_is(c, "key", "image"), 0);
		ck_assert_int_eq(put_text(c, "key", "image"), 0);
	}
	ck_assert_int_ne(access(inside("nowhere"), F_OK), 0);
}
END_TEST

static int work_read_only(void *context)
{
	const struct cache *c = context;

	if (geteuid() == 0 && !become_nobody())
		return CANNOT;
	if (!put_text(c, "key", "image") || chmod(c->folder, 0500) != 0)
		return 2;
	if (put_text(c, "other", "image") || put_text(c, "key", "second"))
		return 3;
	if (get_text(c, "key", "image") != 1 || get_text(c, "other", "image") != 0)
		return 4;
	/* nor can it be made */
	if (chmod(sandbox, 0500) != 0 || put_text(&(struct cache){"/rnea-test-forbidden"}, "key", "image"))
		return 5;
	return count_temporaries(c->folder) == 0 && chmod(sandbox, 0700) == 0 && chmod(c->folder, 0700) == 0 ? 0 : 6;
}

START_TEST(folder_is_read_only)
{
	struct cache c = cache_in("c");
	int status = run_child(work_read_only, &c);

	if (status == CANNOT)
		puts("skipped: folder_is_read_only: root without the right to become another user");
	else
		ck_assert_int_eq(status, 0);
}
END_TEST

START_TEST(there_is_none)
{
	struct cache_why why = {"untouched"};
	struct cache c;

	cache_open(&c, "");
	ck_assert_int_eq(put_text(&c, "key", "image"), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	/* which is what was asked for */
	ck_assert_int_eq(cache_put(&c, "key", 3, "image", 5, &why), 0);
	ck_assert_str_eq(why.text, "");
}
END_TEST

static int says(const struct cache *c, const char *what)
{
	struct cache_why why = {"untouched"};
	char expected[sizeof why.text];

	snprintf(expected, sizeof expected, "%s: %s", c->folder, what);
	return cache_put(c, "key", 3, "image", 5, &why) == 0 && strcmp(why.text, expected) == 0;
}

static int work_says(void *context)
{
	struct cache c = *(struct cache *)context, below = cache_in("d/below/it");
	struct rlimit limit = {10, 10};

	if (geteuid() == 0 && !become_nobody())
		return CANNOT;
	if (!put_text(&c, "key", "first") || chmod(c.folder, 0500) != 0)
		return 2;
	if (!says(&c, "Permission denied") || !says(&below, "Permission denied") || chmod(c.folder, 0700) != 0)
		return 3;
	return setrlimit(RLIMIT_FSIZE, &limit) == 0 && says(&c, "File too large") ? 0 : 4;
}

/* Catches a folder that keeps nothing without a word. */
START_TEST(says_why_it_is_not_used)
{
	static const char private[] = "it is not this user's alone, and what lies there is run";
	struct cache file = cache_in("file"), below = cache_in("file/below"), c = cache_in("c");
	int status;

	entry_write(file.folder, "text", 4);
	ck_assert(says(&file, "Not a directory"));
	ck_assert(says(&below, "Not a directory"));
	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	ck_assert_int_eq(chmod(c.folder, 0770), 0);
	ck_assert(says(&c, private));
	ck_assert_int_eq(chmod(c.folder, 0700), 0);
	if (geteuid() == 0) {
		ck_assert_int_eq(chown(c.folder, 12345, 12345), 0);
		ck_assert(says(&c, private));
		ck_assert_int_eq(chown(c.folder, 0, 0), 0);
	}
	faults_clear();
	faults.fail_at[FAULT_WRITE] = 2;
	faults.error = ENOSPC;
	ck_assert(says(&c, "No space left on device"));
	faults_clear();
	ck_assert_int_eq(get_is(&c, "key", "image"), 1);
	c = cache_in("d");
	if ((status = run_child(work_says, &c)) == CANNOT)
		puts("skipped: says_why_it_is_not_used: root without the right to become another user");
	else
		ck_assert_int_eq(status, 0);
}
END_TEST

Suite *suite_cache_folder(void)
{
	Suite *s = suite_create("cache folder");
	TCase *t = tcase_create("cache folder");

	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_add_test(t, chooses);
	tcase_add_test(t, refuses_long_names);
	tcase_add_test(t, makes_the_folder_private);
	tcase_add_test(t, stays_where_it_was);
	tcase_add_test(t, does_not_make_a_home);
	tcase_add_test(t, refuses_what_others_can_write);
	tcase_add_test(t, refuses_another_users);
	tcase_add_test(t, is_no_folder);
	tcase_add_test(t, folder_is_read_only);
	tcase_add_test(t, there_is_none);
	tcase_add_test(t, says_why_it_is_not_used);
	suite_add_tcase(s, t);
	return s;
}
