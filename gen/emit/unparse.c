#include "base/fold.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_relay.h"
#include "emit/unparse.h"
#include "plan/readings.h"
#include "plan/tiles/tiles.h"
#include <math.h>
#include <stdio.h>

/* Of operations that have one. */
static const char *const SIGNS[OP_COUNT] = {[OP_ADD] = " + ", [OP_SUB] = " - ", [OP_MUL] = "*", [OP_DIV] = "/"};

static void put_expression(const struct unparser *u, struct ref a, struct text *out);

/* Of a node's own type. */
static const struct unparser *unparser_of(const struct unparser *u, struct ref a)
{
	return u->plan->dag->nodes[a.i].is_wide && u->wide ? u->wide : u->narrow;
}

/* Binding strength of what put_value writes for a node. */
static int strength(const struct unparser *u, struct ref a)
{
	const struct node *n = &u->plan->dag->nodes[a.i];

	if (u->plan->names[a.i])
		return op_strength[OP_INPUT];
	if (n->op == OP_CONST && signbit(n->value))
		return op_strength[OP_NEG];
	return op_strength[u->calls[n->op] ? OP_FMA : n->op];
}

/* A name, a number, or the expression itself, in parentheses where it binds less than `least`. */
static void put_value(const struct unparser *u, struct ref a, int least, struct text *out)
{
	int enclose = strength(u, a) < least;

	text_put(out, enclose ? "(" : "");
	if (u->plan->names[a.i])
		text_put(out, u->plan->names[a.i]);
	else /* numbers among lanes */
		put_expression(u == u->wide && u->numbers->splat ? unparser_of(u, a) : u, a, out);
	text_put(out, enclose ? ")" : "");
}

void unparse_value(const struct unparser *u, struct ref a, struct text *out)
{
	put_value(u, a, 0, out);
}

static void put_binary(const struct unparser *u, const struct node *n, struct text *out)
{
	int own = op_strength[n->op];

	put_value(u, n->arg[0], own, out);
	text_put(out, SIGNS[n->op]);
	put_value(u, n->arg[1], own + 1, out); /* no re-association: a - (b - c), a*(b*c) */
}

/* Is it a number where vectors are called for? */
static int is_same_in_all(const struct unparser *u, const struct node *n)
{
	return n->op == OP_CONST ? !n->arg[0].i : !u->is_over_columns && !n->is_wide;
}

/* Over columns, which share the older factor a, -a b + c is written a (-b) + c: one instruction, without a vector of -a. */
static void put_call(const struct unparser *u, const struct node *n, struct text *out)
{
	const struct node *first = &u->plan->dag->nodes[n->arg[0].i];
	int moves = u->is_over_columns && n->op == OP_FMA && first->op == OP_NEG && !u->plan->names[n->arg[0].i];

	text_printf(out, "%s(", u->calls[n->op]);
	for (int k = 0; k < op_arity[n->op]; k++) {
		const char *before = u->numbers->splat && is_same_in_all(u, &u->plan->dag->nodes[n->arg[k].i]) ? u->numbers->splat : "";

		text_printf(out, "%s%s", !k ? "" : moves && k == 1 ? ", -" : ", ", before);
		put_value(u, moves && !k ? first->arg[0] : n->arg[k], moves && k == 1 ? op_strength[OP_NEG] + 1 : 0, out);
		text_put(out, *before ? ")" : "");
	}
	text_putc(out, ')');
}

static void put_around(const struct around *x, int is_end, struct text *out)
{
	text_put(out, is_end ? x->after : x->before);
}

/* From one type of numbers to the other; within an expression of the type that it gives. */
static void put_conversion(const struct unparser *u, const struct node *n, struct text *out)
{
	const struct around *x = n->op == OP_WIDEN ? &u->wide->numbers->widen : &u->wide->numbers->narrow;

	put_around(x, 0, out);
	put_value(unparser_of(u, n->arg[0]), n->arg[0], op_strength[n->op], out);
	put_around(x, 1, out);
}

static void put_expression(const struct unparser *u, struct ref a, struct text *out)
{
	const struct node *n = &u->plan->dag->nodes[a.i];

	if (n->op == OP_CONST && u->loop && n->arg[0].i) {
		emit_put_each_number(u, n, out);
	} else if (n->op == OP_CONST) {
		u->numbers->put_constant(u, n, out);
	} else if (n->op >= OP_WIDEN) {
		(n->op >= OP_PAIR ? emit_put_lanes : put_conversion)(u, n, out);
	} else if (u->numbers->put_cheaper && u->numbers->put_cheaper(u, n, out)) {
		return;
	} else if (u->calls[n->op]) {
		put_call(u, n, out);
	} else if (n->op == OP_NEG) {
		text_putc(out, '-');
		put_value(u, n->arg[0], op_strength[OP_NEG] + 1, out);
	} else if (SIGNS[n->op]) {
		put_binary(u, n, out);
	} else { /* inputs, sines and cosines have names */
		out->failed = 1;
	}
}

/* What a kernel before has left in a row. */
static void put_handed(const struct unparser *u, unsigned row, struct text *out)
{
	const struct stretches *s = u->function->stretches;
	unsigned mu = (unsigned)stretches_found_row(s, FOUND_MU);

	if (s->takes_found && row >= mu)
		unparse_index("mu", row - mu, "step", out);
	else
		unparse_index(s->takes_found ? "found" : "handed", row, "step", out);
}

void unparse_load(const struct unparser *u, const struct node *n, struct text *out)
{
	put_around(&u->numbers->load, 0, out);
	text_put(out, dag_reading_of(n) ? "RNEA_READ_ANEW(" : "");
	if (dag_loop_of(n))
		unparse_element_each(u, (int)n->arg[0].i, (int)n->arg[1].i, out);
	else if (u->function->stretches && u->plan->dag->arguments[n->arg[0].i].is_output)
		put_handed(u, n->arg[1].i, out);
	else
		unparse_element(u, (int)n->arg[0].i, (int)n->arg[1].i, out);
	text_put(out, dag_reading_of(n) ? ")" : "");
	put_around(&u->numbers->load, 1, out);
}

void unparse_angle(const struct unparser *u, struct ref a, struct text *out)
{
	const struct node *n = &u->plan->dag->nodes[a.i];

	if (u->numbers->angle_is_memory && n->op == OP_INPUT) {
		unparse_element(u, (int)n->arg[0].i, (int)n->arg[1].i, out);
		return;
	}
	put_around(&u->numbers->angle, 0, out);
	put_value(u, a, 0, out);
	put_around(&u->numbers->angle, 1, out);
}

/* `, known, sines + 2`: where sine and cosine stand if they are known. */
static void put_known(const struct unparser *u, struct ref angle, struct text *out)
{
	int place = angles_place(&u->sines, u->plan->dag, angle, u->function->loops, 0);

	text_printf(out, ", known, sines%s", u == u->wide ? "_wide" : "");
	if (place > 0)
		text_printf(out, " + %d", 2 * place);
	if (u->loop)
		emit_put_each_step(u, angle, place, out);
	out->failed |= place < 0;
}

static void put_sincos(const struct unparser *u, struct ref a, struct text *out)
{
	const struct emission *e = u->emission;
	const struct plan *p = u->plan;
	const struct node *n = &p->dag->nodes[a.i];
	struct ref s = n->op == OP_SIN ? a : plan_partner(p, a, OP_SIN), c = n->op == OP_COS ? a : plan_partner(p, a, OP_COS);
	int asks = emit_has_known(e) && !u->numbers->is_beside;
	const char *sine = p->names[s.i], *cosine = p->names[c.i];
	char unused[80];

	snprintf(unused, sizeof unused, "unused_%s", sine ? sine : cosine);
	sine = sine ? sine : unused;
	cosine = cosine ? cosine : unused;
	text_printf(out, "%s %s, %s;\n\t", u->numbers->value, sine, cosine);
	text_printf(out, "%s%s(", asks ? "all_small &= " : "", emit_sincos_name(e, u->numbers));
	unparse_angle(u, n->arg[0], out);
	if (asks)
		put_known(u, n->arg[0], out);
	text_printf(out, ", &%s, &%s)", sine, cosine);
}

/* The slot of an output in a window; -1: it has none. */
static int slot_of(const struct unparser *u, size_t output)
{
	const struct windows *w = &u->function->windows;

	return w->slots && !u->numbers->is_beside ? w->slot[output] : -1;
}

/* Over columns a constant is as many. */
static void put_stored(const struct unparser *u, struct ref value, struct text *out)
{
	int is_splat = u->is_over_columns && u->plan->dag->nodes[value.i].op == OP_CONST;

	text_put(out, is_splat ? u->numbers->splat : "");
	put_value(u, value, u->numbers->store_is_cast ? op_strength[OP_NEG] : 0, out);
	text_put(out, is_splat ? ")" : "");
}

/* What a relay's first kernel writes the next one reads, and it may stand in a slice; what loops leave for the last one is the
   thread's own. */
static int is_streamed(const struct unparser *u, const struct output *o)
{
	return emit_is_streamed(u->emission) && !emit_is_start(u->emission, u->function) && o->argument != DAG_REDUCED;
}

static void put_store(const struct unparser *u, size_t output, struct text *out)
{
	const struct output *o = &u->plan->dag->outputs[output];
	int slot = slot_of(u, output), is_call = slot >= 0 || (!u->numbers->is_beside && is_streamed(u, o));

	if (u->numbers->is_beside) {
		text_printf(out, "bound[%d]", unparse_first_bound(u->plan->dag, o->argument) + o->row);
	} else {
		text_put(out, slot >= 0 ? "RNEA_HOLD(" : is_call ? "RNEA_STORE(" : "");
		(u->loop ? unparse_element_each : unparse_element)(u, o->argument, o->row, out);
	}
	if (slot >= 0)
		text_printf(out, ", %d", slot);
	text_put(out, is_call ? ", " : " = ");
	put_around(&u->numbers->store, 0, out);
	put_stored(u, o->value, out);
	put_around(&u->numbers->store, 1, out);
	text_put(out, is_call ? ")" : "");
}

static void put_assignment(const struct unparser *u, struct ref a, struct text *out)
{
	const struct node *n = &u->plan->dag->nodes[a.i];

	if (u->loop && n->op >= OP_LANE0) {
		emit_put_leaving(u, a, out);
		return;
	}
	text_printf(out, "const %s %s = ", u->numbers->value, u->plan->names[a.i]);
	if (n->op == OP_INPUT)
		unparse_load(u, n, out);
	else
		put_expression(u, a, out);
}

/* Where a value stands between segments. */
static void put_slot(const struct unparser *u, const struct line *l, struct text *out)
{
	unparse_index(u->plan->dag->nodes[l->value.i].is_wide ? "wide_across" : "across", (unsigned)l->index, "step", out);
}

static void put_fetch(const struct unparser *u, const struct line *l, struct text *out)
{
	text_printf(out, "const %s %s = %s", u->numbers->value, u->plan->names[l->value.i], u->is_over_columns ? u->numbers->splat : "");
	put_slot(u, l, out);
	text_put(out, u->is_over_columns ? ")" : "");
}

static void put_statement(const struct unparser *u, const struct line *l, struct text *out)
{
	switch (l->kind) {
	case LINE_SINCOS:
		put_sincos(unparser_of(u, l->value), l->value, out);
		break;
	case LINE_STORE:
		put_store(u, l->index, out);
		break;
	case LINE_FETCH:
		put_fetch(unparser_of(u, l->value), l, out);
		break;
	case LINE_KEEP:
		put_slot(u, l, out);
		text_printf(out, " = %s", u->plan->names[l->value.i]);
		break;
	case LINE_SINE:
		text_printf(out, "const %s %s = sines[%zu]", u->numbers->value, u->plan->names[l->value.i], l->index);
		break;
	case LINE_JOIN:
		text_put(out, EMIT_JOIN "()");
		break;
	default:
		put_assignment(unparser_of(u, l->value), l->value, out);
	}
}

/* An angle that sines and cosines read where memory has it has no line. */
static int is_silent(const struct unparser *u, const struct line *l)
{
	if (u->zeros != ZEROS_AMONG && emit_is_zero_store(u->plan, l) != (u->zeros == ZEROS_ALONE))
		return 1;
	if (u->loop && l->kind == LINE_STORE) /* once for all limbs */
		return emit_is_later_limb(u, l);
	return l->kind == LINE_INPUT && u->angles && u->angles[l->value.i];
}

/* What must leave before a slot is taken again. */
static void put_flush_before(const struct unparser *u, const struct line *l, struct text *out)
{
	if (l->kind == LINE_STORE && slot_of(u, l->index) >= 0 && u->function->windows.before[l->index])
		emit_put_flush(u->emission, u->function, u->function->windows.before[l->index] - 1, out);
}

static void put_whole_line(struct unparser *u, const struct line *l, struct text *out)
{
	if (l->kind == LINE_SECTION && u->zeros == ZEROS_ALONE) {
		return;
	} else if (l->kind == LINE_SECTION) {
		unparse_section(u, &u->plan->dag->sections[l->index], out);
	} else if (!is_silent(u, l)) {
		put_flush_before(u, l, out);
		text_putc(out, '\t');
		put_statement(u, l, out);
		text_put(out, ";\n");
	}
}

static void put_line(struct unparser *u, const struct line *l, struct text *out)
{
	size_t from = out->length;
	struct text own;

	text_init(&own, u->emission->arena);
	put_whole_line(u, l, u->loop ? &own : out);
	if (u->loop)
		text_put_indented(out, text_string(&own));
	fold(out, from);
}

struct unparser unparse_new(const struct emission *e, const struct function *function, const struct number_type *numbers)
{
	return (struct unparser){.emission = e, .function = function, .plan = &function->plan, .numbers = numbers,
		.has_samples = e->is_transposed,
		.calls = e->options->strict ? numbers->strict_calls : numbers->calls};
}

void unparse_begin(struct writer *w, const struct emission *e, const struct function *function, const struct number_type *numbers)
{
	const struct number_type *wide = emit_wide(e);

	w->own = unparse_new(e, function, numbers);
	w->wide = unparse_new(e, function, wide ? wide : numbers);
	w->own.narrow = w->wide.narrow = &w->own;
	w->own.wide = w->wide.wide = wide ? &w->wide : NULL;
	if (emit_has_known(e)) {
		w->own.sines = emit_angles(e, function, 0);
		w->wide.sines = emit_angles(e, function, 1);
	}
}

void unparse_within(struct writer *w, const struct plan *lines)
{
	if (w->own.numbers->angle_is_memory)
		w->own.angles = readings_only_angles(lines, w->own.emission->arena);
}

void unparse_lines(struct writer *w, const struct plan *p, struct text *out)
{
	for (size_t i = 0; i < p->line_count; i++) {
		emit_each_before(&w->own, p, i, out);
		put_line(&w->own, &p->lines[i], out);
	}
	emit_each_before(&w->own, p, p->line_count, out);
}

void unparse(const struct emission *e, const struct function *function, const struct number_type *numbers, struct numbers *table,
	struct text *out)
{
	const char *unless = emit_zeros_unless(e, function, numbers->is_beside);
	struct writer w;

	unparse_begin(&w, e, function, numbers);
	unparse_within(&w, &function->plan);
	w.own.table = table;
	w.own.zeros = unless ? ZEROS_LEFT : ZEROS_AMONG;
	w.own.has_inner = tiles_are_inputs(function);
	unparse_lines(&w, &function->plan, out);
	if (function->windows.slots && !numbers->is_beside)
		emit_put_flush(e, function, function->windows.flush_count - 1, out);
	if (!unless)
		return;
	w.own.zeros = ZEROS_ALONE;
	text_printf(out, "#if %s\n", unless);
	unparse_lines(&w, &function->plan, out);
	text_put(out, "#endif\n");
}
