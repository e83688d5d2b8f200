#define _POSIX_C_SOURCE 200809L
#include "eval/arrays.h"
#include "base/text.h"
#include <stdlib.h>
#include <string.h>

enum { NAMES = 400 };

size_t eval_scalar_size(const struct eval_arrays *a)
{
	return a->scalar == RNEA_F32 ? sizeof(float) : sizeof(double);
}

int eval_is_read_by_sample(const struct eval_arrays *a, size_t i)
{
	return !a->s->arrays[i].is_output && !a->s->arrays[i].per_batch;
}

int eval_is_joined(const struct eval_arrays *a, size_t i)
{
	return a->in && eval_is_read_by_sample(a, i) && !a->paths[i];
}

/* ---- opening ---- */

/* All of the shape but the columns. */
static int same_samples(const struct npy *a, const struct npy *b)
{
	return a->shape.dimensions == b->shape.dimensions &&
		!memcmp(a->shape.size, b->shape.size, (a->shape.dimensions - 1) * sizeof *a->shape.size);
}

static enum rneagen_code open_input(
	struct eval_arrays *a, struct npy *n, const char *path, int per_batch, struct rneagen_error *e)
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

static size_t joined_rows(const struct eval_arrays *a)
{
	size_t rows = 0;

	for (size_t i = 0; i < a->s->count; i++)
		rows += a->s->arrays[i].is_output ? a->s->arrays[i].rows : 0;
	return rows;
}

/* Where a link leads, for what is written in parts stands beside that. */
static const char *follow(const char *path, struct arena *arena)
{
	char target[PENDING_PATH];
	const char *copy = NULL;

	if (path && strcmp(path, "-") && !pending_is_in_place(path) && !pending_target(path, target))
		copy = arena_string(arena, target, strlen(target));
	return copy ? copy : path;
}

void eval_name_sinks(struct eval_arrays *a, struct arena *arena)
{
	a->joined.path = follow(a->out, arena);
	a->joined.rows = joined_rows(a);
	for (size_t i = 0; i < a->s->count; i++) {
		a->sinks[i].path = a->s->arrays[i].is_output ? follow(a->paths[i], arena) : NULL;
		a->sinks[i].rows = a->s->arrays[i].rows;
	}
}

size_t eval_sinks(struct eval_arrays *a, struct eval_sink *sinks[DAG_ARGUMENTS + 1])
{
	size_t count = 0;

	if (a->joined.path)
		sinks[count++] = &a->joined;
	for (size_t i = 0; i < a->s->count; i++)
		if (a->sinks[i].path)
			sinks[count++] = &a->sinks[i];
	return count;
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

/* What cannot be read or written at places. */
static enum rneagen_code refuse_order(const char *path, int is_output, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_USAGE,
		"%s: it is %s in order, from beginning to end, but ranks, several devices and --resume need a file, in which every "
		"sample has its place",
		strcmp(path, "-") ? path : is_output ? "standard output" : "<stdin>", is_output ? "written" : "read");
}

enum rneagen_code eval_check_places(struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	if (a->in && !a->all.regular)
		return refuse_order(a->in, 0, e);
	for (size_t i = 0; i < a->s->count; i++)
		if (!a->s->arrays[i].is_output && a->paths[i] && !a->files[i].regular)
			return refuse_order(a->paths[i], 0, e);
	for (size_t i = 0; i < count; i++)
		if (!strcmp(sinks[i]->path, "-") || pending_is_in_place(sinks[i]->path))
			return refuse_order(sinks[i]->path, 1, e);
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
				text + used, size - used, "%s%s %zu", first ? " (" : ", ", a->s->arrays[i].word,
				a->s->arrays[i].rows);
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
		return error_set(e, RNEAGEN_READ, "%s: shape %s, %s needs (%zu,) for %s, the same for all samples",
			n->path, shape, robot, s->rows, s->word);
	}
	if (n->columns != s->rows)
		return error_set(e, RNEAGEN_READ, "%s: %zu columns, %s needs %s%zu for %s", n->path, n->columns,
			robot, word, s->rows, s->word);
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

/* ---- outputs ---- */

static enum rneagen_code open_sink(struct eval_sink *s, enum eval_begin begin, struct rneagen_error *e)
{
	if (!strcmp(s->path, "-")) {
		s->f = stdout;
		return RNEAGEN_OK;
	}
	if (begin == EVAL_ALONE)
		pending_open(&s->pending, s->path, e);
	else
		pending_open_part(&s->pending, s->path, begin == EVAL_GO_ON, e);
	s->f = s->pending.f;
	return e->code;
}

enum rneagen_code eval_open_outputs(struct eval_arrays *a, enum eval_begin begin, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count && !e->code; i++)
		open_sink(sinks[i], begin, e);
	return e->code;
}

static enum rneagen_code fail_sink(const struct eval_sink *s, struct rneagen_error *e)
{
	return pending_fail(s->f == stdout ? "standard output" : s->path, e);
}

/* NULL: it is measured alone. Returns its bytes. */
static uint64_t put_header(FILE *f, const struct eval_arrays *a, const struct eval_sink *s)
{
	struct npy_shape shape = {.dimensions = 1};

	if (a->first)
		shape = a->first->shape;
	shape.size[shape.dimensions - 1] = s->rows;
	return npy_put_header(f, a->scalar, &shape);
}

uint64_t eval_bytes(const struct eval_arrays *a, const struct eval_sink *s, uint64_t samples)
{
	return put_header(NULL, a, s) + samples * s->rows * eval_scalar_size(a);
}

enum rneagen_code eval_put_headers(struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count; i++) {
		/* of a run that goes on, the same bytes are there already */
		sinks[i]->data = put_header(sinks[i]->f, a, sinks[i]);
		if (sinks[i]->f && fflush(sinks[i]->f))
			return fail_sink(sinks[i], e);
	}
	return RNEAGEN_OK;
}

enum rneagen_code eval_join_outputs(struct eval_arrays *a, struct ranks *r, int stays, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count && !e->code; i++) {
		struct pending *p = &sinks[i]->pending;

		sinks[i]->is_other = r->index != 0;
		if (sinks[i]->is_other && pending_watch_part(p, sinks[i]->path, e))
			break;
		if (stays)
			pending_keep(p);
		if (p->temporary)
			ranks_file_open(&sinks[i]->file, r, p->temporary, sinks[i]->path, e);
	}
	return e->code;
}

enum rneagen_code eval_sync(struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count && !e->code; i++)
		ranks_file_sync(sinks[i]->file, e);
	return e->code;
}

enum rneagen_code eval_leave(struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count; i++) {
		struct eval_sink *s = sinks[i];

		ranks_file_close(s->file, e);
		s->file = NULL;
		if (s->is_other)
			pending_forget(&s->pending);
	}
	return e->code;
}

static enum rneagen_code close_sink(struct eval_sink *s, struct rneagen_error *e)
{
	if (s->f == stdout)
		return fflush(stdout) || ferror(stdout) ? fail_sink(s, e) : RNEAGEN_OK;
	return pending_close(&s->pending, e);
}

enum rneagen_code eval_finish(struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count && !e->code; i++)
		close_sink(sinks[i], e);
	for (size_t i = 0; i < count && !e->code; i++)
		if (sinks[i]->f != stdout)
			pending_publish(&sinks[i]->pending, e);
	return e->code;
}

static void close_one(struct eval_sink *s)
{
	struct rneagen_error ignored = {0};

	ranks_file_close(s->file, &ignored);
	if (s->is_other)
		pending_forget(&s->pending);
	else
		pending_drop(&s->pending);
}

void eval_keep(struct eval_arrays *a)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count; i++)
		pending_keep(&sinks[i]->pending);
}

void eval_close(struct eval_arrays *a)
{
	close_one(&a->joined);
	npy_close(&a->all);
	for (size_t i = 0; i < DAG_ARGUMENTS; i++) {
		close_one(&a->sinks[i]);
		npy_close(&a->files[i]);
	}
}
