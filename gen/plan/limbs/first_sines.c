#include "plan/limbs/first_sines.h"
#include "plan/lanes/angles.h"
#include "plan/readings.h"

/* The input that an angle is made of; 0: it is made of several, of an input that all samples share, or of none. */
static struct ref input_of(const struct dag *d, struct ref angle)
{
	const struct node *n = &d->nodes[angle.i];
	struct ref found = {0};

	if (n->op == OP_INPUT)
		return n->arg[0].i == 0 && !d->arguments[0].per_batch ? angle : found;
	for (int k = 0; k < op_arity[n->op]; k++) {
		struct ref input = input_of(d, n->arg[k]);

		if (d->nodes[n->arg[k].i].op == OP_CONST)
			continue;
		if (!input.i || (found.i && found.i != input.i))
			return (struct ref){0};
		found = input;
	}
	return found;
}

int first_sines_row(const struct dag *d, struct ref angle)
{
	return (int)d->nodes[input_of(d, angle).i].arg[1].i;
}

/* Those of a row in the order of the plan. */
static void sort_by_rows(struct angles *list)
{
	for (int i = 1; i < list->count; i++) {
		struct ref angle = list->angle[i];
		int at = i, row = first_sines_row(list->dag, angle);

		for (; at > 0 && first_sines_row(list->dag, list->angle[at - 1]) > row; at--)
			list->angle[at] = list->angle[at - 1];
		list->angle[at] = angle;
	}
}

static int find_angles(struct angles *list, const struct plan *p, struct arena *a)
{
	*list = angles_of(p, 0, a);
	for (int i = 0; i < list->count; i++)
		if (!input_of(p->dag, list->angle[i]).i)
			return 0;
	sort_by_rows(list);
	return list->count > 0;
}

static void put_sines(struct plan *out, const struct angles *list, const struct line *l)
{
	struct ref made[2];
	int count = readings_made(out, l, made), place = angles_place(list, list->dag, list->dag->nodes[l->value.i].arg[0], NULL, 0);

	for (int k = 0; k < count; k++)
		plan_add_line(out, LINE_SINE, made[k], 2 * (size_t)place + (list->dag->nodes[made[k].i].op == OP_COS));
}

/* Leave out lines whose value no line reads any more. Returns how many. */
static size_t strike(struct plan *p, struct arena *a)
{
	struct readings r;
	size_t kept = 0, before = p->line_count;

	if (!readings_make(&r, p, a))
		return 0;
	for (size_t i = 0; i < before; i++) {
		struct line l = p->lines[i];

		if (l.kind != LINE_VALUE || r.last[l.value.i] != i)
			p->lines[kept++] = l;
	}
	readings_free(&r, a);
	p->line_count = kept;
	return before - kept;
}

int first_sines_make(struct plan *out, struct angles *list, const struct plan *p, struct arena *a)
{
	struct angles found;
	struct plan with = *p;

	if (!find_angles(&found, p, a))
		return 0;
	with.lines = arena_take(a, 2 * p->line_count, sizeof *with.lines);
	with.line_count = 0;
	for (size_t i = 0; with.lines && i < p->line_count; i++)
		if (p->lines[i].kind == LINE_SINCOS)
			put_sines(&with, &found, &p->lines[i]);
		else
			with.lines[with.line_count++] = p->lines[i];
	while (!a->failed && strike(&with, a))
		;
	if (a->failed)
		return 0;
	*out = with;
	*list = found;
	return 1;
}
