#ifndef RNEAGEN_FILES_H
#define RNEAGEN_FILES_H
/* Reading and writing whole files for the command: what is written is written whole or not at all. */

#include "error.h"
#include <stddef.h>

struct file_content {
	char *bytes; /* malloc'ed */
	size_t length;
};

/* The whole of a file, or of standard input for "-". Errors: READ, LIMIT, MEMORY. */
enum rneagen_code file_read(const char *path, struct file_content *content, struct rneagen_error *e);

/* Write `source` to `path` and, unless `header` is NULL, `header` beside it with suffix .h. Temporary files are renamed
   once both are complete; on failure neither exists anew. Error: WRITE. */
enum rneagen_code file_write_pair(const char *path, const char *source, const char *header, struct rneagen_error *e);

/* Write to standard output and flush. Error: WRITE (a full disk, a closed pipe). */
enum rneagen_code file_put_stdout_error(const char *s, struct rneagen_error *e);
int file_put_stdout(const char *s);

#endif
