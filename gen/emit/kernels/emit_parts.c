/* Parts of a kernel's grid: the body that calls theirs, which parts that share nothing need where the text is compiled as C alone. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/emit.h"

void emit_put_sample_call(const struct emission *e, const struct pass *p, const char *function, const char *more, struct text *out)
{
	text_printf(out, "%s%s_%s_%s(%s, stride%s%s);", emit_has_known(e) ? "all_small &= " : "", e->options->name, p->algorithm->name,
		function, emit_params(e, emit_main(e), PARAMS_NAMES), more, emit_handed_on(e, emit_known_names(e)));
}

/* The body that calls the parts'. */
void emit_dispatcher(const struct emission *e, struct text *out)
{
	const struct pass *p = emit_main(e);
	struct text cases, calls;

	text_init(&cases, e->arena);
	text_init(&calls, e->arena);
	emit_relay_before(e, &calls);
	for (int i = 0; i < e->part_count; i++) {
		text_printf(&cases, "%s\tcase %d:\n\t\t", i ? "\n" : "", i);
		emit_put_sample_call(e, &e->parts[i].pass, "body", "", &cases);
		text_put(&cases, "\n\t\tbreak;");
		text_put(&calls, i ? "\n\t" : "\t");
		emit_put_sample_call(e, &e->parts[i].pass, "body", "", &calls);
	}
	emit_relay_after(e, &calls);
	const struct slot slots[] = {{"DOC", p->algorithm->doc}, {"NAME", e->options->name}, {"PASS", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"RESULT", emit_has_known(e) ? "int" : "void"}, {"RETURNS", emit_has_known(e) ? EMIT_RETURNS : ""},
		{"BEGIN", emit_has_known(e) ? "\tint all_small = 1;" : ""},
		{"END", emit_has_known(e) ? "\treturn all_small;" : ""}, {"COUNT", emit_int(e, e->part_count)},
		{"CASES", text_string(&cases)}, {"CALLS", text_string(&calls)}};
	size_t from = out->length;

	template_expand(out, emit_is_apart(e) ? template_parts_apart_in : e->target->kernel->parts, slots, sizeof slots / sizeof *slots);
	fold(out, from);
	out->failed |= cases.failed | calls.failed;
}
