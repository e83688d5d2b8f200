#include "core/log.h"
#include <stdlib.h>
#include <string.h>

/* Whether the `length` bytes at `line` report an error: "x.cu(12): error: ...", "ptxas error   : ...". */
static int reports_error(const char *line, size_t length)
{
	for (size_t i = 1; i + 5 < length; i++)
		if (line[i - 1] == ' ' && strncmp(line + i, "error", 5) == 0 && strchr(": #", line[i + 5]))
			return 1;
	return 0;
}

int log_find_error(const char *log, struct log_error *found)
{
	const char *line = log;
	size_t length = strcspn(line, "\n");

	memset(found, 0, sizeof *found);
	while (*line && !reports_error(line, length)) {
		line += length + (line[length] == '\n');
		length = strcspn(line, "\n");
	}
	if (!*line)
		return 0;
	found->line = line;
	found->line_length = length;
	found->quoted = line + length;
	found->quoted += strspn(found->quoted, " \t\n");
	/* gcc quotes behind the number of the line: "   12 |     x = y;" */
	length = strspn(found->quoted, "0123456789");
	if (length && strncmp(found->quoted + length, " | ", 3) == 0)
		found->quoted += length + 3 + strspn(found->quoted + length + 3, " \t");
	found->quoted_length = strcspn(found->quoted, "\n");
	return 1;
}

static size_t count(const char *log, const char *part)
{
	size_t n = 0;

	for (const char *s = log; (s = strstr(s, part)) != NULL; s += strlen(part))
		n++;
	return n;
}

char *log_replace(const char *log, const char *from, const char *to)
{
	char *copy = malloc(strlen(log) + count(log, from) * strlen(to) + 1), *end = copy;
	const char *s = log, *next;

	if (!copy)
		return NULL;
	for (; (next = strstr(s, from)) != NULL; s = next + strlen(from)) {
		memcpy(end, s, (size_t)(next - s));
		end += next - s;
		memcpy(end, to, strlen(to));
		end += strlen(to);
	}
	memcpy(end, s, strlen(s) + 1);
	return copy;
}
