/* The C functions around the bodies: of texts for target c, and of texts for CUDA where they are compiled as C. */
#include "emit/emit_groups.h"
#include "base/template.h"

static int is_soa(const struct emission *e)
{
	return e->options->layout == RNEAGEN_SOA;
}

static const char *joined(const struct emission *e, const char *a, const char *b)
{
	return text_format(e->arena, "%s, %s", a, b);
}

const char *emit_head_c(const struct emission *e)
{
	const struct slot slots[] = {{"IEEE", emit_ieee(e)}, {"ARITHMETIC_C", emit_arithmetic(e, &TARGET_C)}};

	return template_text(e->arena, template_head_c_in, slots, sizeof slots / sizeof *slots);
}

int emit_has_batches(const struct emission *e)
{
	return e->target->kernel || (e->target->has_batches && !e->options->only);
}

const char *emit_any_name(const struct emission *e, const struct function *p)
{
	return emit_has_known(e) || p->segments.count ? "any" : "body";
}

const char *emit_any(const struct emission *e, const struct function *p)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"INLINE", e->target->has_batches ? "" : "inline "},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"CALL_ANY", emit_call_any(e, p)}};

	return template_text(e->arena, template_any_in, slots, sizeof slots / sizeof *slots);
}

void emit_put_any(const struct emission *e, const struct function *p, struct text *out)
{
	text_printf(out, "/* One sample%s. */\n%s\n", emit_has_known(e) ? ", whatever its angles" : "", emit_any(e, p));
}

/* What the function of one sample does: the body itself where nothing else calls it. */
const char *emit_one_call(const struct emission *e, const struct function *p)
{
	const char *names = emit_params(e, p, PARAMS_NAMES), *what = emit_any_name(e, p);
	const struct call body = {.indent = "\t", .arguments = names, .q = "q", .stride = "1", .is_any = e->target->has_batches};
	const struct function *lanes = emit_lanes_alone(p);
	struct text t;

	text_init(&t, e->arena);
	if (lanes)
		text_printf(&t, EMIT_IF_LANES "\t%s_%s_any(%s, 1);\n#else\n", e->options->name, lanes->algorithm->name, names);
	if (p->segments.count || emit_has_batches(e))
		text_printf(&t, "\t%s_%s_%s(%s, 1);\n", e->options->name, p->algorithm->name, what, names);
	else
		text_put(&t, emit_call(e, p, &body));
	text_put(&t, lanes ? "#endif\n" : "");
	return text_string(&t);
}

/* One function for a sample and, where there are batches, one for a part of a batch. */
static void put_functions(const struct emission *e, const struct function *p, struct text *out)
{
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"APART", e->options->strict ? "RNEA_APART " : ""},
		{"CALL", emit_one_call(e, p)}, {"COUNT", is_soa(e) ? "count, " : ""}, {"UNUSED", is_soa(e) ? "" : "\t(void)count;"},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"SIZED_PARAMS", emit_params(e, p, PARAMS_SIZED)},
		{"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"ARRAYS", emit_params(e, p, PARAMS_ARRAYS)},
	};
	size_t count = sizeof slots / sizeof *slots;

	if (p->segments.count)
		emit_segments_one(e, p, out);
	else if (emit_has_batches(e) && emit_has_known(e))
		emit_put_any(e, p, out);
	if (emit_has_batches(e))
		emit_groups(e, p, out);
	emit_lanes_call(e, p, out);
	template_expand(out, template_function_one_in, slots, count);
	if (!emit_has_batches(e))
		return;
	template_expand(out, template_slice_in, slots, count);
	if (p == emit_main(e))
		template_expand(out, template_batch_in, slots, count);
}

const char *emit_functions_c(const struct emission *e)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type},
		{"COUNT_PARAM", emit_count_param(e->options->layout)},
		{"Q_AT_SAMPLE", joined(e, emit_q_at_sample(e), emit_stride(e))}, {"UNREAD", emit_unread_tables(e)}};
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, emit_has_batches(e) && !emit_has_segments(e) ? template_independent_in : "");
	if (emit_has_known(e) && emit_has_batches(e))
		template_expand(&t, template_are_small_in, slots, sizeof slots / sizeof *slots);
	if (emit_has_batches(e))
		emit_groups_moves(e, &t);
	for (int i = 0; i < e->function_count; i++) {
		text_put(&t, i ? "\n" : "");
		put_functions(e, &e->functions[i], &t);
	}
	return text_string(&t);
}

static void put_prototype(
	const struct emission *e, const struct function *p, const char *suffix, const char *more, const char *doc, struct text *out)
{
	text_printf(out, "/* %s */\nvoid %s_%s%s(%s%s);\n", doc, e->options->name, p->algorithm->name, suffix,
		emit_params(e, p, *suffix ? PARAMS_PLAIN : PARAMS_SIZED), more);
}

static void put_slice_prototypes(const struct emission *e, struct text *out)
{
	text_put(out,
		"/* Samples first to end - 1 of such a batch of `count`: calls for different samples may run at the same time, each\n"
		"   in a thread of the caller's own. The arrays are those of ");
	for (int i = 0; i < e->function_count; i++)
		text_printf(out, "%s%s", i == 0 ? "" : i + 1 < e->function_count ? ", " : " and ", e->functions[i].algorithm->name);
	text_put(out, ", in that order. */\n");
	for (int i = 0; i < e->function_count; i++)
		text_printf(out, "void %s_%s_slice(void *const *arrays, size_t count, size_t first, size_t end);\n",
			e->options->name, e->functions[i].algorithm->name);
}

/* What exact means, what a bound covers, and where there is none. */
#define BOUNDED_DOC                                                                                                    \
	"   Exact is what the command above makes of the URDF's decimals, and of its own, in exact arithmetic at these very\n"     \
	"   inputs, where an angle within 5e-15 rad of a multiple of pi/2 is that, and constants that are zero, or equal, but for\n" \
	"   the rounding of the file's numbers, or of extended precision (1e-19 of their terms), are so. Rounding of the file's\n" \
	"   numbers, of constants and operations, sine and cosine, underflow, and the bound's own rounding are in it (Higham,\n" \
	"   Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, section 3.3; Linnainmaa, BIT 16, 1976). Infinite\n" \
	"   where a value may overflow or an angle is beyond the domain of the trigonometry; NaN where the torque depends on an\n" \
	"   input that is not finite. bound must not overlap the others."

static void put_bounded_prototype(const struct emission *e, struct text *out)
{
	int torques = e->request->stored_count == 1 && want_is(e->request->wants[0].kind, IS_TORQUES);

	put_prototype(e, emit_main(e), "_bounded", text_format(e->arena, ", %s *bound", e->memory->type), torques ?
		"The same torques, to the bit, and for each a bound[i] of |tau[i] - exact|.\n" BOUNDED_DOC :
		"The same outputs, to the bit, and for each number x of them, one output after the other, a bound[i] of |x - exact|.\n"
		BOUNDED_DOC, out);
}

/* For a text that is one operation alone. */
static const char *operation_prototypes(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	put_prototype(e, emit_main(e), "", "", emit_main(e)->algorithm->doc, &t);
	put_prototype(e, emit_main(e), "_batch", ", size_t count", "The same for `count` samples; arrays must not overlap.", &t);
	text_printf(&t, "void %s_%s_slice(void *const *arrays, size_t count, size_t first, size_t end);\n", e->options->name,
		emit_main(e)->algorithm->name);
	text_printf(&t, "extern const char %s_info[];", e->options->name);
	return text_string(&t);
}

const char *emit_prototypes(const struct emission *e)
{
	struct text t, one, many;

	if (emit_is_operation(e))
		return operation_prototypes(e);
	text_init(&t, e->arena);
	text_init(&one, e->arena);
	text_init(&many, e->arena);
	text_printf(&one, "%s of one sample: %s", emit_what(e), emit_dimensions(e));
	text_printf(&many, "The same for `count` samples, every array %s; arrays must not overlap.",
		is_soa(e) ? "[row][sample]" : "[sample][row]");
	put_prototype(e, emit_main(e), "", "", text_string(&one), &t);
	if (e->options->bounded)
		put_bounded_prototype(e, &t);
	if (emit_has_batches(e))
		put_prototype(e, emit_main(e), "_batch", ", size_t count", text_string(&many), &t);
	for (const struct function *p = emit_main(e) + 1; p < e->functions + e->function_count; p++)
		put_prototype(e, p, "", "", p->algorithm->brief, &t);
	if (emit_has_batches(e))
		put_slice_prototypes(e, &t);
	emit_pattern_declarations(e, &t);
	text_printf(&t, "/* What this text computes, one `key values` a line. */\nextern const char %s_info[];",
		e->options->name);
	return text_string(&t);
}
