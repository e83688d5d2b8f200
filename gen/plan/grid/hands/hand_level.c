/* What the kernel of a level makes, and what it leaves. */
#include "plan/grid/hands/finder.h"
#include <string.h>

/* The hand that writes a row of an output, the first that has it; -1: none does. */
static int hand_of(const struct hands *h, const struct tree *t, int of)
{
	int body = -1, row = of % t->nv;

	for (int k = 0; k < t->body_count && body < 0; k++)
		if (joint_nv(t->bodies[k].type) && t->bodies[k].iv <= row && row < t->bodies[k].iv + joint_nv(t->bodies[k].type))
			body = k;
	for (int i = 0; i < h->count; i++)
		if (h->list[i].first <= body && body <= h->list[i].last)
			return i;
	return -1;
}

int finder_share(struct finder *f, struct hand_level *level, int begin)
{
	struct hands *h = f->h;
	const struct dag *d = f->d;
	size_t most = d->output_count + (size_t)(h->count - begin) * CUT_MOST;
	struct output *outputs = arena_alloc(f->a, most, sizeof *outputs);

	level->owner = arena_alloc(f->a, most, sizeof *level->owner);
	if (!outputs || !level->owner)
		return 0;
	level->first = *d;
	level->first.outputs = memcpy(outputs, d->outputs, d->output_count * sizeof *outputs);
	for (size_t i = 0; i < d->output_count; i++)
		level->owner[i] = f->is_felt ? -1 : hand_of(h, f->x->tree, d->outputs[i].row);
	for (int k = begin; k < h->count; k++)
		for (int i = 0; i < h->list[k].cut.count; i++) {
			level->owner[level->first.output_count] = k;
			outputs[level->first.output_count++] =
				(struct output){parts_handed(d), h->list[k].rows[i], {h->list[k].cut.nodes[i]}};
		}
	return 1;
}

/* The name that a number has once it is read: what the base feels of limbs has none. */
static struct tag tag_of(const struct finder *f, const struct node *n, int number)
{
	return f->is_felt && !*n->tag.quantity ? (struct tag){.quantity = "sum", .body = number} : n->tag;
}

int finder_rest(struct finder *f, struct hand_level *level, int begin)
{
	const struct hands *h = f->h;
	const struct dag *d = f->d;
	struct dag read = *d;
	struct share share;

	read.nodes = arena_take(f->a, d->count, sizeof *read.nodes);
	if (!read.nodes)
		return 0;
	memcpy(read.nodes, d->nodes, d->count * sizeof *read.nodes);
	for (int k = begin; k < h->count; k++)
		for (int i = 0; i < h->list[k].cut.count; i++) {
			struct node *n = &read.nodes[h->list[k].cut.nodes[i]];

			*n = (struct node){.op = OP_INPUT, .arg = {{(uint32_t)parts_handed(d)}, {(uint32_t)h->list[k].rows[i]}},
				.tag = tag_of(f, n, 1 + i)};
		}
	if (!share_begin(&share, &read, level->owner, f->a))
		return 0;
	share_copy(&share, -1, 0, &level->rest, f->a);
	share_end(&share, f->a);
	arena_release(f->a, read.nodes);
	return !level->rest.failed;
}
