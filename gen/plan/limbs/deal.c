#include "plan/limbs/deal.h"
#include <string.h>

/* An operation of any warp is code that the multiprocessor fetches; beyond so many it counts so many percent of one of the
   longest warp. */
enum { CODE_ROOM = 2000, CODE_PERCENT = 40 };

/* Is it a line that makes or stores something? Inputs are read wherever they are taken. */
static int is_work(const struct dealer *x, uint32_t line)
{
	enum line_kind kind = x->p->lines[line].kind;

	return kind == LINE_VALUE || kind == LINE_SINCOS || kind == LINE_STORE;
}

/* Inputs do not cross, nor do sines that stand in a table: each warp reads those that it takes. */
static int is_there(const struct dealer *x, uint32_t line)
{
	return x->p->lines[line].kind == LINE_INPUT || x->p->lines[line].kind == LINE_SINE;
}

/* ---- what a line takes ---- */

static int has_crossed(const struct dealer *x, uint32_t line)
{
	return x->line[line].made && x->line[line].made <= x->phase;
}

/* Operations that a line takes from what is there, for the warps in `warp`; it stops beyond `most`, and returns TOO_MUCH where
   more than `repeated` of them are made in this phase by another warp. The lines are in x->walked. */
static unsigned walk(struct dealer *x, uint32_t line, uint32_t warp, unsigned most, unsigned repeated)
{
	unsigned cost = 0, again = 0;
	uint32_t depth = 0;

	x->now++;
	x->walked_count = 0;
	x->stack[depth++] = line;
	x->line[line].seen = x->now;
	while (depth && cost <= most) {
		uint32_t i = x->stack[--depth];

		x->walked[x->walked_count++] = i;
		if (has_crossed(x, i)) {
			cost++;
			continue;
		}
		cost += x->line[i].weight;
		again += x->line[i].made ? x->line[i].weight : 0;
		if (again > repeated)
			return TOO_MUCH;
		for (uint32_t k = x->begin[i]; k < x->begin[i + 1]; k++) {
			uint32_t before = x->before[k];

			if (x->line[before].seen == x->now || x->line[before].own & warp)
				continue;
			x->line[before].seen = x->now;
			x->stack[depth++] = before;
		}
	}
	return cost;
}

/* ---- a phase ---- */

static void take(struct dealer *x, int warp, uint32_t line)
{
	x->load[warp] += walk(x, line, 1u << warp, TOO_MUCH, TOO_MUCH);
	for (uint32_t k = 0; k < x->walked_count; k++) {
		uint32_t i = x->walked[k];

		x->line[i].own |= 1u << warp;
		if (has_crossed(x, i))
			continue;
		x->did[(size_t)warp * x->lines + i] = (unsigned char)(x->phase + 1);
		if (!x->line[i].made && !is_there(x, i))
			x->line[i].made = x->phase + 1;
	}
}

/* To the warp that has most of what it takes, as far as there is room, and not too much of it is made by another warp: in the
   next phase that can be fetched. */
static void offer(struct dealer *x, uint32_t line, unsigned most)
{
	unsigned least = TOO_MUCH;
	int best = -1;

	for (int w = 0; w < x->warps; w++) {
		unsigned room = most > x->load[w] ? most - x->load[w] : 0, limit = room < least ? room : least, cost;

		if (!limit)
			continue;
		cost = walk(x, line, 1u << w, limit, x->repeated);
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

		if (x->line[i].made)
			continue;
		if (!x->phase && x->first_cone[i]) {
			x->cone[i] = x->first_cone[i];
			continue;
		}
		for (uint32_t k = x->begin[i]; k < x->begin[i + 1]; k++) {
			uint32_t before = x->before[k];

			if (!has_crossed(x, before) && x->cone[before] > least)
				least = x->cone[before];
		}
		x->cone[i] = least > most ? least : walk(x, i, 0, most, TOO_MUCH);
		if (!x->phase && x->cone[i] <= most)
			x->first_cone[i] = x->cone[i];
	}
}

static int is_ready(const struct dealer *x, uint32_t line, unsigned most, int only_sines)
{
	return !x->line[line].made && is_work(x, line) && x->cone[line] <= most &&
		(!only_sines || x->p->lines[line].kind == LINE_SINCOS);
}

/* Lines by their cones, the longest first, each length in the order of the plan. */
static uint32_t sort_lines(struct dealer *x, unsigned most, int only_sines)
{
	uint32_t count = 0, *begin = arena_alloc(x->a, most + 2, sizeof *begin);

	if (!begin)
		return 0;
	for (uint32_t i = 0; i < x->lines; i++)
		if (is_ready(x, i, most, only_sines)) {
			begin[most - x->cone[i] + 1]++;
			count++;
		}
	for (unsigned k = 0; k <= most; k++)
		begin[k + 1] += begin[k];
	for (uint32_t i = 0; i < x->lines; i++)
		if (is_ready(x, i, most, only_sines))
			x->order[begin[most - x->cone[i]]++] = i;
	arena_release(x->a, begin);
	return count;
}

static unsigned longest_load(const struct dealer *x)
{
	unsigned longest = 0;

	for (int w = 0; w < x->warps; w++)
		longest = x->load[w] > longest ? x->load[w] : longest;
	return longest;
}

/* It ends early where a warp has so many operations that the deal is no better than another. */
static void run_phase(struct dealer *x, unsigned most, int only_sines, unsigned enough)
{
	uint32_t count;

	memset(x->load, 0, sizeof x->load);
	find_cones(x, most);
	count = sort_lines(x, most, only_sines);
	for (uint32_t k = 0; k < count && longest_load(x) < enough; k++)
		if (!x->line[x->order[k]].made)
			offer(x, x->order[k], most);
}

static unsigned all_loads(const struct dealer *x)
{
	unsigned sum = 0;

	for (int w = 0; w < x->warps; w++)
		sum += x->load[w];
	return sum;
}

/* Operations of the lines that no warp has made. */
static unsigned operations_left(const struct dealer *x)
{
	unsigned left = 0;

	for (uint32_t i = 0; i < x->lines; i++)
		left += is_work(x, i) && !x->line[i].made ? x->line[i].weight : 0;
	return left;
}

/* Operations of the sines that a warp has where they are shared out. */
unsigned deal_sines_most(const struct dealer *x, int warps)
{
	unsigned all = 0, heaviest = 0, count = 0;

	for (uint32_t i = 0; i < x->lines; i++)
		if (x->p->lines[i].kind == LINE_SINCOS) {
			count++;
			heaviest = x->line[i].weight > heaviest ? x->line[i].weight : heaviest;
		}
	all = (count + (unsigned)warps - 1) / (unsigned)warps;
	return all * (heaviest + 3);
}

/* What all code costs at least, where so many operations are left. */
static unsigned code_cost(const struct dealer *x, unsigned left)
{
	unsigned code = x->sum + left > CODE_ROOM ? x->sum + left - CODE_ROOM : 0;

	return code * CODE_PERCENT / 100;
}

/* At least, where so many operations are left. */
static unsigned deal_cost(const struct dealer *x, unsigned left)
{
	return x->longest + left / (unsigned)x->warps + code_cost(x, left);
}

/* Returns the operations left; any number where the deal comes to `enough`. */
static unsigned next_phase(struct dealer *x, const struct deal *deal, unsigned left, unsigned enough)
{
	unsigned join = x->phase ? x->limits->join : 0, before = x->longest + join + code_cost(x, left);

	run_phase(x, deal->most[x->phase], deal->has_sines && !x->phase, enough > before ? enough - before : 0);
	x->longest += longest_load(x) + join;
	x->sum += all_loads(x);
	x->phase++;
	return operations_left(x);
}

/* From what is kept on. */
static void begin_deal(struct dealer *x, const struct deal *deal)
{
	const struct dealt *k = &x->kept;
	size_t all = (size_t)deal->warps * x->lines;

	x->warps = deal->warps;
	x->repeated = deal->repeated;
	x->longest = k->longest;
	x->sum = k->sum;
	x->phase = k->phases;
	if (!k->phases) {
		for (uint32_t i = 0; i < x->lines; i++)
			x->line[i] = (struct dealt_line){.weight = x->line[i].weight, .seen = x->line[i].seen};
		memset(x->did, 0, all);
		return;
	}
	memcpy(x->line, k->line, x->lines * sizeof *x->line);
	memcpy(x->did, k->did, all);
}

unsigned deal_run(struct dealer *x, const struct deal *deal, unsigned enough)
{
	unsigned left;

	begin_deal(x, deal);
	left = operations_left(x);
	while (x->phase < MOST_PHASES) {
		left = next_phase(x, deal, left, enough);
		if (deal_cost(x, left) >= enough)
			return TOO_MUCH;
		if (!left)
			return deal_cost(x, 0);
	}
	return TOO_MUCH;
}

int deal_keep(struct dealer *x, const struct deal *deal, int phases)
{
	struct dealt *k = &x->kept;
	unsigned left;

	k->phases = 0;
	k->longest = k->sum = 0;
	begin_deal(x, deal);
	left = operations_left(x);
	while (left && x->phase < phases)
		left = next_phase(x, deal, left, TOO_MUCH);
	memcpy(k->line, x->line, x->lines * sizeof *x->line);
	memcpy(k->did, x->did, (size_t)x->warps * x->lines);
	k->longest = x->longest;
	k->sum = x->sum;
	k->phases = x->phase;
	return left > 0;
}

unsigned deal_weight(const struct readings *r, size_t line)
{
	enum line_kind kind = r->plan->lines[line].kind;

	return r->weight[line] + (kind == LINE_INPUT || kind == LINE_SINE || kind == LINE_STORE);
}

static int find_before(struct dealer *x)
{
	const struct readings *r = &x->readings;
	uint32_t count = 0;

	x->begin = arena_alloc(x->a, x->lines + 1, sizeof *x->begin);
	x->before = arena_take(x->a, r->begin[x->lines] + 1, sizeof *x->before);
	for (uint32_t i = 0; i < x->lines && !x->a->failed; i++) {
		x->now++;
		for (uint32_t k = r->begin[i]; k < r->begin[i + 1]; k++) {
			uint32_t line = r->made[r->list[k].node];

			if (x->line[line].seen != x->now)
				x->before[count++] = line;
			x->line[line].seen = x->now;
		}
		x->begin[i + 1] = count;
	}
	return !x->a->failed;
}

int deal_begin(struct dealer *x)
{
	size_t n = x->lines;

	x->line = arena_alloc(x->a, n, sizeof *x->line);
	x->did = arena_alloc(x->a, n * MOST_WARPS, 1);
	x->kept = (struct dealt){.line = arena_alloc(x->a, n, sizeof *x->kept.line),
		.did = arena_alloc(x->a, n * MOST_WARPS, 1)};
	x->cone = arena_alloc(x->a, n, sizeof *x->cone);
	x->first_cone = arena_alloc(x->a, n, sizeof *x->first_cone);
	x->order = arena_alloc(x->a, n, sizeof *x->order);
	x->stack = arena_alloc(x->a, n, sizeof *x->stack);
	x->walked = arena_alloc(x->a, n, sizeof *x->walked);
	x->last_read = arena_take(x->a, x->p->dag->count, sizeof *x->last_read);
	x->ends = arena_take(x->a, n + 2, sizeof *x->ends);
	x->crossing = (struct crossing){.slot = arena_take(x->a, x->p->dag->count, sizeof *x->crossing.slot),
		.last = arena_alloc(x->a, x->p->dag->count, 1), .seen = arena_alloc(x->a, x->p->dag->count, 1)};
	if (!readings_make(&x->readings, x->p, x->a) || x->a->failed)
		return 0;
	for (uint32_t i = 0; i < n; i++)
		x->line[i].weight = deal_weight(&x->readings, i);
	return find_before(x);
}
