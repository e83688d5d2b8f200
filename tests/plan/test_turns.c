/* Parts of kernels that leave numbers for each other in rows of an output, run by a memory that knows who wrote what, in every
   order of the parts of a kernel. It would catch parts that are taken though one writes a row before another has read what was
   left there: on a GPU they come in some order, so numbers that are compared are right most of the time. And parts that are
   refused though all goes well, which makes a text slower and changes no number. */
#include "plan/drawn.h"
#include "plan/grid/hands/turns.h"
#include "support/suite.h"
#include <stdlib.h>
#include <string.h>

enum { ROWS = 3, MOST_PARTS = 4, MOST_LINES = 5, DRAWS = 4000, PLANS = 600, OWN = 1, OTHER = 2 };

/* Parts, and what runs say of them. */
struct case_ {
	struct part *parts;
	int count, serves;
	struct dag *dag;
	int seen[MOST_PARTS][MOST_LINES]; /* what a line has read; 0: nothing yet */
	int after[ROWS];                  /* a kernel, in the order that was run first: 1 + what is in the row */
};

/* The row of the last array that the line reads, or stores; -1: none. */
static int row_of(const struct case_ *c, const struct line *l, enum line_kind kind)
{
	const struct node *n = &c->dag->nodes[l->value.i];

	if (l->kind != kind)
		return -1;
	if (kind == LINE_INPUT)
		return n->arg[0].i == OTHER ? (int)n->arg[1].i : -1;
	return c->dag->outputs[l->index].argument == OTHER ? c->dag->outputs[l->index].row : -1;
}

static int stores_before(const struct case_ *c, int kernel, int row)
{
	int count = 0;

	for (int i = 0; i < c->count; i++) {
		const struct plan *p = &c->parts[i].function.plan;
		int stores = 0;

		for (size_t l = 0; l < p->line_count; l++)
			stores |= row_of(c, &p->lines[l], LINE_STORE) == row;
		count += stores && part_kernel(&c->parts[i]) < kernel;
	}
	return count;
}

/* A part runs; the memory knows by what line of which part each row was written, from 1. */
static void run_part(struct case_ *c, int part, int most, int memory[ROWS])
{
	const struct plan *p = &c->parts[part].function.plan;
	int kernel = part_kernel(&c->parts[part]);

	for (int l = 0; l < (int)p->line_count; l++) {
		int read = row_of(c, &p->lines[l], LINE_INPUT), stored = row_of(c, &p->lines[l], LINE_STORE);

		if (stored >= 0)
			memory[stored] = 1 + part * MOST_LINES + l;
		if (read < 0)
			continue;
		c->serves &= memory[read] && part_kernel(&c->parts[(memory[read] - 1) / MOST_LINES]) < kernel;
		c->serves &= !c->seen[part][l] || c->seen[part][l] == memory[read];
		c->serves &= stores_before(c, kernel, read) <= most;
		c->seen[part][l] = memory[read];
	}
}

/* The parts of a kernel that are left, in every order; what they leave is to be the same. */
static void run_kernel(struct case_ *c, int kernel, unsigned done, int most, const int memory[ROWS], int *has_run)
{
	int is_end = 1;

	for (int i = 0; i < c->count; i++) {
		int then[ROWS];

		if (done >> i & 1 || part_kernel(&c->parts[i]) != kernel)
			continue;
		is_end = 0;
		memcpy(then, memory, sizeof then);
		run_part(c, i, most, then);
		run_kernel(c, kernel, done | 1u << i, most, then, has_run);
	}
	if (is_end && *has_run)
		c->serves &= !memcmp(c->after, memory, sizeof c->after);
	if (is_end && !*has_run)
		memcpy(c->after, memory, sizeof c->after);
	*has_run |= is_end;
}

static int serves(struct case_ *c, int most)
{
	int memory[ROWS] = {0};

	c->serves = 1;
	memset(c->seen, 0, sizeof c->seen);
	for (int k = 0; k <= MOST_PARTS; k++) {
		int has_run = 0;

		run_kernel(c, k < MOST_PARTS ? k : INT_MAX, 0, most, memory, &has_run);
		memcpy(memory, c->after, sizeof memory);
	}
	return c->serves;
}

/* ---- parts that are drawn ---- */

static void draw_line(struct dag *d, struct plan *p, struct rng *r, double stores)
{
	int row = rng_below(r, ROWS), is_last = rng_chance(r, 0.9);
	struct ref none = {0};

	if (rng_chance(r, stores)) {
		dag_output(d, is_last ? OTHER : OWN, row, dag_input(d, 0, row));
		plan_add_line(p, LINE_STORE, d->outputs[d->output_count - 1].value, d->output_count - 1);
	} else if (rng_chance(r, 0.1)) {
		plan_add_line(p, LINE_VALUE, none, 0);
	} else {
		plan_add_line(p, LINE_INPUT, dag_input(d, is_last ? OTHER : 0, row), 0);
	}
}

/* The first kernels store more, and the last ones read. */
static void draw_parts(struct case_ *c, struct rng *r, struct arena *a)
{
	c->count = 1 + rng_below(r, MOST_PARTS);
	for (int i = 0; i < c->count; i++) {
		struct part *p = &c->parts[i];

		p->is_before = i + 1 < c->count && rng_chance(r, 0.8);
		p->level = rng_below(r, 3);
		p->function.plan = (struct plan){.dag = c->dag, .lines = arena_alloc(a, MOST_LINES, sizeof *p->function.plan.lines)};
		for (int lines = rng_below(r, MOST_LINES + 1); lines > 0; lines--)
			draw_line(c->dag, &p->function.plan, r, p->is_before ? (p->level ? 0.5 : 0.9) : 0.3);
	}
}

START_TEST(test_drawn)
{
	struct case_ c = {.parts = calloc(MOST_PARTS, sizeof *c.parts)};
	int good = 0, several = 0;

	for (unsigned long long seed = 1; seed <= DRAWS && c.parts; seed++) {
		struct rng r = rng_seed(seed);
		int most = 1 + rng_below(&r, 2), expected, found;
		struct arena a;
		struct dag d;

		arena_init(&a, NULL);
		dag_init(&d, &a);
		dag_argument(&d, "q", ROWS, 0);
		dag_argument(&d, "own", ROWS, 1);
		dag_argument(&d, "tau", ROWS, 1);
		c.dag = &d;
		draw_parts(&c, &r, &a);
		expected = serves(&c, most);
		found = turns_serve(c.parts, c.count, ROWS, most, &a);
		ck_assert_msg(found == expected, "seed %llu: %s", seed, found ? "a row is not what was left there" : "all goes well");
		good += expected;
		several += expected && c.count > 2;
		arena_free(&a);
	}
	free(c.parts);
	ck_assert_msg(good > DRAWS / 20 && good < DRAWS / 2 && several > DRAWS / 100, "%d serve, %d of several parts", good, several);
}
END_TEST

/* ---- stores that wait ---- */

/* By line: the last one, from 1, that reads the row which it stores; 0: none does. */
static size_t last_reading(const struct case_ *c, const struct plan *p, const struct line *l)
{
	size_t last = 0;

	for (size_t i = 0; i < p->line_count; i++)
		if (row_of(c, l, LINE_STORE) >= 0 && row_of(c, &p->lines[i], LINE_INPUT) == row_of(c, l, LINE_STORE))
			last = i + 1;
	return last;
}

static int is_line(const struct line *a, const struct line *b)
{
	return a->kind == b->kind && a->value.i == b->value.i && a->index == b->index;
}

static size_t place_of(const struct plan *p, const struct line *l)
{
	size_t i = 0;

	while (i < p->line_count && !is_line(&p->lines[i], l))
		i++;
	return i;
}

/* Whether a line waits or not, those that it stood behind are before it still, unless they wait for longer. */
static void expect_delayed(const struct case_ *c, const struct plan *p, const struct plan *now, unsigned long long seed)
{
	for (size_t i = 0; i < p->line_count; i++) {
		size_t own = last_reading(c, p, &p->lines[i]), place = place_of(now, &p->lines[i]), then = own > i + 1 ? own : i + 1;

		ck_assert_msg(place < p->line_count, "seed %llu: line %zu is lost", seed, i);
		ck_assert_msg(!own || place_of(now, &p->lines[own - 1]) < place, "seed %llu: line %zu stores a row that is read later",
			seed, i);
		for (size_t k = 0; k < p->line_count; k++) {
			size_t last = last_reading(c, p, &p->lines[k]), comes = last > k + 1 ? last : k + 1;
			int is_before = comes < then || (comes == then && (k == comes - 1 || (i != then - 1 && k < i)));

			if (k != i && (place_of(now, &p->lines[k]) < place) != is_before)
				ck_abort_msg("seed %llu: line %zu does not come %s line %zu", seed, k, is_before ? "before" : "behind", i);
		}
	}
	ck_assert_msg(drawn_first_too_early(now) == now->line_count, "seed %llu: a value is read before it is made", seed);
}

/* It would catch a store that waits too little, so that the row is lost, or longer than it must, and keeps a register. */
START_TEST(test_delay)
{
	int waits = 0;

	for (unsigned long long seed = 1; seed <= PLANS; seed++) {
		const struct drawn_knobs knobs = {.named = 0.5, .named_inputs = 1, .late = 0.1};
		struct rng r = rng_seed(seed);
		struct case_ c = {.parts = NULL};
		struct arena a;
		struct dag d;
		struct plan p, now;

		arena_init(&a, NULL);
		dag_init(&d, &a);
		c.dag = &d;
		drawn_inputs(&d, dag_argument(&d, "q", ROWS, 0), ROWS);
		dag_argument(&d, "own", ROWS, 1);
		drawn_inputs(&d, dag_argument(&d, "tau", 3 * ROWS, 1), ROWS);
		drawn_operations(&d, &r, 4 + rng_below(&r, 14));
		drawn_outputs(&d, &r, rng_chance(&r, 0.9) ? OTHER : OWN);
		drawn_plan(&p, &d, &r, &knobs, &a);
		now = p;
		now.lines = arena_alloc(&a, p.line_count, sizeof *now.lines);
		memcpy(now.lines, p.lines, p.line_count * sizeof *now.lines);
		ck_assert(turns_delay_stores(&now, &a));
		expect_delayed(&c, &p, &now, seed);
		waits += memcmp(now.lines, p.lines, p.line_count * sizeof *now.lines) != 0;
		arena_free(&a);
	}
	ck_assert_msg(waits > PLANS / 20, "stores wait in %d plans", waits);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("turns");

	suite_add(s, "drawn", test_drawn, 1, 20);
	suite_add(s, "delay", test_delay, 1, 20);
	return suite_run(s);
}
