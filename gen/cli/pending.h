#ifndef RNEAGEN_PENDING_H
#define RNEAGEN_PENDING_H
/* Output files of the commands that appear whole or not at all: a file is written under a name of its own in the same
   folder and takes its final name when it is complete. Devices and pipes, such as /dev/null, are written in place, and
   so are open files by their names in /dev, such as /dev/stdout, whatever they are. A file that is still pending is
   removed when SIGINT, SIGTERM or SIGHUP ends the program. */

#include "base/error.h"
#include <stdio.h>

struct pending {
	const char *path; /* the final name; the caller's, must outlive the file */
	FILE *f;          /* to write to; NULL once closed */
	char *temporary;  /* private: malloc'ed; NULL if the file is written in place */
};

/* Would a file of this name be written in place? */
int pending_is_in_place(const char *path);

/* Begin a file. On failure *p is empty. Errors: WRITE, LIMIT (too many at once), MEMORY. */
enum rneagen_code pending_open(struct pending *p, const char *path, struct rneagen_error *e);

/* Close the file: all of it is with the system then. On failure it is gone. Error: WRITE. */
enum rneagen_code pending_close(struct pending *p, struct rneagen_error *e);

/* Give the closed file its final name. On failure it is gone. Error: WRITE. */
enum rneagen_code pending_publish(struct pending *p, struct rneagen_error *e);

/* Remove the file, unless it was published; an empty *p is a no-op. */
void pending_drop(struct pending *p);

/* "PATH: cannot be written: " and what errno says. Error: WRITE. */
enum rneagen_code pending_fail(const char *path, struct rneagen_error *e);

#endif
