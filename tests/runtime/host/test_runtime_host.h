#ifndef TEST_RUNTIME_HOST_H
#define TEST_RUNTIME_HOST_H
/* The suites of test_runtime_host and what they share. */

#include "host/host.h"
#include <check.h>
#include <stdatomic.h>

Suite *suite_host_run(void);
Suite *suite_host_load(void);
Suite *suite_host_compiler(void);
Suite *suite_host_names(void);
Suite *suite_host_texts(void);
Suite *suite_workers(void);

/* A folder of the test's own, with a folder "tmp" in it that TMPDIR names. At the end nothing may be left in "tmp",
   no descriptor may be open that was not open before, and no text be loaded. */
extern char sandbox[256];
void sandbox_make(void);
void sandbox_remove(void);

/* "SANDBOX/name"; one of eight buffers in turn. */
const char *inside(const char *name);
void write_file(const char *path, const char *text, int mode);

/* Entries of a folder whose names start with `prefix`. */
int count_entries(const char *folder, const char *prefix);

/* Make "SANDBOX/name" a script of this text behind "#!/bin/sh", and RNEA_CC its path. */
void use_script(const char *name, const char *text);

/* tests/runtime/pendulum.c, malloc, with the first `from` replaced by `to`. */
char *pendulum_with(const char *from, const char *to);

/* Open a text of the pendulum, called text.c in messages, with a cache in "SANDBOX/cache" or none. */
struct host_request pendulum_request(const char *text);
struct host open_pendulum(void);
/* For so many threads at most. */
struct host open_pendulum_slow(unsigned threads);
struct host open_cached(const char *text);

/* Opening fails; nothing is left. */
struct rnea_error fail_open(const struct host_request *r);
struct rnea_error fail_pendulum(void);
void assert_error(const struct rnea_error *e, enum rnea_code code, const char *part);

/* Opening the pendulum with the compiler in RNEA_CC, or with this script, fails so. */
void assert_fails(enum rnea_code code, const char *part);
void assert_script_fails(const char *script, enum rnea_code code, const char *part);

/* tau(q, qdd) of a robot at hand for some samples; inertia times qdd and weight times sin q are what it should be. */
void assert_torques(const struct host *h, double inertia, double weight);

/* Linked with --wrap. */
struct faults {
	long allocations; /* the one after so many more fails, and every later one; -1: none */
	int allocation_failed;
	int no_memfd, no_folder; /* memfd_create and mkdtemp fail with this errno */
	int damage;		 /* what cache_get finds: 1 garbage, 2 an object without the text's symbols */
	int no_thread;		 /* pthread_create fails with this errno */
	atomic_int started, joined; /* how many threads pthread_create and pthread_join have seen */
};
extern struct faults faults;

/* What mkdtemp has made for this thread: how many folders, and the last of them. */
struct made {
	int folders;
	char last[1100];
};
extern _Thread_local struct made made;

#endif
