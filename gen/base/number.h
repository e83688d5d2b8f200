#ifndef RNEAGEN_NUMBER_H
#define RNEAGEN_NUMBER_H
/* Numbers as text. Those in attributes are accepted and refused exactly as urdfdom does: decimal only; no inf, nan,
   hexadecimal or overflow; blanks between numbers and before the first, and after the last if there are several. */

#include "base/within.h"

/* What is wrong: LARGE, a number beyond the doubles; BLANK, nothing but a blank after a single one; WORD, all else. */
enum number_fault { NUMBER_FINE, NUMBER_WORD, NUMBER_LARGE, NUMBER_BLANK };

/* Reads exactly `count` numbers that make up all of `s`. Call in the C locale. */
enum number_fault number_read(const char *s, struct within *values, int count);

/* The decimal with the fewest digits that reads back as the same number: "0.1", "1e-05", "3e+02". Call in the C locale. */
struct number_text {
	char s[32];
};
struct number_text number_shortest(double x);
struct number_text number_shortest_float(float x);

/* The same as people write it: "300". */
struct number_text number_plain(double x);

#endif
