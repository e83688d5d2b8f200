/* nftw */
#define _GNU_SOURCE
#include "core/scratch.h"
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int make_below(struct scratch *s, const char *parent)
{
	/* the names of files in it, and of what a compiler makes beside them, have to fit too */
	if (parent[0] != '/' || strlen(parent) > sizeof s->folder - sizeof "/rnea-XXXXXX")
		return EINVAL;
	snprintf(s->folder, sizeof s->folder, "%s/rnea-XXXXXX", parent);
	if (mkdtemp(s->folder))
		return 0;
	s->folder[0] = '\0';
	return errno;
}

int scratch_make(struct scratch *s)
{
	const char *parent = getenv("TMPDIR");

	s->folder[0] = '\0';
	if (parent && make_below(s, parent) == 0)
		return 0;
	return make_below(s, "/tmp");
}

static int remove_entry(const char *path, const struct stat *about, int type, struct FTW *where)
{
	(void)about;
	(void)type;
	(void)where;
	remove(path);
	return 0;
}

void scratch_remove(struct scratch *s)
{
	if (s->folder[0])
		nftw(s->folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
	s->folder[0] = '\0';
}

int scratch_fill(int fd, const void *data, size_t size)
{
	const char *next = data;
	ssize_t n;

	for (; size; next += n, size -= (size_t)n) {
		do
			n = write(fd, next, size);
		while (n < 0 && errno == EINTR);
		if (n <= 0)
			return n ? errno : EIO;
	}
	return 0;
}

int scratch_take(int fd, void *data, size_t size)
{
	char *next = data;
	ssize_t n;

	for (; size; next += n, size -= (size_t)n) {
		do
			n = read(fd, next, size);
		while (n < 0 && errno == EINTR);
		if (n <= 0)
			return n ? errno : EIO;
	}
	return 0;
}

int scratch_write(const char *path, const void *data, size_t size)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600), e;

	if (fd < 0)
		return errno;
	e = scratch_fill(fd, data, size);
	if (close(fd) != 0 && !e)
		e = errno;
	return e;
}

int scratch_read(const char *path, char **data, size_t *size)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK), e = 0;
	struct stat about;

	*data = NULL;
	*size = 0;
	if (fd < 0)
		return errno;
	if (fstat(fd, &about) != 0)
		e = errno;
	else if (!S_ISREG(about.st_mode))
		e = EINVAL;
	else if (!(*data = calloc((size_t)about.st_size + 1, 1)))
		e = ENOMEM;
	else
		e = scratch_take(fd, *data, *size = (size_t)about.st_size);
	close(fd);
	if (e) {
		free(*data);
		*data = NULL;
	}
	return e;
}
