/* Dictionaries of Python as options of both libraries. */
#include "module.h"
#include <limits.h>
#include <string.h>

struct word {
	const char *word;
	int value;
};

/* A value that is one of a few words. */
static int take_word(const char *key, PyObject *value, const struct word *words, int *result)
{
	const char *s = PyUnicode_Check(value) ? PyUnicode_AsUTF8AndSize(value, NULL) : NULL;
	char known[128] = "";

	if (!s && PyErr_Occurred())
		return -1;
	for (const struct word *w = words; w->word; w++) {
		if (s && !strcmp(s, w->word)) {
			*result = w->value;
			return 0;
		}
		strncat(known, *known ? ", " : "", sizeof known - strlen(known) - 1);
		strncat(known, w->word, sizeof known - strlen(known) - 1);
	}
	PyErr_Format(s ? PyExc_ValueError : PyExc_TypeError, "%s takes %s, not %R", key, known, value);
	return -1;
}

static int take_string(const char *key, PyObject *value, const char **result)
{
	Py_ssize_t length;
	const char *s = PyUnicode_Check(value) ? PyUnicode_AsUTF8AndSize(value, &length) : NULL;

	if (s && strlen(s) == (size_t)length) {
		*result = s;
		return 0;
	}
	if (!PyErr_Occurred())
		PyErr_Format(s ? PyExc_ValueError : PyExc_TypeError, "%s takes a string without NUL, not %R", key, value);
	return -1;
}

static int take_int(const char *key, PyObject *value, int least, int *result)
{
	long n = PyLong_AsLong(value);

	if (n == -1 && PyErr_ExceptionMatches(PyExc_TypeError))
		PyErr_Format(PyExc_TypeError, "%s takes a whole number, not %R", key, value);
	if (n == -1 && PyErr_Occurred())
		return -1;
	if (n < least || n > INT_MAX) {
		PyErr_Format(PyExc_ValueError, "%s takes a whole number from %d on, not %R", key, least, value);
		return -1;
	}
	*result = (int)n;
	return 0;
}

static int take_gravity(PyObject *value, double gravity[3])
{
	if (!PySequence_Check(value) || PySequence_Size(value) != 3) {
		PyErr_Format(PyExc_ValueError, "gravity takes three numbers, not %R", value);
		return -1;
	}
	for (int i = 0; i < 3; i++) {
		PyObject *item = PySequence_GetItem(value, i);

		gravity[i] = item ? PyFloat_AsDouble(item) : 0;
		Py_XDECREF(item);
		if (PyErr_Occurred() && PyErr_ExceptionMatches(PyExc_TypeError))
			PyErr_Format(PyExc_TypeError, "gravity takes three numbers, not %R", value);
		if (PyErr_Occurred())
			return -1;
		if (!(gravity[i] - gravity[i] == 0)) {
			PyErr_Format(PyExc_ValueError, "gravity takes three finite numbers, not %R", value);
			return -1;
		}
	}
	return 0;
}

#define WORD(name, word) {word, RNEAGEN_##name},
#define TARGET_WORD(name, word) {word, RNEAGEN_TARGET_##name},
static const struct word targets[] = {RNEAGEN_TARGETS(TARGET_WORD){NULL, 0}};
static const struct word precisions[] = {RNEAGEN_PRECISIONS(WORD){NULL, 0}};
static const struct word layouts[] = {{"soa", RNEAGEN_SOA}, {"aos", RNEAGEN_AOS}, {NULL, 0}};
static const struct word trigs[] = {
	{"accurate", RNEAGEN_ACCURATE}, {"bounded", RNEAGEN_BOUNDED}, {"fast", RNEAGEN_FAST}, {NULL, 0}};
static const struct word bases[] = {{"fixed", RNEAGEN_FIXED}, {"floating", RNEAGEN_FLOATING}, {NULL, 0}};
static const struct word mimics[] = {{"honour", RNEAGEN_MIMIC_HONOUR}, {"independent", RNEAGEN_MIMIC_INDEPENDENT}, {NULL, 0}};
#define ONLY_WORD(name, word) {word, RNEAGEN_ONLY_##name},
static const struct word onlys[] = {RNEAGEN_ONLY_WORDS(ONLY_WORD){NULL, 0}};
static const struct word backends[] = {{"any", RNEA_BACKEND_ANY}, {"cuda", RNEA_BACKEND_CUDA}, {"cpu", RNEA_BACKEND_HOST},
	{"evaluator", RNEA_BACKEND_EVALUATOR}, {NULL, 0}};

/* One that is a word of a few: 0 or -1; 1: it is not. */
static int take_choice(const char *key, PyObject *value, struct rneagen_options *o)
{
	int x = 0, bad = 1;

	if (!strcmp(key, "target")) {
		bad = take_word(key, value, targets, &x);
		o->target = (enum rneagen_target)x;
	} else if (!strcmp(key, "precision")) {
		bad = take_word(key, value, precisions, &x);
		o->precision = (enum rneagen_precision)x;
	} else if (!strcmp(key, "layout")) {
		bad = take_word(key, value, layouts, &x);
		o->layout = (enum rneagen_layout)x;
	} else if (!strcmp(key, "trig")) {
		bad = take_word(key, value, trigs, &x);
		o->trig = (enum rneagen_trig)x;
	} else if (!strcmp(key, "base")) {
		bad = take_word(key, value, bases, &x);
		o->base = (enum rneagen_base)x;
	} else if (!strcmp(key, "mimic")) {
		bad = take_word(key, value, mimics, &x);
		o->mimic = (enum rneagen_mimic)x;
	} else if (!strcmp(key, "only")) {
		bad = take_word(key, value, onlys, &o->only);
	}
	return bad;
}

static int take_option(const char *key, PyObject *value, struct rneagen_options *o)
{
	const struct {
		const char *key;
		int *value;
	} numbers[] = {{"strict", &o->strict}, {"bounded", &o->bounded}, {"parts", &o->parts},
		{"segments", &o->segments}, {"limbs", &o->limbs}, {"tell", (int *)&o->tell}};
	const struct {
		const char *key, **value;
	} strings[] = {{"order", &o->order}, {"name", &o->name}, {"file", &o->file}, {"scene", &o->scene}};
	int done = take_choice(key, value, o);

	if (done <= 0)
		return done;
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		if (!strcmp(key, numbers[i].key))
			return take_int(key, value, 0, numbers[i].value);
	for (size_t i = 0; i < sizeof strings / sizeof *strings; i++)
		if (!strcmp(key, strings[i].key))
			return take_string(key, value, strings[i].value);
	if (!strcmp(key, "gravity"))
		return take_gravity(value, o->gravity);
	PyErr_Format(PyExc_TypeError, "'%s' is not known", key);
	return -1;
}

int options_take(PyObject *dict, struct rneagen_options *o)
{
	PyObject *key, *value;
	Py_ssize_t at = 0;

	*o = rneagen_options_default();
	while (PyDict_Next(dict, &at, &key, &value)) {
		const char *name;

		if (take_string("an option", key, &name) || take_option(name, value, o))
			return -1;
	}
	return 0;
}

int options_take_open(PyObject *dict, struct rnea_options *o)
{
	PyObject *key, *value;
	Py_ssize_t at = 0;
	int x = 0, bad = 0;

	*o = (struct rnea_options){0};
	while (!bad && PyDict_Next(dict, &at, &key, &value)) {
		const char *name;

		if (take_string("an option", key, &name))
			return -1;
		if (!strcmp(name, "backend")) {
			bad = take_word(name, value, backends, &x);
			o->backend = (enum rnea_backend)x;
		} else if (!strcmp(name, "device")) {
			bad = take_int(name, value, 0, &o->device);
		} else if (!strcmp(name, "block")) {
			bad = take_int(name, value, 0, &x);
			o->block = (unsigned)x;
		} else if (!strcmp(name, "threads")) {
			bad = take_int(name, value, 0, &x);
			o->threads = (unsigned)x;
		} else if (!strcmp(name, "file") || !strcmp(name, "cache")) {
			bad = take_string(name, value, *name == 'f' ? &o->file : &o->cache);
		} else {
			PyErr_Format(PyExc_TypeError, "'%s' is not known", name);
			bad = -1;
		}
	}
	return bad;
}
