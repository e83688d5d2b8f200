/* Calls that fail, one after the other; files that may not grow; a disk that is full; what stands in an entry's place. */
#define _GNU_SOURCE
#include "test_runtime_cache.h"
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* The same before and after if none was left open. */
static int open_descriptors(void)
{
	return count_files("/proc/self/fd", "", "");
}

static const char *const fault_names[FAULT_COUNT] = {"malloc", "write", "close", "renameat", "openat", "read"};

/* One of the calls with number 0, 1, ... fails, until all went well: the image is kept or it is not, the one before it
   is there or the new one is, and nothing is left over. What comes after the entry, the pruning, may fail. */
static long fail_puts(enum fault f, int error)
{
	struct cache c = cache_in("c");
	int descriptors = open_descriptors(), kept;

	for (long k = 0;; k++) {
		faults_clear();
		ck_assert_int_eq(put_text(&c, "key", "first"), 1);
		faults.fail_at[f] = k + 1;
		faults.error = error;
		memset(faults.calls, 0, sizeof faults.calls);
		kept = put_text(&c, "key", "the second");
		if (faults.calls[f] <= k) {
			faults_clear();
			ck_assert_int_eq(kept, 1);
			return k;
		}
		faults_clear();
		ck_assert_msg(kept == (f == FAULT_MALLOC || (k > 0 && (f == FAULT_OPEN || f == FAULT_CLOSE))), "%s %ld",
			fault_names[f], k);
		ck_assert_msg(get_is(&c, "key", kept ? "the second" : "first"), "%s %ld", fault_names[f], k);
		ck_assert_msg(count_files(c.folder, "", "") == 3, "%s %ld left a file", fault_names[f], k);
		ck_assert_int_eq(open_descriptors(), descriptors);
	}
}

static long fail_gets(enum fault f, int error)
{
	struct cache c = cache_in("c");
	int descriptors = open_descriptors(), found;
	long calls;
	size_t size;
	char *data;

	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	for (long k = 0;; k++) {
		faults_clear();
		faults.fail_at[f] = k + 1;
		faults.error = error;
		found = cache_get(&c, "key", 3, &data, &size);
		calls = faults.calls[f];
		faults_clear();
		ck_assert_msg(found == (calls <= k || f == FAULT_CLOSE), "%s %ld", fault_names[f], k);
		ck_assert_uint_eq(size, found ? 5 : 0);
		ck_assert_int_eq(data != NULL, found);
		free(data);
		ck_assert_int_eq(open_descriptors(), descriptors);
		if (calls <= k)
			return k;
	}
}

START_TEST(every_call_fails)
{
	static const int errors[FAULT_COUNT] = {ENOMEM, ENOSPC, EIO, ENOSPC, EMFILE, EIO};
	/* at least so many must have been reached */
	static const long puts_reach[FAULT_COUNT] = {1, 3, 2, 1, 1, 0}, gets_reach[FAULT_COUNT] = {1, 0, 2, 0, 1, 2};
	long puts_failed = fail_puts((enum fault)_i, errors[_i]), gets_failed = fail_gets((enum fault)_i, errors[_i]);

	printf("%s: each of %ld calls of a put and %ld of a get failed\n", fault_names[_i], puts_failed, gets_failed);
	ck_assert_int_ge(puts_failed, puts_reach[_i]);
	ck_assert_int_ge(gets_failed, gets_reach[_i]);
}
END_TEST

/* Somebody else's file in the place of the one to be written: another name is taken, a hundred times. */
START_TEST(temporaries_are_there)
{
	struct cache c = cache_in("c");
	char name[64], *content;
	size_t size;

	ck_assert_int_eq(put_text(&c, "key", "first"), 1);
	faults.time = (struct timespec){1700000000, 12345};
	for (int i = 0; i < 100; i++) {
		ck_assert_int_eq(put_text(&c, "key", i % 2 ? "odd" : "even"), 1);
		snprintf(name, sizeof name, "c/rnea-tmp-%ld-1700000000000012345-%d", (long)getpid(), i);
		entry_write(inside(name), "somebody's", 10);
	}
	ck_assert_int_eq(put_text(&c, "key", "another"), 0);
	faults_clear(); /* Check measures a test by the clock, too */
	ck_assert_int_eq(get_is(&c, "key", "odd"), 1);
	ck_assert_int_eq(count_temporaries(c.folder), 100);
	for (int i = 0; i < 100; i++) {
		snprintf(name, sizeof name, "c/rnea-tmp-%ld-1700000000000012345-%d", (long)getpid(), i);
		content = entry_read(inside(name), &size);
		ck_assert_uint_eq(size, 10);
		ck_assert_mem_eq(content, "somebody's", 10);
		free(content);
	}
}
END_TEST

/* A few bytes at a time, with a signal before each. */
START_TEST(short_and_interrupted)
{
	struct cache c = cache_in("c");
	char text[1001];

	memset(text, 't', sizeof text);
	text[sizeof text - 1] = '\0';
	for (size_t most = 1; most < 70; most++) {
		faults_clear();
		faults.most = most;
		faults.eintr = 1;
		text[0] = (char)('0' + most);
		ck_assert_int_eq(put_text(&c, "key", text), 1);
		ck_assert_int_eq(get_is(&c, "key", text), 1);
		faults_clear();
		ck_assert_int_eq(get_is(&c, "key", text), 1);
	}
}
END_TEST

static int work_limited(void *context)
{
	const struct cache *c = context;
	struct rlimit limit = {2000, 2000};
	char text[4001];

	memset(text, 't', sizeof text);
	text[sizeof text - 1] = '\0';
	if (setrlimit(RLIMIT_FSIZE, &limit) != 0)
		return CANNOT;
	for (size_t length = 1900; length < 2100; length++) {
		text[length] = '\0';
		/* the header has 32 bytes, the key 3 */
		if (put_text(c, "key", text) != (length <= 2000 - 35))
			return 2;
		if (length <= 2000 - 35 && get_text(c, "key", text) != 1)
			return 3;
		text[length] = 't';
	}
	return count_temporaries(c->folder) == 0 && count_entries(c->folder) == 1 ? 0 : 4;
}

static int work_limited_ignoring(void *context)
{
	signal(SIGXFSZ, SIG_IGN);
	return work_limited(context);
}

/* A signal kills who writes more than the limit. */
START_TEST(files_are_limited)
{
	struct cache c = cache_in("c");

	ck_assert_int_eq(run_child(work_limited, &c), 0);
	ck_assert_int_eq(run_child(work_limited_ignoring, &c), 0);
}
END_TEST

static int write_file(const char *path, const char *text)
{
	int fd = open(path, O_WRONLY | O_CLOEXEC);
	int done = fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text);

	return fd >= 0 && close(fd) == 0 && done;
}

/* A name space in which this user is root. */
static int become_root(unsigned user, unsigned group)
{
	char users[32], groups[32];

	snprintf(users, sizeof users, "0 %u 1", user);
	snprintf(groups, sizeof groups, "0 %u 1", group);
	return unshare(CLONE_NEWUSER) == 0 && write_file("/proc/self/uid_map", users) &&
	       write_file("/proc/self/setgroups", "deny") && write_file("/proc/self/gid_map", groups);
}

/* A file system of 16 pages on the sandbox, seen by this process alone. */
static int mount_small(void)
{
	char options[64];

	snprintf(options, sizeof options, "size=%ld,mode=0700", 16 * sysconf(_SC_PAGESIZE));
	return (geteuid() == 0 || become_root(geteuid(), getegid())) && unshare(CLONE_NEWNS) == 0 &&
	       mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
	       mount("tmpfs", sandbox, "tmpfs", 0, options) == 0;
}

static int work_full(void *context)
{
	const struct cache *c = context;
	int kept = 0, refused = 0, there = 0;
	char text[3000], key[16];

	if (!mount_small())
		return CANNOT;
	memset(text, 't', sizeof text);
	text[sizeof text - 1] = '\0';
	for (int i = 0; i < 40; i++) {
		snprintf(key, sizeof key, "%d", i);
		/* before it is full, and after: the ones of one page fit longer than those of three */
		if (put_text(c, key, text))
			kept++;
		else
			refused++;
		if (put_text(c, "large", "small once") && get_text(c, "large", "small once") != 1)
			return 2;
	}
	for (int i = 0; i < 40; i++) {
		snprintf(key, sizeof key, "%d", i);
		there += get_text(c, key, text);
	}
	printf("of 40 entries %d were kept, %d refused\n", kept, refused);
	fflush(stdout);
	return kept == there && kept > 5 && refused > 5 && count_temporaries(c->folder) == 0 ? 0 : 3;
}

START_TEST(disk_is_full)
{
	struct cache c = cache_in("c");
	int status = run_child(work_full, &c);

	if (status == CANNOT)
		puts("skipped: disk_is_full: no right to mount a small file system");
	else
		ck_assert_int_eq(status, 0);
}
END_TEST

/* Catches something in an entry's place that would keep the entry from being kept for ever. */
START_TEST(replaces_what_stands_there)
{
	static const char *const kinds[] = {"garbage", "unreadable", "link", "dangling", "link to a folder", "fifo", "folder"};
	struct cache c = cache_in("c");
	char *path;

	ck_assert_int_eq(put_text(&c, "other", "of another key"), 1);
	ck_assert_int_eq(mkdir(inside("elsewhere"), 0700), 0);
	entry_write(inside("file"), "text", 4);
	path = strdup(entry_path(&c, "key", 3));
	for (int i = 0; i < (int)(sizeof kinds / sizeof *kinds); i++) {
		int made = i < 2 ? (entry_write(path, "garbage", 7), i ? chmod(path, 0) : 0)
			 : i < 5 ? symlink(i == 2 ? inside("file") : i == 3 ? inside("nowhere") : inside("elsewhere"), path)
			 : i == 5 ? mkfifo(path, 0600) : mkdir(path, 0700);

		ck_assert_msg(made == 0, "%s: %s", kinds[i], strerror(errno));
		ck_assert_msg(!get_is(&c, "key", "image"), "%s", kinds[i]);
		ck_assert_msg(put_text(&c, "key", "image"), "%s", kinds[i]);
		ck_assert_msg(get_is(&c, "key", "image"), "%s", kinds[i]);
		ck_assert_int_eq(unlink(path), 0);
	}
	ck_assert_int_eq(count_temporaries(c.folder), 0);
	ck_assert_int_eq(get_is(&c, "other", "of another key"), 1);
	ck_assert_int_eq(access(inside("nowhere"), F_OK), -1);
	ck_assert_int_eq(count_files(inside("elsewhere"), "", ""), 2); /* . and .. */
	free(path);
}
END_TEST

/* What somebody keeps in a folder there is not ours to remove: it is said instead. */
START_TEST(says_what_stands_there)
{
	struct cache c = cache_in("c");
	struct cache_why why = {"untouched"};
	char *path, file[600];

	ck_assert_int_eq(cache_put(&c, "key", 3, "image", 5, &why), 1);
	ck_assert_str_eq(why.text, "");
	path = strdup(entry_path(&c, "key", 3));
	ck_assert_int_eq(unlink(path), 0);
	ck_assert_int_eq(mkdir(path, 0700), 0);
	snprintf(file, sizeof file, "%s/thesis.tex", path);
	entry_write(file, "text", 4);
	for (int i = 0; i < 3; i++) {
		ck_assert_int_eq(cache_put(&c, "key", 3, "image", 5, &why), 0);
		ck_assert_msg(strncmp(why.text, path, strlen(path)) == 0 && strstr(why.text, "not empty"), "%s", why.text);
		ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	}
	ck_assert_int_eq(access(file, F_OK), 0);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
	ck_assert_int_eq(unlink(file), 0);
	ck_assert_int_eq(cache_put(&c, "key", 3, "image", 5, &why), 1);
	ck_assert_str_eq(why.text, "");
	ck_assert_int_eq(get_is(&c, "key", "image"), 1);
	free(path);
}
END_TEST

Suite *suite_cache_fault(void)
{
	Suite *s = suite_create("cache fault");
	TCase *t = tcase_create("cache fault");

	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_add_loop_test(t, every_call_fails, 0, FAULT_COUNT);
	tcase_add_test(t, temporaries_are_there);
	tcase_add_test(t, short_and_interrupted);
	tcase_add_test(t, files_are_limited);
	tcase_add_test(t, disk_is_full);
	tcase_add_test(t, replaces_what_stands_there);
	tcase_add_test(t, says_what_stands_there);
	suite_add_tcase(s, t);
	return s;
}
