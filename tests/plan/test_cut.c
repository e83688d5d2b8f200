/* The fewest values through which all goes, beside a search over all sets of nodes of small DAGs that are drawn. It would catch
   a cut that is larger than it need be, which hands on too many numbers and changes no result; one past which a path goes, which
   only a robot whose hands meet in that way would show; and one far from where paths begin, for which a kernel makes more. */
#include "plan/drawn.h"
#include "plan/grid/hands/cut.h"
#include "support/suite.h"

enum { DAGS = 3000, MOST_NODES = 18, WIDTH = 4 };

struct case_ {
	struct dag dag;
	unsigned char from[MOST_NODES], to[MOST_NODES];
};

static unsigned operands_of(const struct dag *d, uint32_t node)
{
	unsigned set = 0;

	for (int k = 0; k < op_arity[d->nodes[node].op]; k++)
		set |= 1u << d->nodes[node].arg[k].i;
	return set;
}

/* Nodes that paths reach which may not go over `without`. */
static unsigned reached(const struct case_ *c, unsigned without)
{
	unsigned set = 0;

	for (uint32_t i = 0; i < c->dag.count; i++)
		if (!(without >> i & 1) && (c->from[i] || operands_of(&c->dag, i) & set))
			set |= 1u << i;
	return set;
}

static unsigned ends(const struct case_ *c)
{
	unsigned set = 0;

	for (uint32_t i = 0; i < c->dag.count; i++)
		set |= (unsigned)c->to[i] << i;
	return set;
}

/* Nodes over which a path goes. */
static unsigned between(const struct case_ *c)
{
	unsigned set = ends(c);

	for (uint32_t i = (uint32_t)c->dag.count; i-- > 0;)
		set |= set >> i & 1 ? operands_of(&c->dag, i) : 0;
	return set & reached(c, 0);
}

static int size_of(unsigned set)
{
	int count = 0;

	for (; set; set &= set - 1)
		count++;
	return count;
}

static unsigned nodes_of(const struct cut *c, unsigned long long seed)
{
	unsigned set = 0;

	for (int i = 0; i < c->count; i++) {
		ck_assert_msg(i == 0 || c->nodes[i] > c->nodes[i - 1], "seed %llu: not in the order of the DAG", seed);
		set |= 1u << c->nodes[i];
	}
	return set;
}

static void expect_least(const struct case_ *c, const struct cut *cut, unsigned long long seed)
{
	unsigned own = nodes_of(cut, seed), all = between(c), before = reached(c, own) & all;

	ck_assert_msg(!(reached(c, own) & ends(c)), "seed %llu: a path goes past the cut", seed);
	for (unsigned set = all, next = 1; next; set = (set - 1) & all) {
		next = set;
		if (size_of(set) > cut->count || reached(c, set) & ends(c))
			continue;
		if (size_of(set) < cut->count)
			ck_abort_msg("seed %llu: %d nodes, where %d suffice", seed, cut->count, size_of(set));
		if (before & ~reached(c, set))
			ck_abort_msg("seed %llu: cut %x is nearer than %x", seed, set, own);
	}
}

/* Paths begin and end at any node. */
static void draw_any(struct case_ *c, struct rng *r)
{
	drawn_inputs(&c->dag, dag_argument(&c->dag, "q", WIDTH, 0), 2 + rng_below(r, WIDTH - 1));
	drawn_operations(&c->dag, r, 3 + rng_below(r, MOST_NODES - WIDTH - 3));
	for (uint32_t i = 1; i < c->dag.count; i++) {
		c->from[i] = rng_chance(r, i <= WIDTH ? 0.6 : 0.15);
		c->to[i] = rng_chance(r, i <= WIDTH ? 0.1 : 0.4);
	}
}

/* From the first layer of nodes to the last one, so that paths are in each other's way. */
static void draw_layers(struct case_ *c, struct rng *r)
{
	const struct ref none = {0};
	struct dag *d = &c->dag;
	uint32_t first = (uint32_t)d->count;

	drawn_inputs(d, dag_argument(d, "q", WIDTH, 0), WIDTH);
	for (int layer = 1; layer < 4; layer++) {
		uint32_t before = first, end = (uint32_t)d->count;

		first = end;
		for (int k = 0; k < WIDTH; k++) {
			struct ref x = {before + (uint32_t)rng_below(r, (int)(end - before))};
			struct ref y = {before + (uint32_t)rng_below(r, (int)(end - before))};

			if (rng_chance(r, 0.4))
				dag_node(d, OP_NEG, x, none, none, 0);
			else
				dag_node(d, OP_ADD, x, y, none, 0);
		}
	}
	for (uint32_t i = 1; i < d->count; i++) {
		c->from[i] = i <= WIDTH;
		c->to[i] = i >= first;
	}
}

START_TEST(test_drawn)
{
	int cuts = 0, wide = 0;

	for (unsigned long long seed = 1; seed <= DAGS; seed++) {
		struct rng r = rng_seed(seed);
		struct case_ c = {.from = {0}};
		struct arena a;
		struct cut cut;

		arena_init(&a, NULL);
		dag_init(&c.dag, &a);
		if (seed % 2)
			draw_any(&c, &r);
		else
			draw_layers(&c, &r);
		ck_assert(c.dag.count <= MOST_NODES);
		ck_assert(cut_find(&cut, &c.dag, c.from, c.to, &a));
		expect_least(&c, &cut, seed);
		cuts += cut.count > 0;
		wide += cut.count > 2;
		arena_free(&a);
	}
	ck_assert_msg(cuts > DAGS / 2 && wide > DAGS / 10, "%d cuts, %d of more than two nodes", cuts, wide);
}
END_TEST

/* As many paths as there may be, beside each other, and one more: then nothing is said. */
START_TEST(test_most)
{
	const struct ref none = {0};

	for (int more = 0; more < 2; more++) {
		unsigned char from[200] = {0}, to[200] = {0};
		struct arena a;
		struct dag d;
		struct cut cut;

		arena_init(&a, NULL);
		dag_init(&d, &a);
		for (int row = 0, q = dag_argument(&d, "q", 40, 0); row < CUT_MOST + more; row++) {
			struct ref x = dag_input(&d, q, row);

			from[x.i] = 1;
			to[dag_node(&d, OP_NEG, x, none, none, 0).i] = 1;
		}
		ck_assert(cut_find(&cut, &d, from, to, &a));
		ck_assert_msg(cut.count == (more ? 0 : CUT_MOST), "%d nodes", cut.count);
		for (int i = 0; i < cut.count; i++)
			ck_assert(from[cut.nodes[i]]);
		arena_free(&a);
	}
}
END_TEST

int main(void)
{
	Suite *s = suite_create("cut");

	suite_add(s, "drawn", test_drawn, 1, 20);
	suite_add(s, "most", test_most, 1, 20);
	return suite_run(s);
}
