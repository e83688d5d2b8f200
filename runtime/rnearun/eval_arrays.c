#define _POSIX_C_SOURCE 200809L
#include "rnearun/eval_arrays.h"
#include "base/text.h"
#include <stdlib.h>
#include <string.h>

enum { SLICE_BYTES = 64 << 20, NAMES = 400 };

static size_t scalar_size(const struct eval_arrays *a)
{
	return a->scalar == RNEA_F32 ? sizeof(float) : sizeof(double);
}

static int is_read_by_sample(const struct eval_arrays *a, size_t i)
{
	return !a->s->arrays[i].is_output && !a->s->arrays[i].per_batch;
}

int eval_is_joined(const struct eval_arrays *a, size_t i)
{
	return a->in && is_read_by_sample(a, i) && !a->paths[i];
}

/* ---- opening ---- */

/* All of the shape but the columns. */
static int same_samples(const struct npy *a, const struct npy *b)
{
	return a->shape.dimensions == b->shape.dimensions &&
		!memcmp(a->shape.size, b->shape.size, (a->shape.dimensions - 1) * sizeof *a->shape.size);
}

static enum rneagen_code open_input(struct eval_arrays *a, struct npy *n, const char *path, int per_batch, struct rneagen_error *e)
{
	char text[64], first[64];

	if (npy_open(n, path, e) || per_batch)
		return e->code;
	if (!a->first)
		a->first = n;
	if (same_samples(n, a->first))
		return RNEAGEN_OK;
	npy_shape_text(&n->shape, text, sizeof text);
	npy_shape_text(&a->first->shape, first, sizeof first);
	return error_set(
		e, RNEAGEN_READ, "%s: shape %s, other samples than %s, shape %s", n->path, text, a->first->path, first);
}

enum rneagen_code eval_open_inputs(struct eval_arrays *a, int *is_wide, struct rneagen_error *e)
{
	*is_wide = 0;
	if (a->in) {
		if (open_input(a, &a->all, a->in, 0, e))
			return e->code;
		*is_wide |= a->all.scalar == RNEA_F64;
	}
	for (size_t i = 0; i < a->s->count; i++) {
		if (a->s->arrays[i].is_output || !a->paths[i])
			continue;
		if (open_input(a, &a->files[i], a->paths[i], a->s->arrays[i].per_batch, e))
			return e->code;
		*is_wide |= a->files[i].scalar == RNEA_F64;
	}
	return RNEAGEN_OK;
}

static enum rneagen_code open_sink(struct eval_sink *s, const char *path, struct rneagen_error *e)
{
	s->path = path;
	if (!path)
		return RNEAGEN_OK;
	if (!strcmp(path, "-")) {
		s->f = stdout;
		return RNEAGEN_OK;
	}
	pending_open(&s->pending, path, e);
	s->f = s->pending.f;
	return e->code;
}

enum rneagen_code eval_open_outputs(struct eval_arrays *a, struct rneagen_error *e)
{
	if (open_sink(&a->joined, a->out, e))
		return e->code;
	for (size_t i = 0; i < a->s->count; i++)
		if (a->s->arrays[i].is_output && open_sink(&a->sinks[i], a->paths[i], e))
			return e->code;
	return RNEAGEN_OK;
}

/* ---- shapes ---- */

/* "24 (q 7, qd 7, payload.hand 10)", what `in` must have, cut where it is long; returns the number. */
static size_t put_columns(const struct eval_arrays *a, char *text, size_t size)
{
	size_t columns = 0, used;

	for (size_t i = 0; i < a->s->count; i++)
		columns += eval_is_joined(a, i) ? a->s->arrays[i].rows : 0;
	used = (size_t)snprintf(text, size, "%zu", columns);
	for (size_t i = 0, first = 1; i < a->s->count && used < size; i++)
		if (eval_is_joined(a, i)) {
			used += (size_t)snprintf(
				text + used, size - used, "%s%s %zu", first ? " (" : ", ", a->s->arrays[i].word, a->s->arrays[i].rows);
			first = 0;
		}
	if (columns && used < size)
		snprintf(text + used, size - used, ")");
	return columns;
}

static enum rneagen_code check_joined(const struct eval_arrays *a, const char *robot, struct rneagen_error *e)
{
	char text[NAMES];
	size_t nq = a->s->arrays[0].rows, nv = a->s->arrays[1].rows, columns = put_columns(a, text, sizeof text);

	if (a->all.columns == columns)
		return RNEAGEN_OK;
	if (a->s->is_plain && columns == nq + 2 * nv)
		snprintf(text, sizeof text, "nq + 2 nv = %zu + %zu = %zu", nq, 2 * nv, columns);
	return error_set(e, RNEAGEN_READ, "%s: %zu columns, %s needs %s", a->all.path, a->all.columns, robot, text);
}

static enum rneagen_code check_one(const struct eval_arrays *a, size_t i, const char *robot, struct rneagen_error *e)
{
	const struct signature_array *s = &a->s->arrays[i];
	const struct npy *n = &a->files[i];
	const char *word = role_rows(s->role) == ROWS_NQ ? "nq = " : role_rows(s->role) == ROWS_NV ? "nv = " : "";
	char shape[64];

	if (s->per_batch && (n->samples != 1 || n->columns != s->rows)) {
		npy_shape_text(&n->shape, shape, sizeof shape);
		return error_set(e, RNEAGEN_READ, "%s: shape %s, %s needs (%zu,) for %s, the same for all samples", n->path, shape, robot,
			s->rows, s->word);
	}
	if (n->columns != s->rows)
		return error_set(e, RNEAGEN_READ, "%s: %zu columns, %s needs %s%zu for %s", n->path, n->columns, robot, word, s->rows,
			s->word);
	return RNEAGEN_OK;
}

enum rneagen_code eval_check_shapes(const struct eval_arrays *a, const char *robot, struct rneagen_error *e)
{
	if (a->in && check_joined(a, robot, e))
		return e->code;
	for (size_t i = 0; i < a->s->count; i++)
		if (!a->s->arrays[i].is_output && a->paths[i] && check_one(a, i, robot, e))
			return e->code;
	return RNEAGEN_OK;
}

uint64_t eval_samples(const struct eval_arrays *a)
{
	return a->first ? a->first->samples : 1;
}

/* ---- room ---- */

static void set_slice(struct eval_arrays *a)
{
	size_t rows = 0;

	for (size_t i = 0; i < a->s->count; i++)
		rows += a->s->arrays[i].per_batch ? 0 : a->s->arrays[i].rows;
	if (!a->slice)
		a->slice = SLICE_BYTES / (rows * scalar_size(a)) ? SLICE_BYTES / (rows * scalar_size(a)) : 1;
	if (a->slice > eval_samples(a))
		a->slice = eval_samples(a) ? (size_t)eval_samples(a) : 1;
}

static void *alloc(const struct eval_arrays *a, size_t samples, size_t rows, struct rneagen_error *e)
{
	void *p = samples > SIZE_MAX / 2 / scalar_size(a) / rows ? NULL : malloc(samples * rows * scalar_size(a));

	if (!p)
		error_set(e, RNEAGEN_MEMORY, "no memory for slices of %zu samples; choose a smaller --slice", samples);
	return p;
}

/* What was left out is what the URDF says. */
static void fill(struct eval_arrays *a, size_t i, size_t samples)
{
	const struct signature_array *s = &a->s->arrays[i];

	for (size_t k = 0; k < samples * s->rows; k++) {
		real x = s->nominal ? s->nominal[k % s->rows] : 0;

		if (a->scalar == RNEA_F32)
			((float *)a->data[i])[k] = (float)x;
		else
			((double *)a->data[i])[k] = (double)x;
	}
}

enum rneagen_code eval_make(struct eval_arrays *a, struct rneagen_error *e)
{
	size_t rows = 0, outputs = 0;

	set_slice(a);
	for (size_t i = 0; i < a->s->count; i++) {
		const struct signature_array *s = &a->s->arrays[i];
		size_t samples = s->per_batch ? 1 : a->slice;
		struct npy_part whole = {0, s->rows, NULL};

		rows += s->is_output ? s->rows : 0;
		outputs += (size_t)s->is_output;
		if (!(a->data[i] = alloc(a, samples, s->rows, e)))
			return e->code;
		whole.to = a->data[i];
		if (s->per_batch && a->paths[i] && npy_read(&a->files[i], 1, a->scalar, &whole, 1, e))
			return e->code;
		if (!s->is_output && !a->paths[i] && !eval_is_joined(a, i))
			fill(a, i, samples);
	}
	if (a->out && outputs > 1)
		a->gathered = alloc(a, a->slice, rows, e);
	return e->code;
}

/* ---- slices ---- */

enum rneagen_code eval_read(struct eval_arrays *a, size_t count, struct rneagen_error *e)
{
	struct npy_part parts[DAG_ARGUMENTS];
	size_t part_count = 0, first = 0;

	for (size_t i = 0; i < a->s->count; i++) {
		struct npy_part *p = &parts[part_count];

		*p = (struct npy_part){0, a->s->arrays[i].rows, a->data[i]};
		if (eval_is_joined(a, i)) {
			p->first = first;
			first += p->columns;
			part_count++;
		} else if (is_read_by_sample(a, i) && a->paths[i] && npy_read(&a->files[i], count, a->scalar, p, 1, e)) {
			return e->code;
		}
	}
	return a->in ? npy_read(&a->all, count, a->scalar, parts, part_count, e) : RNEAGEN_OK;
}

static enum rneagen_code fail_sink(const struct eval_sink *s, struct rneagen_error *e)
{
	return pending_fail(s->f == stdout ? "standard output" : s->path, e);
}

static size_t joined_rows(const struct eval_arrays *a)
{
	size_t rows = 0;

	for (size_t i = 0; i < a->s->count; i++)
		rows += a->s->arrays[i].is_output ? a->s->arrays[i].rows : 0;
	return rows;
}

/* The outputs of each sample after one another; one alone is so already. */
static const void *gather(struct eval_arrays *a, size_t count)
{
	size_t width = joined_rows(a) * scalar_size(a), at = 0;

	for (size_t i = 0; i < a->s->count; i++) {
		size_t size = a->s->arrays[i].rows * scalar_size(a);

		if (!a->s->arrays[i].is_output)
			continue;
		if (!a->gathered)
			return a->data[i];
		for (size_t k = 0; k < count; k++)
			memcpy((char *)a->gathered + k * width + at, (char *)a->data[i] + k * size, size);
		at += size;
	}
	return a->gathered;
}

enum rneagen_code eval_write(struct eval_arrays *a, size_t count, struct rneagen_error *e)
{
	if (a->joined.f && fwrite(gather(a, count), scalar_size(a) * joined_rows(a), count, a->joined.f) != count)
		return fail_sink(&a->joined, e);
	for (size_t i = 0; i < a->s->count; i++) {
		const struct eval_sink *s = &a->sinks[i];

		if (s->f && fwrite(a->data[i], scalar_size(a) * a->s->arrays[i].rows, count, s->f) != count)
			return fail_sink(s, e);
	}
	return RNEAGEN_OK;
}

/* ---- outputs ---- */

void eval_put_headers(struct eval_arrays *a)
{
	struct npy_shape shape = {.dimensions = 1};

	if (a->first)
		shape = a->first->shape;
	shape.size[shape.dimensions - 1] = joined_rows(a);
	if (a->joined.f)
		npy_put_header(a->joined.f, a->scalar, &shape);
	for (size_t i = 0; i < a->s->count; i++) {
		shape.size[shape.dimensions - 1] = a->s->arrays[i].rows;
		if (a->sinks[i].f)
			npy_put_header(a->sinks[i].f, a->scalar, &shape);
	}
}

static enum rneagen_code close_sink(struct eval_sink *s, struct rneagen_error *e)
{
	if (!s->f)
		return RNEAGEN_OK;
	if (s->f == stdout)
		return fflush(stdout) || ferror(stdout) ? fail_sink(s, e) : RNEAGEN_OK;
	return pending_close(&s->pending, e);
}

static enum rneagen_code publish_sink(struct eval_sink *s, struct rneagen_error *e)
{
	return s->f && s->f != stdout ? pending_publish(&s->pending, e) : RNEAGEN_OK;
}

enum rneagen_code eval_finish(struct eval_arrays *a, struct rneagen_error *e)
{
	close_sink(&a->joined, e);
	for (size_t i = 0; i < a->s->count && !e->code; i++)
		close_sink(&a->sinks[i], e);
	if (!e->code)
		publish_sink(&a->joined, e);
	for (size_t i = 0; i < a->s->count && !e->code; i++)
		publish_sink(&a->sinks[i], e);
	return e->code;
}

void eval_close(struct eval_arrays *a)
{
	pending_drop(&a->joined.pending);
	npy_close(&a->all);
	for (size_t i = 0; i < DAG_ARGUMENTS; i++) {
		pending_drop(&a->sinks[i].pending);
		npy_close(&a->files[i]);
		free(a->data[i]);
	}
	free(a->gathered);
}
