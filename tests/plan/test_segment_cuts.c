/* Small plans that are drawn, cut into segments, beside a search over all ways to cut them, and run. It would catch cuts at which
   more is kept and fetched than need be, and slots that nothing needs: both cost time and memory, and change no number. And a
   value that is written over in its slot before it is fetched, in plans that no robot has. */
#include "plan/drawn.h"
#include "plan/segments.h"
#include "support/suite.h"
#include <limits.h>
#include <string.h>

/* With limits of so few operations each line may be a cut. */
enum { PLANS = 1200, MOST_LINES = 13, MOST_NODES = 40, MOST_OPERATIONS = 15, NOT = -1 };

struct case_ {
	struct arena arena;
	struct dag dag;
	struct plan plan;
	struct segment_limits limits;
	struct segments segments;
	unsigned char reads[MOST_LINES][MOST_NODES];
	int made[MOST_NODES]; /* by node: its line; NOT: it has none, or is an input, which is read again */
	unsigned long long seed;
};

static int is_input(const struct case_ *c, int node)
{
	return c->dag.nodes[node].op == OP_INPUT;
}

static void find_reads(struct case_ *c)
{
	for (size_t i = 0; i < c->dag.count; i++)
		c->made[i] = NOT;
	for (int l = 0; l < (int)c->plan.line_count; l++) {
		uint32_t made[2];

		drawn_reads(&c->plan, &c->plan.lines[l], c->reads[l]);
		for (int k = drawn_made(&c->plan, &c->plan.lines[l], made); k-- > 0;)
			c->made[made[k]] = is_input(c, (int)made[k]) ? NOT : l;
	}
}

/* ---- all ways to cut ---- */

/* Is it read by one of these lines? */
static int is_read(const struct case_ *c, int node, int first, int end)
{
	for (int l = first; l < end; l++)
		if (c->reads[l][node])
			return 1;
	return 0;
}

/* What the lines fetch, inputs among it, and keep for later ones. */
static int cost(const struct case_ *c, int first, int end)
{
	int count = (int)c->limits.overhead;

	for (int i = 0; i < (int)c->dag.count; i++) {
		int is_own = c->made[i] >= first && c->made[i] < end;

		count += is_own ? is_read(c, i, end, (int)c->plan.line_count) : is_read(c, i, first, end);
	}
	return count;
}

static int operations_of(const struct plan *p, uint32_t node, int is_own_line)
{
	const struct node *n = &p->dag->nodes[node];
	int sum = n->op == OP_SIN ? 24 : n->op != OP_INPUT && n->op != OP_CONST;

	for (int k = 0; k < op_arity[n->op] && (is_own_line || !p->names[node]); k++)
		sum += operations_of(p, n->arg[k].i, 0);
	return is_own_line || !p->names[node] ? sum : 0;
}

static int operations(const struct case_ *c, int first, int end)
{
	int sum = 0;

	for (const struct line *l = c->plan.lines + first; l < c->plan.lines + end; l++)
		if (l->kind != LINE_INPUT)
			sum += operations_of(&c->plan, l->value.i, l->kind != LINE_STORE);
	return sum;
}

/* Values that wait at a cut before the line. */
static unsigned across(const struct case_ *c, int line)
{
	unsigned count = 0;

	for (int i = 0; i < (int)c->dag.count; i++)
		count += c->made[i] != NOT && c->made[i] < line && is_read(c, i, line, (int)c->plan.line_count);
	return count;
}

/* The least that is fetched and kept, with cuts before the lines of a set; INT_MAX: no set is within the limits. */
static int least_cost(const struct case_ *c, unsigned most_across)
{
	int lines = (int)c->plan.line_count, least = INT_MAX, of[MOST_LINES + 1][MOST_LINES + 1];
	unsigned waits[MOST_LINES];

	for (int first = 0; first < lines; first++) {
		waits[first] = across(c, first);
		for (int end = first + 1; end <= lines; end++)
			of[first][end] = end == first + 1 || operations(c, first, end) <= (int)c->limits.operations
				? cost(c, first, end) : INT_MAX;
	}
	for (unsigned set = 0; set < 1u << lines; set += 2) {
		int first = 0, sum = 0;

		for (int end = 1; end <= lines && sum < INT_MAX; end++) {
			if (end < lines && !(set >> end & 1))
				continue;
			sum = of[first][end] == INT_MAX || (end < lines && waits[end] > most_across) ? INT_MAX : sum + of[first][end];
			first = end;
		}
		least = sum < least ? sum : least;
	}
	return least;
}

/* ---- a run ---- */

/* What is fetched stands in its slot, and no line reads what the segment has not. Returns what is fetched and kept. */
static int run(const struct case_ *c)
{
	int slots[2][MOST_NODES], count = 0, stored[MOST_NODES] = {0};
	unsigned char has[MOST_NODES], reads[MOST_NODES];

	memset(slots, 0xff, sizeof slots);
	for (const struct plan *p = c->segments.plans; p < c->segments.plans + c->segments.count; p++) {
		memset(has, 0, sizeof has);
		count += (int)c->limits.overhead;
		for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
			int *slot = &slots[p->dag->nodes[l->value.i].is_wide][l->kind == LINE_FETCH || l->kind == LINE_KEEP ? l->index : 0];
			uint32_t made[2];

			drawn_reads(p, l, reads);
			for (size_t i = 0; i < p->dag->count; i++)
				if (reads[i] && !has[i])
					ck_abort_msg("seed %llu: node %zu is not there", c->seed, i);
			if (l->kind == LINE_FETCH && *slot != (int)l->value.i)
				ck_abort_msg("seed %llu: node %u is not in slot %zu", c->seed, l->value.i, l->index);
			for (int k = drawn_made(p, l, made); k-- > 0;)
				has[made[k]] = 1;
			if (l->kind == LINE_KEEP)
				*slot = (int)l->value.i;
			if (l->kind == LINE_STORE)
				stored[l->index]++;
			count += l->kind == LINE_FETCH || l->kind == LINE_KEEP || l->kind == LINE_INPUT;
		}
	}
	for (size_t i = 0; i < c->dag.output_count; i++)
		ck_assert_msg(stored[i] == 1, "seed %llu: output %zu is stored %d times", c->seed, i, stored[i]);
	return count;
}

/* As many slots as values wait at once: from the segment that makes one to the last that fetches it. */
static int slots_needed(const struct case_ *c, int is_wide)
{
	int first[MOST_NODES] = {0}, last[MOST_NODES] = {0}, most = 0;

	for (int k = 0; k < c->segments.count; k++)
		for (size_t l = 0; l < c->segments.plans[k].line_count; l++) {
			const struct line *line = &c->segments.plans[k].lines[l];

			if (line->kind == LINE_KEEP)
				first[line->value.i] = k + 1;
			if (line->kind == LINE_FETCH)
				last[line->value.i] = k + 1;
		}
	for (int k = 1; k <= c->segments.count; k++) {
		int count = 0;

		for (size_t i = 0; i < c->dag.count; i++)
			count += c->dag.nodes[i].is_wide == (unsigned)is_wide && first[i] && first[i] <= k && last[i] >= k;
		most = count > most ? count : most;
	}
	return most;
}

static void draw(struct case_ *c, struct rng *r)
{
	const struct drawn_knobs knobs = {.named = rng_uniform(r, 0.4, 1), .named_inputs = 1, .late = 0.3};
	const struct ref none = {0};
	int has_wide = rng_chance(r, 0.4);

	arena_init(&c->arena, NULL);
	do {
		dag_init(&c->dag, &c->arena);
		drawn_inputs(&c->dag, dag_argument(&c->dag, "q", 3, 0), 2 + rng_below(r, 2));
		if (has_wide)
			dag_node(&c->dag, OP_WIDEN, (struct ref){1}, none, none, 0);
		drawn_operations(&c->dag, r, 3 + rng_below(r, 14));
		drawn_outputs(&c->dag, r, dag_argument(&c->dag, "tau", 0, 1));
		drawn_plan(&c->plan, &c->dag, r, &knobs, &c->arena);
	} while (c->plan.line_count > MOST_LINES);
	ck_assert(c->dag.count <= MOST_NODES && c->dag.output_count <= MOST_NODES);
	c->limits = (struct segment_limits){.operations = 1 + (unsigned)rng_below(r, MOST_OPERATIONS),
		.overhead = (unsigned)rng_below(r, 4), .across = rng_chance(r, 0.5) ? 100 : 1 + (unsigned)rng_below(r, 4)};
	find_reads(c);
}

START_TEST(test_drawn)
{
	static struct case_ c;
	int cut = 0, crowded = 0, wide = 0;

	for (c.seed = 1; c.seed <= PLANS; c.seed++) {
		struct rng r = rng_seed(c.seed);
		int least, found;

		draw(&c, &r);
		least = least_cost(&c, c.limits.across);
		crowded += least == INT_MAX;
		least = least < INT_MAX ? least : least_cost(&c, UINT_MAX);
		ck_assert(segments_make(&c.segments, &c.plan, &c.limits, &c.arena));
		found = run(&c);
		ck_assert_msg(found == least, "seed %llu: %d are fetched and kept, where %d may", c.seed, found, least);
		for (int k = 0; k < 2; k++)
			ck_assert_msg(c.segments.slots[k] == slots_needed(&c, k), "seed %llu: %d slots, where %d suffice", c.seed,
				c.segments.slots[k], slots_needed(&c, k));
		cut += c.segments.count > 2;
		wide += c.segments.slots[1] > 0;
		arena_free(&c.arena);
	}
	ck_assert_msg(cut > PLANS / 4 && crowded > PLANS / 50 && wide > PLANS / 20,
		"%d plans of three segments, %d with more across than may be, %d with wide values", cut, crowded, wide);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("segment_cuts");

	suite_add(s, "drawn", test_drawn, 1, 20);
	return suite_run(s);
}
