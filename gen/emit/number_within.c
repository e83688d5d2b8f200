/* --bounded: pairs of a number and of a bound of how far it is from what the URDF's decimals give. */
#include "emit/unparse.h"
#include <math.h>

#define WITHIN_CALLS(prefix)                                                                                           \
	{[OP_NEG] = prefix "neg", [OP_ADD] = prefix "add", [OP_SUB] = prefix "sub", [OP_MUL] = prefix "mul", [OP_FMA] = prefix "fma", \
		[OP_DIV] = prefix "div", [OP_SQRT] = prefix "sqrt", [OP_ABS] = prefix "abs",\
		[OP_ANEW] = ""}

static const char *const CALLS_F32[OP_COUNT] = WITHIN_CALLS("rneagen_withinf_"),
			 *const CALLS_F64[OP_COUNT] = WITHIN_CALLS("rneagen_within_");

real emit_lost(const struct emission *e, const struct dag *d, const struct node *n)
{
	const struct scalar *s = e->arithmetic;
	struct within c = dag_number(d, n);
	real lost = fabsl(s->round(c.x) - c.x) + (real)within_error(c);

	return lost > 0 ? lost * (1 + 1e-6L) + (real)s->tiny : 0;
}

static void put_constant(const struct unparser *u, const struct node *n, struct text *out)
{
	const struct scalar *s = u->emission->arithmetic;

	text_printf(out, "rneagen_within%s_const(", s->suffix);
	emit_number(u->emission, s, dag_number(u->plan->dag, n).x, out);
	text_put(out, ", ");
	emit_number(u->emission, s, emit_lost(u->emission, u->plan->dag, n), out);
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
