/* Arrays of more elements than 32 bits can count. The states of the reference, over and over, are laid out by copies on
   the device; every torque must be, bit for bit, that of its state's first occurrence, and those are checked. */
#include "arrays.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1 << 26 };

/* What repeats in an array: its rows in soa, the whole of it in aos. */
struct pieces {
	size_t n, bytes, period; /* bytes of each, and of its first period */
};

static size_t at_most(size_t a, size_t b)
{
	return a < b ? a : b;
}

static struct pieces pieces_of(
	const struct gpu_array *a, const struct samples *s, size_t count, enum rnea_layout layout)
{
	size_t n = layout == RNEA_AOS ? 1 : s->rows;

	return (struct pieces){
		.n = n, .bytes = a->bytes / n, .period = a->bytes / n / count * at_most(count, s->count)};
}

static void fill(const struct gpu *g, const struct gpu_array *a, const struct samples *s, size_t count,
	const struct rnea_argument *input, enum rnea_layout layout)
{
	struct pieces p = pieces_of(a, s, count, layout);
	char *host = malloc(p.n * p.period);

	samples_tile(s, host, at_most(count, s->count), input->scalar, layout);
	for (size_t i = 0; i < p.n; i++) {
		CUdeviceptr at = a->data + i * p.bytes;

		GPU(g, cuMemcpyHtoD, (at, host + i * p.period, p.period));
		for (size_t done = p.period; done < p.bytes; done *= 2)
			GPU(g, cuMemcpyDtoD, (at + done, at, at_most(done, p.bytes - done)));
	}
	GPU(g, cuCtxSynchronize, ());
	free(host);
}

/* The first samples against the reference; they stay in `host`. */
static void check_first(const struct gpu *g, struct item *it, const struct gpu_array *tau, const struct reference *r,
	size_t count, const struct pieces *p, char *host)
{
	const struct rnea_info *info = rnea_info(it->robot);
	struct difference d;

	for (size_t i = 0; i < p->n; i++)
		GPU(g, cuMemcpyDtoH, (host + i * p->period, tau->data + i * p->bytes, p->period));
	d = samples_compare(&r->tau, host, at_most(count, r->tau.count), info->precision, info->layout);
	if (!(d.scaled <= it->limit))
		item_fail(
			it, "large arrays: sample %zu is off by %.3g, the limit is %.3g", d.worst, d.scaled, it->limit);
}

/* One piece, a chunk of whole periods at a time. */
static void check_piece(const struct gpu *g, struct item *it, CUdeviceptr at, const struct pieces *p, const char *first)
{
	size_t chunk = p->period > CHUNK ? p->period : CHUNK / p->period * p->period;
	char *wanted = malloc(chunk), *found = malloc(chunk);

	for (size_t done = 0; done < chunk; done += p->period)
		memcpy(wanted + done, first, p->period);
	for (size_t done = 0; done < p->bytes && !*it->failure; done += chunk) {
		size_t n = at_most(chunk, p->bytes - done);

		GPU(g, cuMemcpyDtoH, (found, at + done, n));
		if (memcmp(found, wanted, n) != 0)
			item_fail(it,
				"large arrays: a torque among the bytes %zu to %zu of a piece of %zu is not that "
				"of its state's first occurrence",
				done, done + n, p->bytes);
	}
	free(wanted);
	free(found);
}

static void run_large(const struct gpu *g, struct item *it, const struct reference *r, size_t count)
{
	const struct rnea_info *info = rnea_info(it->robot);
	size_t n = info->input_count + info->output_count;
	struct gpu_array array[ARRAYS_LIMIT];
	void *pointers[ARRAYS_LIMIT];
	struct pieces p;
	struct rnea_error e;
	char *first;

	for (size_t i = 0; i < n; i++) {
		array[i] = gpu_array_new(g, arrays_bytes(&info->arguments[i], count));
		pointers[i] = (void *)(uintptr_t)array[i].data;
		if (i < info->input_count)
			fill(g, &array[i], reference_find(r, info->arguments[i].name), count, &info->arguments[i],
				info->layout);
	}
	if (rnea_launch(it->robot, pointers, count, g->stream, &e) != RNEA_OK)
		item_fail(it, "large arrays: %s", e.message);
	GPU(g, cuStreamSynchronize, (g->stream));
	p = pieces_of(&array[n - 1], &r->tau, count, info->layout);
	first = malloc(p.n * p.period);
	check_first(g, it, &array[n - 1], r, count, &p, first);
	for (size_t i = 0; i < p.n; i++)
		check_piece(g, it, array[n - 1].data + i * p.bytes, &p, first + i * p.period);
	if (!gpu_array_intact(g, &array[n - 1]))
		item_fail(it, "large arrays: written outside of tau");
	free(first);
	for (size_t i = 0; i < n; i++)
		gpu_array_free(g, &array[i]);
}

void verify_large(const struct gpu *g, struct item *it, const struct reference *r, size_t elements)
{
	const struct rnea_info *info = rnea_info(it->robot);
	size_t count = elements / info->nv + 77, wanted = 0, available, total;

	for (size_t i = 0; i < info->input_count + info->output_count; i++)
		wanted += arrays_bytes(&info->arguments[i], count) + 2 * GPU_GUARD;
	GPU(g, cuMemGetInfo, (&available, &total));
	if (wanted > available) {
		printf("skipped: %s: arrays of %zu elements: they take %zu MB, the device has %zu MB\n", it->text,
			elements, wanted >> 20, available >> 20);
		return;
	}
	run_large(g, it, r, count);
	printf("     %s: %zu samples, %zu elements of tau, each right\n", it->text, count, count * info->nv);
}
