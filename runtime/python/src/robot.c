/* A robot that is called: arrays of NumPy are checked and run here, all else by the methods of the package's class. */
#include "arrays.h"
#include <string.h>

struct caller {
	PyObject_HEAD
	struct array arrays[RNEA_ARGUMENT_LIMIT];
	int input_count, count; /* 0: it is not defined yet */
	int places;             /* arrays that a call may name by their place: inputs, and out where it may */
	PyObject *outputs;      /* the named tuple of several outputs; None */
	PyObject *ndarray, *empty, *dtypes[SCALARS], *copy;
	PyObject *kernels[SCALARS]; /* NULL: not open yet */
	int is_direct;              /* arrays of NumPy go to the text as they are */
};

/* Arrays that are called with: by input, and those for outputs. Borrowed. */
struct given {
	PyObject *inputs[RNEA_ARGUMENT_LIMIT], *out;
};


/* ---- defining ---- */

static int set_array(struct array *a, PyObject *tuple)
{
	PyObject *name, *shape;

	if (!PyArg_ParseTuple(tuple, "UnOp", &name, &a->rows, &shape, &a->per_batch))
		return -1;
	a->name = Py_NewRef(name);
	PyUnicode_InternInPlace(&a->name);
	a->shape = Py_NewRef(shape);
	return 0;
}

static PyObject *robot_define(PyObject *self, PyObject *args)
{
	struct caller *r = (struct caller *)self;
	PyObject *arrays, *numpy[5];
	Py_ssize_t count, inputs;

	if (r->count || !PyArg_ParseTuple(args, "O!niO(OOOOO)p", &PyTuple_Type, &arrays, &inputs, &r->places, &r->outputs, &numpy[0],
				&numpy[1], &numpy[2], &numpy[3], &numpy[4], &r->is_direct))
		return NULL;
	Py_INCREF(r->outputs);
	r->ndarray = Py_NewRef(numpy[0]);
	r->empty = Py_NewRef(numpy[1]);
	r->dtypes[F32] = Py_NewRef(numpy[2]);
	r->dtypes[F64] = Py_NewRef(numpy[3]);
	r->copy = Py_NewRef(numpy[4]);
	count = PyTuple_Size(arrays);
	if (count > RNEA_ARGUMENT_LIMIT || inputs > count)
		return PyErr_Format(PyExc_ValueError, "%zd arrays", count);
	for (Py_ssize_t i = 0; i < count; i++)
		if (set_array(&r->arrays[i], PyTuple_GetItem(arrays, i)))
			return NULL;
	r->input_count = (int)inputs;
	r->count = (int)count;
	return Py_NewRef(Py_None);
}

static void robot_free(PyObject *self)
{
	struct caller *r = (struct caller *)self;
	PyTypeObject *type = Py_TYPE(self);

	for (int i = 0; i < RNEA_ARGUMENT_LIMIT; i++) {
		Py_XDECREF(r->arrays[i].name);
		Py_XDECREF(r->arrays[i].shape);
	}
	for (int i = 0; i < SCALARS; i++) {
		Py_XDECREF(r->dtypes[i]);
		Py_XDECREF(r->kernels[i]);
	}
	Py_XDECREF(r->outputs);
	Py_XDECREF(r->ndarray);
	Py_XDECREF(r->empty);
	Py_XDECREF(r->copy);
	((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
	Py_DECREF(type);
}

/* ---- outputs ---- */

static PyObject *new_output(const struct caller *r, int i, const struct lead *lead)
{
	PyObject *shape = array_shape(lead->shape, lead->axes, r->arrays[i].shape), *array;

	array = shape ? PyObject_CallFunctionObjArgs(r->empty, shape, r->dtypes[lead->scalar], NULL) : NULL;
	Py_XDECREF(shape);
	return array;
}

/* The array for output i out of `out`: borrowed; NULL and an exception. */
static PyObject *given_output(const struct caller *r, PyObject *out, int i)
{
	int several = r->count - r->input_count > 1;
	PyObject *array = out;

	if (several && (!PyTuple_Check(out) || PyTuple_Size(out) != r->count - r->input_count))
		return PyErr_Format(PyExc_TypeError, "out: a tuple of %d arrays is wanted, one for each output",
			r->count - r->input_count);
	if (several)
		array = PyTuple_GetItem(out, i - r->input_count);
	if ((PyObject *)Py_TYPE(array) == r->ndarray)
		return array;
	return PyErr_Format(PyExc_TypeError, "out: %U goes into an array of NumPy, not %R", r->arrays[i].name, Py_TYPE(array));
}

/* Outputs into pointers, and what the call returns into c->result. */
static int take_outputs(const struct caller *r, PyObject *out, struct lead *lead, struct call *c)
{
	int several = r->count - r->input_count > 1, bad = 0;
	PyObject *tuple = several ? PyTuple_New(r->count - r->input_count) : NULL;

	if (several && !tuple)
		return -1;
	for (int i = r->input_count; !bad && i < r->count; i++) {
		PyObject *array = out ? Py_XNewRef(given_output(r, out, i)) : new_output(r, i, lead);

		bad = !array || array_take(&r->arrays[i], array, 1, lead, c, i);
		if (several && array)
			bad |= PyTuple_SetItem(tuple, i - r->input_count, array) != 0;
		else
			c->result = array;
	}
	if (several) {
		c->result = bad ? NULL : out ? Py_NewRef(out) : PyObject_CallObject(r->outputs, tuple);
		bad |= !c->result;
		Py_DECREF(tuple);
	}
	return bad ? -1 : 0;
}

/* An output shares no memory with any other array. */
static int check_overlap(const struct caller *r, const struct call *c)
{
	for (int i = r->input_count; i < r->count; i++)
		for (int k = 0; k < i; k++) {
			const char *a = c->views[i].buf, *b = c->views[k].buf;

			if (a < b + c->views[k].len && b < a + c->views[i].len) {
				PyErr_Format(PyExc_ValueError, "out: the array for %U overlaps %U", r->arrays[i].name,
					r->arrays[k].name);
				return -1;
			}
		}
	return 0;
}

/* ---- calls ---- */

/* The text for this type of numbers: opened by the method _open when it is first wanted. */
static struct kernel *kernel_for(PyObject *self, int scalar)
{
	struct caller *r = (struct caller *)self;
	PyObject *k = Py_XNewRef(r->kernels[scalar]);

	if (!k) {
		k = PyObject_CallMethod(self, "_open", "s", scalar == F32 ? "f32" : "f64");
		if (k && !r->kernels[scalar])
			r->kernels[scalar] = Py_NewRef(k);
	}
	return (struct kernel *)k;
}

/* The numbers of a call on no arrays: those that the robot's precision has, else doubles. */
static int own_scalar(PyObject *self, int *scalar)
{
	PyObject *own = PyObject_GetAttrString(self, "scalar");

	*scalar = own && own != Py_None && !PyUnicode_CompareWithASCIIString(own, "f32") ? F32 : F64;
	Py_XDECREF(own);
	return own ? 0 : -1;
}

/* `copies`: may inputs be in several pieces? */
static int prepare(PyObject *self, const struct given *g, int copies, struct call *c)
{
	struct caller *r = (struct caller *)self;
	struct lead lead = {.axes = -1, .scalar = F64};
	int is_told;

	c->view_count = 0;
	c->kernel = NULL;
	c->result = c->keep = NULL;
	c->copy = copies ? r->copy : NULL;
	c->has_stream = 0;
	for (int i = 0; i < r->input_count; i++)
		if (array_take(&r->arrays[i], g->inputs[i], 0, &lead, c, i))
			return -1;
	is_told = lead.scalar_of != NULL; /* else `out` tells of which numbers, if it is given */
	if (is_told && !(c->kernel = kernel_for(self, lead.scalar)))
		return -1;
	if (lead.axes < 0 && !g->out) /* else the first output has the axes of samples */
		lead.axes = 0;
	if (!is_told && !g->out && own_scalar(self, &lead.scalar))
		return -1;
	if (take_outputs(r, g->out, &lead, c) || (g->out && check_overlap(r, c)))
		return -1;
	if (!is_told && !(c->kernel = kernel_for(self, lead.scalar)))
		return -1;
	c->count = 1;
	for (int i = 0; i < lead.axes; i++)
		c->count *= (size_t)lead.shape[i];
	return 0;
}

static PyObject *run(PyObject *self, const struct given *g)
{
	struct call c;
	PyObject *result = NULL;

	if (!prepare(self, g, 1, &c) && !call_run(&c))
		result = Py_NewRef(c.result);
	call_clear(&c);
	return result;
}

static int find_input(const struct caller *r, PyObject *name)
{
	for (int i = 0; i < r->input_count; i++)
		if (name == r->arrays[i].name || !PyUnicode_Compare(name, r->arrays[i].name))
			return i;
	return -1;
}

/* Are these arrays of NumPy's own type, or is there none? */
static int are_plain(const struct caller *r, PyObject *out)
{
	Py_ssize_t count = out && PyTuple_Check(out) ? PyTuple_Size(out) : 0;

	for (Py_ssize_t i = 0; i < count; i++)
		if ((PyObject *)Py_TYPE(PyTuple_GetItem(out, i)) != r->ndarray)
			return 0;
	return !out || PyTuple_Check(out) || (PyObject *)Py_TYPE(out) == r->ndarray;
}

/* Is it a call that needs no more than what is here: every input there, by its name, and of NumPy's own type? */
static int gather(const struct caller *r, PyObject *args, PyObject *names, struct given *g)
{
	Py_ssize_t count = PyTuple_Size(args), at = 0;
	PyObject *name, *value;

	if (!r->is_direct || count > r->places)
		return 0;
	memset(g->inputs, 0, (size_t)r->input_count * sizeof *g->inputs);
	g->out = NULL;
	for (Py_ssize_t i = 0; i < count; i++)
		*(i < r->input_count ? &g->inputs[i] : &g->out) = PyTuple_GetItem(args, i);
	while (names && PyDict_Next(names, &at, &name, &value)) {
		int i = find_input(r, name), is_out = i < 0 && !PyUnicode_CompareWithASCIIString(name, "out");

		if ((i < 0 && !is_out) || (is_out ? g->out : g->inputs[i]))
			return 0;
		*(is_out ? &g->out : &g->inputs[i]) = value;
	}
	g->out = g->out == Py_None ? NULL : g->out;
	for (int i = 0; i < r->input_count; i++)
		if (!g->inputs[i] || (PyObject *)Py_TYPE(g->inputs[i]) != r->ndarray)
			return 0;
	return are_plain(r, g->out);
}

static PyObject *call_method(PyObject *self, const char *method, PyObject *args, PyObject *names)
{
	PyObject *dict = names ? Py_NewRef(names) : PyDict_New(), *result = NULL;

	if (dict)
		result = PyObject_CallMethod(self, method, "OO", args, dict);
	Py_XDECREF(dict);
	return result;
}

static PyObject *robot_call(PyObject *self, PyObject *args, PyObject *names)
{
	struct given g;

	return gather((struct caller *)self, args, names, &g) ? run(self, &g) : call_method(self, "_call", args, names);
}

/* (arrays, out) of NumPy, as _run and _bind_arrays take them. */
static int read_given(const struct caller *r, PyObject *arrays, PyObject *out, struct given *g)
{
	if (!PyTuple_Check(arrays) || PyTuple_Size(arrays) != r->input_count) {
		PyErr_Format(PyExc_TypeError, "a tuple of %d arrays is wanted", r->input_count);
		return -1;
	}
	for (int i = 0; i < r->input_count; i++) {
		g->inputs[i] = PyTuple_GetItem(arrays, i);
		if ((PyObject *)Py_TYPE(g->inputs[i]) != r->ndarray) {
			PyErr_Format(PyExc_TypeError, "%U: an array of NumPy is wanted", r->arrays[i].name);
			return -1;
		}
	}
	g->out = out == Py_None ? NULL : out;
	return 0;
}

static PyObject *robot_run(PyObject *self, PyObject *args)
{
	struct given g;
	PyObject *arrays, *out;

	if (!PyArg_ParseTuple(args, "OO", &arrays, &out) || read_given((struct caller *)self, arrays, out, &g))
		return NULL;
	return run(self, &g);
}

static PyObject *robot_bind(PyObject *self, PyTypeObject *defining, PyObject *const *args, Py_ssize_t count, PyObject *names)
{
	const struct core *core = PyType_GetModuleState(defining);
	struct given g;
	struct call c;

	if (count != 2 || names || read_given((struct caller *)self, args[0], args[1], &g))
		return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_TypeError, "arrays and out are wanted");
	if (!prepare(self, &g, 0, &c)) /* a step reads the arrays again */
		return step_new(core->step, &c);
	call_clear(&c);
	return NULL;
}

static PyMethodDef methods[] = {
	{"_define", robot_define, METH_VARARGS,
		"_define(arrays, input_count, places, outputs, (ndarray, empty, float32, float64, ascontiguousarray), is_direct)"},
	{"_run", robot_run, METH_VARARGS, "_run(arrays, out): a call on arrays of NumPy."},
	{"_bind", (PyCFunction)(void (*)(void))robot_bind, METH_METHOD | METH_FASTCALL | METH_KEYWORDS,
		"_bind(arrays, out): a Step."},
	{NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {{Py_tp_dealloc, robot_free}, {Py_tp_call, robot_call}, {Py_tp_methods, methods},
	{Py_tp_doc, "What rneagen.Robot is made of."}, {0, NULL}};

PyType_Spec robot_spec = {"rneagen._core.Robot", sizeof(struct caller), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE, slots};
