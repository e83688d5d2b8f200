#ifndef RNEA_PYTHON_MODULE_H
#define RNEA_PYTHON_MODULE_H
/* The extension rneagen._core: what Python's package needs of both libraries, by the stable interface of Python 3.11.
   Arrays come in by the buffer protocol, so no header of NumPy is needed. */

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "passes/analysis.h"
#include "rnea.h"
#include "rneagen.h"

/* Fill *o from a dictionary: words for target, precision, layout, trig, base, mimic, only; numbers for strict, bounded,
   parts, segments, tell; three of gravity; strings for order, name, file, scene, which stay the
   dictionary's. 0, or -1 and an exception. */
int options_take(PyObject *dict, struct rneagen_options *o);

/* The same for opening: backend ("any", "cuda", "cpu", "evaluator"), file, device, block, threads, cache. */
int options_take_open(PyObject *dict, struct rnea_options *o);

/* Raise what a library said: ValueError, MemoryError, OSError or RuntimeError, with the message and the code's word;
   returns NULL. */
PyObject *raise_generator(const struct rneagen_error *e);
PyObject *raise_runtime(const struct rnea_error *e);

/* An opened text. */
struct kernel {
	PyObject_HEAD
	struct rnea_robot *robot;
	int is_async; /* a launch may still be under way: it is not closed */
};

PyObject *kernel_new(PyTypeObject *type, struct rnea_robot *robot);

/* A call that is checked: of arrays in views, or at addresses that somebody else keeps. */
struct call {
	struct kernel *kernel; /* a reference, as the next two */
	PyObject *result, *keep;
	PyObject *copy; /* makes a copy in one piece of an input that is in several, borrowed; NULL: such are refused */
	Py_buffer views[RNEA_ARGUMENT_LIMIT];
	int view_count;
	void *pointers[RNEA_ARGUMENT_LIMIT];
	size_t count;
	void *stream;
	int has_stream;
};

/* Launch without Python's lock. 0, or -1 and an exception. */
int call_run(const struct call *c);
void call_clear(struct call *c);

/* A call that can be made again. */
struct step {
	PyObject_HEAD
	struct call call;
};

/* Takes over what *c holds. */
PyObject *step_new(PyTypeObject *type, struct call *c);

/* compile(text, options): the text as a shared object, in bytes (object.c). */
PyObject *object_make(PyObject *self, PyObject *args);

/* rnea_options.stop: has a signal raised an exception, KeyboardInterrupt for one? It stays, for the caller to return. `context`
   holds what PyEval_SaveThread returned. */
int interrupted(void *context);

/* For JAX (xla.c): {platform: capsule of a handler}, empty where XLA's header was not there when this was built; and
   _keep(number, kernel, device): programs that XLA compiled may name it by its number for as long as the process lives.
   device -1: the processor. */
PyObject *xla_handlers(PyObject *self, PyObject *unused);
PyObject *xla_keep(PyObject *self, PyObject *args);

/* The module's types. */
struct core {
	PyTypeObject *kernel, *model, *robot, *step;
};

extern PyType_Spec kernel_spec, model_spec, robot_spec, step_spec;

#endif
