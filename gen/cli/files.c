#define _POSIX_C_SOURCE 200809L
#include "cli/files.h"
#include "cli/pending.h"
#include "urdf/robot.h"
#include <errno.h>
#include <limits.h>
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

/* A complete file that has yet to get its name. */
static enum rneagen_code write_pending(struct pending *p, const char *path, const char *s, struct rneagen_error *e)
{
	if (pending_open(p, path, e))
		return e->code;
	fputs(s, p->f);
	return pending_close(p, e);
}

/* What stands beside `path`: nothing, NULL, where that is a device or a pipe. */
static enum rneagen_code header_path(const char *path, char **header, struct rneagen_error *e)
{
	const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
	size_t stem = dot ? (size_t)(dot - path) : strlen(path);

	*header = NULL;
	if (pending_is_in_place(path))
		return RNEAGEN_OK;
	*header = malloc(stem + sizeof ".h");
	if (!*header)
		return error_memory(e);
	memcpy(*header, path, stem);
	strcpy(*header + stem, ".h");
	return RNEAGEN_OK;
}

enum rneagen_code file_write_pair(const char *path, const char *source, const char *header, struct rneagen_error *e)
{
	char *beside = NULL;
	struct pending first = {0}, second = {0};

	if (header && header_path(path, &beside, e))
		return e->code;
	if (!write_pending(&first, path, source, e) && (!beside || !write_pending(&second, beside, header, e))) {
		if (!pending_publish(&second, e))
			pending_publish(&first, e);
	}
	pending_drop(&first);
	pending_drop(&second);
	free(beside);
	return e->code;
}

/* ---- which file is which ---- */

enum rneagen_code file_note(struct file_names *names, const char *what, const char *path, struct rneagen_error *e)
{
	struct file_name *wider = realloc(names->list, (names->count + 1) * sizeof *wider);

	if (!wider)
		return error_memory(e);
	names->list = wider;
	wider[names->count] = (struct file_name){what, strdup(path)};
	return wider[names->count++].path ? RNEAGEN_OK : error_memory(e);
}

enum rneagen_code file_note_header(struct file_names *names, const char *path, struct rneagen_error *e)
{
	char *beside;

	if (!header_path(path, &beside, e) && beside)
		file_note(names, "the header", beside, e);
	free(beside);
	return e->code;
}

void file_forget(struct file_names *names)
{
	for (size_t i = 0; i < names->count; i++)
		free(names->list[i].path);
	free(names->list);
	*names = (struct file_names){0};
}

int file_has_suffix(const char *path, const char *const *suffixes)
{
	size_t n = strlen(path);

	for (; *suffixes; suffixes++) {
		size_t m = strlen(*suffixes);

		if (n > m && path[n - m - 1] != '/' && !strcmp(path + n - m, *suffixes))
			return 1;
	}
	return 0;
}

/* A regular file, or the folder that one will be in and its name there; links are followed. */
struct place {
	int is_known;
	struct stat st;
	char name[NAME_MAX + 2]; /* "": the file is there */
};

static struct place find_place(const char *path, int is_output)
{
	struct place p = {0};
	char target[PENDING_PATH], *slash;

	if (!strcmp(path, "-"))
		p.is_known = !fstat(is_output ? STDOUT_FILENO : STDIN_FILENO, &p.st) && S_ISREG(p.st.st_mode);
	else if (!stat(path, &p.st))
		p.is_known = S_ISREG(p.st.st_mode);
	else if (is_output && !pending_target(path, target)) {
		slash = strrchr(target, '/');
		snprintf(p.name, sizeof p.name, "%.*s", NAME_MAX + 1, slash ? slash + 1 : target);
		if (slash)
			slash[1] = '\0';
		p.is_known = !stat(slash ? target : ".", &p.st);
	}
	return p;
}

static int same_place(const struct place *a, const struct place *b)
{
	if (!a->is_known || !b->is_known || a->st.st_dev != b->st.st_dev || a->st.st_ino != b->st.st_ino)
		return 0;
	return !strcmp(a->name, b->name);
}

static int is_at(const struct place *p, const struct file_name *n, int is_output)
{
	struct place other = find_place(n->path, is_output);

	return same_place(p, &other);
}

static enum rneagen_code refuse_same(
	const struct file_name *output, const struct file_name *other, int is_input, struct rneagen_error *e)
{
	int is_stdout = !strcmp(output->path, "-");
	const char *what = is_stdout ? "standard output" : output->what, *blank = is_stdout || !*what ? "" : " ";
	const char *name = strcmp(other->path, "-") ? other->path : is_input ? "<stdin>" : "<stdout>";

	return error_set(e, RNEAGEN_USAGE, "%s%s%s is the %s %s%s; name another file", what, blank, is_stdout ? "" : output->path,
		is_input ? "input" : "output", name, is_input ? "" : " as well");
}

static enum rneagen_code check_once(const struct file_names *names, const char *which, const char *done, struct rneagen_error *e)
{
	size_t uses = 0;

	for (size_t i = 0; i < names->count; i++)
		uses += !strcmp(names->list[i].path, "-");
	return uses > 1 ? error_set(e, RNEAGEN_USAGE, "standard %s, -, can be %s once", which, done) : RNEAGEN_OK;
}

enum rneagen_code file_check(const struct file_names *read, const struct file_names *written, struct rneagen_error *e)
{
	if (check_once(read, "input", "read", e) || check_once(written, "output", "written", e))
		return e->code;
	for (size_t i = 0; i < written->count; i++) {
		const struct file_name *output = &written->list[i];
		struct place p = find_place(output->path, 1);

		for (size_t k = 0; k < read->count; k++)
			if (is_at(&p, &read->list[k], 0))
				return refuse_same(output, &read->list[k], 1, e);
		for (size_t k = 0; k < i; k++)
			if (is_at(&p, &written->list[k], 1))
				return refuse_same(output, &written->list[k], 0, e);
	}
	return RNEAGEN_OK;
}

/* ---- standard output ---- */

int file_put_stdout(const char *s)
{
	int bad = fputs(s, stdout) < 0;

	return fflush(stdout) != 0 || ferror(stdout) || bad;
}

enum rneagen_code file_put_stdout_error(const char *s, struct rneagen_error *e)
{
	return file_put_stdout(s) ? error_set(e, RNEAGEN_WRITE, "standard output: cannot be written: %s", strerror(errno))
		: RNEAGEN_OK;
}
