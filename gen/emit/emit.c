#include "base/fold.h"
#include "base/template.h"
#include "emit/columns/emit_columns.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_parts.h"
#include "emit/kernels/emit_relay.h"
#include "emit/kernels/emit_tiles.h"
#include "emit/kernels/emit_transpose.h"
#include "emit/unparse.h"
#include "plan/grid/parts.h"
#include "plan/transposed.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *emit_int(const struct emission *e, int value)
{
	return text_format(e->arena, "%d", value);
}

int emit_function_uses(const struct function *p, enum op op)
{
	for (size_t i = 0; i < p->dag.count; i++)
		if (p->dag.nodes[i].op == op)
			return 1;
	return 0;
}

int emit_uses(const struct emission *e, enum op op)
{
	for (int i = 0; i < e->function_count; i++)
		if (emit_function_uses(&e->functions[i], op))
			return 1;
	return 0;
}

int emit_uses_in(const struct emission *e, enum op op, int is_wide)
{
	for (int i = 0; i < e->function_count; i++)
		for (size_t k = 0; k < e->functions[i].dag.count; k++)
			if (e->functions[i].dag.nodes[k].op == op && (int)e->functions[i].dag.nodes[k].is_wide == is_wide)
				return 1;
	return 0;
}

/* A loop holds a limb's lines once. */
static const struct function *lines_of(const struct function *p)
{
	return p->each ? p->each : p;
}

static void put_statements(const struct emission *e, const struct function *p, struct numbers *table, struct text *out)
{
	emit_unused(e, &p->plan, "", out);
	text_put(out, emit_has_known(e) ? "\tint all_small = 1;\n" : "");
	unparse(e, lines_of(p), e->numbers, table, out);
	text_put(out, emit_has_known(e) ? "\treturn all_small;\n" : "");
}

static void put_body(const struct emission *e, const struct function *p, struct text *out)
{
	const struct slot slots[] = {
		{"DOC", p->algorithm->doc}, {"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"MORE_PARAMS", emit_more_params(e, p)}, {"KNOWN_PARAM", emit_known_params(e)},
		{"RESULT", emit_has_known(e) ? "int" : "void"},
		{"RETURNS", emit_has_known(e) ? EMIT_RETURNS : ""},
	};
	struct numbers *table = emit_new_numbers(e);
	size_t count = sizeof slots / sizeof *slots, from;
	struct text statements;
	const char *rest;

	text_init(&statements, e->arena);
	put_statements(e, p, table, &statements);
	if (p->each)
		emit_each_numbers(e, p->each, out);
	if (table)
		emit_numbers(e, p, table, out);
	from = out->length;
	rest = template_expand_to(out, template_body_in, "BODY", slots, count);
	fold(out, from);
	text_put(out, text_string(&statements));
	out->failed |= statements.failed;
	template_expand(out, rest, slots, count);
}

/* The blocks of a launch. */
static const char *grid_text(const struct emission *e)
{
	return text_format(e->arena, "(unsigned)blocks%s", emit_along(e, e->part_count - emit_hands(e)));
}

static const char *enum_text(const struct emission *e)
{
	return text_format(e->arena, "enum { %s_nq = %d, %s_nv = %d, %s_nb = %d };", e->options->name, e->tree->nq, e->options->name,
		e->tree->nv, e->options->name, e->tree->body_count);
}

/* What a scene can choose without a word in the text's name: nothing but what is wanted. */
static int is_bare(const struct request *k)
{
	return k->is_plain || (k->is_forward && k->stored_count == 1 && !k->freed_count && !k->push_count);
}

const char *emit_what(const struct emission *e)
{
	const struct function *p = emit_main(e);
	int i = 0;

	for (const struct algorithm_array *a = p->algorithm->arrays; a->name; a++, i++)
		if (i >= p->dag.argument_count || strcmp(a->name, p->dag.arguments[i].name) || !is_bare(e->request))
			return p->algorithm->what;
	return i == p->dag.argument_count ? p->algorithm->doc : p->algorithm->what;
}

const char *emit_dimensions(const struct emission *e)
{
	const struct dag *d = &emit_main(e)->dag;
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		const char *before = i == 0 ? "" : a->is_output && !a[-1].is_output ? " -> " : ", ";

		text_printf(&t, "%s%s[%d]", before, a->name, a->rows);
	}
	text_put(&t, e->request->is_plain ? e->target->aliases : ".");
	return text_string(&t);
}

/* Header: the functions beside the first. */
static const char *further_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	for (const struct function *p = emit_main(e) + 1; p < e->functions + e->function_count; p++) {
		const struct call c = {.indent = "\t", .arguments = emit_params(e, p, PARAMS_NAMES), .q = "q", .stride = "1"};
		const struct slot slots[] = {{"BRIEF", p->algorithm->brief}, {"NAME", e->options->name},
			{"FUNCTION", p->algorithm->name}, {"OUTER", e->options->strict ? "RNEA_APART" : "RNEA_INLINE"},
			{"CALL", emit_call(e, p, &c)}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)},
			{"NAMES", emit_params(e, p, PARAMS_NAMES)}};

		template_expand(&t, template_further_h_in, slots, sizeof slots / sizeof *slots);
	}
	return text_string(&t);
}

/* The arithmetic of the precision where it is not the compiler's. */
static const char *numbers_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	if (e->numbers->put_functions)
		e->numbers->put_functions(e, &t);
	if (e->wide && e->wide->put_functions)
		e->wide->put_functions(e, &t);
	return text_string(&t);
}

/* Of its head, which says what the text is of: two texts of one name are told apart by it. */
static const char *digest_text(const struct emission *e)
{
	return emit_int(e, text_digest(emit_banner(e)));
}

static const char *info_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	emit_info(e, &t);
	return text_string(&t);
}

/* A compiler that is asked for ISO C warns of a string that is longer than that promises: 4095 characters. */
static const char *long_text(const char *info)
{
	enum { PROMISED = 4095 };

	return strlen(info) <= PROMISED ? "" :
		"#if defined __GNUC__\n#pragma GCC diagnostic ignored \"-Woverlength-strings\"\n#endif\n";
}

int emit_has_segments(const struct emission *e)
{
	if (e->relay || emit_main(e)->beside)
		return 1;
	for (int i = 0; i < e->function_count; i++)
		if (e->functions[i].segments.count)
			return 1;
	return 0;
}

static void put_function_of(const struct emission *e, const struct function *p, struct text *out)
{
	text_put(out, emit_lanes_instead(e, p) ? EMIT_UNLESS_LANES : "");
	if (p->segments.count)
		emit_segments(e, p, out);
	else
		put_body(e, p, out);
	text_put(out, emit_lanes_instead(e, p) ? "#endif\n" : "");
	emit_lanes_call_bodies(e, p, out);
}

/* Without AVX four doubles are two vectors. Zen 5, one call over that without lanes, by operations in lanes: torques on the
   ground, hyq, 168, 1.12, go1, 157, 1.20; qdd, 225 and 201, 1.05 and 1.07; torques of a floating go1, 370, 0.88; gradients of
   hyq, 520, 0.47.
   Models of processors of ARM take 0.6 to 0.9, but older ones 1.3 where four doubles are not joined to sums, as by gcc with
   -std=c11 (tests/bench/lanes/arm). */
enum { LEAST_WITHOUT_AVX = 300 };

static const char *lanes_need(const struct emission *e)
{
	const struct function *p = emit_main(e)->beside;
	int is_short = plan_instructions(plan_operations(&p->plan)) < LEAST_WITHOUT_AVX;

	return p->dag.width == 4 && e->arithmetic->bytes == 8 && is_short ? "__AVX__" : "__SSE2__";
}

/* Vectors of 16 bytes at least: two floats fill one twice. A header's are C++ too. */
static void put_lanes(const struct emission *e, struct text *out)
{
	int is_f32 = e->arithmetic->bytes == 4, is_two = emit_main(e)->beside->dag.width == 2, are_16_bytes = is_f32 || is_two;
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->arithmetic->type}, {"WIDTH", is_two ? "two" : "four"},
		{"ROOM", is_two && !is_f32 ? "2" : "4"}, {"EACH", is_two ? "a, b" : "a, b, c, d"},
		{"FILLED", !is_two ? "a, b, c, d" : is_f32 ? "a, b, a, b" : "a, b"}, {"SAME", is_two ? "a, a" : "a, a, a, a"},
		{"NEEDS", lanes_need(e)},
		{"ARM", are_16_bytes ? "defined __aarch64__" : "defined __aarch64__ && !defined __STRICT_ANSI__"},
		{"SUFFIX", is_f32 ? "ps" : is_two ? "pd" : "pd256"}};

	template_expand(out, template_lanes_in, slots, sizeof slots / sizeof *slots);
	if (are_16_bytes)
		template_expand(out, template_lanes_neon_in, (struct slot[]){{"SUFFIX", is_f32 ? "f32" : "f64"}}, 1);
	if (e->target->is_header)
		template_expand(out, template_header_lanes_in, slots, sizeof slots / sizeof *slots);
}

static void put_bodies(const struct emission *e, struct text *out)
{
	int is_whole = emit_alone_is_whole(e);

	text_put(out, emit_has_limbs(e) ? EMIT_UNLESS_LIMBS : "");
	text_put(out, emit_has_segments(e) && !e->target->is_header ? template_independent_in : "");
	if (e->lanes)
		put_lanes(e, out);
	if (emit_main(e)->single)
		emit_columns_macros(e, out);
	for (int i = 0; i < e->part_count; i++)
		put_body(e, &e->parts[i].function, out);
	if (is_whole)
		put_function_of(e, emit_main(e), out);
	text_put(out, e->kernels.alone_least ? EMIT_UNLESS_ALONE : "");
	for (int i = 0; e->relay && i < e->relay->start_count; i++)
		put_body(e, &e->relay->starts[i].function, out);
	if (e->relay && !e->relay->start_count)
		put_function_of(e, &e->relay->start.function, out);
	if (e->relay)
		put_function_of(e, &e->relay->solve.function, out);
	for (int i = 0; i < e->function_count; i++)
		if (i == 0 && e->part_count)
			emit_dispatcher(e, out);
		else if (i || !is_whole)
			put_function_of(e, &e->functions[i], out);
	text_put(out, e->kernels.alone_least ? "#endif\n" : "");
	text_put(out, emit_has_limbs(e) ? "#endif\n" : "");
}

static const char *lanes_call(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	emit_lanes_call(e, emit_main(e), &t);
	return text_string(&t);
}

/* ---- what the frames of targets have places for ---- */

enum { MOST_SLOTS = 40 };

struct slots {
	struct slot of[MOST_SLOTS];
	size_t count;
};

static void add_slots(struct slots *s, const struct slot *more, size_t count)
{
	memcpy(s->of + s->count, more, count * sizeof *more);
	s->count += count;
}

static void common_slots(const struct emission *e, struct slots *s)
{
	const struct slot more[] = {{"BANNER", emit_banner(e)}, {"NAME", e->options->name}, {"NUMBERS", numbers_text(e)},
		{"SINCOS_DECLARATION", emit_sincos_declaration(e)}, {"SINCOS", emit_sincos(e)},
		{"IS_SMALL", emit_unless_limbs(e, emit_is_small(e))}};

	add_slots(s, more, sizeof more / sizeof *more);
}

/* Of those that hold C functions, with a table that librnea reads. */
static void function_slots(const struct emission *e, struct slots *s)
{
	const char *info = info_text(e);
	const struct slot more[] = {{"INFO", info}, {"LONG_INFO", long_text(info)}, {"PATTERNS", emit_patterns(e)},
		{"AS_C", emit_has_batches(e) ? template_as_c_in : ""}, {"HEAD_C", emit_head_c(e)}, {"FUNCTIONS_C", emit_functions_c(e)},
		{"PROTOTYPES", emit_prototypes(e)}, {"BOUNDED", ""}};

	add_slots(s, more, sizeof more / sizeof *more);
}

static void kernel_slots(const struct emission *e, const char *kernels, struct slots *s)
{
	const struct function *p = emit_main(e);
	const struct slot more[] = {
		{"ARITHMETIC", emit_arithmetic(e, e->target)}, {"FUNCTION", p->algorithm->name}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)},
		{"ADDRESSES", emit_params(e, p, PARAMS_ADDRESSES)}, {"BLOCK", emit_int(e, e->kernels.block)}, {"GRID", grid_text(e)},
		{"BLOCK_IS", emit_each_block(e) ? "samples of one slice of the batch; a block has RNEA_SAMPLE_THREADS threads for each" :
			"threads in a block: the samples of one slice of the batch"}, {"THREADS", emit_each_threads(e)},
		{"EACH", p->segments.count ? template_launch_segments_in : ""}, {"SAMPLES", p->segments.count ? "samples" : "RNEA_BLOCK"},
		{"MIN_BLOCKS", emit_min_blocks(e)}, {"STAGE", emit_unless_limbs(e, emit_stage(e))}, {"SINES_BYTES", emit_sines_bytes(e)},
		{"STORE", emit_store(e)}, {"KERNELS", kernels}, {"LAUNCH_HEAD", emit_launch_head(e)}, {"LAUNCH_HANDS", emit_launch_hands(e)},
		{"LAUNCH_RELAY", emit_launch_relay(e)}, {"LAUNCH_TRANSPOSE", emit_launch_transpose(e)},
		{"LAUNCH_ALONE", emit_launch_alone(e)}, {"TILES_LAUNCH", emit_tiles_launch(e)},
		{"STAGE_LAUNCH", emit_stage_launch(e)}, {"GIVEN", emit_given(e, "kernel")}, {"LAUNCH_LIMBS", emit_launch_limbs(e)}};

	add_slots(s, more, sizeof more / sizeof *more);
}

static void header_slots(const struct emission *e, struct slots *s)
{
	const struct function *p = emit_main(e);
	const struct slot more[] = {{"DIGEST", digest_text(e)}, {"IEEE", emit_ieee(e)},
		{"ARITHMETIC", emit_arithmetic(e, e->target)}, {"FUNCTION", p->algorithm->name}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)},
		{"OUTER", e->options->strict ? "RNEA_APART" : "RNEA_INLINE"}, {"JOINTS", emit_joints(e)}, {"ENUM", enum_text(e)},
		{"DIMENSIONS", emit_dimensions(e)}, {"SAMPLE", emit_what(e)}, {"RNEA_CALL", emit_one_call(e, p)}, {"LANES_CALL", lanes_call(e)},
		{"FURTHER", further_text(e)}, {"KNOWN_MACROS", emit_has_known(e) ? template_header_known_in : ""},
		{"UNDEF_KNOWN", emit_has_known(e) ? "#undef RNEA_KNOWN\n" : ""}, {"UNDEF_STRICT", emit_undef_strict(e)},
		{"UNDEF_WIDE", emit_undef_wide(e)}, {"UNDEF_LANES", e->lanes ? template_header_lanes_end_in : ""}};

	add_slots(s, more, sizeof more / sizeof *more);
}

void emit_source(const struct emission *e, struct text *out)
{
	struct slots s = {.count = 0};
	const struct rneagen_options options = transposed_options(e->options, e->is_transposed);
	struct emission k = *e;
	struct text kernels;
	const char *rest;
	size_t from = out->length;

	k.options = &options;
	text_init(&kernels, e->arena);
	emit_kernels(&k, &kernels);
	common_slots(e, &s);
	(e->target->is_header ? header_slots : function_slots)(e, &s);
	if (e->target->kernel)
		kernel_slots(&k, text_string(&kernels), &s);
	rest = template_expand_to(out, e->target->frame, "BODIES", s.of, s.count);
	fold(out, from);
	put_bodies(e, out);
	from = out->length;
	if (e->options->bounded) {
		rest = template_expand_to(out, rest, "BOUNDED", s.of, s.count);
		fold(out, from);
		emit_bounded(e, out);
		from = out->length;
	}
	template_expand(out, rest, s.of, s.count);
	fold(out, from);
	fold_blank(out);
	out->failed |= kernels.failed | e->arena->failed;
}

void emit_declarations(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {
		{"BANNER", emit_banner(e)}, {"NAME", e->options->name}, {"ENUM", enum_text(e)},
		{"DIGEST", digest_text(e)}, {"PROTOTYPES", emit_prototypes(e)}, {"JOINTS", emit_joints(e)}};
	size_t from = out->length;

	template_expand(out, e->target->declarations, slots, sizeof slots / sizeof *slots);
	fold(out, from);
	fold_blank(out);
	out->failed |= e->arena->failed;
}
