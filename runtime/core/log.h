#ifndef RNEA_LOG_H
#define RNEA_LOG_H
/* What a compiler said. */

#include <stddef.h>

/* The line that says what is wrong, and the one after it, which quotes the text; not NUL-terminated. */
struct log_error {
	const char *line, *quoted;
	size_t line_length, quoted_length;
};

/* The first line of `log` that reports an error; 0, and an empty *found, if there is none. */
int log_find_error(const char *log, struct log_error *found);

/* A copy of `log` (malloc) in which `to` stands for every `from`; NULL when memory runs out. */
char *log_replace(const char *log, const char *from, const char *to);

#endif
