#include "tell/draw_put.h"
#include "base/number.h"
#include "draw/draw.h"

enum { WIDTH = 84 }; /* a line goes on by one run at most */

/* Rows of one input that are drawn alike. */
struct run {
	const struct drawn_array *array;
	int first, count;
	struct draw_range range;
};

struct telling {
	struct drawn drawn;
	const struct request *request;
	struct run *runs;
	size_t count, capacity;
};

static int is_given(const struct telling *x, const struct drawn_array *a, int row)
{
	const struct row *const rows[] = {x->request->q, x->request->qd, x->request->qdd};
	size_t i = (size_t)(a - x->drawn.arrays);

	return i < DRAWN_OTHERS && rows[i][row].is_given;
}

static int is_alike(struct draw_range a, struct draw_range b)
{
	return a.kind == b.kind && (a.kind == DRAW_ROTATION || (a.lower == b.lower && a.upper == b.upper));
}

/* Lengthens the last run where the row goes on with it. */
static void add_row(struct telling *x, const struct drawn_array *a, int row, struct arena *arena)
{
	struct run *r = x->count ? &x->runs[x->count - 1] : NULL;

	if (is_given(x, a, row))
		return;
	if (r && r->array == a && r->first + r->count == row && is_alike(r->range, a->ranges[row])) {
		r->count++;
		return;
	}
	r = arena_grow(arena, x->runs, x->count, &x->capacity, sizeof *r);
	if (!r)
		return;
	x->runs = r;
	x->runs[x->count++] = (struct run){a, row, 1, a->ranges[row]};
}

static int begin(struct telling *x, const struct analysis *of, struct text *out)
{
	const struct dag *d = &of->dag;

	*x = (struct telling){.request = &of->request};
	if (draw_ranges(&x->drawn, &of->tree, &of->request, out->arena))
		for (int k = 0; k < d->argument_count; k++) {
			const struct drawn_array *a = draw_array(&x->drawn, &d->arguments[k]);

			for (int i = 0; a && i < a->rows; i++)
				add_row(x, a, i, out->arena);
		}
	out->failed |= out->arena->failed;
	return !out->failed;
}

static void put_run(const struct run *r, struct text *out)
{
	text_put(out, r->array->name);
	if (r->count > 1 && r->count < r->array->rows)
		text_printf(out, "[%d..%d]", r->first, r->first + r->count - 1);
	else if (r->count < r->array->rows)
		text_printf(out, "[%d]", r->first);
	if (r->range.kind == DRAW_ROTATION)
		text_put(out, " a rotation");
	else
		text_printf(out, r->range.kind == DRAW_BODY ? " a body of %.6g..%.6g kg" : " %.6g..%.6g",
			r->range.lower, r->range.upper);
}

void draw_put(const struct analysis *a, const char *next, struct text *out)
{
	struct telling x;
	size_t line = out->length;

	if (!begin(&x, a, out))
		return;
	for (size_t i = 0; i < x.count; i++) {
		text_put(out, i ? "," : "");
		if (out->length - line > WIDTH) {
			text_put(out, next);
			line = out->length;
		} else {
			text_put(out, i ? " " : "");
		}
		put_run(&x.runs[i], out);
	}
}

void draw_put_json(const struct analysis *a, const char *next, struct text *out)
{
	static const char *const kinds[] = {[DRAW_NUMBER] = "number", [DRAW_ROTATION] = "rotation", [DRAW_BODY] = "body"};
	struct telling x;

	if (!begin(&x, a, out))
		return;
	for (size_t i = 0; i < x.count; i++) {
		const struct run *r = &x.runs[i];

		text_printf(out, "%s{\"name\": \"%s\", \"first\": %d, \"count\": %d, \"kind\": \"%s\"", i ? next : "",
			r->array->name, r->first, r->count, kinds[r->range.kind]);
		if (r->range.kind != DRAW_ROTATION)
			text_printf(out, ", \"lower\": %s, \"upper\": %s", number_plain(r->range.lower).s,
				number_plain(r->range.upper).s);
		text_putc(out, '}');
	}
}
