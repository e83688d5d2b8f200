/* Functions in segments: a body for each segment, a loop over some samples for each, and what calls them. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/columns/emit_columns.h"
#include "emit/columns/segment_zeros.h"
#include "emit/columns/emit_way_back.h"
#include "emit/emit_groups.h"
#include "emit/unparse.h"
#include "plan/segments.h"
#include "plan/stage.h"

/* Samples of a loop: as many as leave their values across cuts in a core's first cache; no fewer than vectors are wide, unless a
   thread's stack would grow too large. What coordinates carry may be as much again. */
enum { CACHE_BYTES = 16384, STACK_BYTES = 131072, MOST_LANES = 64, WIDE_LANES = 16, FEWEST_LANES = 4 };

int emit_lanes(const struct emission *e, const struct segments *s)
{
	int lanes = MOST_LANES, bytes = segments_bytes(s, e->options, e->wide != NULL);

	while (lanes > FEWEST_LANES && (lanes * bytes > (lanes > WIDE_LANES ? CACHE_BYTES : STACK_BYTES) ||
		lanes * s->carried * e->arithmetic->bytes > STACK_BYTES))
		lanes /= 2;
	return lanes;
}

/* An array of what goes across: of numbers, or of wide numbers. */
struct across {
	const char *type, *name;
	int slots;
};

static void put_form(const struct across *x, enum across_form form, int lanes, struct text *out)
{
	int slots = x->slots ? x->slots : 1;

	switch (form) {
	case ACROSS_PARAMETER:
		text_printf(out, "%s *const %s", x->type, x->name);
		break;
	case ACROSS_RESTRICT:
		text_printf(out, "%s *restrict %s", x->type, x->name);
		break;
	case ACROSS_FIRST:
		text_printf(out, "%s *const first_%s", x->type, x->name);
		break;
	case ACROSS_NAME:
		text_put(out, x->name);
		break;
	case ACROSS_LOCAL:
	case ACROSS_LANES:
		text_printf(out, "\t%s%s %s[%d];", form == ACROSS_LANES ? "RNEA_ALIGNED " : "", x->type, x->name, slots * lanes);
		break;
	case ACROSS_SHARED:
		text_printf(out, "\t__shared__ %s %s[%d*RNEA_SAMPLES*RNEA_BLOCK];", x->type, x->name, slots);
		break;
	case ACROSS_AT_THREAD:
		text_printf(out, "%s + here + j*RNEA_BLOCK", x->name);
	}
}

/* The type of a function's other numbers. */
static const char *wide_value(const struct emission *e)
{
	return emit_wide(e) ? emit_wide(e)->value : "";
}

const char *emit_across(const struct emission *e, const struct segments *s, enum across_form form)
{
	const struct across narrow = {e->numbers->value, "across", s->slots[0]};
	const struct across wide = {wide_value(e), "wide_across", s->slots[1]};
	int lanes = form == ACROSS_LANES ? emit_lanes(e, s) : 1;
	int is_line = form == ACROSS_LOCAL || form == ACROSS_LANES || form == ACROSS_SHARED;
	struct text t;

	text_init(&t, e->arena);
	put_form(&narrow, form, lanes, &t);
	if (wide.slots) {
		text_put(&t, is_line ? "\n" : ", ");
		put_form(&wide, form, lanes, &t);
	}
	return text_string(&t);
}

/* ---- bodies ---- */

struct touched emit_touched(const struct emission *e, const struct plan *p)
{
	struct touched t = {.step = 0};

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++)
		if (l->kind == LINE_FETCH || l->kind == LINE_KEEP) {
			t.across[p->dag->nodes[l->value.i].is_wide] = 1;
			t.step |= l->index > 0;
		} else if (l->kind == LINE_STORE)
			t.step |= emit_is_carried(p->dag, p->dag->outputs[l->index].argument);
	t.stride = emit_mark_arguments(e, p, t.arguments);
	return t;
}

/* Parameters that it does not touch. */
static void put_unused(const struct emission *e, const struct function *p, const struct plan *lines, const struct touched *t,
	struct text *out)
{
	emit_unused(e, lines, "first_", out);
	text_put(out, t->across[0] ? "" : "\t(void)first_across;\n");
	text_put(out, p->segments.slots[1] && !t->across[1] ? "\t(void)first_wide_across;\n" : "");
	text_put(out, t->step ? "" : "\t(void)step;\n");
}

/* This lane's place in the arrays. */
static void put_lane(const struct emission *e, const struct function *p, const struct touched *t, struct text *out)
{
	for (int i = 0; i < p->dag.argument_count; i++) {
		const struct argument *a = &p->dag.arguments[i];

		if (!t->arguments[i] || a->per_batch)
			continue;
		text_printf(out, "\t%s%s *const %s = first_%s + l", a->is_output ? "" : "const ", e->memory->type,
			a->name, a->name);
		if (emit_groups_layout(e, p) == RNEAGEN_AOS)
			text_printf(out, "*%d", a->rows);
		text_put(out, ";\n");
	}
	if (t->across[0])
		text_printf(out, "\t%s *const across = first_across + l;\n", e->numbers->value);
	if (t->across[1])
		text_printf(out, "\t%s *const wide_across = first_wide_across + l;\n", wide_value(e));
}

/* Statements are made in `spare` before they are indented. */
static void put_segment(const struct emission *e, const struct function *p, int k, struct writer *w, struct text *spare,
	struct text *out)
{
	const struct segments *s = &p->segments;
	struct touched touched = emit_touched(e, &s->plans[k]);
	struct segment_zeros zeros = segment_zeros_of(e, p, &s->plans[k]);
	struct text begin, end;

	text_init(&begin, e->arena);
	text_init(&end, e->arena);
	segment_zeros_put(e, p, &zeros, &end);
	text_put(&end, emit_has_known(e) ? "\treturn all_small;\n" : "");
	put_unused(e, p, &s->plans[k], &touched, &begin);
	text_put(&begin, emit_has_known(e) ? "\tint all_small = 1;\n" : "");
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
		{"COUNT", emit_int(e, s->count)}, {"FIRST_PARAMS", emit_params(e, p, PARAMS_FIRST)},
		{"ACROSS_PARAMS", emit_across(e, s, ACROSS_FIRST)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"RESULT", emit_has_known(e) ? "int" : "void"}, {"BEGIN", text_string(&begin)},
		{"END", text_string(&end)},
	};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *rest = template_expand_to(out, template_segment_in, "BODY", slots, count);

	text_clear(spare);
	put_lane(e, p, &touched, spare);
	segment_zeros_put_unused(p, &zeros, spare);
	w->own.zeros = zeros.count ? ZEROS_LEFT : ZEROS_AMONG;
	unparse_within(w, &s->plans[k]);
	unparse_lines(w, &s->plans[k], spare);
	w->own.zeros = ZEROS_AMONG;
	text_put_indented(out, text_string(spare));
	out->failed |= spare->failed;
	template_expand(out, rest, slots, count);
	fold(out, from);
}

static void put_segments(const struct emission *e, const struct function *p, struct text *out)
{
	struct text spare;
	struct writer w;

	text_init(&spare, e->arena);
	unparse_begin(&w, e, p, e->numbers);
	for (int k = 0; k < p->segments.count; k++)
		if (emit_is_loop(p, k))
			emit_columns(e, p, k, &w, &spare, out);
		else
			put_segment(e, p, k, &w, &spare, out);
}

const struct function *emit_many_of(const struct function *p)
{
	return p->many ? p->many : p;
}

/* What one sample runs where there are vectors; NULL: nothing of its own. */
static const struct function *lanes_of(const struct function *p)
{
	return p->lanes_in_batches ? p->beside : NULL;
}

/* What a call of one sample runs. */
static const struct function *single_of(const struct function *p)
{
	return p->single ? p->single : p;
}

void emit_segments(const struct emission *e, const struct function *p, struct text *out)
{
	int has_own = p->single || !emit_has_batches(e);

	if (emit_has_batches(e))
		put_segments(e, emit_many_of(p), out);
	if (lanes_of(p)) {
		text_put(out, EMIT_IF_LANES);
		put_segments(e, lanes_of(p), out);
		text_put(out, has_own ? "#else\n" : "");
	}
	if (has_own)
		put_segments(e, single_of(p), out);
	text_put(out, lanes_of(p) ? "#endif\n" : "");
}

const struct function *emit_lanes_alone(const struct function *p)
{
	return p->lanes_in_batches ? NULL : p->beside;
}

int emit_lanes_instead(const struct emission *e, const struct function *p)
{
	return emit_lanes_alone(p) && !emit_has_batches(e);
}

void emit_lanes_call_bodies(const struct emission *e, const struct function *p, struct text *out)
{
	if (!emit_lanes_alone(p))
		return;
	text_put(out, EMIT_IF_LANES);
	put_segments(e, emit_lanes_alone(p), out);
	text_put(out, "#endif\n");
}

/* ---- batches ---- */

static void put_lanes_function(const struct emission *e, const struct function *p, int k, const char *unread, struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
		{"LANES", emit_int(e, emit_lanes(e, s))}, {"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)},
		{"COUNT_PARAM", emit_count_param(emit_groups_layout(e, p))},
		{"RESTRICT_ACROSS", emit_across(e, s, ACROSS_RESTRICT)}, {"AT_SAMPLE", emit_at_sample(e, p, emit_groups_layout(e, p))},
		{"ACROSS_NAMES", emit_across(e, s, ACROSS_NAME)}, {"UNKNOWN", unread}};

	template_expand(out, template_segment_lanes_in, slots, sizeof slots / sizeof *slots);
}

static void put_one_function(const struct emission *e, const struct function *p, int k, struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"KNOWN", emit_handed_on(e, emit_known_names(e))}, {"KNOWN_PARAM", emit_known_params(e)},
		{"ACROSS_PARAMS", emit_across(e, s, ACROSS_PARAMETER)}, {"ACROSS_NAMES", emit_across(e, s, ACROSS_NAME)}};

	template_expand(out, template_segment_one_in, slots, sizeof slots / sizeof *slots);
}

static void put_one_functions(const struct emission *e, const struct function *p, struct text *out)
{
	for (int k = 0; k < p->segments.count; k++)
		if (!emit_is_loop(p, k))
			put_one_function(e, p, k, out);
}

/* Of batches. */
static const char *many_functions(const struct emission *e, const struct function *p)
{
	const char *unread = emit_handed_on(e, emit_unread_names(e, p)); /* once: it goes through all lines */
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < p->segments.count; k++)
		if (!emit_is_loop(p, k))
			put_lanes_function(e, p, k, unread, &t);
	emit_zeros_many(e, p, &t);
	return text_string(&t);
}

/* Of a call of one sample, what `put` writes: as it is, or in lanes where there are such. */
static const char *one_text(const struct emission *e, const struct function *p,
	void (*put)(const struct emission *e, const struct function *p, struct text *out))
{
	struct text t;

	text_init(&t, e->arena);
	if (lanes_of(p)) {
		text_put(&t, EMIT_IF_LANES);
		put(e, lanes_of(p), &t);
		text_put(&t, "#else\n");
	}
	put(e, single_of(p), &t);
	text_put(&t, lanes_of(p) ? "#endif\n" : "");
	return text_string(&t);
}

static void put_call(const struct emission *e, const struct function *p, int k, const char *indent, const char *what,
	const char *where, const char *more, struct text *out)
{
	text_printf(out, "%s%s_%s_%s%d(%s, %s, %s%s);\n", indent, e->options->name, p->algorithm->name, what, k,
		emit_params(e, p, PARAMS_NAMES), where, emit_across(e, &p->segments, ACROSS_NAME), more);
}

static const char *lanes_calls(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	emit_zeros_many_calls(e, p, &t);
	for (int k = 0; k < p->segments.count; k++)
		if (emit_is_loop(p, k))
			emit_columns_many_calls(e, p, k, &t);
		else
			put_call(e, p, k, "\t", "lanes", emit_groups_layout(e, p) == RNEAGEN_SOA ? "count, first" : "first", "", &t);
	return text_string(&t);
}

static const char *one_calls(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < p->segments.count; k++)
		if (emit_is_loop(p, k))
			emit_columns_calls(e, p, k, &t);
		else
			put_call(e, p, k, "\t", "one", "stride", emit_handed_on(e, emit_known_names(e)), &t);
	return text_string(&t);
}

/* One sample's body. */
static void put_one_body(const struct emission *e, const struct function *p, struct text *out)
{
	text_printf(out, "%s\n%s\n%s", emit_across(e, &p->segments, ACROSS_LOCAL), emit_columns_declaration(e, p), one_calls(e, p));
}

void emit_lanes_call(const struct emission *e, const struct function *of, struct text *out)
{
	const struct function *p = emit_lanes_alone(of);
	struct text functions, body;

	if (!p)
		return;
	text_init(&functions, e->arena);
	text_init(&body, e->arena);
	put_one_functions(e, p, &functions);
	put_one_body(e, p, &body);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"KNOWN_PARAM", emit_known_params(e)}, {"ANY", emit_any(e, p)},
		{"INLINE", e->target->has_batches ? "" : "inline "},
		{"FUNCTIONS", text_string(&functions)}, {"ONE_BODY", text_string(&body)}};

	template_expand(out, template_lanes_call_in, slots, sizeof slots / sizeof *slots);
}

void emit_segments_one(const struct emission *e, const struct function *p, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"MANY", emit_has_batches(e) ? many_functions(e, emit_many_of(p)) : ""}, {"FUNCTIONS", one_text(e, p, put_one_functions)},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"ONE_BODY", one_text(e, p, put_one_body)}};

	text_put(out, emit_lanes_instead(e, p) ? EMIT_UNLESS_LANES : "");
	template_expand(out, template_segments_one_in, slots, sizeof slots / sizeof *slots);
	emit_put_any(e, p, out);
	text_put(out, emit_lanes_instead(e, p) ? "#endif\n" : "");
}

void emit_segments_group(const struct emission *e, const struct function *p, const char *where_small, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"GROUP", emit_int(e, emit_segments_lanes(e, p))}, {"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)},
		{"WHERE_SMALL", where_small}, {"COUNT_PARAM", emit_count_param(emit_groups_layout(e, p))},
		{"CALLS", lanes_calls(e, emit_many_of(p))}, {"DECLARATIONS", emit_columns_many_declarations(e, emit_many_of(p))}};

	template_expand(out, template_group_segments_in, slots, sizeof slots / sizeof *slots);
}

int emit_segments_lanes(const struct emission *e, const struct function *p)
{
	return emit_lanes(e, &emit_many_of(p)->segments);
}
