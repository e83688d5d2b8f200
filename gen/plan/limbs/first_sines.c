#include "plan/limbs/first_sines.h"
#include "plan/readings.h"
#include <string.h>

struct ref first_sines_input(const struct dag *d, struct ref angle)
{
	const struct node *n = &d->nodes[angle.i];
	struct ref found = {0};

	if (n->op == OP_INPUT)
		return n->arg[0].i == 0 && !d->arguments[0].per_batch ? angle : found;
	for (int k = 0; k < op_arity[n->op]; k++) {
		struct ref input = first_sines_input(d, n->arg[k]);

		if (d->nodes[n->arg[k].i].op == OP_CONST)
			continue;
		if (!input.i || (found.i && found.i != input.i))
			return (struct ref){0};
		found = input;
	}
	return found;
}

static uint32_t row_of(const struct dag *d, struct ref angle)
{
	return d->nodes[first_sines_input(d, angle).i].arg[1].i;
}

/* Those of a row in the order of the plan. */
static void insert(struct angles *list, struct ref angle)
{
	int at = list->count++;

	for (; at > 0 && row_of(list->dag, list->angle[at - 1]) > row_of(list->dag, angle); at--)
		list->angle[at] = list->angle[at - 1];
	list->angle[at] = angle;
}

static int find_angles(struct angles *list, const struct plan *p, struct arena *a)
{
	*list = (struct angles){.dag = p->dag, .angle = arena_alloc(a, p->line_count + 1, sizeof *list->angle)};
	for (size_t i = 0; list->angle && i < p->line_count; i++) {
		struct ref angle = p->dag->nodes[p->lines[i].value.i].arg[0];

		if (p->lines[i].kind != LINE_SINCOS)
			continue;
		if (!first_sines_input(p->dag, angle).i)
			return 0;
		insert(list, angle);
	}
	return list->count > 0 && !a->failed;
}

static void put_sines(struct plan *out, const struct angles *list, const struct line *l)
{
	struct ref made[2], angle = list->dag->nodes[l->value.i].arg[0];
	int count = readings_made(out, l, made), place = 0;

	while (list->angle[place].i != angle.i)
		place++;
	for (int k = 0; k < count; k++)
		out->lines[out->line_count++] = (struct line){LINE_SINE, made[k],
			2 * (size_t)place + (list->dag->nodes[made[k].i].op == OP_COS)};
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
