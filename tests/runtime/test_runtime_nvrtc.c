/* Which NVRTC is found, and that finding it does not load it. Copies of the pretended one lie in folders of the test's
   own; what the machine itself has is found by the same search, and may come first. */
#define _GNU_SOURCE
#include "test_runtime.h"
#include "cuda/compile/nvrtc.h"
#include <fcntl.h>
#include <ftw.h>
#include <inttypes.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[256];

static void make_folder(void)
{
	const char *tmp = getenv("TMPDIR");
	char name[256];

	snprintf(name, sizeof name, "%s/rnea-nvrtc-XXXXXX", tmp && *tmp ? tmp : "/tmp");
	ck_assert_ptr_nonnull(mkdtemp(name));
	ck_assert_ptr_nonnull(realpath(name, folder));
	unsetenv("RNEA_NVRTC");
	unsetenv("CUDA_HOME");
	unsetenv("CUDA_PATH");
	unsetenv("VIRTUAL_ENV");
	unsetenv("CONDA_PREFIX");
}

static int remove_one(const char *path, const struct stat *s, int kind, struct FTW *f)
{
	(void)s, (void)kind, (void)f;
	return remove(path);
}

static void remove_folder(void)
{
	ck_assert_int_eq(nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS), 0);
}

static const char *inside(const char *name)
{
	static char buffers[8][1024];
	static int next;
	char *path = buffers[next++ % 8];

	snprintf(path, sizeof buffers[0], "%s/%s", folder, name);
	return path;
}

/* A file in the folder, with the folders above it. */
static const char *write_file(const char *name, const char *content, size_t size)
{
	char *path = strdup(inside(name));
	FILE *f;

	for (char *s = path + strlen(folder) + 1; (s = strchr(s, '/')) != NULL; *s++ = '/') {
		*s = '\0';
		mkdir(path, 0755);
	}
	f = fopen(path, "wb");
	ck_assert_msg(f != NULL, "%s cannot be written", path);
	ck_assert_uint_eq(fwrite(content, 1, size, f), size);
	ck_assert_int_eq(fclose(f), 0);
	free(path);
	return inside(name);
}

/* The pretended NVRTC, whose soname is libnvrtc.so.12. */
static const char *put_nvrtc(const char *name)
{
	size_t size;
	char *content = read_text(FAKE_NVRTC_12, &size);
	const char *path = write_file(name, content, size);

	free(content);
	return path;
}

/* Whether this process has mapped a file whose path contains `part`. */
static int is_loaded(const char *part)
{
	char *maps = read_text("/proc/self/maps", NULL);
	int found = strstr(maps, part) != NULL;

	free(maps);
	return found;
}

static void assert_identity(const char *path)
{
	char text[1024], want[1024];
	struct stat s;

	ck_assert_int_eq(stat(path, &s), 0);
	snprintf(want, sizeof want, "%s %" PRIdMAX " %" PRIdMAX " %" PRIuMAX, path, (intmax_t)s.st_size,
		(intmax_t)s.st_mtim.tv_sec * 1000000000 + s.st_mtim.tv_nsec, (uintmax_t)s.st_ino);
	ck_assert_int_eq(nvrtc_identity(text, sizeof text), 1);
	ck_assert_str_eq(text, want);
}

START_TEST(names_the_chosen)
{
	const char *path = put_nvrtc("a/libnvrtc.so.12");
	const char *link = inside("link");

	setenv("RNEA_NVRTC", path, 1);
	assert_identity(path);
	ck_assert_int_eq(symlink("a/libnvrtc.so.12", link), 0);
	setenv("RNEA_NVRTC", link, 1);
	assert_identity(path);
	ck_assert_int_eq(chdir(folder), 0);
	setenv("RNEA_NVRTC", "./link", 1);
	assert_identity(path);
	ck_assert_int_eq(chdir("/"), 0);
	ck_assert(!is_loaded(folder));
}
END_TEST

static void identity(char text[1024])
{
	ck_assert_int_eq(nvrtc_identity(text, 1024), 1);
}

/* A nanosecond later, a byte longer, another file of the same time and length: each is another NVRTC. */
START_TEST(tells_files_apart)
{
	const char *path = put_nvrtc("libnvrtc.so.12"), *other = put_nvrtc("other");
	struct timespec times[2] = {{1700000000, 5}, {1700000000, 5}};
	char first[1024], second[1024], third[1024], fourth[1024];
	FILE *f;

	setenv("RNEA_NVRTC", path, 1);
	ck_assert_int_eq(utimensat(AT_FDCWD, path, times, 0), 0);
	identity(first);
	ck_assert_ptr_nonnull(strstr(first, " 1700000000000000005 "));
	identity(second);
	ck_assert_str_eq(first, second);
	times[1].tv_nsec++;
	ck_assert_int_eq(utimensat(AT_FDCWD, path, times, 0), 0);
	identity(second);
	ck_assert_str_ne(first, second);
	f = fopen(path, "ab");
	ck_assert_int_eq(fputc('x', f), 'x');
	fclose(f);
	ck_assert_int_eq(utimensat(AT_FDCWD, path, times, 0), 0);
	identity(third);
	ck_assert_str_ne(second, third);
	ck_assert_int_eq(utimensat(AT_FDCWD, other, times, 0), 0);
	ck_assert_int_eq(rename(other, path), 0);
	identity(fourth);
	ck_assert_str_ne(second, fourth);
	ck_assert_str_ne(third, fourth);
}
END_TEST

START_TEST(there_is_none)
{
	static const char *const names[] = {"/nowhere/libnvrtc.so", "libnvrtc-nowhere.so", "/", "/dev/null"};
	char text[1024], small[8];

	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		setenv("RNEA_NVRTC", names[i], 1);
		strcpy(text, "old");
		ck_assert_msg(nvrtc_identity(text, sizeof text) == 0, "%s", names[i]);
		ck_assert_str_eq(text, "");
	}
	setenv("RNEA_NVRTC", put_nvrtc("libnvrtc.so.12"), 1);
	ck_assert_int_eq(nvrtc_identity(text, sizeof text), 1);
	ck_assert_int_eq(nvrtc_identity(small, sizeof small), 0);
	ck_assert_str_eq(small, "");
	ck_assert_int_eq(nvrtc_identity(small, 0), 0);
	/* just too small, and just large enough */
	ck_assert_int_eq(nvrtc_identity(text, strlen(text)), 0);
	nvrtc_identity(text, sizeof text);
	ck_assert_int_eq(nvrtc_identity(text, strlen(text) + 1), 1);
}
END_TEST

/* Of a path the library keeps 511 bytes; what it had to cut is not taken for the file that has the rest as its name. */
START_TEST(path_is_too_long)
{
	char name[600], text[1024];
	size_t length = 511 - strlen(folder) - 1;

	for (size_t i = 0; i < sizeof name; i++)
		name[i] = i % 100 == 99 ? '/' : 'd';
	for (size_t more = 0; more < 3; more++) {
		name[length + more - 1] = 'f';
		name[length + more] = '\0';
		put_nvrtc(name);
		setenv("RNEA_NVRTC", inside(name), 1);
		ck_assert_int_eq(nvrtc_identity(text, sizeof text), 0);
		name[length + more] = 'd';
	}
	name[length - 2] = 'f';
	name[length - 1] = '\0';
	setenv("RNEA_NVRTC", put_nvrtc(name), 1);
	ck_assert_int_eq(nvrtc_identity(text, sizeof text), 1);
}
END_TEST

/* A name without a slash is the linker's to find, even if that loads it. */
START_TEST(asks_the_linker)
{
	char first[1024], second[1024], path[1024];

	setenv("RNEA_NVRTC", "libanl.so.1", 1); /* of glibc, and in nobody's use */
	if (!nvrtc_identity(first, sizeof first)) {
		puts("skipped: asks_the_linker: no libanl.so.1");
		return;
	}
	ck_assert_int_eq(sscanf(first, "%1023s", path), 1);
	ck_assert_int_eq(path[0], '/');
	ck_assert(is_loaded(path));
	ck_assert_int_eq(nvrtc_identity(second, sizeof second), 1);
	ck_assert_str_eq(first, second);
}
END_TEST

/* An empty folder in the place of /usr/local, for this process. */
static int hide_local(void)
{
	return unshare(CLONE_NEWNS) == 0 && mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
	       mount("tmpfs", "/usr/local", "tmpfs", 0, "size=64k") == 0;
}

/* Each place is searched for the identity as it is for opening; `first`: it comes before what the machine may have. */
static const struct place {
	const char *variable, *value, *name;
	int first;
} places[] = {
	{"CUDA_HOME", "cuda", "cuda/lib64/libnvrtc.so.12", 1},
	{"CUDA_PATH", "cuda", "cuda/lib64/libnvrtc.so.12", 1},
	{"VIRTUAL_ENV", "env", "env/lib/python3.11/site-packages/nvidia/cu13/lib/libnvrtc.so.12", 0},
	{"CONDA_PREFIX", "env", "env/lib/python3.11/site-packages/nvidia/cuda_nvrtc/lib/libnvrtc.so.12", 0},
	{"HOME", "home", "home/.local/lib/python3.12/site-packages/nvidia/cu13/lib/libnvrtc.so.12", 0},
	{"PATH", "env/bin", "env/lib/python3.11/site-packages/nvidia/cu13/lib/libnvrtc.so.12", 0},
};

START_TEST(searches_as_opening_does)
{
	const struct place *p = &places[_i];
	const char *path = put_nvrtc(p->name);
	char before[1024], after[1024], opened[4096];
	struct rnea_error e = {0};
	struct nvrtc n;

	chmod(write_file("env/bin/python3", "", 0), 0755);
	setenv(p->variable, inside(p->value), 1);
	if (!p->first && !hide_local())
		printf("%s: no right to hide /usr/local\n", p->variable);
	identity(before);
	if (p->first)
		assert_identity(path);
	ck_assert(!is_loaded(folder) && !is_loaded("/libnvrtc.so"));
	ck_assert_msg(nvrtc_open(&n, &e) == RNEA_OK, "%s", e.message);
	ck_assert_ptr_nonnull(realpath(n.library.path, opened));
	if (!p->first && strncmp(opened, folder, strlen(folder)) != 0)
		printf("skipped: searches_as_opening_does: %s: %s of this machine comes first\n", p->variable, opened);
	ck_assert_msg(strncmp(before, opened, strlen(opened)) == 0 && before[strlen(opened)] == ' ',
		"found %s, opened %s", before, opened);
	/* now it is the one that is loaded, whatever the environment says */
	setenv(p->variable, "/nowhere", 1);
	identity(after);
	ck_assert_str_eq(before, after);
	nvrtc_close(&n);
	identity(after);
	ck_assert_str_eq(before, after);
}
END_TEST

/* The newest, by its name; one that does not load is passed over by opening alone, and the identity tells afterwards.
 */
START_TEST(newest_first)
{
	const char *old = put_nvrtc("cuda/lib64/libnvrtc.so.12"), *new = put_nvrtc("cuda/lib64/libnvrtc.so.13");
	struct rnea_error e = {0};
	struct nvrtc n;

	setenv("CUDA_HOME", inside("cuda"), 1);
	assert_identity(new);
	new = write_file("cuda/lib64/libnvrtc.so.13", "no library", 10);
	assert_identity(new);
	ck_assert_msg(nvrtc_open(&n, &e) == RNEA_OK, "%s", e.message);
	ck_assert_str_eq(n.library.path, old);
	assert_identity(old);
	nvrtc_close(&n);
}
END_TEST

/* Bytes that this process has read from files; -1: the system does not count them. */
static long long bytes_read(void)
{
	FILE *f = fopen("/proc/self/io", "re");
	long long bytes = -1;

	if (f && fscanf(f, "rchar: %lld", &bytes) != 1)
		bytes = -1;
	if (f)
		fclose(f);
	return bytes;
}

/* Catches an identity for which the library, of a hundred megabytes, is read. On the machine's own NVRTC, where it has one. */
START_TEST(reads_no_library)
{
	long long before, read;
	char text[1024], again[1024];

	if (!nvrtc_identity(text, sizeof text) || (before = bytes_read()) < 0) {
		puts("skipped: reads_no_library: no NVRTC, or no /proc/self/io");
		return;
	}
	ck_assert_int_eq(nvrtc_identity(again, sizeof again), 1);
	read = bytes_read() - before;
	printf("identity by %lld bytes: %s\n", read, text);
	ck_assert_str_eq(text, again);
	ck_assert_int_lt(read, 1 << 20);
}
END_TEST

Suite *suite_nvrtc(void)
{
	Suite *s = suite_create("nvrtc");
	TCase *t = tcase_create("nvrtc");

	tcase_set_timeout(t, 60);
	tcase_add_checked_fixture(t, make_folder, remove_folder);
	tcase_add_test(t, names_the_chosen);
	tcase_add_test(t, tells_files_apart);
	tcase_add_test(t, there_is_none);
	tcase_add_test(t, path_is_too_long);
	tcase_add_test(t, asks_the_linker);
	tcase_add_loop_test(t, searches_as_opening_does, 0, sizeof places / sizeof *places);
	tcase_add_test(t, newest_first);
	tcase_add_test(t, reads_no_library);
	suite_add_tcase(s, t);
	return s;
}
