#ifndef RUNTIME_RANGE_EXTREME_H
#define RUNTIME_RANGE_EXTREME_H
/* The largest value over drives and rates of an output at one q. */

#include "range/field.h"

/* No value of sign times the polynomial, sign +1 or -1, is above this; where it is not above `floor`, something below `floor` or
   at it may be returned. Drives are exact. Of rates, the polynomial is raised to one that is convex in each rate, whose largest
   value is at a corner: exact where no square of a rate has a negative coefficient that counts. */
double extreme_above(const struct field *f, const double *coefficients, int sign, double floor);

/* The corner of drives and rates, each one of its bounds over its scale, where the value is about that; in order: drives, rates.
   */
double extreme_corner(const struct field *f, const double *coefficients, int sign, double *x);

#endif
