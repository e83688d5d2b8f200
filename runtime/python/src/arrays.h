#ifndef RNEA_PYTHON_ARRAYS_H
#define RNEA_PYTHON_ARRAYS_H
/* Arrays of NumPy, checked: type of numbers, shape, order, whether they may be written. */

#include "module.h"

enum { F32, F64, SCALARS, AXES = 64 };

struct array {
	PyObject *name; /* interned */
	Py_ssize_t rows;
	PyObject *shape; /* of a sample: a tuple */
	int per_batch;
};

/* The leading axes of all arrays of samples, and the array that has them first; so of their numbers. */
struct lead {
	Py_ssize_t shape[AXES];
	int axes; /* -1: none yet */
	const struct array *of;
	int scalar;
	PyObject *scalar_of;
};

/* (lead..., tail...); NULL and an exception. */
PyObject *array_shape(const Py_ssize_t *lead, int count, PyObject *tail);

/* Look at argument i of the call, and keep its view in it. 0, or -1 and an exception that names the array. */
int array_take(const struct array *a, PyObject *array, int is_output, struct lead *lead, struct call *c, int i);

#endif
