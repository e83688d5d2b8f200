/* Texts whose numbers are pairs of floats: calls instead of operators. */
#include "emit/emit.h"
#include "emit/template.h"

/* The constant's float, and what the float leaves of it. */
static void put_constant(const struct emission *e, real value, struct text *out)
{
	float hi = (float)value;

	text_put(out, "rneagen_pair(");
	emit_number(e, e->arithmetic->part, value, out);
	text_put(out, ", ");
	emit_number(e, e->arithmetic->part, value - (real)hi, out);
	text_putc(out, ')');
}

static int is_float(const struct plan *p, struct ref a)
{
	const struct node *n = &p->dag->nodes[a.i];

	return n->op == OP_CONST && (real)(float)n->value == n->value;
}

/* A name, or an expression. */
static void put_value(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	if (p->names[a.i])
		text_put(out, p->names[a.i]);
	else
		emit_f32x2_expression(e, p, a, out);
}

/* A product with a constant that is a float costs less. */
static int put_product_by_float(const struct emission *e, const struct plan *p, const struct node *n, struct text *out)
{
	int k = is_float(p, n->arg[1]) ? 1 : 0;

	if (n->op != OP_MUL || !is_float(p, n->arg[k]))
		return 0;
	text_put(out, "rneagen_mul_f(");
	put_value(e, p, n->arg[1 - k], out);
	text_put(out, ", ");
	emit_number(e, e->arithmetic->part, p->dag->nodes[n->arg[k].i].value, out);
	text_putc(out, ')');
	return 1;
}

static void put_call(const struct emission *e, const struct plan *p, const struct node *n, struct text *out)
{
	if (put_product_by_float(e, p, n, out))
		return;
	text_printf(out, "rneagen_%s(", emit_operation[n->op]);
	for (int k = 0; k < op_arity[n->op]; k++) {
		text_put(out, k ? ", " : "");
		put_value(e, p, n->arg[k], out);
	}
	text_putc(out, ')');
}

void emit_f32x2_expression(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];

	if (n->op == OP_CONST)
		put_constant(e, n->value, out);
	else if (emit_operation[n->op])
		put_call(e, p, n, out);
	else /* inputs, sines and cosines have names */
		out->failed = 1;
}

/* Sine and cosine of a large angle need all of its bits: they take a double. */
void emit_f32x2_angle(const struct emission *e, const struct plan *p, struct ref a, struct text *out)
{
	const struct node *n = &p->dag->nodes[a.i];

	if (n->op == OP_INPUT) {
		text_printf(out, "%s[%u*stride]", p->dag->arguments[n->arg[0].i].name, (unsigned)n->arg[1].i);
		return;
	}
	text_put(out, "rneagen_join(");
	put_value(e, p, a, out);
	text_putc(out, ')');
}

const unsigned char *emit_f32x2_angles(const struct emission *e, const struct plan *p)
{
	const struct dag *d = p->dag;
	uint32_t *uses = e->arithmetic->part ? arena_alloc(e->arena, d->count, sizeof *uses) : NULL;
	unsigned char *is_angle = uses ? arena_alloc(e->arena, d->count, 1) : NULL;

	if (!is_angle)
		return NULL;
	dag_uses(d, uses);
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		if (uses[i] && (n->op == OP_SIN || n->op == OP_COS) && d->nodes[n->arg[0].i].op == OP_INPUT)
			is_angle[n->arg[0].i] = --uses[n->arg[0].i] == 0;
	}
	return is_angle;
}

void emit_f32x2(const struct emission *e, struct text *out)
{
	if (!e->arithmetic->part)
		return;
	text_put(out, template_f32x2_in);
	if (e->request->friction_width.x > 0)
		text_put(out, template_f32x2_friction_in);
	text_putc(out, '\n');
}
