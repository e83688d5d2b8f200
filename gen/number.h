#ifndef RNEAGEN_NUMBER_H
#define RNEAGEN_NUMBER_H
/* Numbers in attributes, accepted and refused exactly as urdfdom does: decimal only; no inf, nan, hexadecimal or
   overflow; blanks between numbers and before the first, and after the last if there are several. */

/* Reads exactly `count` numbers that make up all of `s`; returns 0 if it holds anything else. Call in the C locale. */
int number_read(const char *s, double *values, int count);

#endif
