#include "certify/check_row.h"
#include "certify/left_out.h"
#include "emit/emit.h"
#include <stdlib.h>
#include <string.h>

static const char *const ROW[] = {"output", "row", "low", "high", "error_bounds", "left_out", "steps", NULL};

/* One row, in a thread. */
struct row_check {
	const struct certificate *c;
	struct reader r;
	struct rneagen_error e;
	const json_t *json;
	size_t output;
	char name[128];
	struct certified certified; /* as stated */
};

/* ---- reading ---- */

static double *take_numbers(struct row_check *x, const json_t *step, const char *key, size_t count, double absent)
{
	const json_t *list = read_member(&x->r, step, x->name, key, JSON_ARRAY);
	double *numbers;

	if (!list)
		return NULL;
	if (json_array_size(list) != count) {
		error_set(&x->e, RNEAGEN_READ, "%s: %s: \"%s\" has %zu numbers for %zu boxes", x->r.file, x->name, key,
			json_array_size(list), count);
		return NULL;
	}
	numbers = malloc((count + 1) * sizeof *numbers);
	if (!numbers)
		error_memory(&x->e);
	for (size_t i = 0; numbers && i < count && !x->e.code; i++)
		numbers[i] = read_number(&x->r, json_array_get(list, i), x->name, absent);
	return numbers;
}

static void take_cuts(struct row_check *x, const json_t *step, struct boxes *b)
{
	const json_t *list = read_member(&x->r, step, x->name, "cuts", JSON_ARRAY);

	for (size_t i = 0; i < json_array_size(list) && !x->e.code; i++) {
		int row = read_whole(&x->r, json_array_get(list, i), x->name, CUTS_NONE, 1 << 20);

		cuts_put(&b->cuts, row);
		b->count += row == CUTS_NONE;
	}
	if (b->cuts.failed)
		error_memory(&x->e);
}

/* Without errors where none were bounded; with those of the precisions in their order, up to one. */
static void take_boxes(struct row_check *x, const json_t *step, enum step_kind kind)
{
	const char *keys[5 + STEPS_PRECISIONS] = {"by", "cuts", "low", "high"};
	struct boxes *b = &x->certified.steps[kind];
	int count = 0;

	for (int k = 0; k < x->c->precision_count && kind == STEP_ERRORS; k++)
		if (json_object_get(step, emit_precision_name(x->c->precisions[k])))
			keys[4 + count++] = emit_precision_name(x->c->precisions[k]);
	if (read_keys(&x->r, step, x->name, keys))
		return;
	take_cuts(x, step, b);
	b->low = x->e.code ? NULL : take_numbers(x, step, "low", b->count, -(double)INFINITY);
	b->high = x->e.code ? NULL : take_numbers(x, step, "high", b->count, (double)INFINITY);
	for (int k = 0; k < x->c->precision_count && kind == STEP_ERRORS && !x->e.code; k++)
		if (json_object_get(step, emit_precision_name(x->c->precisions[k])))
			b->errors[k] = take_numbers(x, step, emit_precision_name(x->c->precisions[k]), b->count,
				(double)INFINITY);
}

static int take_counts(struct row_check *x, const json_t *step, const char *key, int *counts, int least, int most)
{
	const json_t *list = read_member(&x->r, step, x->name, key, JSON_ARRAY);
	size_t count = json_array_size(list);

	if (list && (count == 0 || count > POINT_DIMS))
		error_set(&x->e, RNEAGEN_READ, "%s: %s: \"%s\" is not of one to %d numbers", x->r.file, x->name, key, POINT_DIMS);
	for (size_t i = 0; i < count && !x->e.code; i++)
		counts[i] = read_whole(&x->r, json_array_get(list, i), x->name, least, most);
	return x->e.code ? -1 : (int)count;
}

static void take_pass(struct row_check *x, const json_t *json, struct grid_pass *pass, int dims)
{
	static const char *const keys[] = {"counts", "bends", NULL};
	const json_t *bends;

	if (read_keys(&x->r, json, x->name, keys))
		return;
	bends = read_member(&x->r, json, x->name, "bends", JSON_ARRAY);
	if (take_counts(x, json, "counts", pass->counts, 1, GRID_PLACES) != dims || json_array_size(bends) != (size_t)dims)
		error_set(&x->e, RNEAGEN_READ, "%s: %s: a pass is not of %d rows of q", x->r.file, x->name, dims);
	for (int k = 0; k < dims && !x->e.code; k++)
		pass->bends[k] = read_number(&x->r, json_array_get(bends, (size_t)k), x->name, (double)INFINITY);
}

static void take_grid(struct row_check *x, const json_t *step)
{
	static const char *const keys[] = {"by", "rows", "passes", "counts", "low", "high", NULL};
	struct grid_step *g = &x->certified.grid;
	const json_t *passes;

	if (read_keys(&x->r, step, x->name, keys))
		return;
	g->dim_count = take_counts(x, step, "rows", g->rows, 0, 1 << 20);
	passes = read_member(&x->r, step, x->name, "passes", JSON_ARRAY);
	g->value.lo = read_number(&x->r, json_object_get(step, "low"), x->name, -(double)INFINITY);
	g->value.hi = read_number(&x->r, json_object_get(step, "high"), x->name, (double)INFINITY);
	g->pass_count = (int)json_array_size(passes);
	if (!x->e.code && (take_counts(x, step, "counts", g->counts, 1, GRID_PLACES) != g->dim_count ||
		g->pass_count > GRID_PASSES))
		error_set(&x->e, RNEAGEN_READ, "%s: %s: a grid is not of %d rows of q and at most %d passes", x->r.file, x->name,
			g->dim_count, GRID_PASSES);
	for (int i = 0; i < g->pass_count && !x->e.code; i++)
		take_pass(x, json_array_get(passes, (size_t)i), &g->passes[i], g->dim_count);
}

static void take_bounds(struct row_check *x)
{
	const char *names[STEPS_PRECISIONS + 1] = {NULL};
	const json_t *bounds = json_object_get(x->json, "error_bounds");
	struct box_bound *b = &x->certified.bound;

	for (int k = 0; k < x->c->precision_count; k++)
		names[k] = emit_precision_name(x->c->precisions[k]);
	b->value.lo = read_number(&x->r, json_object_get(x->json, "low"), x->name, -(double)INFINITY);
	b->value.hi = read_number(&x->r, json_object_get(x->json, "high"), x->name, (double)INFINITY);
	if (!x->e.code && !read_keys(&x->r, bounds, x->name, names))
		for (int k = 0; k < x->c->precision_count; k++)
			b->errors[k] = read_number(&x->r, json_object_get(bounds, names[k]), x->name, (double)INFINITY);
}

static void take_output(struct row_check *x)
{
	const struct dag *d = &x->c->a->dag;
	const char *name = read_word(&x->r, x->json, "a row", "output");
	int row = read_whole(&x->r, json_object_get(x->json, "row"), "\"row\" of a row", 0, 1 << 20);

	snprintf(x->name, sizeof x->name, "%.80s[%d]", name, row);
	for (x->output = 0; x->output < d->output_count && !x->e.code; x->output++)
		if (d->outputs[x->output].row == row && !strcmp(d->arguments[d->outputs[x->output].argument].name, name))
			return;
	error_set(&x->e, RNEAGEN_READ, "%s: the text has no output %s", x->r.file, x->name);
}

/* ---- checking ---- */

static void check_boxes(struct row_check *x, const json_t *step, enum step_kind kind)
{
	const struct boxes *b = &x->certified.steps[kind];
	const char *what = "";
	long fault;

	take_boxes(x, step, kind);
	if (x->e.code)
		return;
	fault = certificate_check_boxes(x->c, x->output, kind, b, &what);
	if (fault >= 0 && (size_t)fault == b->count)
		error_set(&x->e, RNEAGEN_READ, "%s: %s, step \"%s\": %s do not make a cover of all q by %zu boxes", x->r.file,
			x->name, STEP_NAMES[kind], what, b->count);
	else if (fault >= 0)
		error_set(&x->e, RNEAGEN_READ, "%s: %s, step \"%s\", box %ld of %zu: %s is not what is stated",
			x->r.file, x->name, STEP_NAMES[kind], fault + 1, b->count, what);
}

static void check_grid(struct row_check *x, const json_t *step)
{
	const char *fault;

	take_grid(x, step);
	if (x->e.code)
		return;
	fault = certificate_check_grid(x->c, x->output, &x->certified.grid);
	if (fault)
		error_set(&x->e, RNEAGEN_READ, "%s: %s, step \"grid\": its %s cannot be as they are stated",
			x->r.file, x->name, fault);
}

static void check_step(struct row_check *x, const json_t *step)
{
	const char *by = read_word(&x->r, step, x->name, "by");
	int kind = 0;

	while (kind < STEP_COUNT && strcmp(by, STEP_NAMES[kind]) != 0)
		kind++;
	if (x->e.code || kind == STEP_COUNT ||
		(kind < BOX_STEPS ? x->certified.steps[kind].count : (size_t)x->certified.grid.dim_count))
		error_set(&x->e, RNEAGEN_READ, "%s: %s: a step is \"%.40s\", which is not known or there twice",
			x->r.file, x->name, by);
	else if (kind == STEP_GRID)
		check_grid(x, step);
	else
		check_boxes(x, step, (enum step_kind)kind);
}

static void check_bound(struct row_check *x)
{
	struct box_bound own = certified_total(&x->certified, x->c->precision_count), *stated = &x->certified.bound;
	const char *what = stated->value.lo != own.value.lo ? "\"low\"" : stated->value.hi != own.value.hi ? "\"high\"" : NULL;

	for (int k = 0; k < x->c->precision_count && !what; k++)
		if (stated->errors[k] != own.errors[k])
			what = emit_precision_name(x->c->precisions[k]);
	if (what)
		error_set(&x->e, RNEAGEN_READ, "%s: %s: its steps do not give the bound that is stated, but another: %s",
			x->r.file, x->name, what);
}

static void check_row(void *job, size_t i)
{
	struct row_check *x = (struct row_check *)job + i;
	const json_t *steps;

	x->r.e = &x->e;
	if (read_keys(&x->r, x->json, "a row", ROW))
		return;
	take_output(x);
	if (!x->e.code)
		take_bounds(x);
	steps = x->e.code ? NULL : read_member(&x->r, x->json, x->name, "steps", JSON_ARRAY);
	if (!x->e.code)
		read_member(&x->r, x->json, x->name, "left_out", JSON_ARRAY);
	x->certified.left_out = x->e.code ? NULL : left_out(x->c->a, x->output);
	if (x->certified.left_out && json_array_size(steps))
		error_set(&x->e, RNEAGEN_READ, "%s: %s: it has steps, but no step is known for it: %s", x->r.file, x->name,
			x->certified.left_out);
	for (size_t k = 0; k < json_array_size(steps) && !x->e.code; k++)
		check_step(x, json_array_get(steps, k));
	if (!x->e.code)
		check_bound(x);
}

/* ---- all ---- */

static void put_row(const struct row_check *x, struct text *out)
{
	const struct box_bound *b = &x->certified.bound;

	if (x->certified.left_out) {
		text_printf(out, "%s: nothing is stated: %s\n", x->name, x->certified.left_out);
		return;
	}
	if (isfinite(b->value.lo) && isfinite(b->value.hi))
		text_printf(out, "%s: from %.6g to %.6g", x->name, b->value.lo + 0.0, b->value.hi + 0.0);
	else
		text_printf(out, "%s: nothing is stated of its range", x->name);
	for (int k = 0; k < x->c->precision_count; k++)
		if (isfinite(b->errors[k]))
			text_printf(out, "; %s off by at most %.3g", emit_precision_name(x->c->precisions[k]), b->errors[k]);
		else
			text_printf(out, "; nothing is stated of %s", emit_precision_name(x->c->precisions[k]));
	text_putc(out, '\n');
}

static enum rneagen_code gather(struct row_check *rows, size_t count, const struct reader *r, struct text *report)
{
	size_t boxes = 0;

	for (size_t i = 0; i < count; i++) {
		if (rows[i].e.code)
			return error_set(r->e, rows[i].e.code, "%s", rows[i].e.message);
		for (size_t k = 0; k < i; k++)
			if (rows[k].output == rows[i].output)
				return error_set(r->e, RNEAGEN_READ, "%s: %s is there twice", r->file, rows[i].name);
		put_row(&rows[i], report);
		for (int kind = 0; kind < BOX_STEPS; kind++)
			boxes += rows[i].certified.steps[kind].count;
	}
	text_printf(report, "\n%s holds: %zu rows by %zu boxes.\n", r->file, count, boxes);
	return RNEAGEN_OK;
}

enum rneagen_code check_rows(
	const struct certificate *c, const struct reader *r, const json_t *list, unsigned threads, struct text *report)
{
	size_t count = json_array_size(list);
	struct row_check *rows = calloc(count + 1, sizeof *rows);
	struct workers *w = workers_open(threads);

	if (!rows || !w)
		error_memory(r->e);
	else if (!r->e->code && count != c->a->dag.output_count)
		error_set(r->e, RNEAGEN_READ, "%s: it has %zu rows, and the text %zu outputs", r->file, count,
			c->a->dag.output_count);
	for (size_t i = 0; rows && i < count; i++)
		rows[i] = (struct row_check){.c = c, .r = *r, .json = json_array_get(list, i)};
	if (!r->e->code) {
		workers_run(w, workers_limit(w), check_row, rows, count);
		gather(rows, count, r, report);
	}
	for (size_t i = 0; rows && i < count; i++)
		for (int kind = 0; kind < BOX_STEPS; kind++)
			boxes_free(&rows[i].certified.steps[kind]);
	free(rows);
	workers_close(w);
	return r->e->code;
}
