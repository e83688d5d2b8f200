#ifndef NUMBERS_H
#define NUMBERS_H
/* Rows of numbers. */

#include <math.h>
#include <stdlib.h>

/* n of them, zero, at least one; the caller frees them. */
static inline void *numbers_new(int n, size_t size)
{
	void *p = calloc((size_t)n + 1, size);

	if (!p)
		abort();
	return p;
}

static inline double numbers_norm(int n, const double *x)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += x[i] * x[i];
	return sqrt(sum);
}

#endif
