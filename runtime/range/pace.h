#ifndef RUNTIME_RANGE_PACE_H
#define RUNTIME_RANGE_PACE_H
/* From the largest second derivatives on a grid to those at all q. */

#include "range/field.h"

/* Of a circle and of a length, where second derivatives are taken along it. */
enum { LEAST_PLACES = 6, LENGTH_PLACES = 3, PACE_ROUNDS = 6 };

/* What is known of a dimension's places: how much larger than on them a polynomial can be; half their distance squared and halved;
   |d2g/dq^2| <= bend |g|. */
struct pace {
	double factor, gap, bend;
};

/* The fewest places of a circle along which second derivatives are taken. */
int pace_least(const struct field_dim *k);

struct pace pace_of(const struct field *f, int k, int count);

/* Places of dimension k where second derivatives are taken along it. */
int pace_own_count(const struct field *f, int k, const int *counts);

/* The best that both ways together give for dimension k of n: `found` is what was found on the grid, most[] what is known of all. */
double pace_best(const struct pace *p, int n, int k, double found, const double *most);

#endif
