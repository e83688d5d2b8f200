#include "certify/assumptions.h"
#include "certify/certificate.h"
#include "emit/emit.h"
#include <string.h>

/* 17 digits read back as the same double; null: nothing is said. */
static void put_number(struct text *out, double x)
{
	if (isfinite(x))
		text_printf(out, "%.17g", x + 0.0);
	else
		text_put(out, "null");
}

static void put_string(struct text *out, const char *name, const char *s)
{
	text_printf(out, "\"%s\": ", name);
	if (s)
		text_put_json(out, s);
	else
		text_put(out, "null");
}

static void put_numbers(struct text *out, const char *name, const double *x, size_t count)
{
	text_printf(out, ",\n        \"%s\": [", name);
	for (size_t i = 0; i < count; i++) {
		text_put(out, i % 8 ? ", " : i ? ",\n          " : "");
		put_number(out, x[i]);
	}
	text_put(out, "]");
}

static void put_robot(const struct certificate *c, struct text *out)
{
	char hash[HASH_TEXT];

	asked_hash(c->a->urdf, c->a->length, hash);
	text_put(out, "  \"robot\": {");
	put_string(out, "name", c->a->robot.name);
	text_put(out, ", ");
	put_string(out, "file", c->a->options.file);
	text_printf(out, ", \"sha256\": \"%s\"},\n", hash);
}

static void put_asked(const struct certificate *c, struct text *out)
{
	const struct rneagen_options *o = &c->a->options;

	text_printf(out, "  \"asked\": {\"trig\": \"%s\", \"base\": \"%s\", \"mimic\": \"%s\", \"strict\": %s, \"gravity\": [",
		emit_trig_name(o->trig), o->base == RNEAGEN_FLOATING ? "floating" : "fixed",
		o->mimic == RNEAGEN_MIMIC_INDEPENDENT ? "independent" : "honour", o->strict ? "true" : "false");
	for (int i = 0; i < 3; i++)
		text_printf(out, "%s%.17g", i ? ", " : "", o->gravity[i] + 0.0);
	text_put(out, "], ");
	put_string(out, "order", o->order);
	text_put(out, ", ");
	put_string(out, "scene", o->scene ? o->scene : "");
	text_put(out, "},\n  \"texts\": [");
	for (int k = 0; k < c->precision_count; k++)
		text_printf(out, "%s\n    {\"target\": \"c\", \"precision\": \"%s\", \"sha256\": \"%s\"}", k ? "," : "",
			emit_precision_name(c->precisions[k]), c->text_hash[k]);
	text_put(out, "\n  ],\n  \"assumptions\": [");
	for (int i = 0; i < ASSUMPTION_COUNT; i++)
		if (assumption_is_needed(c->a, i)) {
			text_put(out, i ? ",\n    " : "\n    ");
			text_put_json(out, ASSUMPTIONS[i].text);
		}
}

static void put_ranges(const struct certificate *c, struct text *out)
{
	const struct dag *d = &c->a->dag;
	int count = 0;

	for (int i = 0; i < d->argument_count; i++)
		for (int r = 0; r < d->arguments[i].rows && c->box.rows[i]; r++) {
			if (!(c->box.rows[i][r].lo <= c->box.rows[i][r].hi))
				continue;
			text_put(out, count++ ? ",\n    {" : "\n    {");
			put_string(out, "input", d->arguments[i].name);
			text_printf(out, ", \"row\": %d, \"lower\": %.17g, \"upper\": %.17g}", r, c->box.rows[i][r].lo,
				c->box.rows[i][r].hi);
		}
}

static void put_boxes(const struct certificate *c, enum step_kind kind, const struct boxes *b, struct text *out)
{
	text_printf(out, "{\"by\": \"%s\", \"cuts\": [", STEP_NAMES[kind]);
	for (size_t i = 0; i < b->cuts.count; i++)
		text_printf(out, "%s%d", i % 64 ? "," : i ? ",\n          " : "", b->cuts.rows[i]);
	text_put(out, "]");
	put_numbers(out, "low", b->low, b->count);
	put_numbers(out, "high", b->high, b->count);
	for (int k = 0; k < c->precision_count && b->errors[k]; k++)
		put_numbers(out, emit_precision_name(c->precisions[k]), b->errors[k], b->count);
	text_put(out, "}");
}

static void put_counts(struct text *out, const char *name, const int *x, int count)
{
	text_printf(out, "\"%s\": [", name);
	for (int i = 0; i < count; i++)
		text_printf(out, "%s%d", i ? ", " : "", x[i]);
	text_put(out, "]");
}

static void put_grid(const struct grid_step *g, struct text *out)
{
	text_printf(out, "{\"by\": \"%s\", ", STEP_NAMES[STEP_GRID]);
	put_counts(out, "rows", g->rows, g->dim_count);
	text_put(out, ",\n        \"passes\": [");
	for (int i = 0; i < g->pass_count; i++) {
		text_put(out, i ? ",\n          {" : "\n          {");
		put_counts(out, "counts", g->passes[i].counts, g->dim_count);
		put_numbers(out, "bends", g->passes[i].bends, (size_t)g->dim_count);
		text_put(out, "}");
	}
	text_put(out, "],\n        ");
	put_counts(out, "counts", g->counts, g->dim_count);
	text_put(out, ", \"low\": ");
	put_number(out, g->value.lo);
	text_put(out, ", \"high\": ");
	put_number(out, g->value.hi);
	text_put(out, "}");
}

/* Why a bound is null. */
static void put_reasons(const struct certificate *c, const struct certified *row, struct text *out)
{
	int has_range = isfinite(row->bound.value.lo) && isfinite(row->bound.value.hi), count = 0;
	const char *why = row->left_out ? row->left_out
		: row->steps[STEP_ERRORS].count ? "something may overflow, or an angle is larger than --trig takes"
		: "the text has an operation that no step is known for";

	text_put(out, ",\n     \"left_out\": [");
	if (!has_range)
		text_printf(out, "\"range: %s\"", why);
	count += !has_range;
	for (int k = 0; k < c->precision_count; k++)
		if (!isfinite(row->bound.errors[k]))
			text_printf(out, "%s\"%s: %s\"", count++ ? ", " : "", emit_precision_name(c->precisions[k]), why);
	text_put(out, "]");
}

static void put_row(const struct certificate *c, size_t i, struct text *out)
{
	const struct output *o = &c->a->dag.outputs[i];
	const struct certified *row = &c->rows[i];
	int count = 0;

	put_string(out, "output", c->a->dag.arguments[o->argument].name);
	text_printf(out, ", \"row\": %d, \"low\": ", o->row);
	put_number(out, row->bound.value.lo);
	text_put(out, ", \"high\": ");
	put_number(out, row->bound.value.hi);
	text_put(out, ", \"error_bounds\": {");
	for (int k = 0; k < c->precision_count; k++) {
		text_printf(out, "%s\"%s\": ", k ? ", " : "", emit_precision_name(c->precisions[k]));
		put_number(out, row->bound.errors[k]);
	}
	text_put(out, "}");
	put_reasons(c, row, out);
	text_put(out, ",\n     \"steps\": [");
	for (int kind = 0; kind < BOX_STEPS; kind++)
		if (row->steps[kind].count) {
			text_put(out, count++ ? ",\n      " : "\n      ");
			put_boxes(c, (enum step_kind)kind, &row->steps[kind], out);
		}
	if (row->grid.dim_count) {
		text_put(out, count++ ? ",\n      " : "\n      ");
		put_grid(&row->grid, out);
	}
	text_put(out, "]}");
}

/* By arguments and their rows. */
static void put_rows(const struct certificate *c, struct text *out)
{
	const struct dag *d = &c->a->dag;
	uint32_t *order = arena_alloc(out->arena, d->output_count, sizeof *order);

	out->failed |= !order;
	if (order)
		dag_order_outputs(d, order);
	for (size_t i = 0; i < d->output_count && order; i++) {
		text_put(out, i ? ",\n    {" : "\n    {");
		put_row(c, order[i], out);
	}
}

void certificate_put(const struct certificate *c, struct text *out)
{
	text_printf(out, "{\n  \"format\": %d,\n  \"version\": \"%s\",\n", CERTIFICATE_FORMAT, RNEAGEN_VERSION);
	put_robot(c, out);
	put_asked(c, out);
	text_put(out, "\n  ],\n  \"ranges\": [");
	put_ranges(c, out);
	text_put(out, "\n  ],\n  \"rows\": [");
	put_rows(c, out);
	text_put(out, "\n  ]\n}\n");
}
