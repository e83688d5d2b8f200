#ifndef RNEA_SOURCE_H
#define RNEA_SOURCE_H
/* A generated text, before anything is compiled. */

#include "core/failure.h"

enum { SOURCE_NAME_LIMIT = 255, SOURCE_FUNCTION_LIMIT = 63, SOURCE_SYMBOL_SIZE = SOURCE_NAME_LIMIT + SOURCE_FUNCTION_LIMIT + 10 };

struct source {
	char *text;			  /* NUL-terminated, malloc */
	char name[SOURCE_NAME_LIMIT + 1]; /* the NAME of its NAME_info */
	int is_cuda;			  /* target cuda: it has kernels; else target c */
};

/* Copy `length` bytes of a text and find its name. On success *s is to be released with source_free, on failure it is
   empty. `file` is for messages. Errors: TEXT, MEMORY. */
enum rnea_code source_copy(struct source *s, const char *text, size_t length, const char *file, struct rnea_error *e);

/* The same for the file at `path`. Errors: also READ. */
enum rnea_code source_read(struct source *s, const char *path, struct rnea_error *e);

/* The bytes of the file at `path` (malloc, *length of them and a NUL). Errors: READ, MEMORY. */
enum rnea_code source_bytes(const char *path, char **text, size_t *length, struct rnea_error *e);

/* What the text of robot `name` calls a function where a backend has it, by the backend's kind: NAME_rnea_kernel,
   NAME_fpass_slice. */
void source_symbol(const char *name, const char *function, const char *kind, char symbol[SOURCE_SYMBOL_SIZE]);

void source_free(struct source *s);

#endif
