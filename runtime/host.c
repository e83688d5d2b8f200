/* getpid */
#define _POSIX_C_SOURCE 200809L
#include "host.h"
#include "compiler.h"
#include "library.h"
#include "object.h"
#include "source.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#if defined _OPENMP
#include <omp.h>
#endif

/* ---- the key of the cache ---- */

struct key {
	char *data; /* malloc; NULL: nothing is kept */
	size_t size;
};

static void append(char *key, size_t *used, const char *text)
{
	size_t length = strlen(text) + 1; /* with its NUL, so that two texts do not run into each other */

	if (key)
		memcpy(key + *used, text, length);
	*used += length;
}

/* Everything that the object depends on. What the options name, files to include for one, is taken not to change. */
static size_t fill_key(char *key, const struct host_request *r, const struct compiler *c)
{
	size_t used = 0;

	append(key, &used, "rnea host 1");
	append(key, &used, c->identity);
	append(key, &used, r->name);
	append(key, &used, r->source);
	for (size_t i = 0; i < r->option_count; i++)
		append(key, &used, r->options[i]);
	return used;
}

static enum rnea_code make_key(
	struct key *key, const struct host_request *r, const struct compiler *c, struct rnea_error *e)
{
	memset(key, 0, sizeof *key);
	if (!r->cache || !r->cache->folder[0] || !c->identity[0])
		return RNEA_OK;
	key->size = fill_key(NULL, r, c);
	if (!(key->data = malloc(key->size)))
		return rnea_error_memory(e);
	fill_key(key->data, r, c);
	return RNEA_OK;
}

/* ---- loading ---- */

static void find_slices(struct host *h, const char *name)
{
	const struct library object = {.handle = h->handle};
	char symbol[SOURCE_SYMBOL_SIZE];

	for (int k = 0; k < RNEA_KERNEL_COUNT; k++) {
		source_symbol(name, (enum rnea_kernel)k, "slice", symbol);
		library_symbol(&object, symbol, &h->slices[k]);
	}
}

static int find_info(struct host *h, const char *name)
{
	const struct library object = {.handle = h->handle};
	char symbol[SOURCE_SYMBOL_SIZE];

	snprintf(symbol, sizeof symbol, "%.*s_info", SOURCE_NAME_LIMIT, name);
	return library_symbol(&object, symbol, &h->info);
}

static enum rnea_code load(
	struct host *h, const struct host_request *r, const char *data, size_t size, struct rnea_error *e)
{
	if (object_load(data, size, r->name, &h->handle, e))
		return e->code;
	if (!find_info(h, r->name))
		return rnea_error_set(e, RNEA_TEXT, "%s: compiled, but it has no %s_info", r->file, r->name);
	find_slices(h, r->name);
	if (!h->slices[RNEA_KERNEL_RNEA])
		return rnea_error_set(e, RNEA_TEXT,
			"%s: compiled, but it has no %s_rnea_slice: write the text again with this version of rneagen",
			r->file, r->name);
	return RNEA_OK;
}

/* An entry that does not load, made by another C library for one, is as good as none. */
static int load_cached(struct host *h, const struct host_request *r, const struct key *key)
{
	struct rnea_error ignored = {0};
	size_t size;
	char *data;

	if (!key->data || !cache_get(r->cache, key->data, key->size, &data, &size))
		return 0;
	load(h, r, data, size, &ignored);
	free(data);
	if (ignored.code)
		host_close(h);
	h->cached = !ignored.code;
	return h->cached;
}

static enum rnea_code load_compiled(struct host *h, const struct host_request *r, const struct compiler *c,
	const struct key *key, struct rnea_error *e)
{
	const struct compiler_request request = {.source = r->source,
		.file = r->file,
		.options = r->options,
		.option_count = r->option_count,
		.log = r->log,
		.log_size = r->log_size};
	size_t size;
	char *data;

	if (compiler_run(c, &request, &data, &size, e))
		return e->code;
	if (!load(h, r, data, size, e)) {
		compiler_describe(c, h->compiler, sizeof h->compiler);
		if (key->data)
			cache_put(r->cache, key->data, key->size, data, size);
	}
	free(data);
	return e->code;
}

/* More threads than a few for each processor serve nobody, and OpenMP ends the program where it cannot start one. */
static unsigned choose_threads(unsigned wanted)
{
#if defined _OPENMP
	int found = omp_get_num_procs();
	unsigned processors = found > 0 ? (unsigned)found : 1;

	if (!wanted)
		return processors;
	return wanted / 4 < processors ? wanted : 4 * processors;
#else
	(void)wanted;
	return 1;
#endif
}

enum rnea_code host_open(struct host *h, const struct host_request *r, struct rnea_error *e)
{
	struct key key = {0};
	struct compiler *c = malloc(sizeof *c);

	memset(h, 0, sizeof *h);
	if (!c)
		rnea_error_memory(e);
	else if (!compiler_find(c, e) && !make_key(&key, r, c, e) && !load_cached(h, r, &key))
		load_compiled(h, r, c, &key, e);
	free(key.data);
	free(c);
	if (e->code)
		host_close(h);
	else
		h->threads = choose_threads(r->threads);
	h->process = (long)getpid();
	return e->code;
}

void host_close(struct host *h)
{
	if (h->handle)
		dlclose(h->handle);
	memset(h, 0, sizeof *h);
}

/* ---- running ---- */

/* Samples that a thread takes at a time, of which texts check and vectorise 256 together. One slice of an arm takes as
   long as waking a second thread: two slices in two threads take 0.6 of the time of one thread, two of 256 samples
   still 0.8, and batches of one slice start no thread. */
enum { SLICE = 512 };

void host_run(const struct host *h, enum rnea_kernel kernel, void *const *arrays, size_t count)
{
	host_slice *slice = h->slices[kernel];
	size_t slices = count / SLICE + (count % SLICE != 0);

	if (!slice || count == 0)
		return;
	/* OpenMP's threads are not there after a fork, and it would wait for them for ever */
	if (slices == 1 || h->threads == 1 || h->process != (long)getpid()) {
		slice(arrays, count, 0, count);
		return;
	}
#if defined _OPENMP
#pragma omp parallel for schedule(dynamic) num_threads(slices < h->threads ? (int)slices : (int)h->threads)
#endif
	for (size_t i = 0; i < slices; i++)
		slice(arrays, count, i * SLICE, i + 1 < slices ? (i + 1) * SLICE : count);
}
