#ifndef TESTS_ARRAY_H
#define TESTS_ARRAY_H
/* Arrays of float or double that a generated function reads and writes. They end where a page begins that traps, and
   begin after bytes that are looked at again; a test sees their elements as double, which holds both. */

#include <stddef.h>

struct array {
	int f32;
	size_t count;
	void *data;
	char *pages;	     /* private: the mapping, guard included */
	size_t before, size; /* private: bytes before the data, bytes of the mapping */
};

struct array array_new(int f32, size_t count);
void array_free(struct array *a);
double array_get(const struct array *a, size_t i);
void array_set(const struct array *a, size_t i, double x);

/* Are the bytes before the array as they were? */
int array_intact(const struct array *a);

/* Same bits, or both NaN? */
int same_number(double a, double b);

#endif
