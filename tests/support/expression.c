#include "support/expression.h"
#include <check.h>
#include <stdlib.h>
#include <string.h>

static const char INPUTS[] = "xyzw", OPS[] = "+-*nscf";
static const enum op OP_OF[] = {OP_ADD, OP_SUB, OP_MUL, OP_NEG, OP_SIN, OP_COS, OP_FMA};

void expression_init(struct dag *d, struct arena *a)
{
	dag_init(d, a);
	dag_argument(d, "in", 4, 0);
	dag_argument(d, "out", 16, 1);
	for (int i = 0; i < 4; i++)
		dag_input(d, 0, i);
}

static struct ref apply(struct dag *d, enum op op, const struct ref *a)
{
	switch (op) {
	case OP_ADD:
		return dag_add(d, a[0], a[1]);
	case OP_SUB:
		return dag_sub(d, a[0], a[1]);
	case OP_MUL:
		return dag_mul(d, a[0], a[1]);
	case OP_NEG:
		return dag_neg(d, a[0]);
	case OP_SIN:
		return dag_sin(d, a[0]);
	case OP_COS:
		return dag_cos(d, a[0]);
	default:
		return dag_fma(d, a[0], a[1], a[2]);
	}
}

static struct ref parse(struct dag *d, const char **s)
{
	struct ref args[3] = {{0}};
	const char *at;
	char *end;
	real value;

	*s += strspn(*s, " ");
	at = strchr(INPUTS, **s);
	if (**s && at) {
		++*s;
		return dag_input(d, 0, (int)(at - INPUTS));
	}
	at = strchr(OPS, **s);
	if (**s && at && ((*s)[1] == ' ')) {
		enum op op = OP_OF[at - OPS];

		++*s;
		for (int i = 0; i < op_arity[op]; i++)
			args[i] = parse(d, s);
		return apply(d, op, args);
	}
	value = strtold(*s, &end);
	ck_assert_msg(end != *s, "expression at '%s'", *s);
	*s = end;
	return dag_const(d, value);
}

struct ref expression_build(struct dag *d, const char *text)
{
	struct ref last = {0};

	for (int row = 0; *text; row++) {
		last = parse(d, &text);
		dag_output(d, 1, row, last);
		text += strspn(text, " ");
		ck_assert_msg(*text == ';' || !*text, "expression at '%s'", text);
		text += *text == ';';
	}
	return last;
}

void expression_print(const struct dag *d, struct ref a, struct text *t)
{
	const struct node *n = &d->nodes[a.i];

	if (n->op == OP_CONST) {
		text_printf(t, "%.21Lg", n->value);
	} else if (n->op == OP_INPUT) {
		text_putc(t, INPUTS[n->arg[1].i]);
	} else {
		for (size_t i = 0; i < sizeof OP_OF / sizeof *OP_OF; i++)
			if (OP_OF[i] == n->op)
				text_putc(t, OPS[i]);
		for (int i = 0; i < op_arity[n->op]; i++) {
			text_putc(t, ' ');
			expression_print(d, n->arg[i], t);
		}
	}
}

void expression_print_outputs(const struct dag *d, struct text *t)
{
	for (size_t i = 0; i < d->output_count; i++) {
		text_put(t, i ? "; " : "");
		expression_print(d, d->outputs[i].value, t);
	}
}
