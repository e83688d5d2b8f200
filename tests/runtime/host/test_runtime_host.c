/* The host backend: texts compiled by the machine's own compiler, and by scripts that pretend to be one. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include <dirent.h>
#include <errno.h>
#include <ftw.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- what fails on purpose ---- */

struct faults faults = {.allocations = -1};
_Thread_local struct made made;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
int __real_memfd_create(const char *name, unsigned flags);
char *__real_mkdtemp(char *name);
int __real_cache_get(const struct cache *c, const void *key, size_t key_size, char **data, size_t *size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
int __wrap_memfd_create(const char *name, unsigned flags);
char *__wrap_mkdtemp(char *name);
int __wrap_cache_get(const struct cache *c, const void *key, size_t key_size, char **data, size_t *size);
int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument);
int __real_pthread_join(pthread_t thread, void **result);
int __wrap_pthread_join(pthread_t thread, void **result);

static int may_allocate(void)
{
	if (faults.allocations < 0)
		return 1;
	if (faults.allocations == 0)
		faults.allocation_failed = 1;
	else
		faults.allocations--;
	return !faults.allocation_failed;
}

void *__wrap_malloc(size_t size)
{
	return may_allocate() ? __real_malloc(size) : NULL;
}

void *__wrap_calloc(size_t count, size_t size)
{
	return may_allocate() ? __real_calloc(count, size) : NULL;
}

int __wrap_memfd_create(const char *name, unsigned flags)
{
	errno = faults.no_memfd;
	return faults.no_memfd ? -1 : __real_memfd_create(name, flags);
}

char *__wrap_mkdtemp(char *name)
{
	errno = faults.no_folder;
	if (faults.no_folder || !__real_mkdtemp(name))
		return NULL;
	made.folders++;
	snprintf(made.last, sizeof made.last, "%s", name);
	return name;
}

int __wrap_cache_get(const struct cache *c, const void *key, size_t key_size, char **data, size_t *size)
{
	int hit = __real_cache_get(c, key, key_size, data, size);

	if (hit && faults.damage == 1)
		memset(*data, 'x', *size);
	for (size_t i = 0; hit && faults.damage == 2 && i + 13 < *size; i++)
		if (memcmp(*data + i, "pendulum_info", 13) == 0)
			(*data)[i] = 'P';
	return hit;
}

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument)
{
	if (faults.no_thread)
		return faults.no_thread;
	faults.started++;
	return __real_pthread_create(thread, attributes, start, argument);
}

int __wrap_pthread_join(pthread_t thread, void **result)
{
	faults.joined++;
	return __real_pthread_join(thread, result);
}

/* ---- the sandbox ---- */

char sandbox[256];
static int open_before;

static int count_descriptors(void)
{
	return count_entries("/proc/self/fd", "");
}

void sandbox_make(void)
{
	snprintf(sandbox, sizeof sandbox, "/tmp/test-host-XXXXXX");
	ck_assert_ptr_nonnull(__real_mkdtemp(sandbox));
	ck_assert_int_eq(mkdir(inside("tmp"), 0700), 0);
	setenv("TMPDIR", inside("tmp"), 1);
	unsetenv("RNEA_CC");
	open_before = count_descriptors();
}

/* Objects of texts in this process: the parts of the file that each has in memory. */
static int count_loaded(void)
{
	FILE *f = fopen("/proc/self/maps", "re");
	char line[5000];
	int n = 0;

	ck_assert_ptr_nonnull(f);
	while (fgets(line, sizeof line, f))
		n += strstr(line, "/memfd:rnea-") != NULL;
	fclose(f);
	return n;
}

static int remove_entry(const char *path, const struct stat *about, int type, struct FTW *where)
{
	(void)about;
	(void)type;
	(void)where;
	return remove(path);
}

void sandbox_remove(void)
{
	ck_assert_int_eq(count_descriptors(), open_before);
	ck_assert_int_eq(count_loaded(), 0);
	ck_assert_int_eq(count_entries(inside("tmp"), ""), 0);
	ck_assert_int_eq(nftw(sandbox, remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
}

const char *inside(const char *name)
{
	static char buffers[8][1500];
	static unsigned next;
	char *path = buffers[next++ % 8];

	snprintf(path, sizeof buffers[0], "%s/%s", sandbox, name);
	return path;
}

int count_entries(const char *folder, const char *prefix)
{
	DIR *d = opendir(folder);
	int n = 0;

	ck_assert_msg(d != NULL, "%s: %s", folder, strerror(errno));
	for (struct dirent *e; (e = readdir(d)) != NULL;)
		n += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 &&
		     strncmp(e->d_name, prefix, strlen(prefix)) == 0;
	closedir(d);
	return n;
}

void write_file(const char *path, const char *text, int mode)
{
	FILE *f = fopen(path, "wbe");

	ck_assert_msg(f != NULL, "%s: %s", path, strerror(errno));
	fputs(text, f);
	ck_assert_int_eq(fclose(f), 0);
	ck_assert_int_eq(chmod(path, (mode_t)mode), 0);
}

void use_script(const char *name, const char *text)
{
	char whole[2048];

	snprintf(whole, sizeof whole, "#!/bin/sh\n%s", text);
	write_file(inside(name), whole, 0700);
	setenv("RNEA_CC", inside(name), 1);
}

/* ---- opening ---- */

char *pendulum_with(const char *from, const char *to)
{
	FILE *f = fopen(TEST_DIR "/runtime/pendulum.c", "rbe");
	char text[8192] = "", *changed = calloc(1, sizeof text + strlen(to)), *at;

	ck_assert_ptr_nonnull(f);
	ck_assert_uint_gt(fread(text, 1, sizeof text - 1, f), 0);
	fclose(f);
	at = strstr(text, from);
	ck_assert_msg(at != NULL, "\"%s\" is not in the text", from);
	memcpy(changed, text, (size_t)(at - text));
	strcat(changed, to);
	strcat(changed, at + strlen(from));
	return changed;
}

struct host_request pendulum_request(const char *text)
{
	static const struct cache none;

	return (struct host_request){
		.source = text, .file = "text.c", .name = "pendulum", .cache = &none, .threads = 1};
}

struct host open_pendulum(void)
{
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	struct host h;

	ck_assert_msg(host_open(&h, &r, &e) == RNEA_OK, "%s", e.message);
	ck_assert_str_eq(e.message, "");
	free(text);
	return h;
}

struct host open_pendulum_slow(unsigned threads)
{
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	struct host h;

	r.threads = threads;
	ck_assert_msg(host_open(&h, &r, &e) == RNEA_OK, "%s", e.message);
	ck_assert_uint_eq(h.threads, threads);
	free(text);
	return h;
}

struct host open_cached(const char *text)
{
	struct host_request r = pendulum_request(text);
	struct rnea_error e = {0};
	struct cache c;
	struct host h;

	cache_open(&c, inside("cache"));
	mkdir(c.folder, 0700);
	r.cache = &c;
	ck_assert_msg(host_open(&h, &r, &e) == RNEA_OK, "%s", e.message);
	return h;
}

struct rnea_error fail_open(const struct host_request *r)
{
	struct rnea_error e = {0};
	struct host h;

	ck_assert_int_ne(host_open(&h, r, &e), RNEA_OK);
	ck_assert_ptr_null(h.handle);
	return e;
}

struct rnea_error fail_pendulum(void)
{
	char *text = pendulum_with("", "");
	struct host_request r = pendulum_request(text);
	struct rnea_error e = fail_open(&r);

	free(text);
	return e;
}

void assert_error(const struct rnea_error *e, enum rnea_code code, const char *part)
{
	ck_assert_msg(e->code == code, "code %d where %d is right: %s", (int)e->code, (int)code, e->message);
	ck_assert_msg(strstr(e->message, part) != NULL, "\"%s\" is not in \"%s\"", part, e->message);
	ck_assert_ptr_null(strchr(e->message, '\n'));
}

void assert_fails(enum rnea_code code, const char *part)
{
	struct rnea_error e = fail_pendulum();

	assert_error(&e, code, part);
}

void assert_script_fails(const char *script, enum rnea_code code, const char *part)
{
	use_script("compiler", script);
	assert_fails(code, part);
}

void assert_torques(const struct host *h, double inertia, double weight)
{
	float q[3] = {0, 0.5f, -3}, qd[3] = {1, 2, 3}, qdd[3] = {1, -2, 0.25f}, tau[3] = {NAN, NAN, NAN};
	void *arrays[] = {q, qd, qdd, tau};

	host_run(h, &(struct host_function){host_find(h, "pendulum", "rnea"), 0}, arrays, 3);
	for (int k = 0; k < 3; k++)
		ck_assert_double_eq_tol((double)tau[k], inertia * (double)qdd[k] + weight * sin((double)q[k]), 1e-5);
}

int main(void)
{
	SRunner *r = srunner_create(suite_host_run());
	int bad;

	srunner_add_suite(r, suite_host_load());
	srunner_add_suite(r, suite_host_compiler());
	srunner_add_suite(r, suite_host_names());
	srunner_add_suite(r, suite_host_texts());
	srunner_add_suite(r, suite_workers());
	srunner_run_all(r, CK_ENV);
	bad = srunner_ntests_failed(r);
	srunner_free(r);
	return bad != 0;
}
