/* f32x2: numbers that are pairs of floats, in memory doubles; calls instead of operators. */
#include "base/template.h"
#include "emit/unparse.h"
#include <float.h>

static real round_f32x2(real x)
{
	float hi = (float)x;

	return (real)hi + (real)(float)(x - (real)hi);
}

/* Its functions of large angles are of doubles. */
static const struct scalar SCALAR_F32X2 = {.name = "f32x2", .type = "struct rneagen_f32x2", .suffix = "",
	.upper = "", .letter = "d", .bytes = 8, .domain = 1e4, .more = "", .round = round_f32x2};

static const struct sincos_frames SINCOS_F32X2 = {template_sincos_f32x2_core_in, template_sincos_f32x2_bounded_in,
	template_sincos_f32x2_accurate_in, template_sincos_f32x2_known_in, NULL, &SINCOS_F64};

/* Of angles that are pairs. */
static const struct sincos_frames SINCOS_PAIR = {template_sincos_f32x2_core_in, template_sincos_pair_bounded_in,
	template_sincos_pair_accurate_in, template_sincos_pair_known_in, NULL, &SINCOS_F64};

static const char *const CALLS[OP_COUNT] = {[OP_NEG] = "rneagen_neg", [OP_ADD] = "rneagen_add", [OP_SUB] = "rneagen_sub",
	[OP_MUL] = "rneagen_mul", [OP_FMA] = "rneagen_fma", [OP_DIV] = "rneagen_div", [OP_SQRT] = "rneagen_sqrt", [OP_ANEW] = ""};

/* The constant's float, and what the float leaves of it. */
static void put_constant(const struct unparser *u, const struct node *n, struct text *out)
{
	float hi = (float)n->value;

	text_put(out, "rneagen_pair(");
	emit_number(u->emission, &SCALAR_F32, n->value, out);
	text_put(out, ", ");
	emit_number(u->emission, &SCALAR_F32, n->value - (real)hi, out);
	text_putc(out, ')');
}

static int is_float(const struct plan *p, struct ref a)
{
	const struct node *n = &p->dag->nodes[a.i];

	return n->op == OP_CONST && (real)(float)n->value == n->value;
}

/* A product with a constant that is a float costs less. */
static int put_product_by_float(const struct unparser *u, const struct node *n, struct text *out)
{
	int k = is_float(u->plan, n->arg[1]) ? 1 : 0;

	if (n->op != OP_MUL || !is_float(u->plan, n->arg[k]))
		return 0;
	text_put(out, "rneagen_mul_f(");
	unparse_value(u, n->arg[1 - k], out);
	text_put(out, ", ");
	emit_number(u->emission, &SCALAR_F32, u->plan->dag->nodes[n->arg[k].i].value, out);
	text_putc(out, ')');
	return 1;
}

static void put_functions(const struct emission *e, struct text *out)
{
	int is_wide = e->numbers->put_functions != put_functions;

	text_put(out, template_f32x2_in);
	if (emit_uses_in(e, OP_DIV, is_wide) || emit_uses_in(e, OP_SQRT, is_wide))
		text_put(out, template_f32x2_quotient_in);
	text_putc(out, '\n');
}

/* Beside floats: a float is a pair, and the first of a pair is the pair rounded to a float. */
const struct number_type WIDE_F32X2 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F32X2, .value = "struct rneagen_f32x2",
	.calls = CALLS, .sincos = "rneagen_sincos_pair_", .angle = {"", ""},
	.widen = {"rneagen_pair(", ", 0.0f)"}, .narrow = {"", ".hi"}, .put_constant = put_constant,
	.put_cheaper = put_product_by_float, .put_functions = put_functions, .frames = &SINCOS_PAIR};

/* Sine and cosine of a large angle need all of its bits: they take a double. The bounds of the model are those that
   templates/arithmetic/f32x2.in and sincos/sincos_f32x2_core.in state; tests/test_f32x2 holds them against MPFR. Factors are
   split into halves by 4097, which must not overflow. */
const struct number_type NUMBER_F32X2 = {.memory = &SCALAR_F64, .arithmetic = &SCALAR_F32X2,
	.value = "struct rneagen_f32x2", .calls = CALLS, .sincos = "rneagen_sincos_f32x2_", .load = {"rneagen_split(", ")"},
	.store = {"rneagen_join(", ")"}, .angle = {"rneagen_join(", ")"}, .angle_is_memory = 1, .put_constant = put_constant,
	.put_cheaper = put_product_by_float, .put_functions = put_functions, .frames = &SINCOS_F32X2,
	.note = " * Arrays are double; arithmetic is in pairs of floats, good to 44 bits for magnitudes from 1e-25 to 1e30,\n"
		" * and slower than double where double takes less than twenty times as long as float.\n",
	.model = {.terms = 3.001 * 0x1p-48, .mul = 7 * 0x1p-48, .quotient = 7 * 0x1p-48, .tiny = 0x1p-146, .input = 0x1p-48,
		.largest = 0x1p114, .sincos = 0x1p-46, .sine = 0x1p-58, .cosine = 0x1p-58, .store = 0x1p-53,
		.store_largest = DBL_MAX, .constant = round_f32x2}};
