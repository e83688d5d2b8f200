#ifndef RNEAGEN_FILES_H
#define RNEAGEN_FILES_H
/* Reading and writing whole files for the command: what is written is written whole or not at all. */

#include "base/error.h"
#include <stddef.h>

struct file_content {
	char *bytes; /* malloc'ed */
	size_t length;
};

/* The whole of a file, or of standard input for "-". Errors: READ, LIMIT, MEMORY. */
enum rneagen_code file_read(const char *path, struct file_content *content, struct rneagen_error *e);

/* Write `source` to `path` and, unless `header` is NULL or `path` is a device or a pipe, `header` beside it with suffix
   .h. Temporary files are renamed once both are complete; on failure neither exists anew. Error: WRITE. */
enum rneagen_code file_write_pair(const char *path, const char *source, const char *header, struct rneagen_error *e);

/* The files that a command line names, by what it reads or by what it writes. */
struct file_names {
	struct file_name {
		const char *what; /* the option, for messages; "" where the name stands alone */
		char *path;       /* "-": standard input or output */
	} *list;
	size_t count;
};

/* Add a file, and for a file that is written with a header beside it that header as well. Error: MEMORY. */
enum rneagen_code file_note(struct file_names *names, const char *what, const char *path, struct rneagen_error *e);
enum rneagen_code file_note_header(struct file_names *names, const char *path, struct rneagen_error *e);

/* Does each file that is written take the place of none that is read, nor of another that is written? Files are the same
   by device and inode, whatever they are called; those that are not there yet, by folder and name. Devices and pipes may
   serve twice, standard input and output once each. Error: USAGE. */
enum rneagen_code file_check(const struct file_names *read, const struct file_names *written, struct rneagen_error *e);

void file_forget(struct file_names *names);

/* Does the name end in one of these suffixes (NULL ends the list), ".h" in "robot.h"? */
int file_has_suffix(const char *path, const char *const *suffixes);

/* Write to standard output and flush. Error: WRITE (a full disk, a closed pipe). */
enum rneagen_code file_put_stdout_error(const char *s, struct rneagen_error *e);
int file_put_stdout(const char *s);

#endif
