#ifndef TEST_RUNTIME_CACHE_H
#define TEST_RUNTIME_CACHE_H
/* The suites of test_runtime_cache and what they share. */

#include "cache/cache.h"
#include <check.h>
#include <stdint.h>
#include <sys/types.h>
#include <time.h>

Suite *suite_cache_folder(void);
Suite *suite_cache_entry(void);
Suite *suite_cache_fault(void);
Suite *suite_cache_race(void);

/* A folder of the test's own, made and removed by the fixture; the variables of the environment are unset. */
extern char sandbox[256];
void sandbox_make(void);
void sandbox_remove(void);

/* "SANDBOX/name"; one of eight buffers in turn. */
const char *inside(const char *name);

/* A cache in that folder of the sandbox. */
struct cache cache_in(const char *name);

/* put and get of strings: 1 a hit with this text, 0 a miss, -1 something else, which get_is asserts that it is not; a
   process that a test has started asserts nothing, for Check's messages are of one process. */
int put_text(const struct cache *c, const char *key, const char *text);
int get_text(const struct cache *c, const char *key, const char *text);
int get_is(const struct cache *c, const char *key, const char *text);

/* Where the entry of a key is, by a hash written for the tests; its whole content, malloc. */
const char *entry_path(const struct cache *c, const void *key, size_t key_size);
char *entry_read(const char *path, size_t *size);
void entry_write(const char *path, const void *content, size_t size);

/* FNV-1a, 64 bits, of `h` and then the data. */
uint64_t fnv(uint64_t h, const void *data, size_t size);
#define FNV_START UINT64_C(14695981039346656037)

/* Files in the folder whose name starts with `prefix` and goes on with one of `next` ("": any). */
int count_files(const char *folder, const char *prefix, const char *next);
int count_entries(const char *folder);
int count_temporaries(const char *folder);

/* Run `work` in a process of its own; its exit status, or 128 + the signal. 77: what it needs is not to be had. */
enum { CANNOT = 77 };
int run_child(int (*work)(void *), void *context);

/* Become a user without rights and give it the sandbox first; 0 if this process is not root or may not. */
int become_nobody(void);

/* Linked with --wrap, for the calling thread: the call with number fail_at (from 1; 0: none) fails with `error`, and that
   with number die_at is not made: the process is killed. */
enum fault { FAULT_MALLOC, FAULT_WRITE, FAULT_CLOSE, FAULT_RENAME, FAULT_OPEN, FAULT_READ, FAULT_COUNT };
struct faults {
	long fail_at[FAULT_COUNT], die_at[FAULT_COUNT], calls[FAULT_COUNT];
	int error;
	size_t most;		   /* a read or write moves no more bytes than this; 0: any number */
	size_t allocated;	   /* the largest request */
	int eintr;		   /* every other read and write is interrupted */
	void (*before_read)(void); /* called once */
	struct timespec time;	   /* what the clock says; 0: what it is */
};
extern _Thread_local struct faults faults;
void faults_clear(void);

#endif
