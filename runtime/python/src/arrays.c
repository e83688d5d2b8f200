#include "arrays.h"
#include <string.h>

static int scalar_of(const Py_buffer *v)
{
	const char *f = v->format ? v->format : "B";

	f += *f == '<' || *f == '=' || *f == '@';
	return !strcmp(f, "d") ? F64 : !strcmp(f, "f") ? F32 : -1;
}

/* "1" after strides of C order; "F" of Fortran's; 0: of neither. */
static char order_of(const Py_buffer *v)
{
	Py_ssize_t c = v->itemsize, f = v->itemsize;
	int is_c = 1, is_f = 1;

	for (int i = v->ndim - 1; i >= 0; c *= v->shape[i--])
		is_c &= v->shape[i] <= 1 || v->strides[i] == c;
	for (int i = 0; i < v->ndim; f *= v->shape[i++])
		is_f &= v->shape[i] <= 1 || v->strides[i] == f;
	return v->len == 0 || is_c ? 'C' : is_f ? 'F' : 0;
}

PyObject *array_shape(const Py_ssize_t *lead, int count, PyObject *tail)
{
	Py_ssize_t n = PyTuple_Size(tail);
	PyObject *shape = PyTuple_New(count + n);

	for (Py_ssize_t i = 0; shape && i < count + n; i++) {
		PyObject *item = i < count ? PyLong_FromSsize_t(lead[i]) : Py_NewRef(PyTuple_GetItem(tail, i - count));

		if (!item || PyTuple_SetItem(shape, i, item))
			Py_CLEAR(shape);
	}
	return shape;
}

/* What messages begin with, before the array's name. */
static const char *part_of(int is_output)
{
	return is_output ? "out: the array for " : "";
}

static int refuse_shape(const struct array *a, const Py_buffer *v, int is_output, const struct lead *lead)
{
	PyObject *empty = PyTuple_New(0), *wanted, *shape = empty ? array_shape(v->shape, v->ndim, empty) : NULL;

	if (lead->axes >= 0 && !a->per_batch)
		wanted = array_shape(lead->shape, lead->axes, a->shape);
	else
		wanted = Py_NewRef(a->shape);
	if (wanted && shape && lead->axes >= 0 && !a->per_batch && lead->of != a)
		PyErr_Format(PyExc_ValueError, "%s%U: its shape is %R; %R goes with %U", part_of(is_output), a->name,
			shape, wanted, lead->of->name);
	else if (wanted && shape)
		PyErr_Format(PyExc_ValueError,
			a->per_batch ? "%s%U: its shape is %R; %R is wanted, for all samples"
				     : "%s%U: its shape is %R; %R is "
				       "wanted, or axes of samples before it",
			part_of(is_output), a->name, shape, wanted);
	Py_XDECREF(empty);
	Py_XDECREF(wanted);
	Py_XDECREF(shape);
	return -1;
}

static int check_shape(const struct array *a, const Py_buffer *v, int is_output, struct lead *lead)
{
	int own = (int)PyTuple_Size(a->shape), axes = v->ndim - own, same = axes >= 0 && v->ndim <= AXES &&
		(!a->per_batch || axes == 0);

	if (own == 1)
		same = same && v->shape[axes] == a->rows;
	else
		for (int i = 0; same && i < own; i++)
			same = v->shape[axes + i] == PyLong_AsSsize_t(PyTuple_GetItem(a->shape, i));
	if (!same || a->per_batch)
		return same ? 0 : refuse_shape(a, v, is_output, lead);
	if (lead->axes < 0) {
		memcpy(lead->shape, v->shape, (size_t)axes * sizeof *v->shape);
		lead->axes = axes;
		lead->of = a;
		return 0;
	}
	same = axes == lead->axes && !memcmp(lead->shape, v->shape, (size_t)axes * sizeof *v->shape);
	return same ? 0 : refuse_shape(a, v, is_output, lead);
}

static int refuse_dtype(const struct array *a, PyObject *array, int is_output)
{
	PyObject *type = PyObject_GetAttrString(array, "dtype");

	if (type)
		PyErr_Format(PyExc_TypeError, "%s%U: its dtype is %S; float32 or float64 is wanted", part_of(is_output), a->name, type);
	Py_XDECREF(type);
	return -1;
}

static int refuse_other_dtype(const struct array *a, PyObject *array, int is_output, const struct lead *lead)
{
	PyObject *type = PyObject_GetAttrString(array, "dtype");

	if (type)
		PyErr_Format(PyExc_TypeError, "%s%U: its dtype is %S, and that of %U is float%d: all arrays have one",
			part_of(is_output), a->name, type, lead->scalar_of, lead->scalar == F32 ? 32 : 64);
	Py_XDECREF(type);
	return -1;
}

static int refuse_order(const struct array *a, int is_output, int is_fortran)
{
	PyErr_Format(PyExc_ValueError,
		is_output && is_fortran ? "out: the array for %U is in Fortran order; give one in C order, as numpy.empty makes it"
		: is_output ? "out: the array for %U is not contiguous; give one that is, as numpy.empty makes it"
		: is_fortran ? "%U: it is in Fortran order; numpy.ascontiguousarray makes a copy in C order"
		: "%U: it is not contiguous; numpy.ascontiguousarray makes a copy that is", a->name);
	return -1;
}

/* Returns 1 where a copy in one piece is to take its place. */
static int check_array(const struct array *a, PyObject *array, const struct call *c, int is_output, struct lead *lead)
{
	const Py_buffer *v = &c->views[c->view_count - 1];
	int scalar = scalar_of(v);
	char order;
	int is_aligned;

	if (scalar < 0)
		return refuse_dtype(a, array, is_output);
	if (lead->scalar_of && scalar != lead->scalar)
		return refuse_other_dtype(a, array, is_output, lead);
	if (!lead->scalar_of) {
		lead->scalar_of = a->name;
		lead->scalar = scalar;
	}
	if (is_output && v->readonly) {
		PyErr_Format(PyExc_ValueError, "out: the array for %U is read-only", a->name);
		return -1;
	}
	if (check_shape(a, v, is_output, lead))
		return -1;
	order = order_of(v);
	is_aligned = (uintptr_t)v->buf % (size_t)v->itemsize == 0;
	if ((order != 'C' || !is_aligned) && !is_output && c->copy)
		return 1;
	if (order != 'C')
		return refuse_order(a, is_output, order != 0);
	if (!is_aligned)
		PyErr_Format(PyExc_ValueError, "%s%U: its numbers do not stand at multiples of %zd bytes; numpy.copy makes an array whose do",
			part_of(is_output), a->name, v->itemsize);
	return is_aligned ? 0 : -1;
}

static int take_view(PyObject *array, struct call *c, int i)
{
	Py_buffer *v = &c->views[c->view_count];

	if (PyObject_GetBuffer(array, v, PyBUF_STRIDES | PyBUF_FORMAT))
		return -1;
	c->view_count++;
	c->pointers[i] = v->buf;
	return 0;
}

/* A copy in one piece in its place; the view keeps it alive. */
static int take_copy(PyObject *array, struct call *c, int i)
{
	PyObject *made = PyObject_CallFunctionObjArgs(c->copy, array, NULL);
	int bad;

	PyBuffer_Release(&c->views[--c->view_count]);
	bad = !made || take_view(made, c, i);
	Py_XDECREF(made);
	return bad ? -1 : 0;
}

int array_take(const struct array *a, PyObject *array, int is_output, struct lead *lead, struct call *c, int i)
{
	int what = take_view(array, c, i);

	if (what && PyErr_ExceptionMatches(PyExc_ValueError)) { /* a dtype that no buffer has, a date for one */
		PyErr_Clear();
		refuse_dtype(a, array, is_output);
	}
	if (!what)
		what = check_array(a, array, c, is_output, lead);
	return what > 0 ? take_copy(array, c, i) : what;
}
