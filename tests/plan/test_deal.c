/* Lines of small plans that are drawn, dealt out to warps with little room, and run. What limbs.c takes is the best of many
   deals of robots (test_limbs); here every deal is run. It would catch a value that is read where it is not; one that is
   written over in its slot while another warp needs it, which threads read in time now and then; slots held too long; two warps
   that make the same where none may; and slots, phases and operations counted wrong, a deal that ends before it costs too much,
   or is another one from phases that were kept on, by which a worse deal is taken, or none, with the same numbers. */
#include "plan/drawn.h"
#include "plan/limbs/deal.h"
#include "support/suite.h"
#include <stdlib.h>
#include <string.h>

enum { PLANS = 1500, MOST_NODES = 64, MOST_SLOTS = 64, JOIN = 7 };

/* A value that waits in a slot: its node and the phases in which it is written, and fetched for the last time. */
struct kept {
	uint32_t node;
	int slot, phase, last;
};

struct case_ {
	struct plan plan;
	struct limbs limbs;
	struct kept kept[MOST_SLOTS * MOST_PHASES];
	int kept_count, stored[4 * MOST_NODES];
	unsigned load[MOST_PHASES][MOST_WARPS];
	unsigned long long seed;
};

/* ---- operations, as they are written ---- */

static unsigned written(const struct plan *p, uint32_t node, int is_own_line)
{
	const struct node *n = &p->dag->nodes[node];
	unsigned sum = n->op == OP_SIN || n->op == OP_COS ? 24 : n->op != OP_INPUT && n->op != OP_CONST;

	if (!is_own_line && p->names[node])
		return 0;
	for (int k = 0; k < op_arity[n->op]; k++)
		sum += written(p, n->arg[k].i, 0);
	return sum;
}

static unsigned weight(const struct plan *p, const struct line *l)
{
	int is_made = l->kind == LINE_VALUE || l->kind == LINE_SINCOS, is_stored = l->kind == LINE_STORE;

	return (is_made || is_stored ? written(p, l->value.i, is_made) : 0) + !is_made;
}

/* ---- a run ---- */

/* Fills in what is left in slots, by all warps. */
static void find_kept(struct case_ *c)
{
	c->kept_count = 0;
	for (int w = 0; w < c->limbs.warps; w++)
		for (size_t i = 0, phase = 0; i < c->limbs.plans[w].line_count; i++) {
			const struct line *l = &c->limbs.plans[w].lines[i];

			phase += l->kind == LINE_JOIN;
			if (l->kind != LINE_KEEP)
				continue;
			if (c->kept_count == MOST_SLOTS * MOST_PHASES || (int)l->index >= c->limbs.slots)
				ck_abort_msg("seed %llu: slot %zu of %d", c->seed, l->index, c->limbs.slots);
			c->kept[c->kept_count++] = (struct kept){l->value.i, (int)l->index, (int)phase, (int)phase};
		}
}

/* It is there: somebody has left it in an earlier phase. */
static void fetch(struct case_ *c, const struct line *l, int phase)
{
	for (int i = 0; i < c->kept_count; i++)
		if (c->kept[i].node == l->value.i && c->kept[i].slot == (int)l->index && c->kept[i].phase < phase) {
			c->kept[i].last = phase > c->kept[i].last ? phase : c->kept[i].last;
			return;
		}
	ck_abort_msg("seed %llu: node %u is fetched in phase %d, and not there", c->seed, l->value.i, phase);
}

static void run_warp(struct case_ *c, int warp)
{
	const struct plan *p = &c->limbs.plans[warp];
	unsigned char has[MOST_NODES] = {0}, reads[MOST_NODES], paid[MOST_NODES] = {0};
	int phase = 0;

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
		uint32_t made[2];

		if (l->kind == LINE_JOIN && ++phase)
			continue;
		drawn_reads(p, l, reads);
		for (uint32_t i = 0; i < p->dag->count; i++) {
			if (reads[i] && !has[i]) /* an assertion costs time even where it holds */
				ck_abort_msg("seed %llu: warp %d reads node %u, which it has not", c->seed, warp, i);
			/* an input counts where it is read first */
			c->load[phase][warp] += reads[i] && p->dag->nodes[i].op == OP_INPUT && !paid[i]++;
		}
		for (int k = drawn_made(p, l, made); k-- > 0;)
			has[made[k]] = 1;
		if (l->kind == LINE_STORE)
			c->stored[l->index]++;
		if (l->kind == LINE_FETCH)
			fetch(c, l, phase);
		else if (l->kind != LINE_KEEP && l->kind != LINE_INPUT)
			c->load[phase][warp] += weight(p, l);
	}
	ck_assert_msg(phase + 1 == c->limbs.phases, "seed %llu: %d phases, not %d", c->seed, phase + 1, c->limbs.phases);
}

/* What a warp fetches counts once for each line that has made it. */
static void count_fetched(struct case_ *c, int warp)
{
	const struct plan *p = &c->limbs.plans[warp];
	int phase = 0, sine_in[MOST_NODES] = {0}; /* by angle: 1 + the phase in which its sine or cosine is fetched */

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
		const struct node *n = &p->dag->nodes[l->value.i];

		phase += l->kind == LINE_JOIN;
		if (l->kind != LINE_FETCH)
			continue;
		if (n->op != OP_SIN && n->op != OP_COS)
			c->load[phase][warp]++;
		else if (!sine_in[n->arg[0].i])
			c->load[phase][warp] += !!(sine_in[n->arg[0].i] = 1 + phase);
	}
}

/* No slot holds two values at once; there are as many slots as values that somebody has still to fetch. */
static void expect_slots(const struct case_ *c)
{
	int most = 0;

	for (int i = 0; i < c->kept_count; i++)
		for (int k = 0; k < i; k++)
			if (c->kept[i].slot == c->kept[k].slot && c->kept[i].phase <= c->kept[k].last &&
				c->kept[k].phase <= c->kept[i].last)
				ck_abort_msg("seed %llu: slot %d is written too early", c->seed, c->kept[i].slot);
	for (int phase = 0; phase < c->limbs.phases; phase++) {
		int count = 0;

		for (int i = 0; i < c->kept_count; i++)
			count += c->kept[i].phase <= phase && c->kept[i].last >= phase;
		most = count > most ? count : most;
	}
	for (int i = 0; i < c->kept_count; i++)
		if (c->kept[i].last <= c->kept[i].phase)
			ck_abort_msg("seed %llu: node %u is kept for nobody", c->seed, c->kept[i].node);
	ck_assert_msg(c->limbs.slots == most, "seed %llu: %d slots for %d values", c->seed, c->limbs.slots, most);
}

static void expect_loads(const struct case_ *c, const struct dealer *x, const struct deal *deal)
{
	unsigned longest = 0, sum = 0;

	for (int phase = 0; phase < c->limbs.phases; phase++) {
		unsigned most = 0;

		for (int w = 0; w < c->limbs.warps; w++) {
			unsigned load = c->load[phase][w];

			if (load > deal->most[phase])
				ck_abort_msg("seed %llu: %u operations in phase %d, of %u", c->seed, load, phase, deal->most[phase]);
			most = load > most ? load : most;
			sum += load;
		}
		longest += most + (phase ? JOIN : 0);
	}
	ck_assert_msg(x->longest == longest, "seed %llu: the longest warp has %u operations, not %u", c->seed, longest, x->longest);
	ck_assert_msg(x->sum == sum, "seed %llu: all have %u operations, not %u", c->seed, sum, x->sum);
}

/* Two warps make nothing in the same phase where nothing may be repeated. */
static void expect_no_repetition(const struct case_ *c, const struct dealer *x)
{
	for (uint32_t i = 0; i < x->lines; i++)
		for (int w = 1; w < x->warps; w++)
			for (int v = 0; v < w; v++)
				if (c->plan.lines[i].kind != LINE_INPUT && c->plan.lines[i].kind != LINE_SINE && deal_did(x, w, i) &&
					deal_did(x, w, i) == deal_did(x, v, i))
					ck_abort_msg("seed %llu: warps %d and %d make line %u in the same phase", c->seed, v, w, i);
}

static void expect_runs(struct case_ *c, const struct dealer *x, const struct deal *deal)
{
	memset(c->load, 0, sizeof c->load);
	memset(c->stored, 0, sizeof c->stored);
	find_kept(c);
	for (int w = 0; w < c->limbs.warps; w++) {
		run_warp(c, w);
		count_fetched(c, w);
	}
	for (size_t i = 0; i < c->plan.dag->output_count; i++)
		if (c->stored[i] != 1)
			ck_abort_msg("seed %llu: output %zu is stored %d times", c->seed, i, c->stored[i]);
	expect_slots(c);
	expect_loads(c, x, deal);
	if (!deal->repeated)
		expect_no_repetition(c, x);
}

/* ---- what is drawn ---- */

/* Sines and cosines stand in a table. */
static void read_sines(struct plan *p)
{
	size_t count = p->line_count;
	struct line *from = malloc((count + 1) * sizeof *from);

	ck_assert(from != NULL);
	memcpy(from, p->lines, count * sizeof *from);
	p->line_count = 0;
	for (size_t i = 0; i < count; i++) {
		uint32_t made[2];

		if (from[i].kind == LINE_SINCOS)
			for (int k = drawn_made(p, &from[i], made); k-- > 0;)
				plan_add_line(p, LINE_SINE, (struct ref){made[k]}, 0);
		else
			p->lines[p->line_count++] = from[i];
	}
	free(from);
}

static struct deal draw_deal(struct rng *r, unsigned whole)
{
	struct deal d = {.warps = 1 + rng_below(r, rng_chance(r, 0.2) ? MOST_WARPS : 4), .has_sines = rng_chance(r, 0.3)};
	int share = 1 + rng_below(r, 6);

	d.repeated = rng_chance(r, 0.5) ? TOO_MUCH : (unsigned)rng_below(r, 4);
	for (int i = 0; i < MOST_PHASES; i++)
		d.most[i] = rng_chance(r, 0.1) ? whole : 4 + (unsigned)rng_below(r, 1 + (int)whole / share);
	return d;
}

/* The same from any of its phases on, and no end before the deal costs as much. */
static void expect_kept(const struct case_ *c, struct dealer *x, const struct deal *deal, unsigned cost)
{
	size_t size = (size_t)x->warps * x->lines;
	unsigned char *did = malloc(size);
	unsigned sum = x->sum;
	int phases = x->phase;

	ck_assert_ptr_nonnull(did);
	memcpy(did, x->did, size);
	for (int phase = phases; phase >= 0; phase--) {
		ck_assert_int_eq(deal_keep(x, deal, phase), phase < phases);
		if (phase == phases)
			continue;
		memset(x->did, 0xff, size); /* as another deal may leave it */
		ck_assert_msg(deal_run(x, deal, cost + 1) == cost, "seed %llu: from phase %d on another cost", c->seed, phase);
		ck_assert_int_eq(x->phase, phases);
		ck_assert_uint_eq(x->sum, sum);
		ck_assert_msg(!memcmp(did, x->did, size), "seed %llu: from phase %d on another deal", c->seed, phase);
		ck_assert_uint_eq(deal_run(x, deal, cost), TOO_MUCH);
	}
	free(did);
}

START_TEST(test_drawn)
{
	int deals = 0, phases = 0, shared = 0;
	struct case_ *c = malloc(sizeof *c);

	for (unsigned long long seed = 1; seed <= PLANS && c; seed++) {
		static const struct limbs_limits limits = {.join = JOIN};
		struct rng r = rng_seed(seed);
		const struct drawn_knobs knobs = {.named = rng_uniform(&r, 0.3, 1), .named_inputs = 1, .late = 0.3};
		struct dealer x = {.p = &c->plan, .limits = &limits};
		unsigned whole = 0;
		struct arena a;
		struct dag d;

		c->seed = seed;
		arena_init(&a, NULL);
		dag_init(&d, &a);
		drawn_inputs(&d, dag_argument(&d, "q", 5, 0), 2 + rng_below(&r, 4));
		drawn_operations(&d, &r, 4 + rng_below(&r, 40));
		ck_assert(d.count <= MOST_NODES);
		drawn_outputs(&d, &r, dag_argument(&d, "tau", 0, 1));
		drawn_plan(&c->plan, &d, &r, &knobs, &a);
		if (rng_chance(&r, 0.3))
			read_sines(&c->plan);
		x.lines = (uint32_t)c->plan.line_count;
		x.a = &a;
		ck_assert(deal_begin(&x));
		for (size_t i = 0; i < c->plan.line_count; i++)
			whole += weight(&c->plan, &c->plan.lines[i]);
		for (int k = 0; k < 6; k++) {
			const struct deal deal = draw_deal(&r, whole);
			unsigned cost = deal_run(&x, &deal, TOO_MUCH);

			if (cost == TOO_MUCH)
				continue;
			deal_plans(&x, &c->limbs);
			ck_assert(!a.failed);
			expect_runs(c, &x, &deal);
			expect_kept(c, &x, &deal, cost);
			deals++;
			phases += c->limbs.phases > 2;
			shared += c->kept_count > c->limbs.slots;
		}
		arena_free(&a);
	}
	free(c);
	ck_assert_msg(deals > PLANS && phases > PLANS / 4 && shared > PLANS / 20,
		"%d deals, %d of three phases, %d that share slots", deals, phases, shared);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("deal");

	suite_add(s, "drawn", test_drawn, 1, 20);
	return suite_run(s);
}
