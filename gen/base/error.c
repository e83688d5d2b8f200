#include "base/error.h"
#include "base/text.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 6000 }; /* a path, and what is said of it */

const char *rneagen_code_text(enum rneagen_code code)
{
	static const char *const texts[] = {
#define RNEAGEN_ERROR_TEXT(code, text) text,
		RNEAGEN_ERRORS(RNEAGEN_ERROR_TEXT)
#undef RNEAGEN_ERROR_TEXT
	};
	return (unsigned)code < RNEAGEN_ERROR_COUNT ? texts[code] : "unknown error";
}

/* Of a message that is too long its middle goes: at the end stands what is wrong with a name that is long. */
static void shorten(char *message, size_t size, const char *whole, size_t length)
{
	static const char gap[] = " ... ";
	size_t end = size / 2, begin = size - 1 - end - strlen(gap);

	while (begin && text_is_inside(whole[begin]))
		begin--;
	while (text_is_inside(whole[length - end]))
		end--;
	snprintf(message, size, "%.*s%s%s", (int)begin, whole, gap, whole + length - end);
}

enum rneagen_code error_set(struct rneagen_error *e, enum rneagen_code code, const char *fmt, ...)
{
	char whole[LONGEST];
	va_list ap;

	if (e->code != RNEAGEN_OK)
		return e->code;
	e->code = code;
	va_start(ap, fmt);
	vsnprintf(whole, sizeof whole, fmt, ap);
	va_end(ap);
	if (strlen(whole) < sizeof e->message)
		strcpy(e->message, whole);
	else
		shorten(e->message, sizeof e->message, whole, strlen(whole));
	for (char *s = e->message; *s; s++)
		if ((unsigned char)*s < 0x20 || *s == 0x7f)
			*s = '?';
	return code;
}

enum rneagen_code error_memory(struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_MEMORY, "%s", rneagen_code_text(RNEAGEN_MEMORY));
}
