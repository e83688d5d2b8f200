#include "core/source.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char marker[] = "RNEA_INFO const char ";
static const char suffix[] = "_info[] =";

static size_t identifier_length(const char *s)
{
	return strspn(s, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_");
}

/* The line that defines NAME_info, after its marker; NULL if there is none. */
static const char *find_marker(const char *text)
{
	const char *s = text;

	while ((s = strstr(s, marker)) != NULL && s != text && s[-1] != '\n')
		s++;
	return s ? s + strlen(marker) : NULL;
}

static enum rnea_code find_name(struct source *s, const char *file, struct rnea_error *e)
{
	const char *name = find_marker(s->text);
	size_t tail = strlen("_info");
	size_t length = name ? identifier_length(name) : 0;

	if (!name)
		return rnea_error_set(e, RNEA_TEXT,
			"%s: not a text of rneagen for target cuda or c: no line starts with \"%sNAME%s\"", file, marker,
			suffix);
	if (length <= tail || strncmp(name + length - tail, suffix, strlen(suffix)) != 0)
		return rnea_error_set(e, RNEA_TEXT, "%s: no identifier that ends in _info after \"%s\"", file, marker);
	length -= tail;
	if (length > SOURCE_NAME_LIMIT)
		return rnea_error_set(
			e, RNEA_TEXT, "%s: the name of the robot has more than %d characters", file, SOURCE_NAME_LIMIT);
	memcpy(s->name, name, length);
	s->name[length] = '\0';
	s->is_cuda = strstr(s->text, "\nextern \"C\" __global__ ") != NULL;
	return RNEA_OK;
}

/* Take over `text`, of `length` bytes and a NUL. */
static enum rnea_code take(struct source *s, char *text, size_t length, const char *file, struct rnea_error *e)
{
	s->text = text;
	if (strlen(text) != length)
		rnea_error_set(e, RNEA_TEXT, "%s: not a text: byte %zu is a NUL", file, strlen(text));
	else
		find_name(s, file, e);
	if (e->code)
		source_free(s);
	return e->code;
}

enum rnea_code source_copy(struct source *s, const char *text, size_t length, const char *file, struct rnea_error *e)
{
	char *copy = malloc(length + 1);

	memset(s, 0, sizeof *s);
	if (!copy)
		return rnea_error_memory(e);
	memcpy(copy, text, length);
	copy[length] = '\0';
	return take(s, copy, length, file, e);
}

/* The whole of `f` with a NUL after it, whatever `f` is; NULL when memory runs out. */
static char *read_all(FILE *f, size_t *length)
{
	size_t capacity = 1 << 16;
	char *text = malloc(capacity), *more;

	for (*length = 0; text; text = more) {
		*length += fread(text + *length, 1, capacity - 1 - *length, f);
		text[*length] = '\0';
		if (*length < capacity - 1)
			return text;
		capacity *= 2;
		if (!(more = realloc(text, capacity)))
			free(text);
	}
	return NULL;
}

enum rnea_code source_bytes(const char *path, char **text, size_t *length, struct rnea_error *e)
{
	FILE *f = fopen(path, "rb");
	int reason;

	*text = NULL;
	if (!f)
		return rnea_error_set(e, RNEA_READ, "%s: %s", path, strerror(errno));
	errno = 0;
	*text = read_all(f, length);
	reason = ferror(f) ? errno : 0;
	fclose(f);
	if (!*text)
		return rnea_error_memory(e);
	if (!reason)
		return RNEA_OK;
	free(*text);
	*text = NULL;
	return rnea_error_set(e, RNEA_READ, "%s: %s", path, strerror(reason));
}

enum rnea_code source_read(struct source *s, const char *path, struct rnea_error *e)
{
	size_t length;
	char *text;

	memset(s, 0, sizeof *s);
	return source_bytes(path, &text, &length, e) ? e->code : take(s, text, length, path, e);
}

void source_symbol(const char *name, const char *function, const char *kind, char symbol[SOURCE_SYMBOL_SIZE])
{
	snprintf(symbol, SOURCE_SYMBOL_SIZE, "%.*s_%.*s_%s", SOURCE_NAME_LIMIT, name, SOURCE_FUNCTION_LIMIT, function, kind);
}

void source_free(struct source *s)
{
	free(s->text);
	memset(s, 0, sizeof *s);
}
