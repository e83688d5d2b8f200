#include "plan/limbs/limbs.h"
#include "plan/limbs/deal.h"
#include "plan/limbs/first_sines.h"
#include <string.h>

/* Long plans are refined once: gradients of atlas take half a second, and warps come out as short. */
enum { TRIES = 12, LONG_PLAN = 4000 };

/* Operations of a line, with all that it takes, that two warps may make in one phase. The least deals of long texts are found by
   the first of these; then others end early. */
static const unsigned REPEATED[] = {25, 12, 100, 400};

/* ---- which deal ---- */

static void set_most(struct deal *d, int from, unsigned most)
{
	for (int i = from; i < MOST_PHASES; i++)
		d->most[i] = most;
}

static void keep_better(struct dealer *x, const struct deal *d, struct deal *best, unsigned *least)
{
	unsigned cost = deal_run(x, d, *least);

	if (cost >= *least || deal_slots(x) > (int)x->limits->across)
		return;
	cost += limbs_spilled(&x->limits->spill, deal_alive(x));
	if (cost >= *least)
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
			d.most[0] = deal_sines_most(x, d.warps);
		keep_better(x, &d, best, least);
	}
}

/* One phase after the other with less room, or more. */
static void refine(struct dealer *x, int rounds, struct deal *best, unsigned *least)
{
	static const double factors[] = {0.5, 0.7, 0.8, 0.87, 0.93, 0.97, 1.04, 1.1, 1.2};

	for (int round = 0; round < rounds; round++)
		for (int phase = best->has_sines; phase < MOST_PHASES - 1; phase++) {
			struct deal from = *best;

			if (!deal_keep(x, &from, phase))
				break;
			for (size_t i = 0; i < sizeof factors / sizeof *factors; i++) {
				struct deal d = from;

				d.most[phase] = (unsigned)(factors[i] * d.most[phase]);
				if (d.most[phase])
					keep_better(x, &d, best, least);
			}
		}
}

static struct deal choose(struct dealer *x, unsigned whole)
{
	struct deal best = {0};
	unsigned least = TOO_MUCH;
	int can_have_sines = deal_sines_most(x, 1) > 0;

	for (size_t i = 0; i < sizeof REPEATED / sizeof *REPEATED; i++)
		for (int has_sines = 0; has_sines <= can_have_sines; has_sines++)
			try_rooms(x, (struct deal){.warps = x->limits->warps, .has_sines = has_sines, .repeated = REPEATED[i]}, whole, &best,
				&least);
	if (best.warps)
		refine(x, whole > LONG_PLAN ? 1 : 2, &best, &least);
	deal_keep(x, &best, 0);
	return best;
}

unsigned limbs_operations(const struct plan *p, struct arena *a)
{
	struct readings r;
	unsigned sum = 0;

	if (!readings_make(&r, p, a))
		return 0;
	for (size_t i = 0; i < p->line_count; i++)
		sum += deal_weight(&r, i);
	readings_free(&r, a);
	return sum;
}

/* The table stands behind what goes across. */
static void place_table(struct limbs *s)
{
	for (int w = 0; w < s->warps; w++)
		for (size_t i = 0; i < s->plans[w].line_count; i++)
			if (s->plans[w].lines[i].kind == LINE_SINE)
				s->plans[w].lines[i].index += (size_t)s->slots;
}

int limbs_make(struct limbs *s, const struct plan *p, const struct limbs_limits *limits, struct arena *a)
{
	struct dealer x = {.p = p, .limits = limits, .a = a};
	struct plan with;
	struct deal best;
	unsigned whole = limbs_operations(p, a);

	*s = (struct limbs){0};
	if (limits->has_first_sines && first_sines_make(&with, &s->first, p, a))
		x.p = &with;
	x.lines = (uint32_t)x.p->line_count;
	if (!deal_begin(&x))
		return 0;
	best = choose(&x, whole);
	s->whole = whole;
	if (!best.warps)
		return 1;
	deal_run(&x, &best, TOO_MUCH);
	s->longest = x.longest;
	if (10 * (double)x.longest > 9 * (double)whole)
		return 1;
	s->sum = x.sum;
	deal_plans(&x, s);
	place_table(s);
	s->alive = deal_alive(&x);
	return !a->failed;
}

static void put_warp(const struct plan *lines, int warp, struct text *out)
{
	int phase = 0, count[LINE_JOIN] = {0}; /* of each kind */

	for (size_t i = 0; i <= lines->line_count; i++) {
		if (i < lines->line_count && lines->lines[i].kind != LINE_JOIN) {
			count[lines->lines[i].kind]++;
			continue;
		}
		text_printf(out, "  warp %d phase %d: %d inputs, %d sines, %d values, %d stores, %d fetched, %d kept\n", warp,
			phase++, count[LINE_INPUT], count[LINE_SINCOS] + count[LINE_SINE], count[LINE_VALUE], count[LINE_STORE], count[LINE_FETCH],
			count[LINE_KEEP]);
		memset(count, 0, sizeof count);
	}
}

void limbs_dump(const struct function *p, struct text *out)
{
	const struct limbs *s = &p->limbs;

	text_printf(out, "%s: %d warps, %d phases, %d values across, %u operations instead of %u, %u by all warps, %d values at once\n",
		p->algorithm->name, s->warps, s->phases, s->slots, s->longest, s->whole, s->sum, s->alive);
	for (int w = 0; w < s->warps; w++)
		put_warp(&s->plans[w], w, out);
}
