/* The kernel of small batches: a function for each warp, and the kernel that calls them. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_first_sines.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_parts.h"
#include "emit/kernels/emit_transpose.h"
#include "emit/unparse.h"
#include "plan/stage.h"
#include <string.h>

static const char *small_text(const struct emission *e, int angles)
{
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < angles; i++) {
		text_printf(&t, "%sfabs%s(x[%d]) <= ", i ? " && " : "", e->arithmetic->suffix, i);
		emit_number(e, e->arithmetic, (real)e->arithmetic->domain, &t);
	}
	return text_string(&t);
}

/* Sines of large angles, before all that asks for sines. */
static void put_known(const struct emission *e, const struct function *p, const struct angles *list, struct text *out)
{
	const struct number_type *n = e->numbers;
	struct text each;

	if (!list->count)
		return;
	text_init(&each, e->arena);
	unparse_angles(e, p, n, list, "", &each);
	const struct slot slots[] = {{"X", n->angle_is_memory ? n->memory->type : n->value}, {"T", n->value},
		{"ANGLES", emit_int(e, list->count)}, {"SINES", emit_int(e, 2 * list->count)}, {"EACH", text_string(&each)},
		{"SMALL", small_text(e, list->count)}, {"SINCOS", e->options->strict ? n->strict_sincos : n->sincos}};

	template_expand(out, template_limb_known_in, slots, sizeof slots / sizeof *slots);
}

/* The lines that come first: all inputs are under way before anything waits for an angle. */
static struct plan inputs_of(const struct plan *lines)
{
	struct plan p = *lines;

	for (p.line_count = 0; p.line_count < lines->line_count && lines->lines[p.line_count].kind == LINE_INPUT;)
		p.line_count++;
	return p;
}

static struct plan rest_after(const struct plan *lines, size_t first)
{
	struct plan p = *lines;

	p.lines += first;
	p.line_count -= first;
	return p;
}

static void put_warp(const struct emission *e, const struct function *p, int warp, struct writer *w, struct text *out)
{
	const struct plan *lines = &p->limbs.plans[warp], inputs = inputs_of(lines),
		rest_of = rest_after(lines, inputs.line_count);
	const struct angles list = angles_of(lines, 0, e->arena);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"NUMBER", emit_int(e, warp)},
		{"COUNT", emit_int(e, p->limbs.warps)}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"T", e->numbers->value},
		{"SINES", emit_table_param(e, p)}};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *rest = template_expand_to(out, template_limb_in, "BODY", slots, count);

	w->own.sines = list;
	unparse_within(w, lines);
	unparse_lines(w, &inputs, out);
	if (emit_has_known(e))
		put_known(e, p, &list, out);
	unparse_lines(w, &rest_of, out);
	if (emit_has_known(e) && list.count)
		text_put(out, "\t(void)all_small;\n");
	fold(out, from);
	template_expand(out, rest, slots, count);
}

/* What a kernel's warps run: the parts of the text, a round of it, or a relay's first function. */
struct crew {
	const struct function *named; /* the kernel is named after it, and, unless it has parts, runs it */
	int is_start, count;
	const char *macro;
};

static struct crew own_crew(const struct emission *e)
{
	if (e->rounds)
		return (struct crew){&e->rounds[FOUND_REST].function, 0, 1, "RNEA_LIMBS"};
	return (struct crew){emit_main(e), 0, emit_is_apart(e) ? 1 : emit_part_places(e), "RNEA_LIMBS"};
}

static struct crew start_crew(const struct emission *e)
{
	return (struct crew){e->rounds ? &e->rounds[FOUND_START].function : &e->relay->start.function, 1, 1, "RNEA_START_LIMBS"};
}

static const struct function *crew_function(const struct emission *e, const struct crew *c, int k)
{
	return c->is_start || emit_is_apart(e) ? c->named : emit_part(e, k);
}

static int crew_knows(const struct emission *e, const struct crew *c)
{
	for (int k = 0; k < c->count; k++) {
		const struct function *p = crew_function(e, c, k);

		if (plan_sincos(&p->plan) && !p->limbs.first.count)
			return 1;
	}
	return 0;
}

int emit_limbs_know(const struct emission *e)
{
	const struct crew own = own_crew(e);

	if (!emit_has_limbs(e) || crew_knows(e, &own))
		return 1;
	if (!emit_start_limbs(e))
		return 0;
	const struct crew start = start_crew(e);

	return crew_knows(e, &start);
}

int emit_has_limbs(const struct emission *e)
{
	return e->target->kernel && emit_limbs_of(e)->warps;
}

const struct limbs *emit_start_limbs(const struct emission *e)
{
	if (e->rounds)
		return &e->rounds[FOUND_START].function.limbs;
	return e->relay && emit_has_limbs(e) && e->relay->start.function.limbs.warps ? &e->relay->start.function.limbs : NULL;
}

static const char *warps_text(const struct emission *e, const struct crew *c)
{
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < c->count; k++) {
		const struct function *p = crew_function(e, c, k);
		struct writer w;

		unparse_begin(&w, e, p, e->numbers);
		if (emit_has_zeros(e, p))
			w.own.zeros = ZEROS_LEFT;
		emit_put_table(e, p, &t);
		for (int i = 0; i < p->limbs.warps; i++)
			put_warp(e, p, i, &w, &t);
	}
	return text_string(&t);
}

static const char *cases_text(const struct emission *e, const struct crew *c)
{
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < c->count; k++) {
		const struct function *p = crew_function(e, c, k);

		for (int i = 0; i < p->limbs.warps; i++)
			text_printf(&t, "\tcase %d:\n\t\t%s_%s_limb%d(%s, across%s);\n\t\tbreak;\n", k * p->limbs.warps + i,
				e->options->name, p->algorithm->name, i, emit_at_sample(e, p, e->options->layout), p->limbs.first.count ? ", sines" : "");
	}
	return text_string(&t);
}

const struct limbs *emit_limbs_of(const struct emission *e)
{
	if (e->rounds)
		return &e->rounds[FOUND_REST].function.limbs;
	return emit_is_apart(e) ? &emit_main(e)->limbs : &emit_part(e, 0)->limbs;
}

int emit_limbs_bytes(const struct emission *e, const struct limbs *s)
{
	return s->words * e->arithmetic->bytes * WARP_THREADS;
}

/* More than a kernel has without being asked; groups of more samples are those that have room in that. */
static int needs_room(const struct emission *e, const struct limbs *s)
{
	return emit_limbs_bytes(e, s) > SHARED_BYTES;
}

const char *emit_unless_limbs(const struct emission *e, const char *what)
{
	if (!emit_has_limbs(e) || !*what)
		return what;
	return text_format(e->arena, EMIT_UNLESS_LIMBS "%s#endif\n", what);
}

/* What the warps' lines wait by, if they do. */
static const char *join_text(const struct emission *e, const struct limbs *s, const char *lines)
{
	const struct slot slots[] = {{"JOIN", EMIT_JOIN}, {"WARPS", emit_int(e, s->warps)}};

	return strstr(lines, EMIT_JOIN) ? template_text(e->arena, template_limbs_join_in, slots, sizeof slots / sizeof *slots) : "";
}

/* What runs before the warps part: the sines of each part that has them made first. */
static const char *first_text(const struct emission *e, const struct crew *c)
{
	const struct limbs *s = &crew_function(e, c, 0)->limbs;
	struct text calls;
	int tables = 0;

	text_init(&calls, e->arena);
	for (int k = 0; k < c->count; k++) {
		const struct function *p = crew_function(e, c, k);

		if (!p->limbs.first.count)
			continue;
		if (c->count > 1)
			text_printf(&calls, "\tif (blockIdx.y == %d)\n\t", k);
		text_printf(&calls, "\t%s_%s_table(%s);\n", e->options->name, p->algorithm->name, emit_table_arguments(e));
		tables++;
	}
	const struct slot slots[] = {{"T", e->numbers->value}, {"NAME", e->options->name}, {"WORDS", emit_int(e, s->words)},
		{"CALLS", text_string(&calls)}};

	return tables ? template_text(e->arena, template_limbs_first_in, slots, sizeof slots / sizeof *slots) : "";
}

static void put_crew(const struct emission *e, const struct crew *c, struct text *out)
{
	const struct limbs *s = &crew_function(e, c, 0)->limbs;
	int has_parts = !c->is_start && e->part_count && !emit_is_apart(e);
	const char *lines = warps_text(e, c);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", c->named->algorithm->name}, {"T", e->numbers->value},
		{"MACRO", c->macro}, {"WARPS", emit_int(e, s->warps)}, {"WORDS", emit_int(e, s->words)},
		{"GROUPS", emit_int(e, s->groups)}, {"JOIN", join_text(e, s, lines)}, {"LIMBS", lines}, {"CASES", cases_text(e, c)},
		{"TRANSPOSE", emit_transpose_begin(e)},
		{"FIRST", first_text(e, c)},
		{"MOST", emit_int(e, (int)s->most)}, {"BYTES", emit_int(e, emit_limbs_bytes(e, s))},
		{"PART", has_parts ? "blockIdx.y*RNEA_LIMBS + " : ""},
		{"ZEROS", c->is_start ? "" : emit_zero_loops(e, "blockIdx.y*RNEA_LIMBS + warp%RNEA_LIMBS", "gridDim.y*RNEA_LIMBS")},
		{"RESTRICT_PARAMS", emit_params(e, c->named, PARAMS_CUDA_RESTRICT)}};

	template_expand(out, template_kernel_limbs_in, slots, sizeof slots / sizeof *slots);
	if (needs_room(e, s))
		template_expand(out, template_limbs_room_in, slots, sizeof slots / sizeof *slots);
}

void emit_limbs(const struct emission *e, struct text *out)
{
	const struct crew own = own_crew(e);

	text_put(out, "#endif\n#if !defined RNEA_NO_LIMBS\n"
		"/* ---- small batches: warps share out each sample, a lane's, between them ---- */\n");
	put_crew(e, &own, out);
	if (emit_start_limbs(e)) {
		const struct crew start = start_crew(e);

		put_crew(e, &start, out);
	}
	text_put(out, "#endif\n");
}

static const char *room_text(const struct emission *e, const struct crew *c)
{
	return needs_room(e, &crew_function(e, c, 0)->limbs)
		? text_format(e->arena, " && %s_%s_limbs_have_room()", e->options->name, c->named->algorithm->name) : "";
}

static const char *launch_text(const struct emission *e, const struct crew *c, const char *parts)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", c->named->algorithm->name}, {"MACRO", c->macro},
		{"PARTS", parts}, {"ROOM", room_text(e, c)}};

	return template_text(e->arena, template_launch_limbs_in, slots, sizeof slots / sizeof *slots);
}

/* Of two rounds, one after the other. */
static const char *launch_rounds(const struct emission *e)
{
	const struct crew start = start_crew(e), rest = own_crew(e);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", rest.named->algorithm->name},
		{"ROOM", text_format(e->arena, "%s%s", room_text(e, &start), room_text(e, &rest))}};

	return template_text(e->arena, template_launch_limb_rounds_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_limbs(const struct emission *e)
{
	if (e->rounds)
		return launch_rounds(e);
	if (!emit_has_limbs(e))
		return "";
	const struct crew own = own_crew(e);

	return launch_text(e, &own, emit_along(e, emit_is_apart(e) ? 0 : e->part_count));
}

const char *emit_launch_start_limbs(const struct emission *e)
{
	if (!emit_start_limbs(e))
		return "";
	const struct crew start = start_crew(e);

	return launch_text(e, &start, "");
}
