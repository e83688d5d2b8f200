#include "emit/kernels/emit_first_sines.h"
#include "base/fold.h"
#include "base/template.h"
#include "emit/unparse.h"
#include "plan/limbs/first_sines.h"

/* The row of angle i: rows follow each other, with a gap here and there, or are of two angles. */
static const char *row_text(const struct emission *e, const struct angles *list)
{
	int before = first_sines_row(list->dag, list->angle[0]);
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, "i");
	if (before)
		text_printf(&t, " + %d", before);
	for (int i = 1; i < list->count; i++) {
		int row = first_sines_row(list->dag, list->angle[i]), gap = row - before - 1;

		before = row;
		if (gap)
			text_printf(&t, " %c (i >= %d ? %d : 0)", gap < 0 ? '-' : '+', i, gap < 0 ? -gap : gap);
	}
	return text_string(&t);
}

/* An angle that is not its input itself. */
static const char *angle_text(const struct emission *e, const struct function *p)
{
	const struct angles *list = &p->limbs.first;
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < list->count; i++)
		if (list->dag->nodes[list->angle[i].i].op != OP_INPUT) {
			text_printf(&t, "i == %d ? ", i);
			unparse_angle_of(e, p, list->angle[i], "x", &t);
			text_put(&t, " : ");
		}
	text_put(&t, "x");
	return text_string(&t);
}

void emit_put_table(const struct emission *e, const struct function *p, struct text *out)
{
	const struct number_type *n = e->numbers;
	const struct angles *list = &p->limbs.first;
	size_t from = out->length;

	if (!list->count)
		return;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"T", n->value},
		{"M", e->memory->type}, {"X", n->angle_is_memory ? n->memory->type : n->value}, {"ROW", row_text(e, list)},
		{"X_OF", angle_text(e, p)}, {"ANGLES", emit_int(e, list->count)}, {"LAST", emit_int(e, list->count - 1)},
		{"PITCH", emit_int(e, p->limbs.words)}, {"FIRST", emit_int(e, p->limbs.slots)}, {"SINCOS", n->sincos}};

	template_expand(out, template_limb_table_in, slots, sizeof slots / sizeof *slots);
	fold(out, from);
}

const char *emit_table_param(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	if (p->limbs.first.count)
		text_printf(&t, ", const %s *const sines", e->numbers->value);
	return text_string(&t);
}

const char *emit_table_arguments(const struct emission *e)
{
	int rows = e->options->layout == RNEAGEN_SOA && !e->is_transposed ? 1 : emit_main(e)->dag.arguments[0].rows;
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, "q + begin");
	if (rows != 1)
		text_printf(&t, "*%d", rows);
	text_printf(&t, ", %s, %d, here, %s_across", emit_q_stride(e), rows, e->options->name);
	return text_string(&t);
}
