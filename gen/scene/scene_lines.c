#include "scene/scene_lines.h"
#include <string.h>

void scene_put_line(enum scene_key key, const char *value, struct text *out)
{
	text_printf(out, value ? "--%s \"" : "--%s", scene_word(key));
	for (const char *s = value ? value : ""; *s; s++) {
		if (*s == '"' || *s == '\\' || *s == '\n')
			text_putc(out, '\\');
		text_putc(out, *s == '\n' ? 'n' : *s);
	}
	text_put(out, value ? "\"" : "");
}

/* "JOINT" NUMBER, quoted as in a scene, becomes "JOINT=NUMBER"; NULL if it is none. */
static const char *join_quoted(char *line)
{
	char *quote = line + 1, *value;

	for (; *quote && *quote != '"'; quote++)
		quote += *quote == '\\' && quote[1];
	value = quote + (*quote == '"');
	if (*value != ' ' && *value != '\t')
		return NULL;
	value += strspn(value, " \t");
	*quote = '=';
	memmove(quote + 1, value, strlen(value) + 1);
	return line + 1;
}

/* JOINT NUMBER becomes JOINT=NUMBER; NULL if it is none. */
static const char *join_plain(char *line)
{
	char *value = line + strlen(line);

	while (value > line && !strchr(" \t", value[-1]))
		value--;
	if (value == line)
		return NULL;
	value[-1] = '=';
	return line;
}

/* Returns 0 where a line is no JOINT NUMBER. */
static int put_armature(char *line, struct text *out)
{
	char *end = line + strlen(line);
	const char *pair;
	int is_quoted;

	while (end > line && strchr(" \t\r", end[-1]))
		*--end = '\0';
	line += strspn(line, " \t");
	if (!*line || *line == '#')
		return 1;
	is_quoted = *line == '"';
	pair = is_quoted ? join_quoted(line) : join_plain(line);
	if (!pair)
		return 0;
	text_put(out, out->length ? "\n" : "");
	if (is_quoted) /* what is escaped there stays so */
		text_printf(out, "--%s \"%s\"", scene_word(SCENE_ARMATURE), pair);
	else
		scene_put_line(SCENE_ARMATURE, pair, out);
	return 1;
}

enum rneagen_code scene_put_armature(const char *path, char *content, struct text *out, struct rneagen_error *e)
{
	int number = 0;
	char *next;

	for (char *line = content; line; line = next) {
		next = strchr(line, '\n');
		if (next)
			*next++ = '\0';
		number++;
		if (!put_armature(line, out))
			return error_set(e, RNEAGEN_SCENE, "%s: line %d: '%s' is not JOINT NUMBER", path, number, line);
	}
	return out->failed ? error_memory(e) : RNEAGEN_OK;
}
