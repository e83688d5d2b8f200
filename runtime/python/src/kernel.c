/* An opened text, and calls of it that were checked before. */
#include "module.h"
#include <string.h>

static PyObject *exception_of(enum rnea_code code)
{
	if (code == RNEA_MEMORY)
		return PyExc_MemoryError;
	return code == RNEA_ARGUMENT || code == RNEA_POINTER || code == RNEA_LIMIT || code == RNEA_URDF ? PyExc_ValueError
													: PyExc_RuntimeError;
}

PyObject *raise_runtime(const struct rnea_error *e)
{
	static const char *const codes[RNEA_ERROR_COUNT] = {
#define CODE_WORD(code, text) [RNEA_##code] = #code,
		RNEA_ERRORS(CODE_WORD)
#undef CODE_WORD
	};
	PyObject *value = Py_BuildValue("(ss)", e->message, codes[e->code]);

	if (value)
		PyErr_SetObject(exception_of(e->code), value);
	Py_XDECREF(value);
	return NULL;
}

PyObject *kernel_new(PyTypeObject *type, struct rnea_robot *robot)
{
	allocfunc make = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
	struct kernel *k = (struct kernel *)make(type, 0);

	if (!k)
		rnea_close(robot);
	else
		k->robot = robot;
	return (PyObject *)k;
}

static void kernel_free(PyObject *self)
{
	struct kernel *k = (struct kernel *)self;
	PyTypeObject *type = Py_TYPE(self);

	/* what a stream still runs must stay */
	if (!k->is_async)
		rnea_close(k->robot);
	((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
	Py_DECREF(type);
}

/* ---- calls ---- */

int call_run(const struct call *c)
{
	const struct rnea_robot *robot = c->kernel->robot;
	struct rnea_error e;
	enum rnea_code code;

	if (c->has_stream)
		c->kernel->is_async = 1;
	Py_BEGIN_ALLOW_THREADS
	if (c->has_stream)
		code = rnea_launch(robot, c->pointers, c->count, c->stream, &e);
	else
		code = rnea_run_aos(robot, c->pointers, c->count, &e);
	Py_END_ALLOW_THREADS
	if (!code)
		return 0;
	PyErr_SetString(exception_of(code), e.message);
	return -1;
}

void call_clear(struct call *c)
{
	for (int i = 0; i < c->view_count; i++)
		PyBuffer_Release(&c->views[i]);
	c->view_count = 0;
	Py_CLEAR(c->kernel);
	Py_CLEAR(c->result);
	Py_CLEAR(c->keep);
}

/* (addresses, count, stream or None) into an empty call. */
static int read_call(struct kernel *k, struct call *c, PyObject *addresses, Py_ssize_t count, PyObject *stream)
{
	Py_ssize_t n = (Py_ssize_t)rnea_argument_count(k->robot, rnea_info(k->robot)->functions->name);

	if (!PyTuple_Check(addresses) || PyTuple_Size(addresses) != n || count < 0) {
		PyErr_Format(PyExc_ValueError, "a tuple of %zd addresses is wanted, and a count from 0 on", n);
		return -1;
	}
	for (Py_ssize_t i = 0; i < n; i++) {
		c->pointers[i] = PyLong_AsVoidPtr(PyTuple_GetItem(addresses, i));
		if (!c->pointers[i] && PyErr_Occurred())
			return -1;
	}
	c->has_stream = stream != Py_None;
	c->stream = c->has_stream ? PyLong_AsVoidPtr(stream) : NULL;
	c->count = (size_t)count;
	return PyErr_Occurred() ? -1 : 0;
}

static PyObject *kernel_launch(PyObject *self, PyObject *args)
{
	struct call c;
	PyObject *addresses, *stream = Py_None;
	Py_ssize_t count;
	int bad;

	if (!PyArg_ParseTuple(args, "On|O", &addresses, &count, &stream))
		return NULL;
	c.view_count = 0;
	c.kernel = (struct kernel *)self;
	bad = read_call(c.kernel, &c, addresses, count, stream) || call_run(&c);
	return bad ? NULL : Py_NewRef(Py_None);
}

static PyObject *kernel_bind(PyObject *self, PyTypeObject *defining, PyObject *const *args, Py_ssize_t count, PyObject *names)
{
	const struct core *core = PyType_GetModuleState(defining);
	struct call c;

	if (count != 5 || names) {
		PyErr_SetString(PyExc_TypeError, "bind takes addresses, count, stream, result, keep");
		return NULL;
	}
	memset(&c, 0, sizeof c);
	if (read_call((struct kernel *)self, &c, args[0], PyLong_AsSsize_t(args[1]), args[2]))
		return NULL;
	c.kernel = (struct kernel *)Py_NewRef(self);
	c.result = Py_NewRef(args[3]);
	c.keep = Py_NewRef(args[4]);
	return step_new(core->step, &c);
}

/* ---- what it is ---- */

static PyObject *kernel_build(PyObject *self, PyObject *unused)
{
	static const char *const backends[] = {"any", "cuda", "cpu", "evaluator"};
	const struct rnea_build *b = rnea_build(((struct kernel *)self)->robot);

	(void)unused;
	return Py_BuildValue("{ss ss ss ss ss sO sd sI ss}", "backend", backends[b->backend], "device", b->device,
		"compiler", b->compiler, "target", b->target, "note", b->note, "cached", b->cached ? Py_True : Py_False,
		"seconds", b->seconds, "threads", b->threads, "unkept", b->unkept);
}

static PyObject *kernel_info(PyObject *self, PyObject *unused)
{
	const struct rnea_info *i = rnea_info(((struct kernel *)self)->robot);
	const struct rnea_operations *o = &i->operations;
	PyObject *names = PyList_New(0);

	(void)unused;
	for (size_t k = 0; names && k < i->input_count + i->output_count; k++) {
		PyObject *name = PyUnicode_FromString(i->arguments[k].name);

		if (!name || PyList_Append(names, name))
			Py_CLEAR(names);
		Py_XDECREF(name);
	}
	return names ? Py_BuildValue("{ss ss ss ss sN s{sn sn sn sn sn sn}}", "precision",
		i->precision == RNEA_F32 ? "f32" : "f64",
			       "arithmetic", i->arithmetic, "layout", i->layout == RNEA_AOS ? "aos" : "soa", "trig", i->trig,
			"arrays", names,
			       "operations", "mul", o->mul, "add", o->add, "sub", o->sub, "neg", o->neg, "fma", o->fma,
			"sincos", o->sincos)
		     : NULL;
}

static PyMethodDef kernel_methods[] = {
	{"launch", kernel_launch, METH_VARARGS,
		"launch(addresses, count, stream=None)\n\nRun on arrays at these addresses, in the order of the text. With a stream, a\n"
		"cudaStream_t as an int: enqueued, on device pointers. Without: done when it returns, on the program's own."},
	{"bind", (PyCFunction)(void (*)(void))kernel_bind, METH_METHOD | METH_FASTCALL | METH_KEYWORDS,
		"bind(addresses, count, stream, result, keep)\n\nA step that launches again and returns `result`; it keeps `keep` alive."},
	{"build", kernel_build, METH_NOARGS, "build()\n\nHow it came to be: backend, device, compiler, ..."},
	{"info", kernel_info, METH_NOARGS, "info()\n\nWhat the text says of itself."}, {NULL, NULL, 0, NULL}};

static PyType_Slot kernel_slots[] = {{Py_tp_dealloc, kernel_free}, {Py_tp_methods, kernel_methods},
	{Py_tp_doc, "A text, compiled and loaded."}, {0, NULL}};

PyType_Spec kernel_spec = {"rneagen._core.Kernel", sizeof(struct kernel), 0,
	Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, kernel_slots};

/* ---- steps ---- */

PyObject *step_new(PyTypeObject *type, struct call *c)
{
	allocfunc make = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
	struct step *s = (struct step *)make(type, 0);

	if (s)
		s->call = *c;
	else
		call_clear(c);
	return (PyObject *)s;
}

static PyObject *step_call(PyObject *self, PyObject *args, PyObject *names)
{
	struct call *c = &((struct step *)self)->call;

	if (PyTuple_Size(args) || names) {
		PyErr_SetString(PyExc_TypeError, "a step takes no arguments: change what is in the arrays that it was bound to");
		return NULL;
	}
	return call_run(c) ? NULL : Py_NewRef(c->result);
}

static void step_free(PyObject *self)
{
	PyTypeObject *type = Py_TYPE(self);

	call_clear(&((struct step *)self)->call);
	((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
	Py_DECREF(type);
}

/* What inspect.signature shows. */
static PyObject *step_signature(PyObject *self, void *unused)
{
	PyObject *inspect = PyImport_ImportModule("inspect"), *made = inspect ? PyObject_CallMethod(inspect, "Signature", NULL) : NULL;

	(void)self, (void)unused;
	Py_XDECREF(inspect);
	return made;
}

static PyGetSetDef step_members[] = {{"__signature__", step_signature, NULL, NULL, NULL}, {NULL, NULL, NULL, NULL, NULL}};

static PyType_Slot step_slots[] = {{Py_tp_dealloc, step_free}, {Py_tp_call, step_call}, {Py_tp_getset, step_members},
	{Py_tp_doc, "A call on arrays that were checked once; step() makes it again and returns the outputs."}, {0, NULL}};

PyType_Spec step_spec = {"rneagen._core.Step", sizeof(struct step), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
	step_slots};
