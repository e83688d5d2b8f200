/* nanosleep */
#define _POSIX_C_SOURCE 200809L
#include "host/host.h"
#include "host/compiler.h"
#include "core/library.h"
#include "host/object.h"
#include "core/source.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- loading ---- */

host_slice *host_find(const struct host *h, const char *name, const char *function)
{
	const struct library object = {.handle = h->handle};
	char symbol[SOURCE_SYMBOL_SIZE];
	host_slice *slice;

	source_symbol(name, function, "slice", symbol);
	library_symbol(&object, symbol, &slice);
	return slice;
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
	return RNEA_OK;
}

/* An entry that does not load, made by another C library for one, is as good as none. */
static int load_cached(struct host *h, const struct host_request *r, const struct host_key *key)
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
	const struct host_key *key, struct rnea_error *e)
{
	const struct compiler_request request = {.source = r->source,
		.file = r->file,
		.options = r->options,
		.option_count = r->option_count,
		.log = r->log,
		.log_size = r->log_size,
		.stop = r->stop};
	size_t size;
	char *data;

	if (compiler_run(c, &request, &data, &size, e))
		return e->code;
	if (!load(h, r, data, size, e)) {
		compiler_describe(c, h->compiler, sizeof h->compiler);
		if (key->data)
			cache_put(r->cache, key->data, key->size, data, size, r->unkept);
	}
	free(data);
	return e->code;
}

/* ---- opening ---- */

enum { TURN_MILLISECONDS = 20, TURN_LIMIT = 300 * 1000 / TURN_MILLISECONDS };

/* What another process compiles is waited for, though not for ever: a fork of one that was killed may still hold its turn. */
static enum rnea_code load_in_turn(struct host *h, const struct host_request *r, const struct compiler *c,
	const struct host_key *key, struct rnea_error *e)
{
	struct cache_turn turn = {-1, -1, ""};
	const struct timespec pause = {.tv_nsec = TURN_MILLISECONDS * 1000000L};

	for (int i = 0; key->data && i < TURN_LIMIT && !cache_turn_begin(r->cache, key->data, key->size, &turn); i++) {
		nanosleep(&pause, NULL);
		if (r->stop.ask && r->stop.ask(r->stop.context))
			return rnea_error_set(e, RNEA_COMPILER, "%s: stopped while another process compiled it", r->file);
	}
	if (!load_cached(h, r, key))
		load_compiled(h, r, c, key, e);
	cache_turn_end(&turn);
	return e->code;
}

enum rnea_code host_open(struct host *h, const struct host_request *r, struct rnea_error *e)
{
	struct host_key key = {0};
	struct compiler *c = malloc(sizeof *c);

	memset(h, 0, sizeof *h);
	if (!c)
		rnea_error_memory(e);
	else if (!compiler_find(c, e) && !host_key(&key, r, c, e) && !load_cached(h, r, &key))
		load_in_turn(h, r, c, &key, e);
	free(key.data);
	free(c);
	if (!e->code && (h->workers = workers_open(r->threads)) == NULL)
		rnea_error_memory(e);
	if (e->code)
		host_close(h);
	else
		h->threads = workers_limit(h->workers);
	return e->code;
}

void host_close(struct host *h)
{
	workers_close(h->workers);
	if (h->handle)
		dlclose(h->handle);
	memset(h, 0, sizeof *h);
}

/* ---- running ---- */

/* Nanoseconds of one operation, of a sample among many: where arrays are aos the compiler cannot take several samples at
   once. Processors are up to three times as fast as this. */
static const struct cost {
	const char *arithmetic;
	double soa, aos;
} costs[] = {{"f32", 0.04, 0.3}, {"f64", 0.08, 0.3}, {"f32x2", 0.4, 2}};

/* Operations that a sine and cosine take, and nanoseconds of a byte that is read or written. */
static const double sincos = 40, byte = 0.05;

enum { COSTS = sizeof costs / sizeof *costs };

double host_sample_ns(const struct rnea_info *info, const struct rnea_function *f)
{
	const struct rnea_operations *o = &f->operations;
	double operations = (double)o->mul + (double)o->add + (double)o->sub + (double)o->fma + sincos * (double)o->sincos,
		bytes = 0;
	int i = 0;

	while (i + 1 < COSTS && strcmp(info->arithmetic, costs[i].arithmetic) != 0)
		i++;
	for (size_t k = 0; k < f->input_count + f->output_count; k++)
		if (!f->arguments[k].per_batch)
			bytes += (double)f->arguments[k].rows * (f->arguments[k].scalar == RNEA_F64 ? 8 : 4);
	return operations * (info->layout == RNEA_AOS ? costs[i].aos : costs[i].soa) + byte * bytes;
}

/* Work that is worth a thread, which takes some 10 us to wake. */
static const double worth_ns = 50e3;

unsigned host_threads(const struct host *h, const struct host_function *f, size_t count)
{
	double worth = (double)count * f->sample_ns / worth_ns;

	return worth < 2 ? 1 : worth < (double)h->threads ? (unsigned)worth : h->threads;
}

/* Samples that a thread takes at a time, of which texts check and vectorise 256 together; fewer of those that take long,
   for in the end threads wait for each other. */
enum { PIECE = 512, PIECE_LONG = 256 };
static const double long_ns = 100;

struct batch {
	host_slice *slice;
	void *const *arrays;
	size_t count, piece;
};

static void run_piece(void *batch, size_t i)
{
	const struct batch *b = batch;
	size_t first = i * b->piece, rest = b->count - first;

	b->slice(b->arrays, b->count, first, rest < b->piece ? b->count : first + b->piece);
}

void host_run(const struct host *h, const struct host_function *f, void *const *arrays, size_t count)
{
	struct batch b = {f->slice, arrays, count, f->sample_ns > long_ns ? PIECE_LONG : PIECE};
	unsigned threads = host_threads(h, f, count);

	if (count == 0)
		return;
	if (threads == 1)
		b.slice(arrays, count, 0, count);
	else
		workers_run(h->workers, threads, run_piece, &b, count / b.piece + (count % b.piece != 0));
}
