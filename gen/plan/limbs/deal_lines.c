/* What goes across, and the lines of each warp. */
#include "plan/limbs/deal.h"
#include <string.h>

/* ---- what goes across ---- */

/* Which values cross, and up to which phase. */
static void find_crossing(const struct dealer *x, struct crossing *c)
{
	for (int w = 0; w < x->warps; w++)
		for (uint32_t i = 0; i < x->lines; i++)
			for (uint32_t k = x->readings.begin[i]; deal_did(x, w, i) && k < x->readings.begin[i + 1]; k++) {
				uint32_t node = x->readings.list[k].node;
				unsigned char phase = (unsigned char)(deal_did(x, w, i) - 1);

				if (deal_did(x, w, x->readings.made[node]))
					continue;
				c->slot[node] = 0;
				c->last[node] = phase > c->last[node] ? phase : c->last[node];
			}
}

static int choose_slots(const struct dealer *x, struct crossing *c)
{
	int slots = 0;
	unsigned char *busy = arena_alloc(x->a, x->p->dag->count, 1); /* by slot: up to this phase */

	for (int phase = 0; busy && phase < x->phases; phase++)
		for (uint32_t i = 0; i < x->p->dag->count; i++) {
			int slot = 0;

			if (c->slot[i] < 0 || x->made[x->readings.made[i]] != phase + 1)
				continue;
			while (slot < slots && busy[slot] >= phase + 1)
				slot++;
			slots += slot == slots;
			busy[slot] = (unsigned char)(c->last[i] + 1);
			c->slot[i] = slot;
		}
	arena_release(x->a, busy);
	return slots;
}

/* Slots that the deal takes which was run last. */
int deal_slots(struct dealer *x)
{
	for (size_t i = 0; i < x->p->dag->count; i++)
		x->crossing.slot[i] = -1;
	memset(x->crossing.last, 0, x->p->dag->count);
	find_crossing(x, &x->crossing);
	return choose_slots(x, &x->crossing);
}

/* ---- the warps' lines ---- */

/* The first warp that makes a line keeps its values. */
static int keeper(const struct dealer *x, uint32_t line)
{
	for (int w = 0; w < x->warps; w++)
		if (deal_did(x, w, line) && deal_did(x, w, line) == x->made[line])
			return w;
	return -1;
}

static void add_line(const struct dealer *x, struct crossing *c, int warp, uint32_t i, struct plan *out)
{
	struct ref made[2];
	int count = readings_made(x->p, &x->p->lines[i], made);

	for (uint32_t k = x->readings.begin[i]; k < x->readings.begin[i + 1]; k++) {
		struct ref r = {x->readings.list[k].node};

		if (c->seen[r.i])
			continue;
		c->seen[r.i] = 1;
		plan_add_line(out, LINE_FETCH, r, (size_t)c->slot[r.i]);
	}
	out->lines[out->line_count++] = x->p->lines[i];
	for (int k = 0; k < count; k++) {
		c->seen[made[k].i] = 1;
		if (c->slot[made[k].i] >= 0 && keeper(x, i) == warp)
			plan_add_line(out, LINE_KEEP, made[k], (size_t)c->slot[made[k].i]);
	}
}

/* Inputs first, so that they are all under way at once. */
static void add_inputs(const struct dealer *x, struct crossing *c, int warp, struct plan *out)
{
	for (uint32_t i = 0; i < x->lines; i++)
		if (deal_did(x, warp, i) && x->p->lines[i].kind == LINE_INPUT) {
			plan_add_line(out, LINE_INPUT, x->p->lines[i].value, 0);
			c->seen[x->p->lines[i].value.i] = 1;
		}
}

static void make_warp(const struct dealer *x, struct crossing *c, int warp, struct plan *out)
{
	struct ref none = {0};

	*out = *x->p;
	out->line_count = 0;
	out->lines = arena_take(x->a, 3 * (size_t)x->lines + x->readings.begin[x->lines] + MOST_PHASES, sizeof *out->lines);
	memset(c->seen, 0, x->p->dag->count);
	if (!out->lines)
		return;
	add_inputs(x, c, warp, out);
	for (int phase = 0; phase < x->phases; phase++) {
		if (phase)
			plan_add_line(out, LINE_JOIN, none, (size_t)phase);
		for (uint32_t i = 0; i < x->lines; i++)
			if (deal_did(x, warp, i) == phase + 1 && x->p->lines[i].kind != LINE_INPUT)
				add_line(x, c, warp, i, out);
	}
}

void deal_plans(struct dealer *x, struct limbs *s)
{
	s->plans = arena_alloc(x->a, (size_t)x->warps, sizeof *s->plans);
	if (x->a->failed)
		return;
	s->slots = deal_slots(x);
	for (int w = 0; w < x->warps; w++)
		make_warp(x, &x->crossing, w, &s->plans[w]);
	s->warps = x->warps;
	s->phases = x->phases;
}
