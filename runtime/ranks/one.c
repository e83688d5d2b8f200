/* One process, alone. */
#define _POSIX_C_SOURCE 200809L
#include "ranks/ranks.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct ranks_file {
	int fd;
	const char *shown;
};

int ranks_open(struct ranks *r, int *argc, char ***argv)
{
	(void)argc, (void)argv;
	*r = (struct ranks){.count = 1, .local_count = 1, .room = calloc(1, RANKS_ROOM)};
	if (!r->room)
		fprintf(stderr, "rnearun: out of memory\n");
	return r->room != NULL;
}

void ranks_close(struct ranks *r)
{
	free(r->room);
}

void ranks_gather(struct ranks *r, const void *mine, size_t size, void *all)
{
	(void)r;
	memcpy(all, mine, size);
}

void ranks_meet(struct ranks *r)
{
	(void)r;
}

void ranks_release(struct ranks *r, int shows)
{
	(void)r, (void)shows;
}

/* ---- files ---- */

static enum rneagen_code fail(const char *shown, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_WRITE, "%s: cannot be written: %s", shown, strerror(errno));
}

enum rneagen_code ranks_file_open(
	struct ranks_file **f, struct ranks *r, const char *path, const char *shown, struct rneagen_error *e)
{
	(void)r;
	if (!(*f = malloc(sizeof **f)))
		return error_memory(e);
	**f = (struct ranks_file){open(path, O_WRONLY | O_CLOEXEC), shown};
	if ((*f)->fd >= 0)
		return RNEAGEN_OK;
	fail(shown, e);
	free(*f);
	*f = NULL;
	return e->code;
}

enum rneagen_code ranks_file_sync(struct ranks_file *f, struct rneagen_error *e)
{
	return fdatasync(f->fd) ? fail(f->shown, e) : RNEAGEN_OK;
}

enum rneagen_code ranks_file_close(struct ranks_file *f, struct rneagen_error *e)
{
	if (f && close(f->fd))
		fail(f->shown, e);
	free(f);
	return e->code;
}

enum rneagen_code ranks_file_write(
	struct ranks_file *f, const void *bytes, size_t size, uint64_t at, struct rneagen_error *e)
{
	for (size_t done = 0; done < size;) {
		ssize_t n = pwrite(f->fd, (const char *)bytes + done, size - done, (off_t)(at + done));

		if (n < 0 && errno != EINTR)
			return fail(f->shown, e);
		done += n > 0 ? (size_t)n : 0;
	}
	return RNEAGEN_OK;
}
