#ifndef RNEA_SOURCE_H
#define RNEA_SOURCE_H
/* A generated text, before anything is compiled. */

#include "error.h"

enum { SOURCE_NAME_LIMIT = 255 };

struct source {
	char *text; /* NUL-terminated, malloc */
	char name[SOURCE_NAME_LIMIT + 1]; /* the NAME of its NAME_info */
};

/* Copy `length` bytes of a text and find its name. On success *s is to be released with source_free, on failure it is
   empty. `file` is for messages. Errors: TEXT, MEMORY. */
enum rnea_code source_copy(
	struct source *s, const char *text, size_t length, const char *file, struct rnea_error *e);

/* The same for the file at `path`. Errors: also READ. */
enum rnea_code source_read(struct source *s, const char *path, struct rnea_error *e);

void source_free(struct source *s);

#endif
