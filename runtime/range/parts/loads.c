#include "range/parts/loads.h"
#include <string.h>

enum { MANY = LOADS_LIMBS + 1 };

/* ---- where ---- */

int loads_total(const struct loads *l, uint32_t node)
{
	return dag_place(l->totals, l->total_count, node);
}

int loads_is_wrench(const struct loads *l, uint32_t node)
{
	return dag_place(l->wrenches, l->wrench_count, node) >= 0;
}

/* Force and moment of a body: of values with the same name the last, which has all in it. Returns how many of the six there are.
   */
static int list_wrench(const struct dag *d, int number, uint32_t *list)
{
	int count = 0;

	for (int k = 0; k < LOADS_WRENCH; k++)
		for (uint32_t i = (uint32_t)d->count; i-- > 1;) {
			const struct tag *tag = &d->nodes[i].tag;

			if (op_arity[d->nodes[i].op] && tag->body == number && tag->component == "xyz"[k % 3] &&
				!strcmp(tag->quantity, k < 3 ? "f" : "n")) {
				list[count++] = i;
				break;
			}
		}
	return count;
}

/* ---- is it such a sum ---- */

static unsigned char owner_of(const struct loads *l, uint32_t node)
{
	int place = dag_place(l->wrenches, l->wrench_count, node);

	for (int limb = 0; limb < l->limb_count && place >= 0; limb++)
		if (place < l->ends[limb])
			return (unsigned char)(1 + limb);
	return 0;
}

static unsigned char join(unsigned char a, unsigned char b)
{
	return !a || a == b ? b : !b ? a : MANY;
}

/* Returns 0 where wrenches are multiplied by each other, or something is done to one that sums of them do not allow. */
static int mark_node(struct loads *l, const struct dag *d, uint32_t i)
{
	const struct node *n = &d->nodes[i];
	unsigned char of[3] = {0}, all = 0, own = owner_of(l, i);
	int is_product = n->op == OP_MUL || n->op == OP_FMA;
	int is_linear = is_product || n->op == OP_ADD || n->op == OP_SUB || n->op == OP_NEG || n->op == OP_ANEW;

	for (int k = 0; k < op_arity[n->op]; k++)
		all = join(all, of[k] = l->of[n->arg[k].i]);
	l->of[i] = own ? own : all;
	return own ? !all || all == own : !all || (is_linear && !(is_product && of[0] && of[1]));
}

/* The nodes that force and moment are made of, into below[]. Returns 0 where one of them is made of another, or is a limb's. */
static int mark_below(const struct loads *l, const struct dag *d, unsigned char *below)
{
	for (int k = 0; k < l->total_count; k++) {
		memset(below, 0, d->count);
		below[l->totals[k]] = 1;
		dag_mark_operands(d, d->count, below);
		for (int j = 0; j < l->total_count; j++)
			if (loads_is_wrench(l, l->totals[k]) || (j != k && below[l->totals[j]]))
				return 0;
	}
	for (int k = 0; k < l->total_count; k++)
		below[l->totals[k]] = 1;
	dag_mark_operands(d, d->count, below);
	return 1;
}

int loads_find(struct loads *l, const struct dag *d, const struct tree *t, int carrier, const unsigned char *is_limb,
	struct arena *a)
{
	unsigned char *below = arena_alloc(a, d->count, 1);
	int is_sum;

	*l = (struct loads){.of = arena_alloc(a, d->count, 1)};
	if (!below || !l->of)
		return 0;
	l->total_count = list_wrench(d, t->bodies[carrier].number, l->totals);
	for (int b = 0; b < t->body_count; b++)
		if (t->bodies[b].parent == carrier && is_limb[b]) {
			int count;

			if (l->limb_count == LOADS_LIMBS)
				return 0;
			/* its numbers turn together: of a part of them the degree in the limb's angle is higher */
			count = list_wrench(d, t->bodies[b].number, l->wrenches + l->wrench_count);
			if (count < LOADS_WRENCH)
				return 0;
			l->wrench_count += count;
			l->ends[l->limb_count++] = l->wrench_count;
		}
	is_sum = l->limb_count && l->total_count && mark_below(l, d, below);
	for (uint32_t i = 1; i < d->count && is_sum; i++)
		is_sum = !below[i] || mark_node(l, d, i);
	return is_sum;
}

int loads_are_closed(const struct loads *l, const struct dag *d, unsigned char *reads)
{
	for (uint32_t i = (uint32_t)d->count; i-- > 1;) {
		if (reads[i] && loads_is_wrench(l, i))
			return 0;
		for (int k = 0; k < op_arity[d->nodes[i].op] && reads[i] && loads_total(l, i) < 0; k++)
			reads[d->nodes[i].arg[k].i] = 1;
	}
	return 1;
}

/* ---- what one adds ---- */

struct adding {
	const struct loads *l;
	const struct dag *d;
	struct dag *out;
	const struct ref *map;
	struct ref *part; /* by node: what of it the limb adds */
};

static struct ref part_of_product(const struct adding *s, struct ref a, struct ref b)
{
	if (s->l->of[a.i])
		return dag_mul(s->out, s->part[a.i], s->map[b.i]);
	return s->l->of[b.i] ? dag_mul(s->out, s->map[a.i], s->part[b.i]) : (struct ref){0};
}

static struct ref part_of(const struct adding *s, const struct node *n)
{
	const struct ref *part = s->part;

	switch (n->op) {
	case OP_NEG:
		return dag_neg(s->out, part[n->arg[0].i]);
	case OP_ADD:
		return dag_add(s->out, part[n->arg[0].i], part[n->arg[1].i]);
	case OP_SUB:
		return dag_sub(s->out, part[n->arg[0].i], part[n->arg[1].i]);
	case OP_MUL:
		return part_of_product(s, n->arg[0], n->arg[1]);
	case OP_FMA:
		return dag_add(s->out, part_of_product(s, n->arg[0], n->arg[1]), part[n->arg[2].i]);
	default:
		return part[n->arg[0].i];
	}
}

int loads_put(struct ref load[LOADS_WRENCH], const struct loads *l, int limb, const struct dag *d, struct dag *out,
	const struct ref *map, struct arena *a)
{
	struct adding s = {l, d, out, map, arena_alloc(a, d->count, sizeof *s.part)};

	if (!s.part)
		return 0;
	for (uint32_t i = 1; i < d->count; i++) {
		unsigned char owner = l->of[i] ? owner_of(l, i) : 0;

		if (owner)
			s.part[i] = owner == 1 + limb ? map[i] : (struct ref){0};
		else if (l->of[i])
			s.part[i] = part_of(&s, &d->nodes[i]);
	}
	for (int k = 0; k < l->total_count; k++)
		load[k] = s.part[l->totals[k]];
	return !out->failed;
}
