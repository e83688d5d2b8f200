/* f32, f64 and mixed: numbers that the language has, written with its signs. */
#include "emit/unparse.h"
#include "base/template.h"
#include "base/number.h"
#include <float.h>
#include <stdio.h>
#include <string.h>

static void write_literal(struct number_text t, const char *suffix, char *s, size_t size)
{
	snprintf(s, size, "%s%s%s", t.s, strpbrk(t.s, ".e") ? "" : ".0", suffix);
}

static real round_f32(real x)
{
	return (real)(float)x;
}

static void write_f32(double x, char *s, size_t size)
{
	write_literal(number_shortest_float((float)x), "f", s, size);
}

static real round_f64(real x)
{
	return (real)(double)x;
}

static void write_f64(double x, char *s, size_t size)
{
	write_literal(number_shortest(x), "", s, size);
}

const struct scalar SCALAR_F32 = {.name = "f32", .type = "float", .suffix = "f", .upper = "F", .letter = "f", .bytes = 4,
	.domain = 1e4, .unit = 0x1p-24, .tiny = 0x1p-148, .unit_text = "0x1p-24f", .tiny_text = "0x1p-146f",
	.largest = "0x1.fffffep127f", .flushes = 1, .more = "; take --precision f64, or mixed, whose constants are f64",
	.round = round_f32, .write = write_f32};
const struct scalar SCALAR_F64 = {.name = "f64", .type = "double", .suffix = "", .upper = "", .letter = "d", .bytes = 8,
	.domain = 1e7, .unit = 0x1p-53, .tiny = 0x1p-1072, .unit_text = "0x1p-53", .tiny_text = "0x1p-1071",
	.largest = "0x1.fffffffffffffp1023", .more = "", .round = round_f64, .write = write_f64};

static const struct sincos_frames SINCOS_F32 = {template_sincos_f32_core_in, template_sincos_f32_bounded_in,
	template_sincos_f32_accurate_in, template_sincos_f32_known_in, template_sincos_f32_fast_in, NULL};
const struct sincos_frames SINCOS_F64 = {template_sincos_f64_core_in, template_sincos_f64_bounded_in,
	template_sincos_f64_accurate_in, template_sincos_f64_known_in, NULL, NULL};

#define STRICT_CALLS                                                                                                   \
	[OP_ADD] = "RNEA_ADD", [OP_SUB] = "RNEA_SUB", [OP_MUL] = "RNEA_MUL", [OP_FMA] = "RNEA_FMA", [OP_DIV] = "RNEA_DIV", \
	[OP_SQRT] = "RNEA_SQRT", [OP_ANEW] = "RNEA_ANEW"

static const char *const CALLS_F32[OP_COUNT] = {[OP_FMA] = "RNEA_FMA", [OP_SQRT] = "sqrtf", [OP_ABS] = "fabsf",
	[OP_ANEW] = "RNEA_ANEW"},
			 *const CALLS_F64[OP_COUNT] = {[OP_FMA] = "RNEA_FMA", [OP_SQRT] = "sqrt", [OP_ABS] = "fabs",
	[OP_ANEW] = "RNEA_ANEW"},
			 *const STRICT_CALLS_F32[OP_COUNT] = {STRICT_CALLS, [OP_ABS] = "fabsf"},
			 *const STRICT_CALLS_F64[OP_COUNT] = {STRICT_CALLS, [OP_ABS] = "fabs"};

/* Beside those of another type. */
static const char *const WIDE_CALLS[OP_COUNT] = {[OP_FMA] = "RNEA_WIDE_FMA", [OP_SQRT] = "sqrt"},
			 *const WIDE_STRICT_CALLS[OP_COUNT] = {[OP_ADD] = "RNEA_WIDE_ADD", [OP_SUB] = "RNEA_WIDE_SUB",
				 [OP_MUL] = "RNEA_WIDE_MUL", [OP_FMA] = "RNEA_WIDE_FMA", [OP_DIV] = "RNEA_WIDE_DIV",
				 [OP_SQRT] = "RNEA_WIDE_SQRT"};

static void put_constant(const struct unparser *u, const struct node *n, struct text *out)
{
	if (!emit_put_number(u, n->value, out))
		emit_number(u->emission, u->numbers->arithmetic, n->value, out);
}

/* Of a text in floats for a GPU, where a division is a function with branches. */
static int is_reciprocal(const struct emission *e, const struct dag *d, const struct node *n)
{
	return n->op == OP_DIV && !n->is_wide && d->nodes[n->arg[0].i].op == OP_CONST && d->nodes[n->arg[0].i].value == 1 &&
		e->target->has_unit && !e->options->strict;
}

static int put_reciprocal(const struct unparser *u, const struct node *n, struct text *out)
{
	if (!is_reciprocal(u->emission, u->plan->dag, n))
		return 0;
	text_put(out, "rneagen_reciprocalf(");
	unparse_value(u, n->arg[1], out);
	text_putc(out, ')');
	return 1;
}

static void put_reciprocals(const struct emission *e, struct text *out)
{
	for (int i = 0; i < e->function_count; i++)
		for (size_t k = 0; k < e->functions[i].dag.count; k++)
			if (is_reciprocal(e, &e->functions[i].dag, &e->functions[i].dag.nodes[k])) {
				text_put(out, template_reciprocal_in);
				return;
			}
}

/* 0.85 units in the last place are 1.7 of rounding. No result of sine and cosine underflows but for tiny angles. */
#define MODEL_F32                                                                                                \
	.add = 0x1p-24, .mul = 0x1p-24, .quotient = 0x1.00002p-24, .tiny = 0x1p-150, .largest = (double)FLT_MAX, \
	.sincos = 1.7 * 0x1p-24, .sine = 0x1p-149, .constant = round_f32
#define MODEL_F64                                                                                                            \
	.add = 0x1p-53, .mul = 0x1p-53, .quotient = 0x1p-53, .tiny = 0x1p-1072, .largest = DBL_MAX, .sincos = 1.7 * 0x1p-53, \
	.sine = 0x1p-1072, .constant = round_f64

const struct number_type NUMBER_F32 = {.memory = &SCALAR_F32, .arithmetic = &SCALAR_F32, .value = "float",
	.calls = CALLS_F32, .strict_calls = STRICT_CALLS_F32, .sincos = "rneagen_sincosf_",
	.strict_sincos = "rneagen_strict_sincosf_", .load = {"", ""}, .store = {"", ""}, .angle = {"", ""},
	.note = "", .put_constant = put_constant, .put_cheaper = put_reciprocal, .put_functions = put_reciprocals,
	.frames = &SINCOS_F32, .lanes = &LANES_F32, .bounded = &WITHIN_F32, .fuses = 1, .model = {MODEL_F32, .store_largest = DBL_MAX},
	.fast_sine = -21.41, .fast_cosine = -21.19, .fast_angle = (double)3.14159265f};

const struct number_type NUMBER_F64 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F64, .value = "double",
	.calls = CALLS_F64, .strict_calls = STRICT_CALLS_F64, .sincos = "rneagen_sincos_",
	.strict_sincos = "rneagen_strict_sincos_", .load = {"", ""}, .store = {"", ""}, .angle = {"", ""},
	.note = "", .put_constant = put_constant, .frames = &SINCOS_F64, .lanes = &LANES_F64, .bounded = &WITHIN_F64, .fuses = 1,
	.model = {MODEL_F64, .store_largest = DBL_MAX}};

/* Results are rounded to float when they are stored. */
const struct number_type NUMBER_MIXED = {.memory = &SCALAR_F32, .arithmetic = &SCALAR_F64, .value = "double",
	.calls = CALLS_F64, .strict_calls = STRICT_CALLS_F64, .sincos = "rneagen_sincos_",
	.strict_sincos = "rneagen_strict_sincos_", .load = {"(double)", ""}, .store = {"(float)", ""}, .store_is_cast = 1,
	.angle = {"", ""}, .note = "", .put_constant = put_constant, .frames = &SINCOS_F64, .bounded = &WITHIN_MIXED, .fuses = 1,
	.model = {MODEL_F64, .store = 0x1p-24, .store_tiny = 0x1p-150, .store_largest = (double)FLT_MAX}};

const struct number_type WIDE_F64 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F64, .value = "double",
	.calls = WIDE_CALLS, .strict_calls = WIDE_STRICT_CALLS, .sincos = "rneagen_sincos_",
	.strict_sincos = "rneagen_strict_sincos_", .angle = {"", ""}, .widen = {"(double)", ""}, .narrow = {"(float)", ""},
	.put_constant = put_constant, .frames = &SINCOS_F64};

static const char *const LANES_CALLS[OP_COUNT] = {[OP_FMA] = "RNEA_LANES_FMA"};

void emit_put_lanes(const struct unparser *u, const struct node *n, struct text *out)
{
	text_put(out, n->op == OP_PACK ? "RNEA_LANES(" : "");
	unparse_value(u, n->arg[0], out);
	if (n->op >= OP_LANE0) {
		text_printf(out, "[%d]", (int)(n->op - OP_LANE0));
		return;
	}
	text_put(out, ", ");
	unparse_value(u, n->arg[1], out);
	text_put(out, n->op == OP_PACK ? ")" : "");
}

static void put_lanes(const struct unparser *u, const struct node *n, struct text *out)
{
	const struct dag_lanes *x = n->arg[0].i ? &u->plan->dag->lanes[n->arg[0].i - 1] : NULL;

	if (!x) {
		put_constant(u, n, out);
		return;
	}
	for (int i = 0; i < u->plan->dag->width; i++) {
		text_put(out, i ? ", " : "RNEA_LANES(");
		emit_number(u->emission, u->numbers->arithmetic, x->x[i], out);
	}
	text_putc(out, ')');
}

static const char *const COLUMNS_CALLS[OP_COUNT] = {[OP_FMA] = "RNEA_COLUMNS_FMA"};

const struct number_type COLUMNS_F32 = {.memory = &SCALAR_F32, .arithmetic = &SCALAR_F32, .value = "rneagen_columns",
	.splat = "RNEA_COLUMNS_OF(", .calls = COLUMNS_CALLS, .load = {"", ""}, .store = {"", ""},
	.put_constant = put_constant};
const struct number_type COLUMNS_F64 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F64, .value = "rneagen_columns",
	.splat = "RNEA_COLUMNS_OF(", .calls = COLUMNS_CALLS, .load = {"", ""}, .store = {"", ""},
	.put_constant = put_constant};
const struct number_type LANES_F32 = {.memory = &SCALAR_F32, .arithmetic = &SCALAR_F32, .value = "rneagen_lanes",
	.splat = "RNEA_SPLAT(", .calls = LANES_CALLS, .strict_calls = LANES_CALLS, .put_constant = put_lanes};
const struct number_type LANES_F64 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F64, .value = "rneagen_lanes",
	.splat = "RNEA_SPLAT(", .calls = LANES_CALLS, .strict_calls = LANES_CALLS, .put_constant = put_lanes};
