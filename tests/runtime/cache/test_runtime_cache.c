/* The cache on disk: what its tests share. */
#define _GNU_SOURCE
#include "test_runtime_cache.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- calls that fail; linked with --wrap ---- */

_Thread_local struct faults faults;

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size);
ssize_t __real_write(int fd, const void *data, size_t size);
ssize_t __wrap_write(int fd, const void *data, size_t size);
ssize_t __real_read(int fd, void *data, size_t size);
ssize_t __wrap_read(int fd, void *data, size_t size);
int __real_close(int fd);
int __wrap_close(int fd);
int __real_renameat(int from_folder, const char *from, int to_folder, const char *to);
int __wrap_renameat(int from_folder, const char *from, int to_folder, const char *to);
int __real_clock_gettime(clockid_t clock, struct timespec *time);
int __wrap_clock_gettime(clockid_t clock, struct timespec *time);
int __real_openat(int folder, const char *name, int flags, ...);
int __wrap_openat(int folder, const char *name, int flags, ...);

void faults_clear(void)
{
	faults = (struct faults){0};
}

static int fails(enum fault f)
{
	if (++faults.calls[f] == faults.die_at[f])
		raise(SIGKILL);
	if (faults.calls[f] != faults.fail_at[f])
		return 0;
	errno = faults.error;
	return 1;
}

static int interrupted(enum fault f)
{
	if (!faults.eintr || faults.calls[f] % 2)
		return 0;
	faults.calls[f]++;
	errno = EINTR;
	return 1;
}

static size_t limited(size_t size)
{
	return faults.most && faults.most < size ? faults.most : size;
}

void *__wrap_malloc(size_t size)
{
	if (size > faults.allocated)
		faults.allocated = size;
	return fails(FAULT_MALLOC) ? NULL : __real_malloc(size);
}

void *__wrap_realloc(void *block, size_t size)
{
	return fails(FAULT_MALLOC) ? NULL : __real_realloc(block, size);
}

ssize_t __wrap_write(int fd, const void *data, size_t size)
{
	if (interrupted(FAULT_WRITE) || fails(FAULT_WRITE))
		return -1;
	return __real_write(fd, data, limited(size));
}

ssize_t __wrap_read(int fd, void *data, size_t size)
{
	void (*hook)(void) = faults.before_read;

	faults.before_read = NULL;
	if (hook)
		hook();
	if (interrupted(FAULT_READ) || fails(FAULT_READ))
		return -1;
	return __real_read(fd, data, limited(size));
}

int __wrap_close(int fd)
{
	int failed = fails(FAULT_CLOSE), error = errno, result = __real_close(fd);

	if (failed)
		errno = error;
	return failed ? -1 : result;
}

int __wrap_renameat(int from_folder, const char *from, int to_folder, const char *to)
{
	return fails(FAULT_RENAME) ? -1 : __real_renameat(from_folder, from, to_folder, to);
}

int __wrap_openat(int folder, const char *name, int flags, ...)
{
	mode_t mode = 0;
	va_list ap;

	if (flags & O_CREAT) {
		va_start(ap, flags);
		mode = va_arg(ap, mode_t);
		va_end(ap);
	}
	return fails(FAULT_OPEN) ? -1 : __real_openat(folder, name, flags, mode);
}

int __wrap_clock_gettime(clockid_t clock, struct timespec *time)
{
	if (!faults.time.tv_sec)
		return __real_clock_gettime(clock, time);
	*time = faults.time;
	return 0;
}

/* ---- the sandbox ---- */

char sandbox[256];

void sandbox_make(void)
{
	const char *tmp = getenv("TMPDIR");

	snprintf(sandbox, sizeof sandbox, "%s/rnea-cache-XXXXXX", tmp && *tmp ? tmp : "/tmp");
	ck_assert_ptr_nonnull(mkdtemp(sandbox));
	unsetenv("RNEA_CACHE");
	unsetenv("XDG_CACHE_HOME");
	unsetenv("HOME");
	faults_clear();
}

static int remove_one(const char *path, const struct stat *s, int kind, struct FTW *f)
{
	(void)s, (void)kind, (void)f;
	return remove(path);
}

void sandbox_remove(void)
{
	faults_clear();
	ck_assert_int_eq(nftw(sandbox, remove_one, 16, FTW_DEPTH | FTW_PHYS), 0);
}

const char *inside(const char *name)
{
	static char buffers[8][512];
	static int next;
	char *path = buffers[next++ % 8];

	snprintf(path, sizeof buffers[0], "%s/%s", sandbox, name);
	return path;
}

struct cache cache_in(const char *name)
{
	struct cache c;

	cache_open(&c, inside(name));
	return c;
}

int put_text(const struct cache *c, const char *key, const char *text)
{
	return cache_put(c, key, strlen(key), text, strlen(text), NULL);
}

int get_text(const struct cache *c, const char *key, const char *text)
{
	size_t size = 12345;
	char *data = &(char){0};
	int found = cache_get(c, key, strlen(key), &data, &size), right;

	if (!found)
		return data || size ? -1 : 0;
	right = found == 1 && size == strlen(text) && strcmp(data, text) == 0;
	free(data);
	return right ? 1 : -1;
}

int get_is(const struct cache *c, const char *key, const char *text)
{
	int found = get_text(c, key, text);

	ck_assert_msg(found >= 0, "\"%s\" of %s: something else than \"%s\"", key, c->folder, text);
	return found;
}

/* ---- files ---- */

uint64_t fnv(uint64_t h, const void *data, size_t size)
{
	for (const unsigned char *s = data; size; size--)
		h = (h ^ *s++) * UINT64_C(1099511628211);
	return h;
}

const char *entry_path(const struct cache *c, const void *key, size_t key_size)
{
	static char path[sizeof c->folder + 32];

	snprintf(path, sizeof path, "%s/rnea-%016" PRIx64, c->folder, fnv(FNV_START, key, key_size));
	return path;
}

char *entry_read(const char *path, size_t *size)
{
	FILE *f = fopen(path, "rb");
	char *content = malloc(1 << 22);

	ck_assert_msg(f && content, "%s: %s", path, strerror(errno));
	*size = fread(content, 1, 1 << 22, f);
	fclose(f);
	return content;
}

void entry_write(const char *path, const void *content, size_t size)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

	ck_assert_msg(fd >= 0, "%s: %s", path, strerror(errno));
	ck_assert_int_eq(__real_write(fd, content, size), (ssize_t)size);
	ck_assert_int_eq(__real_close(fd), 0);
}

int count_files(const char *folder, const char *prefix, const char *next)
{
	DIR *d = opendir(folder);
	size_t length = strlen(prefix);
	int count = 0;

	ck_assert_msg(d != NULL, "%s: %s", folder, strerror(errno));
	for (const struct dirent *e; (e = readdir(d)) != NULL;)
		count += strncmp(e->d_name, prefix, length) == 0 && (!*next || strchr(next, e->d_name[length]));
	closedir(d);
	return count;
}

int count_entries(const char *folder)
{
	return count_files(folder, "rnea-", "0123456789abcdef");
}

int count_temporaries(const char *folder)
{
	return count_files(folder, "rnea-tmp-", "");
}

/* ---- processes ---- */

int run_child(int (*work)(void *), void *context)
{
	pid_t pid = fork();
	int status;

	ck_assert_int_ge(pid, 0);
	if (!pid)
		_exit(work(context));
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

int become_nobody(void)
{
	enum { NOBODY = 65534 };

	return geteuid() == 0 && chown(sandbox, NOBODY, NOBODY) == 0 && setresgid(NOBODY, NOBODY, NOBODY) == 0 &&
	       setresuid(NOBODY, NOBODY, NOBODY) == 0 && access(sandbox, W_OK) == 0;
}

int main(void)
{
	SRunner *r = srunner_create(suite_cache_folder());
	int bad;

	srunner_add_suite(r, suite_cache_entry());
	srunner_add_suite(r, suite_cache_fault());
	srunner_add_suite(r, suite_cache_race());
	srunner_run_all(r, CK_ENV);
	bad = srunner_ntests_failed(r);
	srunner_free(r);
	return bad != 0;
}
