#ifndef RNEAGEN_PENDING_H
#define RNEAGEN_PENDING_H
/* Output files of the commands that appear whole or not at all: a file is written under a name of its own in the same
   folder and takes its final name when it is complete. Where that is a symbolic link, the file is the one that it leads to.
   Devices and pipes, such as /dev/null, are written in place, and so are open files by their names in /dev, such as
   /dev/stdout, whatever they are. What takes the place of a file has its mode. A file that is still pending is removed when
   SIGINT, SIGTERM, SIGHUP, SIGPIPE or SIGXCPU ends the program. */

#include "base/error.h"
#include <stdio.h>
#include <sys/types.h>

enum { PENDING_PATH = 4096 }; /* bytes of a path, as the system has it */

struct pending {
	const char *path; /* the final name; the caller's, must outlive the file */
	FILE *f;          /* to write to; NULL once closed */
	char *temporary;  /* its name till then, malloc'ed; NULL if the file is written in place */
	char *target;     /* private, as the rest: what `path` leads to, malloc'ed; NULL as before */
	int stays;        /* it is not removed */
	dev_t device;
	ino_t inode;
};

/* The file that a name stands for: where symbolic links lead, and what is there need not exist; or the name itself. Returns 0,
   or the errno of links that lead to one another or to names that are too long. */
int pending_target(const char *path, char target[PENDING_PATH]);

/* Would a file of this name be written in place? */
int pending_is_in_place(const char *path);

/* Begin a file. On failure *p is empty. Errors: WRITE, LIMIT (too many at once), MEMORY. */
enum rneagen_code pending_open(struct pending *p, const char *path, struct rneagen_error *e);

/* Could a file of this name be begun? It is found out, and nothing is left. Errors: as pending_open. */
enum rneagen_code pending_try(const char *path, struct rneagen_error *e);

/* Begin a file that others, who know its final name alone, write to as well: it is called PATH.part, and what another
   run left there is replaced. `keeps`: it is there, its contents stay, and so does it on failure. Errors: as
   pending_open. */
enum rneagen_code pending_open_part(struct pending *p, const char *path, int keeps, struct rneagen_error *e);

/* Of such a file that another process has begun: a signal that ends this one removes it, too. Errors: as pending_open. */
enum rneagen_code pending_watch_part(struct pending *p, const char *path, struct rneagen_error *e);

/* From now on the file stays where this fails or a signal ends the program. */
void pending_keep(struct pending *p);

/* No longer this process's: nothing is done to the file. An empty *p is a no-op. */
void pending_forget(struct pending *p);

/* Close the file: all of it is with the system then. On failure it is gone. Error: WRITE. */
enum rneagen_code pending_close(struct pending *p, struct rneagen_error *e);

/* Give the closed file its final name. On failure it is gone. Error: WRITE. */
enum rneagen_code pending_publish(struct pending *p, struct rneagen_error *e);

/* Remove the file, unless it was published; an empty *p is a no-op. */
void pending_drop(struct pending *p);

/* What else is to be removed when a signal ends the program, from now on: what the function does a handler may do. */
void pending_also(void (*removes)(void));

/* "PATH: cannot be written: " and what errno says. Error: WRITE. */
enum rneagen_code pending_fail(const char *path, struct rneagen_error *e);

#endif
