/* nftw and getdents64 */
#define _GNU_SOURCE
#include "core/scratch.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Those that there are, for scratch_abandon: the first of them. A name that is being written is not to be read. */
enum { NOTED = 16, TRIES = 100 };
enum { FREE, WRITING, WHOLE };

static struct note {
	atomic_int state;
	char folder[sizeof(struct scratch)];
} notes[NOTED];

static void note(const char *folder)
{
	for (int i = 0; i < NOTED; i++) {
		int state = FREE;

		if (atomic_compare_exchange_strong(&notes[i].state, &state, WRITING)) {
			strcpy(notes[i].folder, folder);
			atomic_store(&notes[i].state, WHOLE);
			return;
		}
	}
}

static void forget(const char *folder)
{
	for (int i = 0; i < NOTED; i++)
		if (atomic_load(&notes[i].state) == WHOLE && !strcmp(notes[i].folder, folder))
			atomic_store(&notes[i].state, FREE);
}

static int make_below(struct scratch *s, const char *parent)
{
	/* the names of files in it, and of what a compiler makes beside them, have to fit too */
	if (parent[0] != '/' || strlen(parent) > sizeof s->folder - sizeof "/rnea-XXXXXX")
		return EINVAL;
	snprintf(s->folder, sizeof s->folder, "%s/rnea-XXXXXX", parent);
	if (mkdtemp(s->folder)) {
		note(s->folder);
		return 0;
	}
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
	if (s->folder[0]) {
		nftw(s->folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
		forget(s->folder);
	}
	s->folder[0] = '\0';
}

/* The files of a folder. nftw and opendir take memory, which a handler may not. */
static void empty(int folder)
{
	_Alignas(struct dirent64) char entries[4096];
	ssize_t size;

	lseek(folder, 0, SEEK_SET);
	while ((size = getdents64(folder, entries, sizeof entries)) > 0)
		for (ssize_t at = 0; at < size; at += ((struct dirent64 *)(entries + at))->d_reclen)
			unlinkat(folder, ((struct dirent64 *)(entries + at))->d_name, 0);
}

/* Again where a compiler that still runs has made a file meanwhile; once the folder is gone it cannot. */
static void abandon(const char *path)
{
	int folder = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);

	for (int i = 0; folder >= 0 && i < TRIES; i++) {
		empty(folder);
		if (!rmdir(path) || errno != ENOTEMPTY)
			break;
	}
	if (folder >= 0)
		close(folder);
}

void scratch_abandon(void)
{
	for (int i = 0; i < NOTED; i++)
		if (atomic_load(&notes[i].state) == WHOLE)
			abandon(notes[i].folder);
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
