/* Parts of a kernel's grid: the body that calls theirs, which parts that share nothing need where the text is compiled as C
   alone. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_parts.h"
#include "emit/kernels/emit_relay.h"
#include "plan/stage.h"
#include "plan/tiles/tiles.h"

void emit_put_sample_call(
	const struct emission *e, const struct function *p, const char *function, const char *more, struct text *out)
{
	text_printf(out, "%s%s_%s_%s(%s, stride%s%s);", emit_has_known(e) ? "all_small &= " : "", e->options->name, p->algorithm->name,
		function, emit_params(e, emit_main(e), PARAMS_NAMES), more, emit_handed_on(e, emit_known_names(e)));
}

const char *emit_along(const struct emission *e, int parts)
{
	struct text t;

	text_init(&t, e->arena);
	if (parts)
		text_printf(&t, ", %d", parts);
	return text_string(&t);
}

/* Does it read what a hand has left in an output? */
static int is_handed(const struct function *p)
{
	for (size_t i = 0; i < p->dag.count && p->stretches; i++)
		if (p->dag.nodes[i].op == OP_INPUT && p->dag.arguments[p->dag.nodes[i].arg[0].i].is_output)
			return 1;
	return 0;
}

int emit_takes_found(const struct function *p)
{
	return p->stretches && p->stretches->takes_found;
}

const char *emit_handed(const struct emission *e, const struct function *p, const char *at, const char *step)
{
	if (!emit_takes_found(p))
		return text_format(e->arena, "%s, %s", at, step);
	return text_format(e->arena, "%s, %s + %d*%s, %s", at, at, stretches_found_row(p->stretches, FOUND_MU), step, step);
}

const char *emit_more_params(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	if (tiles_are_inputs(p))
		text_put(&t, ", const size_t inner");
	if (tiles_rows(p) && tiles_rows(p)->gap)
		text_put(&t, ", const size_t gap");
	if (p->stretches && p->stretches->period)
		text_put(&t, ", const size_t skip");
	if (emit_takes_found(p))
		text_printf(&t, ", const %s *found, const %s *mu, const size_t step", e->memory->type, e->memory->type);
	else if (is_handed(p))
		text_printf(&t, ", const %s *handed, const size_t step", e->memory->type);
	return text_string(&t);
}

const char *emit_gap(const struct emission *e, const struct function *p, int is_staged)
{
	return text_format(e->arena, is_staged ? "staged ? %d : 0" : "0", tiles_rows(p)->gap);
}

const char *emit_more(const struct emission *e, const struct function *p, int is_staged, const char *inner, const char *handed)
{
	const char *skip = e->options->layout == RNEAGEN_SOA ? ", staged ? (size_t)(%d - %d) : 0" : ", staged ? RNEA_BLOCK*%d - %d : 0";
	struct text t;

	text_init(&t, e->arena);
	if (tiles_are_inputs(p))
		text_printf(&t, ", %s", inner);
	if (tiles_rows(p) && tiles_rows(p)->gap)
		text_printf(&t, ", %s", emit_gap(e, p, is_staged));
	if (p->stretches && p->stretches->period)
		text_printf(&t, is_staged ? skip : ", 0", stage_pitch(stretches_rows(p->stretches, 0), e->options), p->stretches->period);
	if (is_handed(p))
		text_printf(&t, ", %s", handed);
	return text_string(&t);
}

int emit_hand_levels(const struct emission *e)
{
	int hands = emit_hands(e);

	return hands ? e->parts[hands - 1].level + 1 : 0;
}

int emit_hands_of(const struct emission *e, int level)
{
	int count = 0;

	for (int i = 0; i < emit_hands(e); i++)
		count += e->parts[i].level == level;
	return count;
}

const char *emit_hands_kernel(const struct emission *e, int level)
{
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, "hands");
	if (level)
		text_printf(&t, "%d", level);
	text_put(&t, "_kernel");
	return text_string(&t);
}

int emit_joints_again(const struct emission *e)
{
	int most = 0;

	for (int i = 0; i < e->part_count; i++)
		most = e->parts[i].joints > most ? e->parts[i].joints : most;
	return most;
}

const char *emit_launch_hands(const struct emission *e)
{
	int levels = emit_hand_levels(e);
	struct text t;

	text_init(&t, e->arena);
	for (int level = 0; level < levels; level++) {
		const char *kernel = emit_hands_kernel(e, level);
		const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", emit_main(e)->algorithm->name}, {"KERNEL", kernel},
			{"STATUS", level ? "status" : levels > 1 ? "int status" : "const int status"},
			{"HANDS", emit_int(e, emit_hands_of(e, level))}, {"GIVEN", emit_given(e, kernel)}};

		template_expand(&t, template_launch_hands_in, slots, sizeof slots / sizeof *slots);
	}
	return text_string(&t);
}

/* A call of a part's body where the arrays are the sample's own. */
static void put_part_call(const struct emission *e, const struct function *p, struct text *out)
{
	const struct dag *d = &emit_main(e)->dag;
	const char *handed = emit_handed(e, p, d->arguments[parts_handed(d)].name, "stride");

	emit_put_sample_call(e, p, "body", emit_more(e, p, 0, "stride", handed), out);
}

/* The body that calls the parts'. */
void emit_dispatcher(const struct emission *e, struct text *out)
{
	const struct function *p = emit_main(e);
	struct text cases, calls;

	text_init(&cases, e->arena);
	text_init(&calls, e->arena);
	emit_relay_before(e, &calls);
	for (int i = 0; i < e->part_count; i++) {
		text_printf(&cases, "%s\tcase %d:\n\t\t", i ? "\n" : "", i);
		put_part_call(e, &e->parts[i].function, &cases);
		text_put(&cases, "\n\t\tbreak;");
		text_put(&calls, i ? "\n\t" : "\t");
		put_part_call(e, &e->parts[i].function, &calls);
	}
	emit_relay_after(e, &calls);
	const struct slot slots[] = {{"DOC", p->algorithm->doc}, {"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"RESULT", emit_has_known(e) ? "int" : "void"}, {"RETURNS", emit_has_known(e) ? EMIT_RETURNS : ""},
		{"BEGIN", emit_has_known(e) ? "\tint all_small = 1;" : ""},
		{"END", emit_has_known(e) ? "\treturn all_small;" : ""}, {"COUNT", emit_int(e, e->part_count)},
		{"PARTS", e->part_count > 1 ? "In parts that share nothing, one after the other; in a kernel each block makes one of them." :
			e->parts->function.each ? "In one part, with loops over limbs that are alike." :
			"In one part; a kernel makes some of the motion again instead of keeping it."},
		{"CASES", text_string(&cases)}, {"CALLS", text_string(&calls)}};
	size_t from = out->length;

	template_expand(out, emit_is_apart(e) ? template_parts_apart_in : e->target->kernel->parts, slots, sizeof slots / sizeof *slots);
	fold(out, from);
	out->failed |= cases.failed | calls.failed;
}
