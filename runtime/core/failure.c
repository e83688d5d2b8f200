#include "core/failure.h"
#include <stdarg.h>
#include <stdio.h>

const char *rnea_code_text(enum rnea_code code)
{
	static const char *const texts[] = {
#define RNEA_ERROR_TEXT(code, text) text,
		RNEA_ERRORS(RNEA_ERROR_TEXT)
#undef RNEA_ERROR_TEXT
	};
	return (unsigned)code < RNEA_ERROR_COUNT ? texts[code] : "unknown error";
}

struct rnea_error *rnea_error_start(struct rnea_error *e, struct rnea_error *spare)
{
	struct rnea_error *used = e ? e : spare;

	used->code = RNEA_OK;
	used->message[0] = '\0';
	return used;
}

enum rnea_code rnea_error_set(struct rnea_error *e, enum rnea_code code, const char *fmt, ...)
{
	va_list ap;

	if (e->code != RNEA_OK)
		return e->code;
	e->code = code;
	va_start(ap, fmt);
	vsnprintf(e->message, sizeof e->message, fmt, ap);
	va_end(ap);
	for (char *s = e->message; *s; s++)
		if ((unsigned char)*s < 0x20 || *s == 0x7f)
			*s = ' ';
	return code;
}

enum rnea_code rnea_error_memory(struct rnea_error *e)
{
	return rnea_error_set(e, RNEA_MEMORY, "%s", rnea_code_text(RNEA_MEMORY));
}
