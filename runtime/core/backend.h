#ifndef RNEA_BACKEND_H
#define RNEA_BACKEND_H
/* What compiles a text and runs its functions: one record each. To add one, write a folder that defines such a record, name it
   in enum rnea_backend, and enter it in the list of rnea.c; nothing else asks which it is. */

#include "core/source.h"

struct cache;
struct cache_why;

struct backend_request {
	const struct source *source;
	const char *file;                   /* what messages call it */
	const struct rnea_options *options;
	const struct cache *cache;
	struct cache_why *unkept;           /* receives why what is compiled is not kept */
	const struct rnea_evaluator *evaluator; /* what rnea_open_evaluator was given; else NULL */
};

/* Functions are numbers, as in info->functions. */
struct backend {
	enum rnea_backend name;
	const char *symbols; /* what it calls a function: NAME_rnea_SYMBOLS */
	const char *refusal; /* why a text for target c is not for it; NULL: it is */
	int has_streams;     /* launches take one */

	/* Compile the text of `r` or take it from the cache, and load it. On success *info holds the functions that are there,
	   *build what is to be told but for note, unkept and seconds, and *state what `close` takes; both it and the robot's info
	   and options stay where they are. On failure *state is NULL and *info empty; *absent says whether this machine has
	   nothing of the backend. */
	enum rnea_code (*open)(void **state, const struct backend_request *r, struct rnea_info *info, struct rnea_build *build,
		int *absent, struct rnea_error *e);
	void (*close)(void *state);

	/* rnea_launch_kernel and rnea_run, of the first function: the pointers are checked, `count` is not 0. */
	enum rnea_code (*launch)(
		const void *state, size_t function, void *const *arrays, size_t count, void *stream, struct rnea_error *e);
	enum rnea_code (*run)(const void *state, void *const *arrays, size_t count, struct rnea_error *e);
	/* The same of a text of layout soa on arrays [sample][row]; NULL: it cannot. */
	enum rnea_code (*run_aos)(const void *state, void *const *arrays, size_t count, struct rnea_error *e);

	/* Of a kernel; NULL: it has none. */
	struct rnea_resources (*resources)(const void *state, size_t function);
};

#endif
