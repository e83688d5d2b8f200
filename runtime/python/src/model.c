/* A robot in its scene, analysed: arrays, joints, limits, patterns of matrices, drawn inputs. Nothing is compiled. */
#include "module.h"
#include "draw/draw.h"
#include "rnearun/signature.h"
#include "tree/pattern.h"
#include <math.h>
#include <string.h>

struct model {
	PyObject_HEAD
	PyObject *urdf, *options; /* bytes, dict: the analysis reads them */
	struct analysis analysis;
	struct rneagen_error error;
	int is_open;
};

PyObject *raise_generator(const struct rneagen_error *e)
{
	PyObject *value;

	if (e->code == RNEAGEN_MEMORY)
		return PyErr_NoMemory();
	value = Py_BuildValue("(ss)", e->message, "URDF");
	if (value)
		PyErr_SetObject(PyExc_ValueError, value);
	Py_XDECREF(value);
	return NULL;
}

static int model_init(PyObject *self, PyObject *args, PyObject *names)
{
	struct model *m = (struct model *)self;
	struct rneagen_options o;
	Py_ssize_t length;
	char *bytes;
	enum rneagen_code code;

	if (m->is_open || names || !PyArg_ParseTuple(args, "SO!", &m->urdf, &PyDict_Type, &m->options)) {
		m->urdf = m->options = NULL;
		return -1;
	}
	Py_INCREF(m->urdf);
	Py_INCREF(m->options);
	if (PyBytes_AsStringAndSize(m->urdf, &bytes, &length) || options_take(m->options, &o))
		return -1;
	Py_BEGIN_ALLOW_THREADS
	code = analysis_open(&m->analysis, bytes, (size_t)length, &o, &m->error);
	Py_END_ALLOW_THREADS
	if (code) {
		raise_generator(&m->error);
		return -1;
	}
	m->is_open = 1;
	return 0;
}

static void model_free(PyObject *self)
{
	struct model *m = (struct model *)self;
	PyTypeObject *type = Py_TYPE(self);

	if (m->is_open)
		analysis_free(&m->analysis);
	Py_XDECREF(m->urdf);
	Py_XDECREF(m->options);
	((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
	Py_DECREF(type);
}

/* Append, and give the reference to the list. 0, or -1. */
static int append(PyObject *list, PyObject *item)
{
	int bad = !item || PyList_Append(list, item);

	Py_XDECREF(item);
	return bad ? -1 : 0;
}

/* What its rows are where a call leaves it out; None: it must be given. */
static PyObject *default_of(const struct signature_array *s)
{
	PyObject *list = s->has_default ? PyList_New(0) : Py_NewRef(Py_None);

	for (size_t i = 0; list && s->has_default && i < s->rows; i++)
		if (append(list, PyFloat_FromDouble(s->nominal ? (double)s->nominal[i] : 0)))
			Py_CLEAR(list);
	return list;
}


/* ---- arrays ---- */

/* The want of this array, where it is a matrix by joints; NULL: it is none. */
static const struct want *find_matrix(const struct request *k, const char *argument)
{
	for (int i = 0; i < k->stored_count; i++)
		if (!strcmp(k->wants[i].argument, argument) && request_is_matrix(k, &k->wants[i]))
			return &k->wants[i];
	return NULL;
}

/* Where the elements of a wanted matrix stand: (rows, columns, how many rows and columns there are); None for what is none. */
static PyObject *pattern_of(struct model *m, const char *argument)
{
	struct analysis *a = &m->analysis;
	const struct want *w = find_matrix(&a->request, argument);
	int cols = 0, found;
	PyObject *row = PyList_New(0), *col = PyList_New(0);
	struct pattern p = {0};
	struct arena arena;

	arena_init(&arena, NULL);
	found = w && request_pattern(&p, &a->tree, w, a->request.dense, &arena);
	cols = p.cols;
	for (int i = 0; found && row && col && i < p.lines * cols; i++)
		if (p.row[i] >= 0 && (append(row, PyLong_FromLong(i / cols)) || append(col, PyLong_FromLong(i % cols))))
			Py_CLEAR(row);
	arena_free(&arena);
	if (found && row && col)
		return Py_BuildValue("(NNii)", row, col, p.lines, cols);
	found = row && col;
	Py_XDECREF(row);
	Py_XDECREF(col);
	return found ? Py_NewRef(Py_None) : NULL;
}

static PyObject *array_dict(struct model *m, const struct signature_array *s, const char *of)
{
	return Py_BuildValue("{ss ss sn sO sO ss ss sN sN}", "name", s->name, "word", s->word, "rows",
		(Py_ssize_t)s->rows, "is_output", s->is_output ? Py_True : Py_False, "per_batch", s->per_batch ? Py_True
			: Py_False, "role", role_word(s->role), "of",
		of ? of : "", "default", default_of(s), "pattern", pattern_of(m, s->name));
}

static PyObject *model_arrays(PyObject *self, PyObject *unused)
{
	struct model *m = (struct model *)self;
	PyObject *list = PyList_New(0);
	struct signature s;

	(void)unused;
	if (!signature_of(&s, &m->analysis))
		Py_CLEAR(list);
	for (size_t i = 0; list && i < s.count; i++)
		if (append(list, array_dict(m, &s.arrays[i], m->analysis.dag.arguments[i].of)))
			Py_CLEAR(list);
	return list ? list : PyErr_Occurred() ? NULL : PyErr_NoMemory();
}

/* ---- joints ---- */

static PyObject *joint_dict(const struct model *m, int i)
{
	const struct tree *t = &m->analysis.tree;
	const struct tree_joint *j = &t->joints[i];
	const struct joint *x = tree_joint_of(t->source, t, i);
	double none = (double)INFINITY;
	int is_limited = x && x->has_limits && j->nq == 1 && j->type != JOINT_CONTINUOUS,
	    has_rates = x && (x->has_limits || x->has_rates);

	return Py_BuildValue("{ss ss ss si si si si sd sd sd sd}", "name", j->name, "link", t->bodies[j->body].link,
		"type", joint_type_name(j->type), "iq", j->iq, "nq", j->nq, "iv", j->iv, "nv", j->nv, "lower",
		is_limited ? x->lower : -none, "upper", is_limited ? x->upper : none, "velocity",
		has_rates && x->velocity > 0 ? x->velocity : none, "effort",
		has_rates && x->effort > 0 ? x->effort : none);
}

static PyObject *model_joints(PyObject *self, PyObject *unused)
{
	const struct model *m = (struct model *)self;
	PyObject *list = PyList_New(0);

	(void)unused;
	for (int i = 0; list && i < m->analysis.tree.joint_count; i++)
		if (append(list, joint_dict(m, i)))
			Py_CLEAR(list);
	return list;
}

static PyObject *warnings_list(const struct analysis *a)
{
	PyObject *list = PyList_New(0);

	for (size_t i = 0; list && i < a->robot.warning_count; i++)
		if (append(list, PyUnicode_FromString(a->robot.warnings[i])))
			Py_CLEAR(list);
	return list;
}

/* Does the robot float, with the first rows of q, in the world's own frame? */
static int has_free_base(const struct analysis *a)
{
	const struct tree *t = &a->stated;
	const struct body *b = t->joint_count ? &t->bodies[t->joints[0].body] : NULL;
	int is_free = b && t->joints[0].type == JOINT_FLOATING && !t->joints[0].iq && b->parent < 0;

	for (int i = 0; i < 9 && is_free; i++)
		is_free = b->X.R.m[i / 3][i % 3].x == (i / 3 == i % 3) && b->X.p[i / 3].x == 0;
	return is_free;
}

/* Values of the rows that the scene gives, by row. */
static PyObject *given_dict(const struct row *rows, int count)
{
	PyObject *dict = PyDict_New();

	for (int i = 0; dict && i < count; i++) {
		PyObject *row = PyLong_FromLong(i), *value = PyFloat_FromDouble((double)rows[i].value.x);

		if (!row || !value || (rows[i].is_given && PyDict_SetItem(dict, row, value)))
			Py_CLEAR(dict);
		Py_XDECREF(row);
		Py_XDECREF(value);
	}
	return dict;
}

static PyObject *model_facts(PyObject *self, PyObject *unused)
{
	const struct analysis *a = &((struct model *)self)->analysis;
	const struct request *k = &a->request;
	int nq = a->tree.nq, nv = a->tree.nv;

	(void)unused;
	return Py_BuildValue("{ss si si si sO sO sO sl sN s{sN sN sN sN}}", "name", a->robot.name, "nq", nq, "nv", nv, "nb",
		a->tree.body_count, "floating", a->tree.floating ? Py_True : Py_False, "free_base",
		has_free_base(a) ? Py_True : Py_False, "forward",
		k->is_forward ? Py_True : Py_False, "flops", analysis_flops(a), "warnings", warnings_list(a), "given", "q",
		given_dict(k->q, nq), "qd", given_dict(k->qd, nv), "qdd", given_dict(k->qdd, nv), "tau", given_dict(k->tau, nv));
}

/* ---- drawn inputs ---- */

static PyObject *drawn_dict(const struct drawn *x, size_t samples)
{
	PyObject *dict = PyDict_New();

	for (int i = 0; dict && i < x->count; i++) {
		const struct drawn_array *a = &x->arrays[i];
		Py_ssize_t size = (Py_ssize_t)(a->per_batch ? 1 : samples) * a->rows * (Py_ssize_t)sizeof(double);
		PyObject *bytes = a->values ? PyBytes_FromStringAndSize((const char *)a->values, size) : Py_NewRef(Py_None);

		if (!bytes || PyDict_SetItemString(dict, a->name, bytes))
			Py_CLEAR(dict);
		Py_XDECREF(bytes);
	}
	return dict;
}

static PyObject *model_draw(PyObject *self, PyObject *args)
{
	const struct model *m = (struct model *)self;
	struct draw_options o = {0};
	PyObject *dict = NULL;
	struct drawn drawn;
	struct arena arena;
	Py_ssize_t count;
	int done;

	if (!PyArg_ParseTuple(args, "Kn", &o.seed, &count))
		return NULL;
	o.count = (size_t)count;
	arena_init(&arena, NULL);
	Py_BEGIN_ALLOW_THREADS
	done = draw_inputs(&drawn, &m->analysis.tree, &m->analysis.request, &o, &arena);
	Py_END_ALLOW_THREADS
	dict = done ? drawn_dict(&drawn, o.count) : PyErr_NoMemory();
	arena_free(&arena);
	return dict;
}

static PyMethodDef methods[] = {
	{"arrays", model_arrays, METH_NOARGS, "Inputs, then outputs, in the order of the text."},
	{"joints", model_joints, METH_NOARGS, "Joints with rows, and their limits; infinite where the URDF has none."},
	{"facts", model_facts, METH_NOARGS, "Sizes, and warnings."},
	{"draw", model_draw, METH_VARARGS, "draw(seed, count): bytes of doubles, by the name of an input: [sample][row], or [row]."},
	{NULL, NULL, 0, NULL}};

static PyType_Slot slots[] = {{Py_tp_init, model_init}, {Py_tp_dealloc, model_free}, {Py_tp_methods, methods},
	{Py_tp_doc, "Model(urdf, options)\n\nA robot in its scene, analysed."}, {0, NULL}};

PyType_Spec model_spec = {"rneagen._core.Model", sizeof(struct model), 0, Py_TPFLAGS_DEFAULT, slots};
