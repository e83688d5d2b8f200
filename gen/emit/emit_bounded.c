/* NAME_rnea_bounded: torques, or what else is wanted, and, by a running error analysis beside them, how far each may be from
   what the URDF's decimals give. */
#include "emit/emit.h"
#include "emit/template.h"
#include <math.h>

/* Roundings of a bound from an operation's operands to its result, three times u for the factor 1 + 3u included. */
static const int roundings[OP_COUNT] = {
	[OP_ADD] = 7, [OP_SUB] = 7, [OP_MUL] = 10, [OP_FMA] = 14, [OP_SIN] = 12, [OP_COS] = 12};

static void put_value(const struct emission *e, const struct plan *p, struct ref a, struct text *out);

/* A function of the pairs' own. */
static void put_call(const struct emission *e, const char *name, struct text *out)
{
	text_printf(out, "rneagen_within%s_%s(", e->arithmetic->suffix, name);
}

/* What the type takes from the constant, and how far that is from what the file's decimals give; not less when rounded. */
static void put_constant(const struct emission *e, struct within c, struct text *out)
{
	int f32 = e->arithmetic->bytes == 4;
	real rounded = f32 ? (real)(float)c.x : (real)(double)c.x, lost = fabsl(rounded - c.x) + (real)within_error(c);

	if (lost > 0)
		lost = lost * (1 + 1e-6L) + (f32 ? 0x1p-148L : 0x1p-1072L);
	put_call(e, "const", out);
	emit_number(e, e->arithmetic, c.x, out);
	text_put(out, ", ");
	emit_number(e, e->arithmetic, lost, out);
	text_putc(out, ')');
}

static void put_expression(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];

	if (n->op == OP_CONST) {
		put_constant(e, dag_number(p->dag, n), out);
		return;
	}
	if (!emit_operation[n->op]) { /* inputs, sines and cosines have names */
		out->failed = 1;
		return;
	}
	put_call(e, emit_operation[n->op], out);
	for (int k = 0; k < op_arity[n->op]; k++) {
		text_put(out, k ? ", " : "");
		put_value(e, p, n->arg[k], out);
	}
	text_putc(out, ')');
}

static void put_value(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	if (p->names[a.i])
		text_put(out, p->names[a.i]);
	else
		put_expression(e, p, a, out);
}

static void put_assignment(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];

	text_printf(out, "const struct rneagen_within%s %s = ", e->arithmetic->suffix, p->names[a.i]);
	if (n->op != OP_INPUT) {
		put_expression(e, p, a, out);
		return;
	}
	put_call(e, "input", out);
	text_put(out, emit_converts(e) ? "(double)" : "");
	text_printf(out, "%s[%u])", p->dag->arguments[n->arg[0].i].name, (unsigned)n->arg[1].i);
}

/* The name of a sine or cosine, or one for what nobody needs. */
static void put_name(const struct plan *p, struct ref a, const char *other, struct text *out)
{
	if (p->names[a.i])
		text_put(out, p->names[a.i]);
	else
		text_printf(out, "unused_%s", other);
}

static void put_sincos(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];
	struct ref s = n->op == OP_SIN ? a : plan_partner(p, a, OP_SIN), c = n->op == OP_COS ? a : plan_partner(p, a, OP_COS);
	struct text sine, cosine;

	text_init(&sine, e->arena);
	text_init(&cosine, e->arena);
	put_name(p, s, p->names[a.i], &sine);
	put_name(p, c, p->names[a.i], &cosine);
	text_printf(out, "struct rneagen_within%s %s, %s;\n\t", e->arithmetic->suffix, text_string(&sine), text_string(&cosine));
	text_printf(out, "rneagen_within%s_sincos_%s(", e->arithmetic->suffix, emit_trig_name(emit_trig_of(e->options)));
	put_value(e, p, n->arg[0], out);
	text_printf(out, ", &%s, &%s)", text_string(&sine), text_string(&cosine));
}

/* Where the bounds of an output begin: one output's come after the other's. */
static int first_bound(const struct dag *d, int argument)
{
	int first = 0;

	for (int i = 0; i < argument; i++)
		first += d->arguments[i].is_output ? d->arguments[i].rows : 0;
	return first;
}

/* In memory of another type: one rounding more, of the output, and that of the bound. */
static void put_store(const struct emission *e, const struct plan *p, const struct output *o, struct text *out)
{
	text_printf(out, "bound[%d] = %s", first_bound(p->dag, o->argument) + o->row, emit_converts(e) ? "rneagen_within_f32(" : "");
	put_value(e, p, o->value, out);
	text_put(out, emit_converts(e) ? ", factor)" : ".e*factor");
}

/* `statement` is room for one. */
static void put_line(const struct emission *e, const struct pass *pass, const struct line *l, struct text *statement, struct text *out)
{
	const struct plan *p = &pass->plan;

	text_clear(statement);
	if (l->kind == LINE_SECTION) {
		emit_section(e, pass, &p->dag->sections[l->index], out);
		return;
	}
	if (l->kind == LINE_SINCOS)
		put_sincos(e, p, l->value, statement);
	else if (l->kind == LINE_STORE)
		put_store(e, p, &p->dag->outputs[l->index], statement);
	else
		put_assignment(e, p, l->value, statement);
	text_putc(statement, ';');
	out->failed |= statement->failed;
	emit_wrapped(out, text_string(statement));
}

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

static const char *factor_text(const struct emission *e, int way)
{
	struct text t;

	text_init(&t, e->arena);
	emit_number(e, e->arithmetic, 1 + 2 * way * (e->arithmetic->bytes == 4 ? 0x1p-24L : 0x1p-53L), &t);
	return text_string(&t);
}

/* Nothing is known of an output that overflowed. */
static const char *ends_text(const struct emission *e, const struct dag *d)
{
	int f32 = e->memory->bytes == 4;
	struct text t, i;

	text_init(&t, e->arena);
	for (int a = 0; a < d->argument_count; a++) {
		if (!d->arguments[a].is_output)
			continue;
		text_init(&i, e->arena);
		if (first_bound(d, a))
			text_printf(&i, "%d + ", first_bound(d, a));
		text_put(&i, "i");
		text_printf(&t, "\tfor (int i = 0; i < %d; i++)\n\t\tbound[%s] = ", d->arguments[a].rows, text_string(&i));
		text_printf(&t, "fabs%s(%s[i]) <= %s ? ", e->memory->suffix, d->arguments[a].name, f32 ? "0x1.fffffep127f" : "0x1.fffffffffffffp1023");
		text_printf(&t, "bound[%s] : bound[%s] + HUGE_VAL%s;\n", text_string(&i), text_string(&i), f32 ? "F" : "");
	}
	return text_string(&t);
}

void emit_bounded(const struct emission *e, struct text *out)
{
	const struct pass *p = emit_main(e);
	int f32 = e->arithmetic->bytes == 4, way = longest_way(e, &p->dag);
	struct text statement;
	const char *rest;
	const struct slot slots[] = {
		{"F", e->arithmetic->suffix}, {"F_UPPER", f32 ? "F" : ""}, {"T", e->arithmetic->type}, {"U", f32 ? "0x1p-24f" : "0x1p-53"},
		{"TINY", f32 ? "0x1p-146f" : "0x1p-1071"}, {"THREE", f32 ? "3.0f" : "3.0"}, {"MAX", f32 ? "0x1.fffffep127f" : "0x1.fffffffffffffp1023"},
		{"SINCOS", f32 ? "1.7f*0x1p-24f" : "1.7*0x1p-53"}, {"MODE", emit_trig_name(emit_trig_of(e->options))},
		{"FUSED", e->options->strict ? "1" : f32 ? "defined FP_FAST_FMAF" : "defined FP_FAST_FMA"}, {"NAME", e->options->name}, {"STRICT", e->options->strict ? "strict_" : ""}, {"APART", e->options->strict ? "RNEA_APART " : ""},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)}, {"M", e->memory->type},
		{"FACTOR", factor_text(e, way)}, {"ENDS", ends_text(e, &p->dag)},
	};
	size_t count = sizeof slots / sizeof *slots;

	template_expand(out, template_bounded_in, slots, count);
	if (plan_operations(&p->plan).sincos)
		template_expand(out, template_bounded_sincos_in, slots, count);
	if (emit_converts(e))
		template_expand(out, template_bounded_store_in, slots, count);
	rest = template_expand_to(out, template_bounded_function_in, "BODY", slots, count);
	text_init(&statement, e->arena);
	for (size_t i = 0; i < p->plan.line_count; i++)
		put_line(e, p, &p->plan.lines[i], &statement, out);
	template_expand(out, rest, slots, count);
	out->failed |= way < 0;
}
