#include "base/number.h"
#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The digits as a whole number, and how many of them stand behind the point; 0 where they are too many or too far off. */
static int read_digits(const char *s, uint64_t *whole, long *behind)
{
	int has_point = 0;
	long exponent;

	*whole = 0;
	*behind = 0;
	for (; *s == '.' || (*s >= '0' && *s <= '9'); s++) {
		if (*s == '.') {
			has_point = 1;
			continue;
		}
		if (*whole > (UINT64_MAX - 9) / 10)
			return 0;
		*whole = *whole * 10 + (uint64_t)(*s - '0');
		*behind += has_point;
	}
	exponent = *s == 'e' || *s == 'E' ? strtol(s + 1, NULL, 10) : 0;
	if (exponent < -999 || exponent > 999)
		return 0;
	*behind -= exponent;
	return 1;
}

/* Is a decimal the number of the type that is nearest to it? With `behind` digits behind the point these, as a whole number,
   must be a multiple of 5^behind. */
static int is_exact(const char *s, real near)
{
	uint64_t whole;
	long behind;

	if (!read_digits(s + strspn(s, " \t\r\n+-"), &whole, &behind))
		return 0;
	if (!whole)
		return near == 0;
	for (; behind > 0 && whole % 5 == 0; behind--)
		whole /= 5;
	for (; behind < 0 && whole < UINT64_MAX / 10; behind++)
		whole *= 10;
	return behind == 0 && (uint64_t)(real)whole == whole;
}

/* The decimal that `s` begins with; *end stands behind it, as strtod has it. */
static struct within parse(const char *s, char **end)
{
	real x = (real)strtod(s, NULL), near = strtold(s, end);

	return is_exact(s, near) ? (struct within){x, near, 0, 0, 0} : within_decimal(x, near);
}

static enum number_fault read_one(const char **s, struct within *value)
{
	const char *digits = *s + strspn(*s, " \t\r\n+-");
	char *end;

	/* strtod would take hexadecimal, inf and nan */
	if ((!isdigit((unsigned char)*digits) && *digits != '.') || (digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')))
		return NUMBER_WORD;
	*value = parse(*s, &end);
	if (end == *s)
		return NUMBER_WORD;
	*s = end;
	return isfinite(value->x) ? NUMBER_FINE : NUMBER_LARGE;
}

enum number_fault number_read(const char *s, struct within *values, int count)
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
