#include "plan/limbs.h"
#include "plan/readings.h"
#include <stdlib.h>
#include <string.h>

/* A phase takes for each warp at most so many operations; which, is tried from a share of the whole up to the whole. */
enum { MOST_WARPS = 16, MOST_PHASES = 8, TRIES = 12, TOO_MUCH = 1 << 30 };

/* What to try: the operations that a warp may take in each phase; whether sines come first, in a phase of their own. */
struct deal {
	int warps, has_sines;
	unsigned most[MOST_PHASES];
};

struct crossing {
	int *slot;             /* by node; -1: it does not cross */
	unsigned char *last;   /* by node: the last phase that fetches it */
	unsigned char *seen;   /* by node, of a warp */
};

struct dealer {
	const struct plan *p;
	struct readings readings;
	const struct limbs_limits *limits;
	struct arena *a;
	uint32_t lines;
	uint32_t *weight;          /* by line: operations */
	uint32_t *own;             /* by line: a bit for each warp that has its values */
	unsigned char *made;       /* by line: 1 + the phase that makes it first; 0: none yet */
	unsigned char *did;        /* by warp and line: 1 + the phase in which the warp makes it; 0: it does not */
	uint32_t *cone, *first_cone; /* by line: operations that it takes from what is there; in the first phase */
	uint32_t *order;           /* lines of a phase, those that take most first */
	uint32_t *seen, now;       /* by line: the walk that has been there */
	uint32_t *stack, *walked, walked_count;
	struct crossing crossing;
	unsigned load[MOST_WARPS];
	int warps, phase;
	/* what a deal comes to */
	unsigned longest;
	int phases;
};

static int is_work(const struct dealer *x, uint32_t line)
{
	enum line_kind kind = x->p->lines[line].kind;

	return kind == LINE_VALUE || kind == LINE_SINCOS || kind == LINE_STORE;
}

/* ---- what a line takes ---- */

/* Inputs do not cross: each warp reads those that it takes. */
static int has_crossed(const struct dealer *x, uint32_t line)
{
	return x->made[line] && x->made[line] <= x->phase;
}

/* Operations that a line takes from what is there, for the warps in `warp`; it stops beyond `most`. The lines are in x->walked. */
static unsigned walk(struct dealer *x, uint32_t line, uint32_t warp, unsigned most)
{
	unsigned cost = 0;
	uint32_t depth = 0;

	x->now++;
	x->walked_count = 0;
	x->stack[depth++] = line;
	x->seen[line] = x->now;
	while (depth && cost <= most) {
		uint32_t i = x->stack[--depth];

		x->walked[x->walked_count++] = i;
		if (has_crossed(x, i)) {
			cost++;
			continue;
		}
		cost += x->weight[i];
		for (uint32_t k = x->readings.begin[i]; k < x->readings.begin[i + 1]; k++) {
			uint32_t before = x->readings.made[x->readings.list[k].node];

			if (x->seen[before] == x->now || x->own[before] & warp)
				continue;
			x->seen[before] = x->now;
			x->stack[depth++] = before;
		}
	}
	return cost;
}

/* ---- a phase ---- */

static void take(struct dealer *x, int warp, uint32_t line)
{
	x->load[warp] += walk(x, line, 1u << warp, TOO_MUCH);
	for (uint32_t k = 0; k < x->walked_count; k++) {
		uint32_t i = x->walked[k];

		x->own[i] |= 1u << warp;
		if (has_crossed(x, i))
			continue;
		x->did[(size_t)warp * x->lines + i] = (unsigned char)(x->phase + 1);
		if (!x->made[i] && x->p->lines[i].kind != LINE_INPUT)
			x->made[i] = (unsigned char)(x->phase + 1);
	}
}

/* To the warp that has most of what it takes, as far as there is room. */
static void offer(struct dealer *x, uint32_t line, unsigned most)
{
	unsigned least = TOO_MUCH;
	int best = -1;

	for (int w = 0; w < x->warps; w++) {
		unsigned room = most > x->load[w] ? most - x->load[w] : 0, limit = room < least ? room : least, cost;

		if (!limit)
			continue;
		cost = walk(x, line, 1u << w, limit);
		if (cost > limit || (cost == least && x->load[w] >= x->load[best]))
			continue;
		least = cost;
		best = w;
	}
	if (best >= 0)
		take(x, best, line);
}

/* Cones of what is left, as far as they have room. */
static void find_cones(struct dealer *x, unsigned most)
{
	for (uint32_t i = 0; i < x->lines; i++) {
		unsigned least = 0;

		if (x->made[i])
			continue;
		if (!x->phase && x->first_cone[i]) {
			x->cone[i] = x->first_cone[i];
			continue;
		}
		for (uint32_t k = x->readings.begin[i]; k < x->readings.begin[i + 1]; k++) {
			uint32_t before = x->readings.made[x->readings.list[k].node];

			if (!has_crossed(x, before) && x->cone[before] > least)
				least = x->cone[before];
		}
		x->cone[i] = least > most ? least : walk(x, i, 0, most);
		if (!x->phase && x->cone[i] <= most)
			x->first_cone[i] = x->cone[i];
	}
}

/* Lines by their cones, the longest first, each length in the order of the plan. */
static uint32_t sort_lines(struct dealer *x, unsigned most, int only_sines)
{
	uint32_t count = 0, *begin = arena_alloc(x->a, most + 2, sizeof *begin);

	if (!begin)
		return 0;
	for (uint32_t i = 0; i < x->lines; i++)
		if (!x->made[i] && is_work(x, i) && x->cone[i] <= most && (!only_sines || x->p->lines[i].kind == LINE_SINCOS)) {
			begin[most - x->cone[i] + 1]++;
			count++;
		}
	for (unsigned k = 0; k <= most; k++)
		begin[k + 1] += begin[k];
	for (uint32_t i = 0; i < x->lines; i++)
		if (!x->made[i] && is_work(x, i) && x->cone[i] <= most && (!only_sines || x->p->lines[i].kind == LINE_SINCOS))
			x->order[begin[most - x->cone[i]]++] = i;
	arena_release(x->a, begin);
	return count;
}

static void run_phase(struct dealer *x, unsigned most, int only_sines)
{
	uint32_t count;

	memset(x->load, 0, sizeof x->load);
	find_cones(x, most);
	count = sort_lines(x, most, only_sines);
	for (uint32_t k = 0; k < count; k++)
		if (!x->made[x->order[k]])
			offer(x, x->order[k], most);
}

static unsigned longest_load(const struct dealer *x)
{
	unsigned longest = 0;

	for (int w = 0; w < x->warps; w++)
		longest = x->load[w] > longest ? x->load[w] : longest;
	return longest;
}

static uint32_t lines_left(const struct dealer *x)
{
	uint32_t left = 0;

	for (uint32_t i = 0; i < x->lines; i++)
		left += is_work(x, i) && !x->made[i];
	return left;
}

/* Operations of the sines that a warp has where they are shared out. */
static unsigned sines_most(const struct dealer *x, int warps)
{
	unsigned all = 0, heaviest = 0, count = 0;

	for (uint32_t i = 0; i < x->lines; i++)
		if (x->p->lines[i].kind == LINE_SINCOS) {
			count++;
			heaviest = x->weight[i] > heaviest ? x->weight[i] : heaviest;
		}
	all = (count + (unsigned)warps - 1) / (unsigned)warps;
	return all * (heaviest + 3);
}

/* Returns the operations of the longest warp, TOO_MUCH where the phases do not suffice or `enough` is reached. */
static unsigned run(struct dealer *x, const struct deal *deal, unsigned enough)
{
	x->warps = deal->warps;
	x->longest = 0;
	memset(x->own, 0, x->lines * sizeof *x->own);
	memset(x->made, 0, x->lines);
	memset(x->did, 0, (size_t)x->warps * x->lines);
	for (x->phase = 0; x->phase < MOST_PHASES; x->phase++) {
		run_phase(x, deal->most[x->phase], deal->has_sines && !x->phase);
		x->longest += longest_load(x) + (x->phase ? x->limits->join : 0);
		x->phases = x->phase + 1;
		if (x->longest >= enough)
			return TOO_MUCH;
		if (!lines_left(x))
			return x->longest;
	}
	return TOO_MUCH;
}

/* ---- what goes across ---- */

static unsigned char did(const struct dealer *x, int warp, uint32_t line)
{
	return x->did[(size_t)warp * x->lines + line];
}

/* Which values cross, and up to which phase. */
static void find_crossing(const struct dealer *x, struct crossing *c)
{
	for (int w = 0; w < x->warps; w++)
		for (uint32_t i = 0; i < x->lines; i++)
			for (uint32_t k = x->readings.begin[i]; did(x, w, i) && k < x->readings.begin[i + 1]; k++) {
				uint32_t node = x->readings.list[k].node;
				unsigned char phase = (unsigned char)(did(x, w, i) - 1);

				if (did(x, w, x->readings.made[node]))
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
static int find_slots(struct dealer *x)
{
	for (size_t i = 0; i < x->p->dag->count; i++)
		x->crossing.slot[i] = -1;
	memset(x->crossing.last, 0, x->p->dag->count);
	find_crossing(x, &x->crossing);
	return choose_slots(x, &x->crossing);
}

/* ---- which deal ---- */

static unsigned whole_weight(const struct dealer *x)
{
	unsigned whole = 0;

	for (uint32_t i = 0; i < x->lines; i++)
		whole += x->weight[i];
	return whole;
}

static void set_most(struct deal *d, int from, unsigned most)
{
	for (int i = from; i < MOST_PHASES; i++)
		d->most[i] = most;
}

static void keep_better(struct dealer *x, const struct deal *d, struct deal *best, unsigned *least)
{
	unsigned cost = run(x, d, *least);

	if (cost >= *least || find_slots(x) > (int)x->limits->across)
		return;
	*least = cost;
	*best = *d;
}

/* With the same room in each phase. */
static void try_rooms(struct dealer *x, struct deal d, unsigned whole, struct deal *best, unsigned *least)
{
	double share = 1.0;

	for (int i = 0; i < TRIES; i++, share *= 0.8) {
		unsigned most = (unsigned)(share * whole);

		set_most(&d, 0, most);
		if (d.has_sines)
			d.most[0] = sines_most(x, d.warps);
		keep_better(x, &d, best, least);
	}
}

/* One phase after the other with less room, or more. */
static void refine(struct dealer *x, struct deal *best, unsigned *least)
{
	static const double factors[] = {0.5, 0.7, 0.8, 0.87, 0.93, 0.97, 1.04, 1.1, 1.2};

	for (int round = 0; round < 2; round++)
		for (int phase = best->has_sines; phase < MOST_PHASES - 1; phase++) {
			struct deal from = *best;

			for (size_t i = 0; i < sizeof factors / sizeof *factors; i++) {
				struct deal d = from;

				d.most[phase] = (unsigned)(factors[i] * d.most[phase]);
				if (d.most[phase])
					keep_better(x, &d, best, least);
			}
		}
}

static struct deal choose(struct dealer *x, unsigned whole, unsigned *least)
{
	struct deal best = {0};

	*least = TOO_MUCH;
	for (int warps = x->limits->least ? x->limits->least : 2; warps <= x->limits->warps; warps *= 2)
		for (int sines = 0; sines < 2; sines++) {
			struct deal d = {.warps = warps, .has_sines = sines};

			if (sines && !sines_most(x, 1))
				continue;
			try_rooms(x, d, whole, &best, least);
		}
	if (best.warps)
		refine(x, &best, least);
	return best;
}

/* ---- the warps' lines ---- */

static void add(struct plan *p, enum line_kind kind, struct ref value, size_t index)
{
	p->lines[p->line_count++] = (struct line){kind, value, index};
}

/* The first warp that makes a line keeps its values. */
static int keeper(const struct dealer *x, uint32_t line)
{
	for (int w = 0; w < x->warps; w++)
		if (did(x, w, line) && did(x, w, line) == x->made[line])
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
		add(out, LINE_FETCH, r, (size_t)c->slot[r.i]);
	}
	out->lines[out->line_count++] = x->p->lines[i];
	for (int k = 0; k < count; k++) {
		c->seen[made[k].i] = 1;
		if (c->slot[made[k].i] >= 0 && keeper(x, i) == warp)
			add(out, LINE_KEEP, made[k], (size_t)c->slot[made[k].i]);
	}
}

/* Inputs first, so that they are all under way at once. */
static void add_inputs(const struct dealer *x, struct crossing *c, int warp, struct plan *out)
{
	for (uint32_t i = 0; i < x->lines; i++)
		if (did(x, warp, i) && x->p->lines[i].kind == LINE_INPUT) {
			add(out, LINE_INPUT, x->p->lines[i].value, 0);
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
			add(out, LINE_JOIN, none, (size_t)phase);
		for (uint32_t i = 0; i < x->lines; i++)
			if (did(x, warp, i) == phase + 1 && is_work(x, i))
				add_line(x, c, warp, i, out);
	}
}

static void make_plans(struct dealer *x, struct limbs *s)
{
	s->plans = arena_alloc(x->a, (size_t)x->warps, sizeof *s->plans);
	if (x->a->failed)
		return;
	s->slots = find_slots(x);
	for (int w = 0; w < x->warps; w++)
		make_warp(x, &x->crossing, w, &s->plans[w]);
	s->warps = x->warps;
	s->phases = x->phases;
}

static int begin(struct dealer *x)
{
	size_t n = x->lines;

	x->weight = arena_alloc(x->a, n, sizeof *x->weight);
	x->own = arena_alloc(x->a, n, sizeof *x->own);
	x->made = arena_alloc(x->a, n, 1);
	x->did = arena_alloc(x->a, n * MOST_WARPS, 1);
	x->cone = arena_alloc(x->a, n, sizeof *x->cone);
	x->first_cone = arena_alloc(x->a, n, sizeof *x->first_cone);
	x->order = arena_alloc(x->a, n, sizeof *x->order);
	x->seen = arena_alloc(x->a, n, sizeof *x->seen);
	x->stack = arena_alloc(x->a, n, sizeof *x->stack);
	x->walked = arena_alloc(x->a, n, sizeof *x->walked);
	x->crossing = (struct crossing){.slot = arena_take(x->a, x->p->dag->count, sizeof *x->crossing.slot),
		.last = arena_alloc(x->a, x->p->dag->count, 1), .seen = arena_alloc(x->a, x->p->dag->count, 1)};
	if (!readings_make(&x->readings, x->p, x->a) || x->a->failed)
		return 0;
	for (uint32_t i = 0; i < n; i++) {
		enum line_kind kind = x->p->lines[i].kind;

		x->weight[i] = x->readings.weight[i] + (kind == LINE_INPUT || kind == LINE_STORE);
	}
	return 1;
}

int limbs_make(struct limbs *s, const struct plan *p, const struct limbs_limits *limits, struct arena *a)
{
	struct dealer x = {.p = p, .limits = limits, .a = a, .lines = (uint32_t)p->line_count};
	struct deal best;
	unsigned whole, least;

	*s = (struct limbs){0};
	if (!begin(&x))
		return 0;
	whole = whole_weight(&x);
	best = choose(&x, whole, &least);
	s->whole = whole;
	s->longest = least;
	if (!best.warps || 10 * (double)least > 9 * (double)whole)
		return 1;
	run(&x, &best, TOO_MUCH);
	make_plans(&x, s);
	return !a->failed;
}

/* Bytes of shared memory that a kernel has without asking, for 32 lanes; a wait costs as much as some 20 operations. */
enum { SHARED_BYTES = 48 << 10, LANES = 32, JOIN_OPERATIONS = 20, WARPS_SINGLE = 16, WARPS_DOUBLE = 8 };

int limbs_choose(struct pass *p, const struct rneagen_options *o, struct arena *a)
{
	int is_double = o->precision != RNEAGEN_F32;
	struct limbs_limits limits = {.warps = is_double ? WARPS_DOUBLE : WARPS_SINGLE,
		.across = is_double ? SHARED_BYTES / LANES / 8u : SHARED_BYTES / LANES / 4u, .join = JOIN_OPERATIONS};

	p->limbs = (struct limbs){0};
	if (o->limbs == RNEAGEN_LIMBS_NONE || o->precision == RNEAGEN_F32X2 || dag_has_wide(&p->dag))
		return 1;
	if (o->limbs != RNEAGEN_LIMBS_AUTO)
		limits.warps = limits.least = o->limbs;
	return limbs_make(&p->limbs, &p->plan, &limits, a);
}

static void put_warp(const struct plan *lines, int warp, struct text *out)
{
	int fetched = 0, kept = 0, inputs = 0, stores = 0, sines = 0, values = 0, phase = 0;

	for (size_t i = 0; i <= lines->line_count; i++) {
		if (i == lines->line_count || lines->lines[i].kind == LINE_JOIN) {
			text_printf(out, "  warp %d phase %d: %d inputs, %d sines, %d values, %d stores, %d fetched, %d kept\n", warp, phase++,
				inputs, sines, values, stores, fetched, kept);
			fetched = kept = inputs = stores = sines = values = 0;
			continue;
		}
		fetched += lines->lines[i].kind == LINE_FETCH;
		kept += lines->lines[i].kind == LINE_KEEP;
		inputs += lines->lines[i].kind == LINE_INPUT;
		stores += lines->lines[i].kind == LINE_STORE;
		sines += lines->lines[i].kind == LINE_SINCOS;
		values += lines->lines[i].kind == LINE_VALUE;
	}
}

void limbs_dump(const struct pass *p, struct text *out)
{
	const struct limbs *s = &p->limbs;

	text_printf(out, "%s: %d warps, %d phases, %d values across, %u operations instead of %u\n", p->algorithm->name, s->warps, s->phases,
		s->slots, s->longest, s->whole);
	for (int w = 0; w < s->warps; w++)
		put_warp(&s->plans[w], w, out);
}
