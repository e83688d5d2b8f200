#define _POSIX_C_SOURCE 200809L
#include "files.h"
#include "robot.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Read on to the end, or to one byte past what a URDF may have. */
static enum rneagen_code read_stream(FILE *f, const char *path, struct file_content *content, struct rneagen_error *e)
{
	size_t capacity = 0;

	for (;;) {
		size_t n;

		if (content->length == capacity) {
			char *wider = realloc(content->bytes, capacity = capacity ? capacity * 2 : 65536);

			if (!wider)
				return error_memory(e);
			content->bytes = wider;
		}
		n = fread(content->bytes + content->length, 1, capacity - content->length, f);
		content->length += n;
		if (content->length > LIMIT_FILE_BYTES)
			return error_set(e, RNEAGEN_LIMIT, "%s: larger than the limit of %d bytes", path, LIMIT_FILE_BYTES);
		if (n == 0)
			break;
	}
	return ferror(f) ? error_set(e, RNEAGEN_READ, "%s: cannot be read: %s", path, strerror(errno)) : RNEAGEN_OK;
}

enum rneagen_code file_read(const char *path, struct file_content *content, struct rneagen_error *e)
{
	int is_stdin = !strcmp(path, "-");
	FILE *f = is_stdin ? stdin : fopen(path, "rb");

	*content = (struct file_content){0};
	if (!f)
		return error_set(e, RNEAGEN_READ, "%s: cannot be opened: %s", path, strerror(errno));
	read_stream(f, is_stdin ? "<stdin>" : path, content, e);
	if (!is_stdin)
		fclose(f);
	return e->code;
}

static enum rneagen_code fail_write(const char *path, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_WRITE, "%s: cannot be written: %s", path, strerror(errno));
}

/* A complete file under a name of its own in the same folder; the name is malloc'ed. Devices such as /dev/null cannot
   be replaced and are written in place: then the name is NULL. */
static enum rneagen_code write_temporary(const char *path, const char *s, char **temporary, struct rneagen_error *e)
{
	size_t length = strlen(path);
	struct stat st;
	char *name = NULL;
	FILE *f = NULL;
	int in_place = !stat(path, &st) && !S_ISREG(st.st_mode), fd, bad;

	*temporary = NULL;
	if (in_place) {
		f = fopen(path, "wb");
	} else {
		name = malloc(length + sizeof ".XXXXXX");
		if (!name)
			return error_memory(e);
		strcpy(stpcpy(name, path), ".XXXXXX");
		fd = mkstemp(name);
		if (fd >= 0) {
			mode_t mask = umask(0);

			umask(mask);
			fchmod(fd, 0666 & ~mask);
			f = fdopen(fd, "wb");
		}
	}
	if (!f) {
		fail_write(path, e);
		free(name);
		return e->code;
	}
	bad = fputs(s, f) < 0;
	bad |= fclose(f) != 0;
	if (bad) {
		fail_write(path, e);
		if (name)
			unlink(name);
		free(name);
		return e->code;
	}
	*temporary = name;
	return RNEAGEN_OK;
}

static char *header_path(const char *path)
{
	const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
	size_t stem = dot ? (size_t)(dot - path) : strlen(path);
	char *h = malloc(stem + sizeof ".h");

	if (h) {
		memcpy(h, path, stem);
		strcpy(h + stem, ".h");
	}
	return h;
}

static enum rneagen_code publish(char *temporary, const char *path, struct rneagen_error *e)
{
	if (!temporary)
		return RNEAGEN_OK;
	if (rename(temporary, path)) {
		fail_write(path, e);
		unlink(temporary);
	}
	return e->code;
}

enum rneagen_code file_write_pair(const char *path, const char *source, const char *header, struct rneagen_error *e)
{
	char *beside = header ? header_path(path) : NULL, *first = NULL, *second = NULL;

	if (header && !beside)
		return error_memory(e);
	if (!write_temporary(path, source, &first, e) && (!header || !write_temporary(beside, header, &second, e))) {
		if (!publish(second, beside, e))
			publish(first, path, e);
	}
	if (e->code && first)
		unlink(first);
	free(first);
	free(second);
	free(beside);
	return e->code;
}

int file_put_stdout(const char *s)
{
	int bad = fputs(s, stdout) < 0;

	return fflush(stdout) != 0 || bad;
}

enum rneagen_code file_put_stdout_error(const char *s, struct rneagen_error *e)
{
	return file_put_stdout(s) ? error_set(e, RNEAGEN_WRITE, "standard output: cannot be written: %s", strerror(errno)) : RNEAGEN_OK;
}
