#include "plan/lanes/angles.h"

struct angles angles_of(const struct plan *p, int is_wide, struct arena *a)
{
	struct angles list = {.dag = p->dag, .angle = arena_alloc(a, plan_sincos(p), sizeof *list.angle)};

	for (size_t i = 0; list.angle && i < p->line_count; i++) {
		const struct node *n = &p->dag->nodes[p->lines[i].value.i];

		if (p->lines[i].kind == LINE_SINCOS && (int)n->is_wide == is_wide)
			list.angle[list.count++] = n->arg[0];
	}
	return list;
}

/* A DAG, in the turn of its loops for a limb. */
struct each_turn {
	const struct dag *d;
	const struct each *loops;
	int limb;
};

static int is_same_leaf(const struct node *x, const struct node *y, const struct each_turn *t)
{
	int loop = y->op == OP_INPUT ? dag_loop_of(y) : 0;

	if (y->op == OP_INPUT)
		return x->arg[0].i == y->arg[0].i && x->arg[1].i == y->arg[1].i + (loop ? (uint32_t)(t->limb * t->loops->shift[loop]) : 0);
	return x->value == (y->arg[0].i ? t->d->lanes[y->arg[0].i - 1].x[t->limb] : y->value);
}

static int is_same(const struct dag *d, struct ref a, const struct each_turn *t, struct ref b)
{
	const struct node *x = &d->nodes[a.i], *y = &t->d->nodes[b.i];
	int same = x->op == y->op;

	if (same && !op_arity[x->op])
		return is_same_leaf(x, y, t);
	for (int k = 0; same && k < op_arity[x->op]; k++)
		same = is_same(d, x->arg[k], t, y->arg[k]);
	return same;
}

int angles_place(const struct angles *list, const struct dag *d, struct ref angle, const struct each *loops, int limb)
{
	const struct each_turn turn = {d, loops, limb};

	for (int i = 0; i < list->count; i++)
		if (list->dag == d ? list->angle[i].i == angle.i : is_same(list->dag, list->angle[i], &turn, angle))
			return i;
	return -1;
}
