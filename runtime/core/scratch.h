#ifndef RNEA_SCRATCH_H
#define RNEA_SCRATCH_H
/* A private folder for files that are needed for a moment, and files read and written whole. */

#include <stddef.h>

struct scratch {
	char folder[1024]; /* "": there is none */
};

/* Make one, for this user alone, below TMPDIR (if that is an absolute path of bearable length), else below /tmp.
   Returns 0, or the errno; s->folder is then "". */
int scratch_make(struct scratch *s);

/* Remove it with all that is in it. */
void scratch_remove(struct scratch *s);

/* For a program's own handler of a signal that ends it: remove all that there are, with the files in them. */
void scratch_abandon(void);

/* Write a new file. Returns 0, or the errno. */
int scratch_write(const char *path, const void *data, size_t size);

/* The whole of a file, malloc, and a NUL after it. Returns 0, or the errno. */
int scratch_read(const char *path, char **data, size_t *size);

/* Write everything to a descriptor, or read so many bytes from one; EIO where it ends before. Returns 0, or the errno. */
int scratch_fill(int fd, const void *data, size_t size);
int scratch_take(int fd, void *data, size_t size);

#endif
