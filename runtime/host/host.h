#ifndef RNEA_HOST_H
#define RNEA_HOST_H
/* The host backend: a text compiled by the machine's C compiler to a shared object, in this process. */

#include "cache/cache.h"
#include "core/child.h"
#include "core/failure.h"
#include "core/workers.h"
#include <stddef.h>

struct host_request {
	const char *source;	    /* NUL-terminated: target cuda or c */
	const char *file;	    /* what messages call it */
	const char *name;	    /* NAME of NAME_info */
	const char *const *options; /* further options for the compiler, option_count of them */
	size_t option_count;
	const struct cache *cache;
	struct cache_why *unkept; /* receives why what is compiled is not kept; may be NULL */
	unsigned threads; /* 0: one for each processor */
	char *log;	  /* as in struct rnea_options; the caller has emptied it */
	size_t log_size;
	struct child_stop stop;
};

/* Samples `first` to `end` - 1 of a batch of `count`; `arrays` in the order of the function's signature. */
typedef void host_slice(void *const *arrays, size_t count, size_t first, size_t end);

struct host_function {
	host_slice *slice;
	double sample_ns; /* that a sample takes one thread, about (host_sample_ns); 0: a run takes one thread */
};

struct host {
	void *handle;			       /* of dlopen */
	const char *info;		       /* NAME_info; belongs to the handle */
	struct workers *workers;
	unsigned threads; /* that a run may use */
	int cached;
	char compiler[512]; /* "gcc (Debian 12.2.0-14) 12.2.0 (/usr/bin/gcc)"; "": it came from the cache */
};

/* Compile, or take from the cache, and load. On failure *h is empty. Errors: NO_COMPILER (lists what was tried),
   COMPILER (it cannot be run, or was killed; the shared object does not load), COMPILE (the message has the first error
   and its line), TEXT (the object lacks what a text of rneagen has), MEMORY. */
enum rnea_code host_open(struct host *h, const struct host_request *r, struct rnea_error *e);
void host_close(struct host *h);

/* What the object is kept by in the cache: free key->data. Errors: MEMORY. */
struct compiler;
struct host_key {
	char *data; /* NULL: nothing is kept */
	size_t size;
};
enum rnea_code host_key(
	struct host_key *key, const struct host_request *r, const struct compiler *c, struct rnea_error *e);

/* NAME_FUNCTION_slice; NULL: the text has none. */
host_slice *host_find(const struct host *h, const char *name, const char *function);

/* Nanoseconds that one sample among many takes one thread of a usual processor: by the operations and arrays that the
   table states, so that it is the same everywhere and at every run. */
double host_sample_ns(const struct rnea_info *info, const struct rnea_function *f);

/* How many threads a batch is worth: one more for every 50 us of work, up to h->threads. */
unsigned host_threads(const struct host *h, const struct host_function *f, size_t count);

/* Run a function over a whole batch, its slices shared among the threads that it is worth; done when it returns. */
void host_run(const struct host *h, const struct host_function *f, void *const *arrays, size_t count);

#endif
