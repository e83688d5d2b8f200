/* The last segment of what a call of one sample runs, where it is a loop over columns (DAG_COLUMN): its body, the functions that run
   it, and their calls. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/unparse.h"

int emit_is_loop(const struct pass *p, int segment)
{
	return p->dag.run_count && segment == p->segments.count - 1;
}

/* Statements are made in `spare` before they are indented. */
void emit_columns(const struct emission *e, const struct pass *p, struct writer *w, struct text *spare, struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"T", e->memory->type},
		{"NUMBER", emit_int(e, s->count - 1)}, {"COUNT", emit_int(e, s->count)}, {"NV", emit_int(e, e->tree->nv)}};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *rest = template_expand_to(out, template_segment_columns_in, "BODY", slots, count);

	text_clear(spare);
	unparse_within(w, &s->plans[s->count - 1]);
	unparse_lines(w, &s->plans[s->count - 1], spare);
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
	text_printf(out, "%s_%s_%s(%s", e->options->name, p->algorithm->name, function, p->dag.arguments[r->argument].name);
}

/* Where a sample's rows are together, columns are side by side; in a batch of soa one comes after the other. */
void emit_columns_calls(const struct emission *e, const struct pass *p, struct text *out)
{
	int is_soa = e->options->layout == RNEAGEN_SOA;
	const char *indent = is_soa ? "\t\t" : "\t";

	text_put(out, is_soa ? "\tif (stride == 1) {\n" : "");
	for (int i = 0; i < p->dag.run_count; i++) {
		const struct column_run *r = &p->dag.runs[i];

		text_put(out, indent);
		put_name(e, p, "columns_of", r, out);
		text_printf(out, " + %d, across, %d);\n", r->first, r->count);
	}
	text_put(out, is_soa ? "\t} else {\n" : "");
	for (int i = 0; i < p->dag.run_count && is_soa; i++) {
		const struct column_run *r = &p->dag.runs[i];

		text_printf(out, "\t\tfor (size_t j = %d; j < %d; j++)\n\t\t\t", r->first, r->first + r->count);
		put_name(e, p, "column_of", r, out);
		text_put(out, " + j*stride, stride, across);\n");
	}
	text_put(out, is_soa ? "\t}\n" : "");
}
