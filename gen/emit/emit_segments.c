/* Functions of passes in segments: a body for each, a loop over some samples for each, and what calls them. */
#include "base/fold.h"
#include "emit/emit.h"
#include "base/template.h"
#include "plan/stage.h"
#include "emit/unparse.h"

/* Samples of a loop: as many as leave their values across cuts in a core's first cache; no fewer than vectors are wide, unless a
   thread's stack would grow too large. */
enum { CACHE_BYTES = 16384, STACK_BYTES = 131072, MOST_LANES = 64, WIDE_LANES = 16, FEWEST_LANES = 4 };

static int across_bytes(const struct emission *e, const struct segments *s)
{
	return s->slots[0] * e->arithmetic->bytes + (e->wide ? s->slots[1] * e->wide->arithmetic->bytes : 0);
}

int emit_lanes(const struct emission *e, const struct segments *s)
{
	int lanes = MOST_LANES;

	while (lanes > FEWEST_LANES && lanes * across_bytes(e, s) > (lanes > WIDE_LANES ? CACHE_BYTES : STACK_BYTES))
		lanes /= 2;
	return lanes;
}

/* An array of what goes across: of numbers, or of wide numbers. */
struct across {
	const char *type, *name;
	int slots;
};

/* How it is written: as a parameter; the same where compilers are to know that it overlaps nothing; as that of a segment, for its
   first sample; its name; its declaration with room for a sample, or for some lanes; in a kernel, for all threads; where a
   thread's sample has it. */
enum form { PARAMETER, RESTRICT, FIRST, NAME, LOCAL, LANES, SHARED, AT_THREAD };

static void put_form(const struct across *x, enum form form, int lanes, struct text *out)
{
	int slots = x->slots ? x->slots : 1;

	switch (form) {
	case PARAMETER:
		text_printf(out, "%s *const %s", x->type, x->name);
		break;
	case RESTRICT:
		text_printf(out, "%s *restrict %s", x->type, x->name);
		break;
	case FIRST:
		text_printf(out, "%s *const first_%s", x->type, x->name);
		break;
	case NAME:
		text_put(out, x->name);
		break;
	case LOCAL:
	case LANES:
		text_printf(out, "\t%s %s[%d];", x->type, x->name, slots * lanes);
		break;
	case SHARED:
		text_printf(out, "\t__shared__ %s %s[%d*RNEA_SAMPLES*RNEA_BLOCK];", x->type, x->name, slots);
		break;
	case AT_THREAD:
		text_printf(out, "%s + here + j*RNEA_BLOCK", x->name);
	}
}

/* The type of a pass's other numbers. */
static const char *wide_value(const struct emission *e)
{
	return emit_wide(e) ? emit_wide(e)->value : "";
}

/* Of both arrays, or of the one that there is. */
static const char *across(const struct emission *e, const struct segments *s, enum form form)
{
	const struct across narrow = {e->numbers->value, "across", s->slots[0]};
	const struct across wide = {wide_value(e), "wide_across", s->slots[1]};
	int lanes = form == LANES ? emit_lanes(e, s) : 1, is_line = form == LOCAL || form == LANES || form == SHARED;
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

struct touched emit_touched(const struct plan *p)
{
	struct touched t = {.step = 0};

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++)
		if (l->kind == LINE_FETCH || l->kind == LINE_KEEP) {
			t.across[p->dag->nodes[l->value.i].is_wide] = 1;
			t.step |= l->index > 0;
		}
	t.stride = emit_mark_arguments(p, t.arguments);
	return t;
}

/* Parameters that it does not touch. */
static void put_unused(const struct emission *e, const struct pass *p, const struct plan *lines, const struct touched *t,
	struct text *out)
{
	emit_unused(e, lines, "first_", out);
	text_put(out, t->across[0] ? "" : "\t(void)first_across;\n");
	text_put(out, p->segments.slots[1] && !t->across[1] ? "\t(void)first_wide_across;\n" : "");
	text_put(out, t->step ? "" : "\t(void)step;\n");
}

/* This lane's place in the arrays. */
static void put_lane(const struct emission *e, const struct pass *p, const struct touched *t, struct text *out)
{
	for (int i = 0; i < p->dag.argument_count; i++) {
		const struct argument *a = &p->dag.arguments[i];

		if (!t->arguments[i] || a->per_batch)
			continue;
		text_printf(out, "\t%s%s *const %s = first_%s + l", a->is_output ? "" : "const ", e->memory->type,
			a->name, a->name);
		if (e->options->layout == RNEAGEN_AOS)
			text_printf(out, "*%d", a->rows);
		text_put(out, ";\n");
	}
	if (t->across[0])
		text_printf(out, "\t%s *const across = first_across + l;\n", e->numbers->value);
	if (t->across[1])
		text_printf(out, "\t%s *const wide_across = first_wide_across + l;\n", wide_value(e));
}

/* Statements are made in `spare` before they are indented. */
static void put_segment(const struct emission *e, const struct pass *p, int k, struct writer *w, struct text *spare,
	struct text *out)
{
	const struct segments *s = &p->segments;
	struct touched touched = emit_touched(&s->plans[k]);
	struct text begin;

	text_init(&begin, e->arena);
	put_unused(e, p, &s->plans[k], &touched, &begin);
	text_put(&begin, emit_has_known(e) ? "\tint all_small = 1;\n" : "");
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
		{"COUNT", emit_int(e, s->count)}, {"FIRST_PARAMS", emit_params(e, p, PARAMS_FIRST)},
		{"ACROSS_PARAMS", across(e, s, FIRST)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"RESULT", emit_has_known(e) ? "int" : "void"}, {"BEGIN", text_string(&begin)},
		{"END", emit_has_known(e) ? "\treturn all_small;\n" : ""},
	};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *rest = template_expand_to(out, template_segment_in, "BODY", slots, count);

	text_clear(spare);
	put_lane(e, p, &touched, spare);
	unparse_within(w, &s->plans[k]);
	unparse_lines(w, &s->plans[k], spare);
	text_put_indented(out, text_string(spare));
	out->failed |= spare->failed;
	fold(out, from);
	template_expand(out, rest, slots, count);
}

static void put_segments(const struct emission *e, const struct pass *p, struct text *out)
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

/* What a batch runs. */
static const struct pass *many_of(const struct pass *p)
{
	return p->many ? p->many : p;
}

void emit_segments(const struct emission *e, const struct pass *p, struct text *out)
{
	put_segments(e, many_of(p), out);
	if (p->beside) {
		text_put(out, "#if defined RNEA_LANES\n");
		put_segments(e, p->beside, out);
		text_put(out, p->single ? "#else\n" : "");
	}
	if (p->single)
		put_segments(e, p->single, out);
	text_put(out, p->beside ? "#endif\n" : "");
}

/* ---- batches ---- */

/* What a call of one sample runs. */
static const struct pass *single_of(const struct pass *p)
{
	return p->single ? p->single : p;
}

static void put_lanes_function(const struct emission *e, const struct pass *p, int k, struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
		{"LANES", emit_int(e, emit_lanes(e, s))}, {"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)},
		{"COUNT_PARAM", e->options->layout == RNEAGEN_SOA ? "size_t count, " : ""},
		{"RESTRICT_ACROSS", across(e, s, RESTRICT)}, {"AT_SAMPLE", emit_at_sample(e, p)},
		{"ACROSS_NAMES", across(e, s, NAME)}, {"UNKNOWN", emit_handed_on(e, emit_unknown_names(e))}};

	template_expand(out, template_segment_lanes_in, slots, sizeof slots / sizeof *slots);
}

static void put_one_function(const struct emission *e, const struct pass *p, int k, struct text *out)
{
	const struct segments *s = &p->segments;
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"KNOWN", emit_handed_on(e, emit_known_names(e))}, {"KNOWN_PARAM", emit_known_params(e)},
		{"ACROSS_PARAMS", across(e, s, PARAMETER)}, {"ACROSS_NAMES", across(e, s, NAME)}};

	template_expand(out, template_segment_one_in, slots, sizeof slots / sizeof *slots);
}

static void put_one_functions(const struct emission *e, const struct pass *p, struct text *out)
{
	for (int k = 0; k < p->segments.count; k++)
		if (!emit_is_loop(p, k))
			put_one_function(e, p, k, out);
}

static const char *functions_text(const struct emission *e, const struct pass *p)
{
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < many_of(p)->segments.count; k++)
		if (!emit_is_loop(many_of(p), k))
			put_lanes_function(e, many_of(p), k, &t);
	emit_zeros_many(e, many_of(p), &t);
	text_put(&t, p->beside ? "#if defined RNEA_LANES\n" : "");
	if (p->beside)
		put_one_functions(e, p->beside, &t);
	text_put(&t, p->beside ? "#else\n" : "");
	put_one_functions(e, single_of(p), &t);
	text_put(&t, p->beside ? "#endif\n" : "");
	return text_string(&t);
}

static void put_call(const struct emission *e, const struct pass *p, int k, const char *indent, const char *what,
	const char *where, const char *more, struct text *out)
{
	text_printf(out, "%s%s_%s_%s%d(%s, %s, %s%s);\n", indent, e->options->name, p->algorithm->name, what, k,
		emit_params(e, p, PARAMS_NAMES), where, across(e, &p->segments, NAME), more);
}

static const char *lanes_calls(const struct emission *e, const struct pass *p)
{
	struct text t;

	text_init(&t, e->arena);
	emit_zeros_many_calls(e, p, &t);
	for (int k = 0; k < p->segments.count; k++)
		if (emit_is_loop(p, k))
			emit_columns_many_calls(e, p, k, &t);
		else
			put_call(e, p, k, "\t\t\t", "lanes", e->options->layout == RNEAGEN_SOA ? "count, first" : "first", "", &t);
	return text_string(&t);
}

static const char *one_calls(const struct emission *e, const struct pass *p)
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

/* One sample's body, as it is, or in lanes where there are such. */
static const char *one_body(const struct emission *e, const struct pass *p)
{
	const struct pass *ways[] = {p->beside, single_of(p)};
	struct text t;

	text_init(&t, e->arena);
	for (int i = !p->beside; i < 2; i++) {
		text_put(&t, !p->beside ? "" : i ? "#else\n" : "#if defined RNEA_LANES\n");
		text_printf(&t, "%s\n%s\n%s", across(e, &ways[i]->segments, LOCAL), emit_columns_declaration(e, ways[i]), one_calls(e, ways[i]));
	}
	text_put(&t, p->beside ? "#endif\n" : "");
	return text_string(&t);
}

static const char *and_small(const struct emission *e, const char *are_small)
{
	struct text t;

	text_init(&t, e->arena);
	if (emit_has_known(e))
		text_printf(&t, " && %s", are_small);
	return text_string(&t);
}

void emit_segments_part(const struct emission *e, const struct pass *p, const char *are_small, const char *call_any,
	struct text *out)
{
	int is_soa = e->options->layout == RNEAGEN_SOA;
	const char *count_param = is_soa ? "size_t count, " : "";
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)}, {"KNOWN", emit_handed_on(e, emit_known_names(e))},
		{"KNOWN_PARAM", emit_known_params(e)}, {"WHATEVER", emit_has_known(e) ? ", whatever its angles" : ""},
		{"WHERE_SMALL", emit_has_known(e) ? " where their angles are small, which is the rule" : ""},
		{"AND_SMALL", and_small(e, are_small)}, {"CALL_ANY", call_any}, {"COUNT_PARAM", count_param},
		{"AT_SAMPLE", emit_at_sample(e, p)}, {"LANES", emit_int(e, emit_lanes(e, &many_of(p)->segments))},
		{"FUNCTIONS", functions_text(e, p)}, {"CALLS", lanes_calls(e, many_of(p))}, {"ONE_BODY", one_body(e, p)},
		{"DECLARATIONS", across(e, &many_of(p)->segments, LANES)}};

	template_expand(out, template_part_segments_in, slots, sizeof slots / sizeof *slots);
}

/* ---- kernels ---- */

/* Samples of a thread (H100, 1 M samples, ps): g1_brainco in f32, 1, 2 and 4 take 1338, 742 and 643; in f64, 1 and 2 take 3254
   and 2487; romeo in f64, 2 and 4 take 526 and 546. */
enum { MOST_SINGLE = 4, MOST_DOUBLE = 2, LARGEST_BLOCK = 64 };

int emit_segments_bytes(const struct emission *e, const struct pass *p)
{
	int bytes = across_bytes(e, &p->segments);

	return bytes ? bytes : e->arithmetic->bytes;
}

int emit_segments_samples(const struct emission *e)
{
	return e->arithmetic->bytes == 4 ? MOST_SINGLE : MOST_DOUBLE;
}

int emit_segments_block(const struct emission *e, const struct pass *p)
{
	return LARGEST_BLOCK * 2 * emit_segments_bytes(e, p) > SHARED_BYTES ? WARP_THREADS : LARGEST_BLOCK;
}

static const char *loops_in_kernel(const struct emission *e, const struct pass *p)
{
	int has_angles = emit_has_known(e) && emit_has_angles(e, p);
	const char *at_sample = emit_at_sample(e, p);
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < p->segments.count; k++) {
		const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
			{"FROM", has_angles ? "from" : "0"}, {"TO", has_angles ? "to" : "each"},
			{"LARGE", has_angles ? "large |= (unsigned)!" : ""}, {"SHIFT", has_angles ? " << j" : ""},
			{"AT_SAMPLE", at_sample}, {"ACROSS", across(e, &p->segments, AT_THREAD)},
			{"KNOWN", emit_handed_on(e, has_angles ? emit_known_tables(e, p) : emit_unknown_names(e))}};

		template_expand(&t, template_kernel_segment_in, slots, sizeof slots / sizeof *slots);
	}
	return text_string(&t);
}

static const char *rounds_in_kernel(const struct emission *e, const struct pass *p)
{
	const char *loops = loops_in_kernel(e, p);
	struct text t;

	if (!emit_has_known(e) || !emit_has_angles(e, p))
		return loops;
	text_init(&t, e->arena);
	emit_rounds(e, p, loops, &t);
	return text_string(&t);
}

void emit_segments_kernel(const struct emission *e, const struct pass *p, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", p->algorithm->name},
		{"BOUNDS", p == emit_main(e) ? "RNEA_BLOCK, RNEA_MIN_BLOCKS" : "RNEA_BLOCK"},
		{"MOST", emit_int(e, emit_segments_samples(e))}, {"BYTES", emit_int(e, emit_segments_bytes(e, p))},
		{"SHARED_BYTES", emit_int(e, SHARED_BYTES)}, {"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)},
		{"SHARED", across(e, &p->segments, SHARED)}, {"LOCAL", across(e, &p->segments, LOCAL)},
		{"ROUNDS", rounds_in_kernel(e, p)}};

	template_expand(out, template_kernel_segments_in, slots, sizeof slots / sizeof *slots);
}
