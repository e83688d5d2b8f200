#define _POSIX_C_SOURCE 200809L
#include "files.h"
#include "pending.h"
#include "robot.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* A complete file that has yet to get its name. */
static enum rneagen_code write_pending(struct pending *p, const char *path, const char *s, struct rneagen_error *e)
{
	if (pending_open(p, path, e))
		return e->code;
	fputs(s, p->f);
	return pending_close(p, e);
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

enum rneagen_code file_write_pair(const char *path, const char *source, const char *header, struct rneagen_error *e)
{
	char *beside = header ? header_path(path) : NULL;
	struct pending first = {0}, second = {0};

	if (header && !beside)
		return error_memory(e);
	if (!write_pending(&first, path, source, e) && (!header || !write_pending(&second, beside, header, e))) {
		if (!pending_publish(&second, e))
			pending_publish(&first, e);
	}
	pending_drop(&first);
	pending_drop(&second);
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
