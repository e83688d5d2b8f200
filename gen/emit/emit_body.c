#include "emit/emit.h"
#include "base/number.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WRAP_COLUMN = 100 };

/* The decimal with the fewest digits that the target reads back as the same number. */
static void write_number(double value, int f32, struct written_number *w)
{
	struct number_text t = f32 ? number_shortest_float((float)value) : number_shortest(value);

	snprintf(w->s, sizeof w->s, "%s%s%s", t.s, strpbrk(t.s, ".e") ? "" : ".0", f32 ? "f" : "");
}

/* Where such a number is written, if it is. */
static struct written_number *place_of(const struct emission *e, double value)
{
	uint64_t bits;

	memcpy(&bits, &value, sizeof bits);
	return &e->written[bits * 0x9e3779b97f4a7c15u >> 32 & (EMIT_WRITTEN - 1)];
}

void emit_number(const struct emission *e, const struct scalar *type, real value, struct text *out)
{
	int f32 = type->bytes == 4;
	double rounded = f32 ? (double)(float)value : (double)value;
	struct written_number here, *w;

	if (!isfinite(rounded)) {
		error_set(e->error, RNEAGEN_NUMBER, "%s: a constant of the model, %.6Lg, is no finite number in %s",
			e->options->file, value, f32 ? "f32; take --precision f64, or mixed, whose constants are f64" : "f64");
		rounded = 0;
	}
	w = e->written ? place_of(e, rounded) : &here;
	if (!e->written || w->type != type || w->value != rounded || signbit(w->value) != signbit(rounded)) {
		w->type = type;
		w->value = rounded;
		write_number(rounded, f32, w);
	}
	text_put(out, w->s);
}

static void put_expression(const struct emission *e, const struct plan *p, struct ref a, struct text *out);

/* What an operation is written as, called with its operands; NULL: with a sign between them. */
static const char *call_of(const struct emission *e, enum op op)
{
	static const char *const strict[OP_COUNT] = {[OP_ADD] = "RNEA_ADD", [OP_SUB] = "RNEA_SUB", [OP_MUL] = "RNEA_MUL",
		[OP_DIV] = "RNEA_DIV", [OP_SQRT] = "RNEA_SQRT"};

	if (op == OP_SQRT && !e->options->strict)
		return e->arithmetic->bytes == 4 ? "sqrtf" : "sqrt";
	return op == OP_FMA ? "RNEA_FMA" : e->options->strict ? strict[op] : NULL;
}

/* Binding strength of what put_value writes for a node. */
static int strength(const struct emission *e, const struct plan *p, struct ref a)
{
	const struct node *n = &p->dag->nodes[a.i];

	if (p->names[a.i])
		return op_strength[OP_INPUT];
	if (n->op == OP_CONST && signbit(n->value))
		return op_strength[OP_NEG];
	return op_strength[call_of(e, n->op) ? OP_FMA : n->op];
}

/* A name, a number, or the expression itself, in parentheses where it binds less than `least`. */
static void put_value(const struct emission *e, const struct plan *p, struct ref a, int least, struct text *out)
{
	int enclose = strength(e, p, a) < least;

	if (enclose)
		text_putc(out, '(');
	if (p->names[a.i])
		text_put(out, p->names[a.i]);
	else
		put_expression(e, p, a, out);
	if (enclose)
		text_putc(out, ')');
}

static void put_binary(const struct emission *e, const struct plan *p, const struct node *n, const char *sign,
	struct text *out)
{
	int own = op_strength[n->op];

	put_value(e, p, n->arg[0], own, out);
	text_put(out, sign);
	put_value(e, p, n->arg[1], own + 1, out); /* no re-association: a - (b - c), a*(b*c) */
}

static void put_call(const struct emission *e, const struct plan *p, const struct node *n, struct text *out)
{
	text_printf(out, "%s(", call_of(e, n->op));
	for (int k = 0; k < op_arity[n->op]; k++) {
		text_put(out, k ? ", " : "");
		put_value(e, p, n->arg[k], 0, out);
	}
	text_putc(out, ')');
}

static void put_expression(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];

	if (e->arithmetic->part) {
		emit_f32x2_expression(e, p, a, out);
		return;
	}
	if (call_of(e, n->op)) {
		put_call(e, p, n, out);
		return;
	}
	switch (n->op) {
	case OP_CONST:
		emit_number(e, e->arithmetic, n->value, out);
		break;
	case OP_NEG:
		text_putc(out, '-');
		put_value(e, p, n->arg[0], op_strength[OP_NEG] + 1, out);
		break;
	case OP_ADD:
		put_binary(e, p, n, " + ", out);
		break;
	case OP_SUB:
		put_binary(e, p, n, " - ", out);
		break;
	case OP_MUL:
		put_binary(e, p, n, "*", out);
		break;
	case OP_DIV:
		put_binary(e, p, n, "/", out);
		break;
	default: /* inputs, sines and cosines have names */
		out->failed = 1;
	}
}

/* Append a statement, breaking it after a comma or an operator where it grows past the margin. */
void emit_wrapped(struct text *out, const char *statement)
{
	size_t column = 8;

	text_putc(out, '\t');
	for (const char *s = statement; *s; s++) {
		text_putc(out, *s);
		column++;
		if (column > WRAP_COLUMN && s[0] == ',' && s[1] == ' ') {
			text_put(out, "\n\t\t");
			column = 16;
			s++;
		}
	}
	text_putc(out, '\n');
}

static void put_sincos(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];
	struct ref s = n->op == OP_SIN ? a : plan_partner(p, a, OP_SIN), c = n->op == OP_COS ? a : plan_partner(p, a, OP_COS);
	char unused[80];
	const char *sine = p->names[s.i], *cosine = p->names[c.i];

	snprintf(unused, sizeof unused, "unused_%s", sine ? sine : cosine);
	sine = sine ? sine : unused;
	cosine = cosine ? cosine : unused;
	text_printf(out, "\t%s %s, %s;\n", e->arithmetic->type, sine, cosine);
	text_printf(out, "\t%srneagen_%ssincos%s_%s(", emit_has_small(e) ? "all_small &= " : "",
		e->options->strict ? "strict_" : "", emit_sincos_suffix(e),
		emit_has_small(e) ? "either" : emit_trig_name(emit_trig_of(e->options)));
	if (e->arithmetic->part)
		emit_f32x2_angle(e, p, n->arg[0], out);
	else
		put_value(e, p, n->arg[0], 0, out);
	text_printf(out, "%s, &%s, &%s);\n", emit_has_small(e) ? ", small" : "", sine, cosine);
}

/* Of sections that are about no body. */
static const char *const SECTION_TITLES[SECTION_COUNT] = {[SECTION_END] = "torques of joints that others mimic",
	[SECTION_FREED] = "what the scene frees", [SECTION_TOTALS] = "power and energies",
	[SECTION_BIAS] = "from here on without accelerations: torques of gravity and velocities",
	[SECTION_GRAVITY] = "from here on at rest: torques of gravity",
	[SECTION_PRODUCTS] = "derivatives times vectors, and by what is freed"};

/* "out to link 2 "lower" (fpass)"; "back from link 2 "lower" to link 1 (bpass): torque of "elbow"" */
void emit_section(const struct emission *e, const struct pass *pass, const struct section *s, struct text *out)
{
	const struct body *k = &e->tree->bodies[s->body];

	if (emit_is_operation(e))
		return;
	if (SECTION_TITLES[s->kind]) {
		text_printf(out, "\n\t/* ---- %s ---- */\n", SECTION_TITLES[s->kind]);
		return;
	}
	if (s->kind == SECTION_BY) {
		text_put(out, "\n\t/* ---- derivatives by \"");
		text_put_comment(out, *k->joint ? k->joint : "base");
		text_put(out, "\" ---- */\n");
		return;
	}
	text_printf(out, "\n\t/* ---- %s link %d \"", s->kind == SECTION_OUT ? "out to" : "back from", k->number);
	text_put_comment(out, k->link);
	text_putc(out, '"');
	if (s->kind == SECTION_OUT) {
		text_put(out, dag_find_role(&pass->dag, ROLE_BODY_WRENCHES, 0) >= 0 ? "" : " (fpass)");
	} else {
		if (k->parent < 0)
			text_put(out, " to the world (bpass)");
		else
			text_printf(out, " to link %d (bpass)", e->tree->bodies[k->parent].number);
		if (*k->joint) {
			text_put(out, k->type == JOINT_FIXED ? ": held at \"" : k->follower ? ": share of the driver of \"" : ": torque of \"");
			text_put_comment(out, k->joint);
			text_putc(out, '"');
		}
	}
	text_put(out, " ---- */\n");
}

static void put_store(const struct emission *e, const struct plan *p, const struct output *o, struct text *out)
{
	int streamed = emit_is_streamed(e);

	text_printf(out, streamed ? "RNEA_STORE(%s[%d*stride], " : "%s[%d*stride] = ", p->dag->arguments[o->argument].name, o->row);
	if (e->arithmetic->part)
		text_put(out, "rneagen_join(");
	else if (emit_converts(e))
		text_printf(out, "(%s)", e->memory->type);
	put_value(e, p, o->value, emit_converts(e) && !e->arithmetic->part ? op_strength[OP_NEG] : 0, out);
	text_put(out, e->arithmetic->part ? ")" : "");
	text_put(out, streamed ? ");" : ";");
}

static void put_load(const struct emission *e, const struct plan *p, const struct node *n, struct text *out)
{
	if (e->arithmetic->part)
		text_put(out, "rneagen_split(");
	else if (emit_converts(e))
		text_printf(out, "(%s)", e->arithmetic->type);
	text_printf(out, p->dag->arguments[n->arg[0].i].per_batch ? "%s[%u]" : "%s[%u*stride]",
		p->dag->arguments[n->arg[0].i].name, (unsigned)n->arg[1].i);
	text_put(out, e->arithmetic->part ? ")" : "");
}

static void put_assignment(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];

	text_printf(out, "const %s %s = ", e->arithmetic->type, p->names[a.i]);
	if (n->op == OP_INPUT)
		put_load(e, p, n, out);
	else
		put_expression(e, p, a, out);
	text_putc(out, ';');
}

/* A store or an assignment; `statement` is room for it. */
static void put_statement(const struct emission *e, const struct plan *p, const struct line *l, struct text *statement, struct text *out)
{
	text_clear(statement);
	if (l->kind == LINE_STORE)
		put_store(e, p, &p->dag->outputs[l->index], statement);
	else
		put_assignment(e, p, l->value, statement);
	out->failed |= statement->failed;
	emit_wrapped(out, text_string(statement));
}

/* An argument of which nothing is read or written would be an unused parameter. */
static void put_unused_arguments(const struct plan *p, int has_small, struct text *out)
{
	const struct dag *d = p->dag;

	for (int i = 0; i < d->argument_count; i++) {
		int used = 0;

		for (size_t k = 0; k < d->output_count && !used; k++)
			used = d->outputs[k].argument == i;
		for (size_t k = 0; k < d->count && !used; k++)
			used = d->nodes[k].op == OP_INPUT && d->nodes[k].arg[0].i == (uint32_t)i;
		if (!used)
			text_printf(out, "\t(void)%s;\n", d->arguments[i].name);
	}
	if (has_small && !plan_operations(p).sincos)
		text_put(out, "\t(void)small;\n");
}

void emit_body(const struct emission *e, const struct pass *pass, struct text *out)
{
	const struct plan *p = &pass->plan;
	const unsigned char *angles = emit_f32x2_angles(e, p);
	struct text statement;

	text_init(&statement, e->arena);
	put_unused_arguments(p, emit_has_small(e), out);
	if (emit_has_small(e))
		text_put(out, "\tint all_small = 1;\n");
	for (size_t i = 0; i < p->line_count; i++) {
		const struct line *l = &p->lines[i];

		switch (l->kind) {
		case LINE_SECTION:
			emit_section(e, pass, &p->dag->sections[l->index], out);
			break;
		case LINE_SINCOS:
			put_sincos(e, p, l->value, out);
			break;
		default:
			if (l->kind == LINE_STORE || !angles || !angles[l->value.i])
				put_statement(e, p, l, &statement, out);
		}
	}
	if (emit_has_small(e))
		text_put(out, "\treturn all_small;\n");
}
