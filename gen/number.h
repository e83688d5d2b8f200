#ifndef RNEAGEN_NUMBER_H
#define RNEAGEN_NUMBER_H
/* Numbers in attributes, accepted and refused exactly as urdfdom does: decimal only; no inf, nan, hexadecimal or
   overflow; blanks between numbers and before the first, and after the last if there are several. */

/* What is wrong: LARGE, a number beyond the doubles; BLANK, nothing but a blank after a single one; WORD, all else. */
enum number_fault { NUMBER_FINE, NUMBER_WORD, NUMBER_LARGE, NUMBER_BLANK };

/* Reads exactly `count` numbers that make up all of `s`. Call in the C locale. */
enum number_fault number_read(const char *s, double *values, int count);

#endif
