#include "scene/scene_lines.h"
#include <string.h>

static void put_quoted(const char *value, struct text *out)
{
	text_putc(out, '"');
	for (const char *s = value; *s; s++) {
		if (*s == '"' || *s == '\\' || *s == '\n')
			text_putc(out, '\\');
		text_putc(out, *s == '\n' ? 'n' : *s);
	}
	text_putc(out, '"');
}

void scene_put_line(enum scene_key key, const char *value, struct text *out)
{
	text_printf(out, value ? "--%s " : "--%s", scene_word(key));
	if (value)
		put_quoted(value, out);
}

void scene_put_file(const char *path, struct text *out)
{
	text_put(out, SCENE_OF_FILE);
	put_quoted(strcmp(path, "-") ? path : "standard input", out);
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
	text_putc(out, '\n');
	if (!*line || *line == '#')
		return 1;
	is_quoted = *line == '"';
	pair = is_quoted ? join_quoted(line) : join_plain(line);
	if (!pair)
		return 0;
	text_printf(out, "%s ", scene_word(SCENE_ARMATURE));
	if (is_quoted) /* what is escaped there stays so */
		text_printf(out, "\"%s\"", pair);
	else
		put_quoted(pair, out);
	return 1;
}

enum rneagen_code scene_put_armature(const char *path, char *content, struct text *out, struct rneagen_error *e)
{
	int number = 0;
	char *next;

	scene_put_file(path, out);
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
