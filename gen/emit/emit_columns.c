/* The last segments of what a call of one sample runs, where they are loops over columns (DAG_COLUMN): their bodies, the
   functions that run these, and the calls. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/unparse.h"

int emit_is_loop(const struct pass *p, int segment)
{
	return segment >= p->segments.count - p->dag.loop_count;
}

static int loop_of(const struct pass *p, int segment)
{
	return segment - (p->segments.count - p->dag.loop_count);
}

/* Statements are made in `spare` before they are indented. */
void emit_columns(const struct emission *e, const struct pass *p, int segment, struct writer *w, struct text *spare,
	struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"T", e->memory->type},
		{"SEGMENT", emit_int(e, segment)}, {"COUNT", emit_int(e, s->count)},
		{"NUMBER", emit_int(e, loop_of(p, segment))}};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *rest = template_expand_to(out, template_segment_columns_in, "BODY", slots, count);

	text_clear(spare);
	unparse_within(w, &s->plans[segment]);
	unparse_lines(w, &s->plans[segment], spare);
	text_put_indented(out, text_string(spare));
	out->failed |= spare->failed;
	template_expand(out, rest, slots, count);
	if (e->options->layout == RNEAGEN_SOA)
		template_expand(out, template_segment_columns_soa_in, slots, count);
	fold(out, from);
}

/* ---- calls ---- */

static void put_name(const struct emission *e, const struct pass *p, const char *function, const struct column_run *r,
	struct text *out)
{
	text_printf(out, "%s_%s_%s%d(%s", e->options->name, p->algorithm->name, function, r->loop,
		p->dag.arguments[r->argument].name);
}

/* Where a sample's rows are together, columns are side by side; in a batch of soa one comes after the other. */
void emit_columns_calls(const struct emission *e, const struct pass *p, int segment, struct text *out)
{
	int is_soa = e->options->layout == RNEAGEN_SOA;
	const char *indent = is_soa ? "\t\t" : "\t";
	const struct column_run *runs = p->dag.runs, *end = runs + p->dag.run_count;

	text_put(out, is_soa ? "\tif (stride == 1) {\n" : "");
	for (const struct column_run *r = runs; r < end; r++) {
		if (r->loop != loop_of(p, segment))
			continue;
		text_put(out, indent);
		put_name(e, p, "columns", r, out);
		if (r->first)
			text_printf(out, " + %d", r->first);
		text_printf(out, ", across, %d);\n", r->count);
	}
	text_put(out, is_soa ? "\t} else {\n" : "");
	for (const struct column_run *r = runs; r < end && is_soa; r++) {
		if (r->loop != loop_of(p, segment))
			continue;
		text_printf(out, "\t\tfor (size_t j = %d; j < %d; j++)\n\t\t\t", r->first, r->first + r->count);
		put_name(e, p, "column", r, out);
		text_put(out, " + j*stride, stride, across);\n");
	}
	text_put(out, is_soa ? "\t}\n" : "");
}
