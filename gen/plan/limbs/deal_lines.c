/* What goes across, and the lines of each warp. */
#include "plan/limbs/deal.h"
#include <string.h>

/* A warp's lines in its order, but for inputs, in x->order. Returns how many. */
static uint32_t order_own(struct dealer *x, int w)
{
	uint32_t count = 0;

	for (int phase = 0; phase < x->phase; phase++)
		for (uint32_t i = 0; i < x->lines; i++)
			if (deal_did(x, w, i) == phase + 1 && x->p->lines[i].kind != LINE_INPUT)
				x->order[count++] = i;
	return count;
}

/* ---- what goes across ---- */

/* What a line of a warp fetches: that crosses, at least up to this phase. */
static void note_crossing(const struct dealer *x, struct crossing *c, int w, uint32_t i)
{
	unsigned char phase = (unsigned char)(deal_did(x, w, i) - 1);

	for (uint32_t k = x->readings.begin[i]; k < x->readings.begin[i + 1]; k++) {
		uint32_t node = x->readings.list[k].node;

		if (c->seen[node] || deal_did(x, w, x->readings.made[node]))
			continue;
		c->seen[node] = 1;
		c->slot[node] = 0;
		c->last[node] = phase > c->last[node] ? phase : c->last[node];
	}
}

/* Which values cross, and up to which phase: a warp fetches one in the phase in which it reads it first. */
static void find_crossing(struct dealer *x)
{
	for (int w = 0; w < x->warps; w++) {
		uint32_t count = order_own(x, w);

		memset(x->crossing.seen, 0, x->p->dag->count);
		for (uint32_t k = 0; k < count; k++)
			note_crossing(x, &x->crossing, w, x->order[k]);
	}
}

static int choose_slots(const struct dealer *x, struct crossing *c)
{
	int slots = 0;
	unsigned char *busy = arena_alloc(x->a, x->p->dag->count, 1); /* by slot: up to this phase */

	for (int phase = 0; busy && phase < x->phase; phase++)
		for (uint32_t i = 0; i < x->p->dag->count; i++) {
			int slot = 0;

			if (c->slot[i] < 0 || x->line[x->readings.made[i]].made != phase + 1)
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
	find_crossing(x);
	return choose_slots(x, &x->crossing);
}

/* ---- values at once ---- */

/* Inputs are there from the start; the lines in x->order are numbered from 1. */
static void find_ends(struct dealer *x, uint32_t count)
{
	memset(x->last_read, 0, x->p->dag->count * sizeof *x->last_read);
	memset(x->ends, 0, (x->lines + 2) * sizeof *x->ends);
	for (uint32_t now = 1; now <= count; now++) {
		uint32_t i = x->order[now - 1];
		struct ref made[2];

		for (int k = readings_made(x->p, &x->p->lines[i], made); k-- > 0;)
			x->last_read[made[k].i] = now;
		for (uint32_t k = x->readings.begin[i]; k < x->readings.begin[i + 1]; k++)
			x->last_read[x->readings.list[k].node] = now;
	}
	for (uint32_t i = 0; i < x->p->dag->count; i++)
		x->ends[x->last_read[i]]++;
}

/* Values that a line fetches, and makes. */
static int new_values(struct dealer *x, uint32_t i)
{
	unsigned char *seen = x->crossing.seen;
	struct ref made[2];
	int count = readings_made(x->p, &x->p->lines[i], made), fetched = 0;

	for (uint32_t k = x->readings.begin[i]; k < x->readings.begin[i + 1]; k++) {
		uint32_t node = x->readings.list[k].node;

		fetched += !seen[node];
		seen[node] = 1;
	}
	for (int k = 0; k < count; k++)
		seen[made[k].i] = 1;
	return fetched + count;
}

static int alive_of(struct dealer *x, int w)
{
	uint32_t count = order_own(x, w);
	int alive = 0, most;

	find_ends(x, count);
	memset(x->crossing.seen, 0, x->p->dag->count);
	for (uint32_t i = 0; i < x->lines; i++)
		if (deal_did(x, w, i) && x->p->lines[i].kind == LINE_INPUT)
			alive += new_values(x, i);
	most = alive;
	for (uint32_t now = 1; now <= count; now++) {
		alive += new_values(x, x->order[now - 1]);
		most = alive > most ? alive : most;
		alive -= (int)x->ends[now];
	}
	return most;
}

int deal_alive(struct dealer *x)
{
	int most = 0;

	for (int w = 0; w < x->warps; w++) {
		int alive = alive_of(x, w);

		most = alive > most ? alive : most;
	}
	return most;
}

/* ---- the warps' lines ---- */

/* The first warp that makes a line keeps its values. */
static int keeper(const struct dealer *x, uint32_t line)
{
	for (int w = 0; w < x->warps; w++)
		if (deal_did(x, w, line) && deal_did(x, w, line) == x->line[line].made)
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
	for (int phase = 0; phase < x->phase; phase++) {
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
	s->phases = x->phase;
}
