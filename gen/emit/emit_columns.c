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

/* Parameters that a body of one row does not touch. */
static const char *unused_text(const struct emission *e, const struct plan *lines)
{
	struct touched touched = emit_touched(lines);
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, touched.stride ? "" : "\t(void)stride;\n");
	text_put(&t, touched.across[0] ? "" : "\t(void)across;\n");
	text_put(&t, touched.step ? "" : "\t(void)step;\n");
	return text_string(&t);
}

/* Statements are made in `spare` before they are indented. */
void emit_columns(const struct emission *e, const struct pass *p, int segment, struct writer *w, struct text *spare,
	struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"T", e->memory->type},
		{"SEGMENT", emit_int(e, segment)}, {"COUNT", emit_int(e, s->count)}, {"UNUSED", unused_text(e, &s->plans[segment])},
		{"NUMBER", emit_int(e, loop_of(p, segment))}};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *rest = template_expand_to(out, template_segment_columns_in, "BODY", slots, count);

	text_clear(spare);
	unparse_within(w, &s->plans[segment]);
	unparse_lines(w, &s->plans[segment], spare);
	text_put_indented(out, text_string(spare));
	out->failed |= spare->failed;
	template_expand(out, rest, slots, count);
	if (!e->target->kernel)
		template_expand(out, template_segment_columns_row_in, slots, count);
	if (!e->target->kernel && e->options->layout == RNEAGEN_SOA)
		template_expand(out, template_segment_columns_soa_in, slots, count);
	fold(out, from);
}

/* ---- calls ---- */

/* Columns in a row, or one of them. */
static void put_call(const struct emission *e, const struct pass *p, const struct column_run *r, const char *indent, int is_row,
	struct text *out)
{
	const char *array = p->dag.arguments[r->argument].name, *name = e->options->name, *pass = p->algorithm->name;

	if (!is_row) {
		text_printf(out, "%sfor (size_t j = %d; j < %d; j++)\n", indent, r->first, r->first + r->count);
		text_printf(out, "%s\t%s_%s_column%d(%s + j*stride, stride, across);\n", indent, name, pass, r->loop, array);
		return;
	}
	text_printf(out, "%s%s_%s_columns%d(%s", indent, name, pass, r->loop, array);
	if (r->first)
		text_printf(out, " + %d", r->first);
	text_printf(out, ", across, %d);\n", r->count);
}

static void put_calls(const struct emission *e, const struct pass *p, int loop, const char *indent, int is_row, struct text *out)
{
	for (const struct column_run *r = p->dag.runs; r < p->dag.runs + p->dag.run_count; r++)
		if (r->loop == loop)
			put_call(e, p, r, indent, is_row, out);
}

/* Where a sample's rows are together, columns are side by side; in a batch of soa one comes after the other. */
void emit_columns_calls(const struct emission *e, const struct pass *p, int segment, struct text *out)
{
	if (e->options->layout != RNEAGEN_SOA) {
		put_calls(e, p, loop_of(p, segment), "\t", 1, out);
		return;
	}
	text_put(out, "\tif (stride == 1) {\n");
	put_calls(e, p, loop_of(p, segment), "\t\t", 1, out);
	text_put(out, "\t} else {\n");
	put_calls(e, p, loop_of(p, segment), "\t\t", 0, out);
	text_put(out, "\t}\n");
}
