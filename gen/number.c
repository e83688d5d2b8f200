#include "number.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum number_fault read_one(const char **s, double *value)
{
	const char *digits = *s + strspn(*s, " \t\r\n+-");
	char *end;

	/* strtod would take hexadecimal, inf and nan */
	if ((!isdigit((unsigned char)*digits) && *digits != '.') || (digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')))
		return NUMBER_WORD;
	*value = strtod(*s, &end);
	if (end == *s)
		return NUMBER_WORD;
	*s = end;
	return isfinite(*value) ? NUMBER_FINE : NUMBER_LARGE;
}

enum number_fault number_read(const char *s, double *values, int count)
{
	enum number_fault fault = NUMBER_FINE;
	size_t blanks;

	for (int i = 0; i < count; i++) {
		enum number_fault one = read_one(&s, &values[i]);

		if (one == NUMBER_WORD || (*s && *s != ' '))
			return NUMBER_WORD;
		fault = one ? one : fault;
	}
	blanks = strspn(s, " ");
	if (s[blanks])
		return NUMBER_WORD;
	return fault ? fault : count == 1 && blanks ? NUMBER_BLANK : NUMBER_FINE;
}

/* 9 and 17 digits always suffice. */
struct number_text number_shortest_float(float x)
{
	struct number_text t;

	for (int digits = 1; digits <= 9; digits++) {
		snprintf(t.s, sizeof t.s, "%.*g", digits, (double)x);
		if (strtof(t.s, NULL) == x)
			break;
	}
	return t;
}

struct number_text number_shortest(double x)
{
	struct number_text t;

	for (int digits = 1; digits <= 17; digits++) {
		snprintf(t.s, sizeof t.s, "%.*g", digits, x);
		if (strtod(t.s, NULL) == x)
			break;
	}
	return t;
}

struct number_text number_plain(double x)
{
	struct number_text t = number_shortest(x);

	if (strstr(t.s, "e+") && fabs(x) < 1e15) /* a whole number, for it has fewer digits than places before the point */
		snprintf(t.s, sizeof t.s, "%.0f", x);
	return t;
}
