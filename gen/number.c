#include "number.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int read_one(const char **s, double *value)
{
	const char *digits = *s + strspn(*s, " \t\r\n+-");
	char *end;

	if (digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X'))
		return 0; /* strtod would take it */
	*value = strtod(*s, &end);
	if (end == *s || !isfinite(*value))
		return 0;
	*s = end;
	return 1;
}

int number_read(const char *s, double *values, int count)
{
	for (int i = 0; i < count; i++)
		if (!read_one(&s, &values[i]) || (*s && *s != ' '))
			return 0;
	if (count > 1)
		s += strspn(s, " ");
	return !*s;
}
