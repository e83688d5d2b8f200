#include "cuda/relay.h"
#include <stdio.h>

/* A small batch has several blocks for the same samples, which share the columns: so many at most, as in the generated launch
   function. Each makes the factors anew. H100, f32, 1024 samples, the third kernel alone, 16 and 32 along y: atlas 9.1 and 8.5
   us, floating hyq 6.6 and 6.6; 4096: atlas, 8 and 16, 11.7 and 17.2. */
enum { FEW_GROUPS = 32, MOST_ALONG_FEW = 32, MOST_ALONG = 16 };

enum rnea_code relay_kernel(const struct device *d, void *module, const struct source *s, const struct rnea_function *f,
	const char *which, size_t bytes, struct device_kernel *k, struct rnea_error *e)
{
	char name[SOURCE_NAME_LIMIT];

	snprintf(name, sizeof name, "%s_%s", f->name, which);
	source_symbol(s->name, name, "kernel", k->name);
	if (device_find(d, module, k, bytes, e))
		return e->code;
	if (!k->function)
		return rnea_error_set(e, RNEA_TEXT, "the text defines no kernel %s, which %s_info tells of", k->name, s->name);
	return RNEA_OK;
}

static enum rnea_code find_hands(struct relay *r, const struct device *d, void *module, const struct source *s,
	const struct rnea_function *f, unsigned block, struct rnea_error *e)
{
	char which[16] = "hands";

	for (r->hand_kernels = 0; r->hand_kernels < RNEA_HANDS_LIMIT && f->hands[r->hand_kernels]; r->hand_kernels++) {
		if (r->hand_kernels)
			snprintf(which, sizeof which, "hands%u", r->hand_kernels);
		if (relay_kernel(d, module, s, f, which, f->stage_bytes * block, &r->hands[r->hand_kernels], e))
			return e->code;
	}
	return RNEA_OK;
}

enum rnea_code relay_hands(const struct relay *r, const struct device *d, const struct rnea_function *f, unsigned blocks,
	unsigned block, void **parameters, void *stream, struct rnea_error *e)
{
	for (unsigned i = 0; i < r->hand_kernels; i++)
		if (device_launch(d, &r->hands[i], blocks, f->hands[i], block, parameters, stream, e))
			return e->code;
	return RNEA_OK;
}

static enum rnea_code refuse_shared(const struct device *d, const struct rnea_function *f, size_t bytes, struct rnea_error *e)
{
	return rnea_error_set(e, RNEA_ARGUMENT,
		"%s takes %zu bytes of shared memory for a block, and the device has %zu: make the text with --parts 2, or more", f->name,
		bytes, d->most_shared);
}

static enum rnea_code find_transpose(struct relay *r, const struct device *d, void *module, const struct source *s,
	const struct rnea_function *f, struct rnea_error *e)
{
	r->transposed_samples = 0;
	if (!f->transposed_samples)
		return RNEA_OK;
	if (f->transposed_bytes > d->most_shared)
		return refuse_shared(d, f, f->transposed_bytes, e);
	if (relay_kernel(d, module, s, f, "transpose", f->transposed_bytes, &r->transpose, e))
		return e->code;
	r->transpose.given_bytes = f->transposed_bytes;
	r->transposed_samples = f->transposed_samples;
	r->transposed_threads = f->transposed_threads;
	r->outputs = (unsigned)f->output_count;
	return RNEA_OK;
}

enum rnea_code relay_find(struct relay *r, const struct device *d, void *module, const struct source *s,
	const struct rnea_function *f, unsigned block, struct rnea_error *e)
{
	r->threads = 0;
	if (find_transpose(r, d, module, s, f, e))
		return e->code;
	if (find_hands(r, d, module, s, f, block, e) || r->hand_kernels)
		return e->code;
	if (!f->relay_threads)
		return RNEA_OK;
	if (f->relay_bytes > d->most_shared)
		return refuse_shared(d, f, f->relay_bytes, e);
	if (relay_kernel(d, module, s, f, "start", 0, &r->start, e) ||
		relay_kernel(d, module, s, f, "solve", f->relay_bytes, &r->solve, e))
		return e->code;
	r->solve.given_bytes = f->relay_bytes;
	r->threads = f->relay_threads;
	r->samples = f->relay_samples;
	r->room = f->relay_room;
	return RNEA_OK;
}

enum rnea_code relay_solve(const struct relay *r, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e)
{
	unsigned groups = device_blocks(count, r->samples), along = r->room / groups,
		 most = groups <= FEW_GROUPS ? MOST_ALONG_FEW : MOST_ALONG;

	along = along > most ? most : along ? along : 1;
	return device_launch(d, &r->solve, groups, along, r->threads * r->samples, parameters, stream, e);
}

enum rnea_code relay_transpose(const struct relay *r, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e)
{
	if (!r->transposed_samples)
		return RNEA_OK;
	return device_launch(d, &r->transpose, device_blocks(count, r->transposed_samples), r->outputs, r->transposed_threads,
		parameters, stream, e);
}
