/* The module rneagen._core. */
#include "module.h"
#include "scene/scene_lines.h"
#include "urdf.h"
#include <string.h>

/* ---- texts ---- */

static PyObject *text_dict(const struct rneagen_result *r)
{
	PyObject *warnings = PyList_New(0);

	for (size_t i = 0; warnings && i < r->warning_count; i++) {
		PyObject *s = PyUnicode_FromString(r->warnings[i]);

		if (!s || PyList_Append(warnings, s))
			Py_CLEAR(warnings);
		Py_XDECREF(s);
	}
	if (!warnings)
		return NULL;
	return Py_BuildValue("{ss sz sz sz sz sz sN}", "name", r->name, "source", r->source, "header", r->header, "info",
		r->info, "info_json", r->info_json, "dot", r->dot, "warnings", warnings);
}

static PyObject *generate(PyObject *self, PyObject *args)
{
	struct rneagen_error e = {0};
	struct rneagen_options o;
	struct rneagen_result r;
	enum rneagen_code code;
	PyObject *options, *dict;
	Py_ssize_t length;
	const char *urdf;

	(void)self;
	if (!PyArg_ParseTuple(args, "y#O!", &urdf, &length, &PyDict_Type, &options) || options_take(options, &o))
		return NULL;
	Py_BEGIN_ALLOW_THREADS
	code = rneagen_generate(urdf, (size_t)length, &o, &r, &e);
	Py_END_ALLOW_THREADS
	if (code)
		return raise_generator(&e);
	dict = text_dict(&r);
	rneagen_result_free(&r);
	return dict;
}

/* ---- robots ---- */

int interrupted(void *context)
{
	PyThreadState **state = context;
	int found;

	PyEval_RestoreThread(*state);
	found = PyErr_Occurred() || PyErr_CheckSignals();
	*state = PyEval_SaveThread();
	return found;
}

static PyObject *open_text(PyObject *self, PyObject *args)
{
	const struct core *core = PyModule_GetState(self);
	struct rnea_robot *robot;
	struct rnea_options o;
	struct rnea_error e;
	enum rnea_code code;
	PyObject *options;
	PyThreadState *state;
	Py_ssize_t length;
	const char *text;

	if (!PyArg_ParseTuple(args, "s#O!", &text, &length, &PyDict_Type, &options) || options_take_open(options, &o))
		return NULL;
	o.stop = interrupted;
	o.stop_context = &state;
	state = PyEval_SaveThread();
	code = rnea_open(text, (size_t)length, &o, &robot, &e);
	PyEval_RestoreThread(state);
	if (PyErr_Occurred() && !code)
		rnea_close(robot);
	if (PyErr_Occurred())
		return NULL;
	return code ? raise_runtime(&e) : kernel_new(core->kernel, robot);
}

static PyObject *evaluate(PyObject *self, PyObject *args)
{
	const struct core *core = PyModule_GetState(self);
	PyObject *generate_options, *options;
	struct rnea_robot *robot;
	struct rneagen_options g;
	struct rnea_options o;
	struct rnea_error e;
	enum rnea_code code;
	Py_ssize_t length;
	const char *urdf;

	if (!PyArg_ParseTuple(args, "y#O!O!", &urdf, &length, &PyDict_Type, &generate_options, &PyDict_Type, &options) ||
		options_take(generate_options, &g) || options_take_open(options, &o))
		return NULL;
	Py_BEGIN_ALLOW_THREADS
	code = rnea_evaluate_urdf(urdf, (size_t)length, &g, &o, &robot, &e);
	Py_END_ALLOW_THREADS
	return code ? raise_runtime(&e) : kernel_new(core->kernel, robot);
}

/* ---- DLPack ---- */

/* The head of DLManagedTensor (dlpack.h, version 0): the tensor itself. */
struct tensor {
	void *data;
	int32_t device_type, device;
	int32_t axes;
	uint8_t kind, bits;
	uint16_t lanes;
	int64_t *shape, *strides;
	uint64_t offset;
};

static PyObject *int_tuple(const int64_t *values, int32_t count)
{
	PyObject *tuple = PyTuple_New(count);

	for (int32_t i = 0; tuple && i < count; i++) {
		PyObject *item = PyLong_FromLongLong(values[i]);

		if (!item || PyTuple_SetItem(tuple, i, item))
			Py_CLEAR(tuple);
	}
	return tuple;
}

static PyObject *dlpack(PyObject *self, PyObject *capsule)
{
	const struct tensor *t = PyCapsule_GetPointer(capsule, "dltensor");
	PyObject *shape, *strides;

	(void)self;
	if (!t)
		return NULL;
	if (t->lanes != 1)
		return PyErr_Format(PyExc_TypeError, "numbers of %d lanes", t->lanes);
	shape = int_tuple(t->shape, t->axes);
	strides = t->strides ? int_tuple(t->strides, t->axes) : Py_NewRef(Py_None);
	if (shape && strides)
		return Py_BuildValue("(NiiiNN)", PyLong_FromVoidPtr((char *)t->data + t->offset), t->device, t->kind,
			t->bits, shape, strides);
	Py_XDECREF(shape);
	Py_XDECREF(strides);
	return NULL;
}

/* ---- the module ---- */

static PyObject *scene_words(PyObject *self, PyObject *unused)
{
	static const char *const words[] = {
#define SCENE_WORD(key, word, takes, kind) word,
		SCENE_KEYS(SCENE_WORD)
#undef SCENE_WORD
	};
	static const int takes[] = {
#define SCENE_TAKES(key, word, takes, kind) takes,
		SCENE_KEYS(SCENE_TAKES)
#undef SCENE_TAKES
	};
	static const enum scene_kind kinds[] = {
#define SCENE_KIND(key, word, takes, kind) kind,
		SCENE_KEYS(SCENE_KIND)
#undef SCENE_KIND
	};
	static const char *const names[] = {"name", "names", "pair", "freed", "value"};
	PyObject *dict = PyDict_New();

	(void)self, (void)unused;
	for (int i = 0; dict && i < SCENE_KEY_COUNT; i++) {
		PyObject *value = Py_BuildValue("(is)", takes[i], names[kinds[i]]);

		if (!value || PyDict_SetItemString(dict, words[i], value))
			Py_CLEAR(dict);
		Py_XDECREF(value);
	}
	return dict;
}

/* A file of rotor inertias as lines of a scene, by the reader of the command. */
static PyObject *armature(PyObject *self, PyObject *args)
{
	struct rneagen_error e = {0};
	const char *path, *content;
	PyObject *lines;
	struct arena a;
	struct text t;
	char *copy;

	(void)self;
	if (!PyArg_ParseTuple(args, "ss", &path, &content))
		return NULL;
	arena_init(&a, NULL);
	text_init(&t, &a);
	copy = arena_string(&a, content, strlen(content));
	if (!copy)
		error_memory(&e);
	else
		scene_put_armature(path, copy, &t, &e);
	lines = e.code ? raise_generator(&e) : PyUnicode_FromString(text_string(&t));
	arena_free(&a);
	return lines;
}

/* Raises what open would say of these options. */
static PyObject *check_open(PyObject *self, PyObject *options)
{
	struct rnea_options o;

	(void)self;
	if (!PyDict_Check(options))
		return PyErr_Format(PyExc_TypeError, "a dictionary is wanted");
	return options_take_open(options, &o) ? NULL : Py_NewRef(Py_None);
}

static PyMethodDef methods[] = {
	{"generate", generate, METH_VARARGS,
		"generate(urdf, options): a dictionary of name, source, header, info, info_json, dot, warnings."},
	{"open", open_text, METH_VARARGS, "open(text, options): a Kernel."},
	{"compile", object_make, METH_VARARGS,
		"compile(text, options): the bytes of a shared object, by the compiler and the cache of open."},
	{"evaluate", evaluate, METH_VARARGS,
		"evaluate(urdf, generate_options, options): a Kernel that compiles nothing."},
	{"dlpack", dlpack, METH_O,
		"dlpack(capsule): (address, device, kind, bits, shape, strides in elements or None). The capsule keeps the array."},
	{"scene_words", scene_words, METH_NOARGS,
		"The words of a scene: whether they take a value (0 no, 1 yes, 2 may), and of what kind."},
	{"check_open", check_open, METH_O, "check_open(options): raises what open would say of them."},
	{"armature", armature, METH_VARARGS,
		"armature(path, content): the lines of a scene that a file of rotor inertias means; the path is for messages."},
	{"xla_handlers", xla_handlers, METH_NOARGS,
		"xla_handlers(): capsules for jax.ffi, by platform; {} where the build had no header of XLA."},
	{"xla_keep", xla_keep, METH_VARARGS,
		"xla_keep(number, kernel, device): what XLA's programs name by the number; device -1: the processor."},
	{NULL, NULL, 0, NULL}};

static int add_type(PyObject *module, PyType_Spec *spec, PyTypeObject **type)
{
	*type = (PyTypeObject *)PyType_FromModuleAndSpec(module, spec, NULL);
	return *type ? PyModule_AddType(module, *type) : -1;
}

static int execute(PyObject *module)
{
	struct core *core = PyModule_GetState(module);

	if (PyModule_AddStringConstant(module, "version", RNEAGEN_VERSION))
		return -1;
	return add_type(module, &kernel_spec, &core->kernel) || add_type(module, &model_spec, &core->model) ||
			add_type(module, &robot_spec, &core->robot) || add_type(module, &step_spec, &core->step)
		? -1
		: 0;
}

static int traverse(PyObject *module, visitproc visit, void *arg)
{
	struct core *core = PyModule_GetState(module);

	Py_VISIT(core->kernel);
	Py_VISIT(core->model);
	Py_VISIT(core->robot);
	Py_VISIT(core->step);
	return 0;
}

static int clear(PyObject *module)
{
	struct core *core = PyModule_GetState(module);

	Py_CLEAR(core->kernel);
	Py_CLEAR(core->model);
	Py_CLEAR(core->robot);
	Py_CLEAR(core->step);
	return 0;
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, execute}, {0, NULL}};

static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, .m_name = "_core",
	.m_doc = "What rneagen's package needs of its libraries.",
	.m_size = sizeof(struct core), .m_methods = methods, .m_slots = slots, .m_traverse = traverse, .m_clear = clear};

PyMODINIT_FUNC PyInit__core(void)
{
	return PyModuleDef_Init(&definition);
}
