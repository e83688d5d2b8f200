#ifndef RNEAGEN_PENDING_NAMES_H
#define RNEAGEN_PENDING_NAMES_H
/* Which file the name of an output stands for, and what it is called till it is complete. */

/* The number of the open file that a name of /dev or /proc stands for; -1: it is another name. */
int pending_number(const char *path);

/* A name for mkstemp, in the folder of `path`, that begins as its own does; or PATH.part. malloc'ed; NULL when memory runs
   out. */
char *pending_temporary_name(const char *path);
char *pending_part_name(const char *path);

#endif
