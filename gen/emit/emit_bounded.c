/* NAME_rnea_bounded, NAME_fd_bounded: torques, or what else is wanted, and, by a running error analysis beside them, how far each
   may be from what the URDF's decimals give. */
#include "emit/unparse.h"
#include "base/fold.h"
#include "base/template.h"
#include <math.h>

int unparse_first_bound(const struct dag *d, int argument)
{
	int first = 0;

	for (int i = 0; i < argument; i++)
		first += d->arguments[i].is_output ? d->arguments[i].rows : 0;
	return first;
}

/* Roundings of a bound from an operation's operands to its result, three times u for the factor 1 + 3u included. */
static const int roundings[OP_COUNT] = {
	[OP_ADD] = 7, [OP_SUB] = 7, [OP_MUL] = 10, [OP_FMA] = 14, [OP_DIV] = 18, [OP_SQRT] = 12,
	[OP_SIN] = 12, [OP_COS] = 12};

/* The most roundings of a bound on any way from an input to an output; -1 when memory runs out. */
static int longest_way(const struct emission *e, const struct dag *d)
{
	int *way = arena_alloc(e->arena, d->count, sizeof *way), longest = 0;

	for (size_t i = 0; way && i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		int most = 0;

		for (int k = 0; k < op_arity[n->op]; k++)
			most = way[n->arg[k].i] > most ? way[n->arg[k].i] : most;
		way[i] = most + roundings[n->op];
		longest = way[i] > longest ? way[i] : longest;
	}
	arena_release(e->arena, way);
	return way ? longest + 8 : -1; /* and those of the end */
}

/* bounded_quotient.in counts on at most 1.25. */
static const char *factor_text(const struct emission *e, int way)
{
	struct text t;

	text_init(&t, e->arena);
	if (8 * way * e->arithmetic->unit > 1)
		error_set(e->error, RNEAGEN_LIMIT, "%s: more operations one after the other than --bounded can add up in %s%s",
			e->options->file, e->arithmetic->name, e->arithmetic->more);
	emit_number(e, e->arithmetic, 1 + 2 * way * (real)e->arithmetic->unit, &t);
	return text_string(&t);
}

/* Nothing is known of an output that overflowed. */
static const char *ends_text(const struct emission *e, const struct dag *d)
{
	const struct scalar *m = e->memory;
	struct text t, i;

	text_init(&t, e->arena);
	for (int a = 0; a < d->argument_count; a++) {
		if (!d->arguments[a].is_output)
			continue;
		text_init(&i, e->arena);
		if (unparse_first_bound(d, a))
			text_printf(&i, "%d + ", unparse_first_bound(d, a));
		text_put(&i, "i");
		text_printf(&t, "\tfor (int i = 0; i < %d; i++)\n\t\tbound[%s] = ", d->arguments[a].rows, text_string(&i));
		text_printf(&t, "fabs%s(%s[i]) <= %s ? ", m->suffix, d->arguments[a].name, m->largest);
		text_printf(&t, "bound[%s] : bound[%s] + HUGE_VAL%s;\n", text_string(&i), text_string(&i), m->upper);
	}
	return text_string(&t);
}

/* When is a product that is joined to a sum rounded with it? For the preprocessor. */
static const char *fused_text(const struct emission *e)
{
	if (e->options->strict)
		return "1";
	return *e->arithmetic->upper ? "defined FP_FAST_FMAF" : "defined FP_FAST_FMA";
}

/* ---- by a table of operations, and derivatives of each result by all of them ---- */

/* A value takes 32 bytes of stack; a result a sweep over all. */
enum { MOST_NODES = 4096, MOST_STEPS = 1 << 19 };

static const signed char KINDS[OP_COUNT] = {[OP_CONST] = 0, [OP_INPUT] = 1, [OP_NEG] = 2, [OP_ADD] = 3,
	[OP_SUB] = 4, [OP_MUL] = 5, [OP_FMA] = 6, [OP_SIN] = 7, [OP_COS] = 8, [OP_DIV] = -1, [OP_SQRT] = -1, [OP_ABS] = -1,
	[OP_ANEW] = 9, [OP_WIDEN] = -1, [OP_NARROW] = -1};

int emit_bounds_by_table(const struct emission *e, const struct dag *d)
{
	for (size_t i = 0; i < d->count; i++)
		if (KINDS[d->nodes[i].op] < 0)
			return 0;
	return e->options->bounded == RNEAGEN_BOUNDS_CLOSE && d->count <= MOST_NODES && d->count * d->output_count <= MOST_STEPS;
}

/* Which of the input arrays. */
static int input_number(const struct dag *d, int argument)
{
	int number = 0;

	for (int a = 0; a < argument; a++)
		number += !d->arguments[a].is_output;
	return number;
}

static void put_operation(const struct dag *d, const struct node *n, int constant, struct text *out)
{
	uint32_t a[3] = {0};

	for (int k = 0; k < op_arity[n->op]; k++)
		a[k] = n->arg[k].i;
	if (n->op == OP_CONST)
		a[0] = (uint32_t)constant;
	if (n->op == OP_INPUT) {
		a[0] = (uint32_t)input_number(d, (int)n->arg[0].i);
		a[1] = n->arg[1].i;
	}
	text_printf(out, "{%d, %u, %u, %u}", KINDS[n->op], a[0], a[1], a[2]);
}

static const char *operations_text(const struct emission *e, const struct dag *d)
{
	struct text t;
	int constants = 0;

	text_init(&t, e->arena);
	for (size_t i = 0; i < d->count; i++) {
		text_put(&t, i % 4 ? " " : "\t\t");
		put_operation(d, &d->nodes[i], constants, &t);
		constants += d->nodes[i].op == OP_CONST;
		text_put(&t, i + 1 == d->count ? "\n" : i % 4 == 3 ? ",\n" : ",");
	}
	return text_string(&t);
}

/* How far what the type takes from a constant is from what the file's decimals give; not less when rounded. */
static real lost_of(const struct emission *e, const struct dag *d, const struct node *n)
{
	const struct scalar *s = e->arithmetic;
	struct within c = dag_number(d, n);
	real lost = fabsl(s->round(c.x) - c.x) + (real)within_error(c);

	return lost > 0 ? lost * (1 + 1e-6L) + (real)s->tiny : 0;
}

/* As the text has them, and how far that is from what the file's decimals give; not less when rounded. */
static const char *constants_text(const struct emission *e, const struct dag *d)
{
	struct text t;

	text_init(&t, e->arena);
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		if (n->op != OP_CONST)
			continue;
		text_put(&t, "\t\t{");
		emit_number(e, &SCALAR_F64, e->arithmetic->round(dag_number(d, n).x), &t);
		text_put(&t, ", ");
		emit_number(e, &SCALAR_F64, lost_of(e, d, n), &t);
		text_put(&t, "},\n");
	}
	return text_string(&t);
}

/* The nodes that are stored, in the order of their bounds. */
static const char *results_text(const struct emission *e, const struct dag *d)
{
	struct text t;
	uint32_t *order = arena_alloc(e->arena, d->output_count, sizeof *order);

	text_init(&t, e->arena);
	if (order)
		dag_order_outputs(d, order);
	for (size_t i = 0; i < d->output_count && order; i++) {
		text_put(&t, i % 16 ? " " : "\t\t");
		text_printf(&t, "%u,%s", d->outputs[order[i]].value.i, i % 16 == 15 ? "\n" : "");
	}
	text_put(&t, d->output_count % 16 ? "\n" : "");
	return text_string(&t);
}

static const char *inputs_text(const struct emission *e, const struct dag *d)
{
	struct text t;

	text_init(&t, e->arena);
	for (int a = 0; a < d->argument_count; a++)
		if (!d->arguments[a].is_output)
			text_printf(&t, "%s%s", t.length ? ", " : "", d->arguments[a].name);
	text_put(&t, t.length ? "" : "0"); /* braces of an array are not empty */
	return text_string(&t);
}

static const char *number_text(const struct emission *e, size_t number)
{
	return text_format(e->arena, "%zu", number);
}

/* Beyond the domain of sine and cosine nothing is known. */
static const char *angle_text(const struct emission *e)
{
	struct text t;

	if (emit_trig_of(e->options) == RNEAGEN_ACCURATE)
		return "HUGE_VAL";
	text_init(&t, e->arena);
	emit_number(e, &SCALAR_F64, (real)e->arithmetic->domain, &t);
	return text_string(&t);
}

/* A double, a float that is no smaller, or that where results are rounded to floats. */
static const char *store_text(const struct emission *e)
{
	if (e->memory != e->arithmetic)
		return "(float)((e + 0x1p-24*rneagen_sweptf_place(fabs(all[results[i]].x)*(1 + 0x1p-51) + all[results[i]].e))*(1 + "
			"0x1p-22) + 0x1p-148)";
	return e->memory == &SCALAR_F32 ? "(float)(e > 0 ? e*(1 + 0x1p-22) + 0x1p-149 : e)" : "e*(1 + 0x1p-50)";
}

static void put_swept(const struct emission *e, const struct function *p, struct text *out)
{
	const struct dag *d = &p->dag;
	const struct scalar *s = e->arithmetic;
	const struct slot slots[] = {
		{"M_F", e->memory->suffix}, {"U", s->unit_text}, {"TINY", s->tiny_text}, {"MAX", s->largest},
		{"FUSED", fused_text(e)}, {"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"APART", e->options->strict ? "RNEA_APART " : ""}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)},
		{"NAMES", emit_params(e, p, PARAMS_NAMES)}, {"M", e->memory->type}, {"OPERATIONS", operations_text(e, d)},
		{"CONSTANTS", constants_text(e, d)}, {"RESULTS", results_text(e, d)}, {"INPUTS", inputs_text(e, d)},
		{"COUNT", number_text(e, d->count)}, {"RESULT_COUNT", number_text(e, d->output_count)},
		{"ANGLE", angle_text(e)}, {"STORE", store_text(e)}, {"ENDS", ends_text(e, d)},
	};
	size_t count = sizeof slots / sizeof *slots, from = out->length;

	template_expand(out, template_swept_in, slots, count);
	template_expand(out, template_swept_function_in, slots, count);
	fold(out, from);
}

/* ---- by statements that each keep their bound ---- */

/* The operations that the text has, each beside its bound. */
static void put_operations_within(
	const struct emission *e, const struct function *p, const struct slot *slots, size_t count, struct text *out)
{
	template_expand(out, template_bounded_in, slots, count);
	if (emit_function_uses(p, OP_SIN) || emit_function_uses(p, OP_COS))
		template_expand(out, template_bounded_sincos_in, slots, count);
	if (emit_function_uses(p, OP_DIV) || emit_function_uses(p, OP_SQRT))
		template_expand(out, template_bounded_quotient_in, slots, count);
	if (e->memory != e->arithmetic)
		template_expand(out, template_bounded_store_in, slots, count);
}

static void put_running(const struct emission *e, const struct function *p, struct text *out)
{
	const struct scalar *s = e->arithmetic;
	int way = longest_way(e, &p->dag);
	const char *rest;
	const struct slot slots[] = {
		{"F", s->suffix}, {"F_UPPER", s->upper}, {"T", s->type}, {"U", s->unit_text}, {"TINY", s->tiny_text},
		{"MAX", s->largest}, {"MODE", emit_trig_name(emit_trig_of(e->options))}, {"FUSED", fused_text(e)},
		{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"STRICT", e->options->strict ? "strict_" : ""},
		{"APART", e->options->strict ? "RNEA_APART " : ""}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)},
		{"NAMES", emit_params(e, p, PARAMS_NAMES)}, {"M", e->memory->type}, {"FACTOR", factor_text(e, way)},
		{"ENDS", ends_text(e, &p->dag)},
	};
	size_t count = sizeof slots / sizeof *slots, from = out->length;

	put_operations_within(e, p, slots, count, out);
	rest = template_expand_to(out, template_bounded_function_in, "BODY", slots, count);
	fold(out, from);
	unparse(e, p, e->numbers->bounded, NULL, out);
	from = out->length;
	template_expand(out, rest, slots, count);
	fold(out, from);
	out->failed |= way < 0;
}

void emit_bounded(const struct emission *e, struct text *out)
{
	const struct function *p = emit_main(e);

	text_put(out, template_bounded_finite_in);
	if (emit_bounds_by_table(e, &p->dag))
		put_swept(e, p, out);
	else
		put_running(e, p, out);
}

/* ---- pairs of a number and of a bound of how far it is from what the URDF's decimals give ---- */

#define WITHIN_CALLS(prefix)                                                                                           \
	{[OP_NEG] = prefix "neg", [OP_ADD] = prefix "add", [OP_SUB] = prefix "sub", [OP_MUL] = prefix "mul", [OP_FMA] = prefix "fma", \
		[OP_DIV] = prefix "div", [OP_SQRT] = prefix "sqrt", [OP_ABS] = prefix "abs",\
		[OP_ANEW] = ""}

static const char *const CALLS_F32[OP_COUNT] = WITHIN_CALLS("rneagen_withinf_"),
			 *const CALLS_F64[OP_COUNT] = WITHIN_CALLS("rneagen_within_");

static void put_constant(const struct unparser *u, const struct node *n, struct text *out)
{
	const struct scalar *s = u->emission->arithmetic;

	text_printf(out, "rneagen_within%s_const(", s->suffix);
	emit_number(u->emission, s, dag_number(u->plan->dag, n).x, out);
	text_put(out, ", ");
	emit_number(u->emission, s, lost_of(u->emission, u->plan->dag, n), out);
	text_putc(out, ')');
}

/* In memory of another type: one rounding more, of the output, and that of the bound. */
const struct number_type WITHIN_F32 = {.memory = &SCALAR_F32, .arithmetic = &SCALAR_F32, .value = "struct rneagen_withinf",
	.calls = CALLS_F32, .strict_calls = CALLS_F32, .sincos = "rneagen_withinf_sincos_",
	.strict_sincos = "rneagen_withinf_sincos_", .load = {"rneagen_withinf_input(", ")"}, .store = {"", ".e*factor"},
	.angle = {"", ""}, .is_beside = 1, .put_constant = put_constant};
const struct number_type WITHIN_F64 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F64, .value = "struct rneagen_within",
	.calls = CALLS_F64, .strict_calls = CALLS_F64, .sincos = "rneagen_within_sincos_",
	.strict_sincos = "rneagen_within_sincos_", .load = {"rneagen_within_input(", ")"}, .store = {"", ".e*factor"},
	.angle = {"", ""}, .is_beside = 1, .put_constant = put_constant};
const struct number_type WITHIN_MIXED = {.memory = &SCALAR_F32, .arithmetic = &SCALAR_F64, .value = "struct rneagen_within",
	.calls = CALLS_F64, .strict_calls = CALLS_F64, .sincos = "rneagen_within_sincos_",
	.strict_sincos = "rneagen_within_sincos_", .load = {"rneagen_within_input((double)", ")"},
	.store = {"rneagen_within_f32(", ", factor)"}, .angle = {"", ""}, .is_beside = 1, .put_constant = put_constant};
