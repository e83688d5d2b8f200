/* A text as a shared object for others to load: the host backend's compiler, and the same cache. */
#include "module.h"
#include "cache/cache.h"
#include "host/compiler.h"
#include "host/host.h"
#include <stdlib.h>

static enum rnea_code find_or_run(
	const struct host_request *r, const struct compiler *c, char **data, size_t *size, struct rnea_error *e)
{
	const struct compiler_request request = {.source = r->source, .file = r->file, .stop = r->stop};
	struct host_key key;

	if (host_key(&key, r, c, e))
		return e->code;
	if ((!key.data || !cache_get(r->cache, key.data, key.size, data, size)) && !compiler_run(c, &request, data, size, e) && key.data)
		cache_put(r->cache, key.data, key.size, *data, *size, NULL);
	free(key.data);
	return e->code;
}

/* As the host backend names it, but for NAME_info, which it has none of. */
static enum rnea_code make_object(
	const char *text, const struct rnea_options *o, PyThreadState **state, char **data, size_t *size, struct rnea_error *e)
{
	struct cache cache;
	const struct host_request request = {
		.source = text, .file = o->file ? o->file : "<text>", .name = "", .cache = &cache,
		.stop = {interrupted, state}};
	struct compiler *c = malloc(sizeof *c);

	cache_open(&cache, o->cache);
	if (!c)
		rnea_error_memory(e);
	else if (!compiler_find(c, e))
		find_or_run(&request, c, data, size, e);
	free(c);
	return e->code;
}

PyObject *object_make(PyObject *self, PyObject *args)
{
	PyObject *options, *bytes;
	struct rnea_options o;
	struct rnea_error e = {0};
	char *data = NULL;
	size_t size = 0;
	const char *text;
	PyThreadState *state;

	(void)self;
	if (!PyArg_ParseTuple(args, "sO!", &text, &PyDict_Type, &options) || options_take_open(options, &o))
		return NULL;
	state = PyEval_SaveThread();
	make_object(text, &o, &state, &data, &size, &e);
	PyEval_RestoreThread(state);
	if (e.code && !PyErr_Occurred())
		raise_runtime(&e);
	if (PyErr_Occurred()) {
		free(data);
		return NULL;
	}
	bytes = PyBytes_FromStringAndSize(data, (Py_ssize_t)size);
	free(data);
	return bytes;
}
