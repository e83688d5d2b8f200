#include "base/error.h"
#include <stdarg.h>
#include <stdio.h>

const char *rneagen_code_text(enum rneagen_code code)
{
	static const char *const texts[] = {
#define RNEAGEN_ERROR_TEXT(code, text) text,
		RNEAGEN_ERRORS(RNEAGEN_ERROR_TEXT)
#undef RNEAGEN_ERROR_TEXT
	};
	return (unsigned)code < RNEAGEN_ERROR_COUNT ? texts[code] : "unknown error";
}

enum rneagen_code error_set(struct rneagen_error *e, enum rneagen_code code, const char *fmt, ...)
{
	va_list ap;

	if (e->code != RNEAGEN_OK)
		return e->code;
	e->code = code;
	va_start(ap, fmt);
	vsnprintf(e->message, sizeof e->message, fmt, ap);
	va_end(ap);
	for (char *s = e->message; *s; s++)
		if ((unsigned char)*s < 0x20 || *s == 0x7f)
			*s = '?';
	return code;
}

enum rneagen_code error_memory(struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_MEMORY, "%s", rneagen_code_text(RNEAGEN_MEMORY));
}
