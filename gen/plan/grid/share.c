#include "plan/grid/share.h"
#include <string.h>

enum { TOGETHER = 8 }; /* nodes that are passed over at once where none is live */

int share_begin(struct share *x, const struct dag *whole, const int *owner, struct arena *a)
{
	*x = (struct share){.whole = whole, .owner = owner};
	x->live = arena_alloc(a, whole->count + TOGETHER, 1);
	x->place = arena_take(a, whole->count, sizeof *x->place);
	return x->live && x->place;
}

void share_end(struct share *x, struct arena *a)
{
	arena_release(a, x->place);
	arena_release(a, x->live);
}

static int is_chosen(const struct share *x, size_t output, int first, int end)
{
	return x->owner[output] >= first && x->owner[output] < end;
}

static int any_live(const struct share *x, size_t first)
{
	static const unsigned char none[TOGETHER];

	return memcmp(x->live + first, none, TOGETHER) != 0;
}

/* What the outputs take, the last node first. Returns the number of nodes; node 0 is one of them. */
static size_t mark(struct share *x, int first, int end)
{
	const struct dag *d = x->whole;
	size_t count = 0;

	memset(x->live, 0, d->count + TOGETHER);
	for (size_t i = 0; i < d->output_count; i++)
		if (is_chosen(x, i, first, end))
			x->live[d->outputs[i].value.i] = 1;
	x->live[0] = 1;
	for (size_t i = d->count; i-- > 0;) {
		if (i % TOGETHER == TOGETHER - 1 && !any_live(x, i + 1 - TOGETHER)) {
			i -= TOGETHER - 1;
			continue;
		}
		count += x->live[i];
		for (int k = 0; k < op_arity[d->nodes[i].op] && x->live[i]; k++)
			x->live[d->nodes[i].arg[k].i] = 1;
	}
	return count;
}

/* A section begins where its first live node stands. */
static void copy_nodes(struct share *x, struct dag *out)
{
	const struct dag *d = x->whole;
	size_t section = 0;

	for (size_t i = 0; i < d->count; i++) {
		for (; section < d->section_count && d->sections[section].node <= i; section++)
			out->sections[section].node = (uint32_t)out->count;
		if (i % TOGETHER == 0 && !any_live(x, i) &&
			(section == d->section_count || d->sections[section].node >= i + TOGETHER)) {
			i += TOGETHER - 1;
			continue;
		}
		if (!x->live[i])
			continue;
		x->place[i] = (uint32_t)out->count;
		out->nodes[out->count] = d->nodes[i];
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			out->nodes[out->count].arg[k].i = x->place[d->nodes[i].arg[k].i];
		out->count++;
	}
	for (; section < d->section_count; section++)
		out->sections[section].node = (uint32_t)out->count;
}

static void copy_outputs(const struct share *x, int first, int end, struct dag *out)
{
	const struct dag *d = x->whole;
	size_t section = 0;

	for (size_t i = 0; i <= d->output_count; i++) {
		for (; section < d->section_count && d->sections[section].output <= i; section++)
			out->sections[section].output = out->output_count;
		if (i < d->output_count && is_chosen(x, i, first, end))
			out->outputs[out->output_count++] = (struct output){
				d->outputs[i].argument, d->outputs[i].row, {x->place[d->outputs[i].value.i]}};
	}
}

void share_copy(struct share *x, int first, int end, struct dag *out, struct arena *a)
{
	const struct dag *d = x->whole;

	*out = *d;
	out->arena = a;
	out->table = NULL;
	out->count = out->output_count = 0;
	out->nodes = arena_take(a, mark(x, first, end), sizeof *out->nodes);
	out->outputs = arena_take(a, d->output_count, sizeof *out->outputs);
	out->sections = arena_take(a, d->section_count, sizeof *out->sections);
	out->numbers = arena_take(a, d->number_count, sizeof *out->numbers);
	if (!out->nodes || !out->outputs || !out->sections || !out->numbers) {
		out->failed = 1;
		return;
	}
	out->number_capacity = d->number_count;
	if (d->number_count)
		memcpy(out->numbers, d->numbers, d->number_count * sizeof *d->numbers);
	memcpy(out->sections, d->sections, d->section_count * sizeof *d->sections);
	copy_nodes(x, out);
	copy_outputs(x, first, end, out);
}
