#include "cuda/pipe.h"
#include "cuda/packing.h"
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A slice is about SLICE_BYTES, so that copies run at full speed, but no less than SLICE_SAMPLES, so that the kernel
   fills the device. Arrays begin at multiples of ALIGN. */
enum { BUFFERS = 3, SLICE_BYTES = 1 << 22, SLICE_SAMPLES = 4096, ALIGN = 256 };

struct buffer {
	void *stream;		   /* NULL: the buffer has not been needed yet */
	char *locked;		   /* page-locked, buffer_bytes */
	unsigned long long device; /* as many bytes */
	size_t first, count;	   /* the samples of the slice that is under way; none: 0 */
};

struct pipe {
	struct pipe *next;
	struct buffer buffers[BUFFERS];
};

struct pipe_pool {
	const struct driver *driver;
	struct workers *workers;
	const struct rnea_info *info;
	size_t slice, buffer_bytes;
	pthread_mutex_t lock;
	struct pipe *idle; /* under the lock */
};

/* One call. Array i stands at offsets[i] of a buffer's memory: first the inputs that are packed, then the outputs that
   are, then those that are copied from and to where the program has them. */
struct call {
	const struct pipe_pool *pool;
	void *const *arrays;
	size_t count, array_count, slice;
	int direct[RNEA_ARGUMENT_LIMIT];
	size_t offsets[RNEA_ARGUMENT_LIMIT];
	size_t packed_in; /* bytes of packed inputs */
	size_t packed_out_at, packed_out;
};

static size_t sample_bytes(const struct rnea_argument *a)
{
	return a->rows * (a->scalar == RNEA_F64 ? sizeof(double) : sizeof(float));
}

static size_t round_up(size_t bytes)
{
	return (bytes + ALIGN - 1) / ALIGN * ALIGN;
}

static size_t array_count(const struct rnea_info *info)
{
	return info->input_count + info->output_count;
}

/* ---- the pool ---- */

enum rnea_code pipe_open(struct pipe_pool **pool, const struct driver *driver, const struct rnea_info *info,
	unsigned threads, struct rnea_error *e)
{
	struct pipe_pool *p = *pool = calloc(1, sizeof *p);
	size_t bytes = 0, whole = 0, n = array_count(info);

	if (!p)
		return rnea_error_memory(e);
	p->driver = driver;
	p->info = info;
	for (size_t i = 0; i < n; i++)
		*(info->arguments[i].per_batch ? &whole : &bytes) += sample_bytes(&info->arguments[i]);
	p->slice = bytes ? SLICE_BYTES / bytes : 1;
	if (p->slice < SLICE_SAMPLES)
		p->slice = SLICE_SAMPLES;
	/* whole blocks */
	p->slice = (p->slice + info->block - 1) / info->block * info->block;
	p->buffer_bytes = p->slice * bytes + whole + n * ALIGN;
	if ((p->workers = workers_open(threads)) != NULL && pthread_mutex_init(&p->lock, NULL) == 0)
		return RNEA_OK;
	workers_close(p->workers);
	free(p);
	*pool = NULL;
	return rnea_error_memory(e);
}

size_t pipe_slice(const struct pipe_pool *pool)
{
	return pool->slice;
}

static void buffer_free(const struct device *d, struct buffer *b)
{
	struct rnea_error ignored = {0};

	if (b->stream)
		device_finish(d, b->stream, &ignored);
	device_free_host(d, b->locked);
	device_free(d, b->device);
	memset(b, 0, sizeof *b);
}

void pipe_close(struct pipe_pool *pool, int lost)
{
	if (!pool)
		return;
	while (pool->idle) {
		struct pipe *p = pool->idle;

		pool->idle = p->next;
		for (int i = 0; i < BUFFERS && !lost; i++)
			buffer_free(&pool->driver->device, &p->buffers[i]);
		free(p);
	}
	pthread_mutex_destroy(&pool->lock);
	workers_close(pool->workers);
	free(pool);
}

static struct pipe *take_pipe(struct pipe_pool *pool)
{
	struct pipe *p;

	pthread_mutex_lock(&pool->lock);
	if ((p = pool->idle) != NULL)
		pool->idle = p->next;
	pthread_mutex_unlock(&pool->lock);
	return p ? p : calloc(1, sizeof *p);
}

static void return_pipe(struct pipe_pool *pool, struct pipe *p)
{
	pthread_mutex_lock(&pool->lock);
	p->next = pool->idle;
	pool->idle = p;
	pthread_mutex_unlock(&pool->lock);
}

/* Give a buffer what it needs, unless it has it. */
static enum rnea_code buffer_make(const struct pipe_pool *pool, struct buffer *b, struct rnea_error *e)
{
	const struct device *d = &pool->driver->device;
	void *locked = NULL;

	if (b->stream)
		return RNEA_OK;
	/* filled, because what is copied back has gaps between its arrays; with nan, so that an output which no kernel
	   writes is seen */
	if (!device_alloc_host(d, pool->buffer_bytes, &locked, e) && !device_alloc(d, pool->buffer_bytes, &b->device, e) &&
		!device_stream(d, &b->stream, e))
		device_fill_nan(d, b->device, pool->buffer_bytes, b->stream, e);
	b->locked = locked;
	if (e->code)
		buffer_free(d, b);
	return e->code;
}

/* ---- one call ---- */

/* Whether the driver has locked the whole of an array, and so can copy it without our help. */
static enum rnea_code look_at(struct call *c, size_t i, struct rnea_error *e)
{
	const struct device *d = &c->pool->driver->device;
	const struct rnea_argument *a = &c->pool->info->arguments[i];
	const char *first = c->arrays[i], *last = first + sample_bytes(a) * (a->per_batch ? 1 : c->count) - 1;
	enum device_kind kind = device_kind(d, first);

	if (kind == DEVICE_KIND_DEVICE)
		return rnea_error_set(e, RNEA_POINTER,
			"rnea_run: array %zu, \"%s\", is device memory; rnea_launch takes that", i, a->name);
	if (a->per_batch && i >= c->pool->info->input_count && c->slice < c->count)
		return rnea_error_set(e, RNEA_ARGUMENT,
			"rnea_run: array %zu, \"%s\", is an output of the whole batch, which cannot be cut: use "
			"rnea_launch",
			i, a->name);
	c->direct[i] = kind == DEVICE_KIND_LOCKED && device_kind(d, last) == DEVICE_KIND_LOCKED;
	return RNEA_OK;
}

/* Place the arrays with `direct` as given, from input or output `from` to `to` - 1; the bytes used so far are returned.
 */
static size_t place(struct call *c, size_t from, size_t to, int direct, size_t used)
{
	for (size_t i = from; i < to; i++) {
		const struct rnea_argument *a = &c->pool->info->arguments[i];

		if (c->direct[i] != direct)
			continue;
		c->offsets[i] = used;
		used = round_up(used + sample_bytes(a) * (a->per_batch ? 1 : c->slice));
	}
	return used;
}

static enum rnea_code plan(struct call *c, struct rnea_error *e)
{
	const struct rnea_info *info = c->pool->info;
	size_t used;

	c->array_count = array_count(info);
	c->slice = c->count < c->pool->slice ? c->count : c->pool->slice;
	for (size_t i = 0; i < c->array_count; i++)
		if (look_at(c, i, e))
			return e->code;
	c->packed_in = place(c, 0, info->input_count, 0, 0);
	used = place(c, info->input_count, c->array_count, 0, c->packed_in);
	c->packed_out_at = c->packed_in;
	c->packed_out = used - c->packed_in;
	place(c, 0, c->array_count, 1, used);
	return RNEA_OK;
}

/* Where the slice of array i that buffer `b` has lies in the program's memory, and on the device. */
static struct device_lines lines_of(const struct call *c, const struct buffer *b, size_t i)
{
	const struct rnea_argument *a = &c->pool->info->arguments[i];
	size_t bytes = sample_bytes(a), scalar = bytes / a->rows;
	struct device_lines l = {.host = c->arrays[i], .device = b->device + c->offsets[i], .lines = 1, .width = bytes};

	if (a->per_batch)
		return l;
	if (c->pool->info->layout == RNEA_AOS) {
		l.host = (char *)l.host + b->first * bytes;
		l.width = b->count * bytes;
	} else {
		l.host = (char *)l.host + b->first * scalar;
		l.lines = a->rows;
		l.width = b->count * scalar;
		l.host_pitch = c->count * scalar;
	}
	return l;
}

/* The inputs of a slice: those that are packed in one copy, the others each in its own. */
static enum rnea_code send(const struct call *c, const struct buffer *b, struct rnea_error *e)
{
	const struct device *d = &c->pool->driver->device;
	struct device_lines packed = {.host = b->locked, .device = b->device, .lines = 1, .width = c->packed_in};
	struct packing packing = {.in = 1};

	for (size_t i = 0; i < c->pool->info->input_count; i++) {
		struct device_lines l = lines_of(c, b, i);

		if (!c->direct[i])
			packing_add(&packing, &l, b->locked + c->offsets[i]);
		else if (device_copy_in(d, &l, b->stream, e))
			return e->code;
	}
	packing_run(&packing, c->pool->workers);
	return c->packed_in ? device_copy_in(d, &packed, b->stream, e) : RNEA_OK;
}

static enum rnea_code fetch(const struct call *c, const struct buffer *b, struct rnea_error *e)
{
	const struct device *d = &c->pool->driver->device;
	struct device_lines packed = {.host = b->locked + c->packed_out_at,
		.device = b->device + c->packed_out_at,
		.lines = 1,
		.width = c->packed_out};

	for (size_t i = c->pool->info->input_count; i < c->array_count; i++) {
		struct device_lines l = lines_of(c, b, i);

		if (c->direct[i] && device_copy_out(d, &l, b->stream, e))
			return e->code;
	}
	return c->packed_out ? device_copy_out(d, &packed, b->stream, e) : RNEA_OK;
}

static enum rnea_code launch(const struct call *c, const struct buffer *b, struct rnea_error *e)
{
	void *arrays[RNEA_ARGUMENT_LIMIT];

	for (size_t i = 0; i < c->array_count; i++)
		arrays[i] = (void *)(uintptr_t)(b->device + c->offsets[i]);
	return driver_launch(c->pool->driver, 0, arrays, b->count, b->stream, e);
}

/* Wait for the slice that is under way in a buffer, and unpack its outputs. */
static enum rnea_code finish(const struct call *c, struct buffer *b, struct rnea_error *e)
{
	struct packing packing = {.in = 0};

	if (!b->count)
		return RNEA_OK;
	if (device_wait(&c->pool->driver->device, b->stream, e))
		return e->code;
	for (size_t i = c->pool->info->input_count; i < c->array_count; i++) {
		struct device_lines l = lines_of(c, b, i);

		if (!c->direct[i])
			packing_add(&packing, &l, b->locked + c->offsets[i]);
	}
	packing_run(&packing, c->pool->workers);
	b->count = 0;
	return RNEA_OK;
}

static enum rnea_code run(const struct call *c, struct pipe *p, struct rnea_error *e)
{
	int turn = 0;

	for (size_t first = 0; first < c->count; first += c->slice, turn = (turn + 1) % BUFFERS) {
		struct buffer *b = &p->buffers[turn];

		if (buffer_make(c->pool, b, e) || finish(c, b, e))
			return e->code;
		b->first = first;
		b->count = c->count - first < c->slice ? c->count - first : c->slice;
		if (send(c, b, e) || launch(c, b, e) || fetch(c, b, e))
			return e->code;
	}
	for (int i = 0; i < BUFFERS; i++, turn = (turn + 1) % BUFFERS)
		if (finish(c, &p->buffers[turn], e))
			return e->code;
	return RNEA_OK;
}

/* After a failure: nothing of this call may still read or write the program's arrays or the pipe's when it returns. */
static void settle(const struct pipe_pool *pool, struct pipe *p)
{
	for (int i = 0; i < BUFFERS; i++) {
		struct rnea_error ignored = {0};

		if (p->buffers[i].count)
			device_wait(&pool->driver->device, p->buffers[i].stream, &ignored);
		p->buffers[i].count = 0;
	}
}

enum rnea_code pipe_run(struct pipe_pool *pool, void *const *arrays, size_t count, struct rnea_error *e)
{
	struct call c = {.pool = pool, .arrays = arrays, .count = count};
	struct pipe *p;
	int pushed;

	if (device_enter(&pool->driver->device, &pushed, e))
		return e->code;
	if (!plan(&c, e)) {
		if (!(p = take_pipe(pool))) {
			rnea_error_memory(e);
		} else {
			if (run(&c, p, e))
				settle(pool, p);
			return_pipe(pool, p);
		}
	}
	device_leave(&pool->driver->device, pushed);
	return e->code;
}
