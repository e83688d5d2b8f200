#include "urdf/diagnostic.h"
#include <stdarg.h>
#include <stdio.h>

enum { MESSAGE_BYTES = sizeof((struct rneagen_error *)0)->message };

enum rneagen_code diagnostic_error(const struct diagnostic *p, enum rneagen_code code, long line, const char *fmt, ...)
{
	char what[MESSAGE_BYTES];
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(what, sizeof what, fmt, ap);
	va_end(ap);
	if (line)
		return error_set(p->error, code, "%s:%ld: %s", p->file, line, what);
	return error_set(p->error, code, "%s: %s", p->file, what);
}

void diagnostic_warning(const struct diagnostic *p, long line, const char *fmt, ...)
{
	char what[MESSAGE_BYTES];
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(what, sizeof what, fmt, ap);
	va_end(ap);
	robot_warn(p->robot, p->arena, "%s:%ld: %s", p->file, line, what);
}
