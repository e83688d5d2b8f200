/* Parts of a kernel's grid: the body that calls theirs. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/emit.h"

/* The call of a part's body with the dispatcher's own arguments. */
static void put_part_call(const struct emission *e, int part, struct text *out)
{
	text_printf(out, "%s%s_%s_body(%s, stride%s%s);", emit_has_known(e) ? "all_small &= " : "", e->options->name,
		e->parts[part].algorithm.name, emit_params(e, emit_main(e), PARAMS_NAMES),
		emit_has_known(e) ? ", " : "", emit_has_known(e) ? emit_known_names(e) : "");
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
		put_part_call(e, i, &cases);
		text_put(&cases, "\n\t\tbreak;");
		text_put(&calls, i ? "\n\t" : "\t");
		put_part_call(e, i, &calls);
	}
	emit_relay_after(e, &calls);
	const struct slot slots[] = {{"DOC", p->algorithm->doc}, {"NAME", e->options->name}, {"PASS", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"RESULT", emit_has_known(e) ? "int" : "void"}, {"RETURNS", emit_has_known(e) ? EMIT_RETURNS : ""},
		{"BEGIN", emit_has_known(e) ? "\tint all_small = 1;" : ""},
		{"END", emit_has_known(e) ? "\treturn all_small;" : ""}, {"COUNT", emit_int(e, e->part_count)},
		{"CASES", text_string(&cases)}, {"CALLS", text_string(&calls)}};
	size_t from = out->length;

	template_expand(out, e->target->kernel->parts, slots, sizeof slots / sizeof *slots);
	fold(out, from);
	out->failed |= cases.failed | calls.failed;
}
