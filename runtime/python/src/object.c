/* A text as a shared object for others to load: the host backend's compiler, and the same cache. */
#include "module.h"
#include "cache/cache.h"
#include "host/compiler.h"
#include <stdlib.h>
#include <string.h>

static const char kind[] = "rnea object 1"; /* texts that librnea opens have another */

/* kind, compiler and text, each with its NUL; malloc, *size bytes. NULL, and *size is 0: nothing is kept. */
static char *make_key(const struct compiler *c, const char *text, size_t *size)
{
	size_t identity = strlen(c->identity) + 1, length = strlen(text) + 1;
	char *key = identity > 1 ? malloc(sizeof kind + identity + length) : NULL;

	*size = key ? sizeof kind + identity + length : 0;
	if (key) {
		memcpy(key, kind, sizeof kind);
		memcpy(key + sizeof kind, c->identity, identity);
		memcpy(key + sizeof kind + identity, text, length);
	}
	return key;
}

static enum rnea_code make_object(
	const char *text, const struct rnea_options *o, char **data, size_t *size, struct rnea_error *e)
{
	const struct compiler_request request = {.source = text, .file = o->file ? o->file : "<text>"};
	struct compiler *c = malloc(sizeof *c);
	struct cache cache;
	size_t key_size;
	char *key;

	if (!c)
		return rnea_error_memory(e);
	if (compiler_find(c, e)) {
		free(c);
		return e->code;
	}
	cache_open(&cache, o->cache);
	key = make_key(c, text, &key_size);
	if ((!key || !cache_get(&cache, key, key_size, data, size)) && !compiler_run(c, &request, data, size, e) && key)
		cache_put(&cache, key, key_size, *data, *size, NULL);
	free(key);
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

	(void)self;
	if (!PyArg_ParseTuple(args, "sO!", &text, &PyDict_Type, &options) || options_take_open(options, &o))
		return NULL;
	Py_BEGIN_ALLOW_THREADS
	make_object(text, &o, &data, &size, &e);
	Py_END_ALLOW_THREADS
	if (e.code)
		return raise_runtime(&e);
	bytes = PyBytes_FromStringAndSize(data, (Py_ssize_t)size);
	free(data);
	return bytes;
}
