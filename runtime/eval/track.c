#include "eval/track.h"
#include <stdlib.h>
#include <string.h>

enum { SLICE_BYTES = 64 << 20 };

/* ---- room ---- */

size_t eval_track_slice(const struct eval_arrays *a)
{
	size_t bytes = 0;

	for (size_t i = 0; i < a->s->count; i++)
		bytes += a->s->arrays[i].per_batch ? 0 : a->s->arrays[i].rows * eval_scalar_size(a);
	return SLICE_BYTES / bytes ? SLICE_BYTES / bytes : 1;
}

static void *alloc(const struct eval_arrays *a, size_t samples, size_t rows, struct rneagen_error *e)
{
	size_t size = eval_scalar_size(a);
	void *p = samples > SIZE_MAX / 2 / size / rows ? NULL : malloc(samples * rows * size);

	if (!p)
		error_set(e, RNEAGEN_MEMORY, "no memory for slices of %zu samples; choose a smaller --slice", samples);
	return p;
}

/* What was left out is what the URDF says. */
static void fill(struct eval_track *l, size_t i, size_t samples)
{
	const struct signature_array *s = &l->arrays->s->arrays[i];

	for (size_t k = 0; k < samples * s->rows; k++) {
		real x = s->nominal ? s->nominal[k % s->rows] : 0;

		if (l->arrays->scalar == RNEA_F32)
			((float *)l->data[i])[k] = (float)x;
		else
			((double *)l->data[i])[k] = (double)x;
	}
}

static enum rneagen_code open_array(struct eval_track *l, size_t i, struct rneagen_error *e)
{
	const struct eval_arrays *a = l->arrays;
	const struct signature_array *s = &a->s->arrays[i];
	size_t samples = s->per_batch ? 1 : l->slice;
	struct npy_part whole = {0, s->rows, NULL};

	if (!(l->data[i] = alloc(a, samples, s->rows, e)))
		return e->code;
	whole.to = l->data[i];
	if (s->is_output)
		return RNEAGEN_OK;
	if (a->paths[i] && npy_again(&l->files[i], &a->files[i], e))
		return e->code;
	if (a->paths[i] && s->per_batch)
		return npy_read(&l->files[i], 1, a->scalar, &whole, 1, e);
	if (!a->paths[i] && !eval_is_joined(a, i))
		fill(l, i, samples);
	return RNEAGEN_OK;
}

enum rneagen_code eval_track_open(struct eval_track *l, const struct eval_arrays *a, size_t slice, struct rneagen_error *e)
{
	size_t rows = 0, outputs = 0;

	l->arrays = a;
	l->slice = slice;
	for (size_t i = 0; i < a->s->count; i++) {
		rows += a->s->arrays[i].is_output ? a->s->arrays[i].rows : 0;
		outputs += (size_t)a->s->arrays[i].is_output;
		if (open_array(l, i, e))
			return e->code;
	}
	if (a->in && npy_again(&l->all, &a->all, e))
		return e->code;
	if (a->out && outputs > 1)
		l->gathered = alloc(a, slice, rows, e);
	return e->code;
}

void eval_track_close(struct eval_track *l)
{
	npy_close(&l->all);
	for (size_t i = 0; i < DAG_ARGUMENTS; i++) {
		npy_close(&l->files[i]);
		free(l->data[i]);
	}
	free(l->gathered);
}

/* ---- slices ---- */

static enum rneagen_code read_file(struct eval_track *l, struct npy *n, uint64_t at, size_t count,
	const struct npy_part *parts, size_t part_count, struct rneagen_error *e)
{
	if (n->regular)
		npy_seek(n, at);
	return npy_read(n, count, l->arrays->scalar, parts, part_count, e);
}

static enum rneagen_code read_slice(struct eval_track *l, uint64_t at, size_t count, struct rneagen_error *e)
{
	const struct eval_arrays *a = l->arrays;
	struct npy_part parts[DAG_ARGUMENTS];
	size_t part_count = 0, first = 0;

	for (size_t i = 0; i < a->s->count; i++) {
		struct npy_part *p = &parts[part_count];

		*p = (struct npy_part){0, a->s->arrays[i].rows, l->data[i]};
		if (eval_is_joined(a, i)) {
			p->first = first;
			first += p->columns;
			part_count++;
		} else if (eval_is_read_by_sample(a, i) && a->paths[i] && read_file(l, &l->files[i], at, count, p, 1, e)) {
			return e->code;
		}
	}
	return a->in ? read_file(l, &l->all, at, count, parts, part_count, e) : RNEAGEN_OK;
}

/* The outputs of each sample after one another; one alone is so already. */
static const void *gather(struct eval_track *l, size_t count)
{
	const struct eval_arrays *a = l->arrays;
	size_t width = a->joined.rows * eval_scalar_size(a), at = 0;

	for (size_t i = 0; i < a->s->count; i++) {
		size_t size = a->s->arrays[i].rows * eval_scalar_size(a);

		if (!a->s->arrays[i].is_output)
			continue;
		if (!l->gathered)
			return l->data[i];
		for (size_t k = 0; k < count; k++)
			memcpy((char *)l->gathered + k * width + at, (char *)l->data[i] + k * size, size);
		at += size;
	}
	return l->gathered;
}

static enum rneagen_code write_array(
	const struct eval_track *l, const struct eval_sink *s, const void *data, uint64_t at, size_t count,
	struct rneagen_error *e)
{
	size_t size = s->rows * eval_scalar_size(l->arrays);

	if (s->file)
		return ranks_file_write(s->file, data, count * size, s->data + at * size, e);
	if (s->f && fwrite(data, size, count, s->f) != count)
		return pending_fail(s->f == stdout ? "standard output" : s->path, e);
	return RNEAGEN_OK;
}

enum rneagen_code eval_track_do(struct eval_track *l, uint64_t first, size_t count, struct rneagen_error *e)
{
	const struct eval_arrays *a = l->arrays;
	struct rnea_error error;

	if (read_slice(l, first, count, e))
		return e->code;
	if (rnea_run(l->robot, l->data, count, &error))
		return error_set(e, RNEAGEN_UNSUPPORTED, "%s", error.message);
	if (a->out && write_array(l, &a->joined, gather(l, count), first, count, e))
		return e->code;
	for (size_t i = 0; i < a->s->count; i++)
		if (a->s->arrays[i].is_output && write_array(l, &a->sinks[i], l->data[i], first, count, e))
			return e->code;
	return RNEAGEN_OK;
}
