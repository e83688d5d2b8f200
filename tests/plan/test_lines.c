/* Orders of lines, and counts of values at once, of small DAGs that are drawn. test_order looks at orders that are taken, of
   robots; here each is written. It would catch a line that comes before what it reads, or is lost, in an order that is not taken
   today; an order in which more values wait than need be, by which registers spill and no number changes; and values at once
   counted wrong, by which other kernels are chosen, with the same numbers. */
#include "plan/drawn.h"
#include "plan/early.h"
#include "plan/order.h"
#include "support/suite.h"
#include <limits.h>
#include <stdlib.h>

enum { JOINTS = 4, PLANS = 1500, TREES = 400, TREE_LINES = 13 };

struct case_ {
	struct arena arena;
	struct dag dag;
	struct plan plan;
	struct tree tree;
	struct tree_joint joints[JOINTS];
	unsigned long long seed;
};

static void begin(struct case_ *c, unsigned long long seed)
{
	static const enum role roles[] = {ROLE_JOINT_POSITION, ROLE_JOINT_VELOCITY, ROLE_JOINT_TORQUE, ROLE_GRAVITY};

	c->seed = seed;
	arena_init(&c->arena, NULL);
	dag_init(&c->dag, &c->arena);
	for (size_t i = 0; i < sizeof roles / sizeof *roles; i++)
		dag_argument_of(&c->dag, (struct argument){.name = "in", .rows = roles[i] == ROLE_GRAVITY ? 3 : JOINTS, .role = roles[i]});
	for (int i = 0; i < JOINTS; i++)
		c->joints[i] = (struct tree_joint){.iq = i, .nq = 1, .iv = i, .nv = 1};
	c->tree = (struct tree){.joints = c->joints, .joint_count = JOINTS, .nv = JOINTS};
}

static void draw(struct case_ *c, unsigned long long seed)
{
	struct rng r = rng_seed(seed);
	const struct drawn_knobs knobs = {.named = rng_uniform(&r, 0.3, 1), .named_inputs = 1, .late = 0.3};

	begin(c, seed);
	for (int i = 0; i < 4; i++)
		drawn_inputs(&c->dag, i, rng_below(&r, i < 3 ? JOINTS + 1 : 3));
	dag_const(&c->dag, 2);
	drawn_operations(&c->dag, &r, 3 + rng_below(&r, 30));
	drawn_outputs(&c->dag, &r, dag_argument(&c->dag, "qdd", JOINTS, 1));
	drawn_plan(&c->plan, &c->dag, &r, &knobs, &c->arena);
	c->plan.tree = &c->tree;
}

/* ---- values at once ---- */

/* By line: values that wait behind it; with `at`, those that are there while it is made, what it reads and makes among them. */
static int most_at_once(const struct plan *p, int at)
{
	size_t *first = calloc(2 * p->dag->count, sizeof *first), *last = first + p->dag->count;
	unsigned char *reads = calloc(p->dag->count, 1);
	int most = 0;

	ck_assert(first && reads);
	for (size_t l = 0; l < p->line_count; l++) {
		uint32_t made[2];

		drawn_reads(p, &p->lines[l], reads);
		for (int k = drawn_made(p, &p->lines[l], made); k-- > 0;)
			first[made[k]] = last[made[k]] = l + 1;
		for (size_t i = 0; i < p->dag->count; i++)
			last[i] = reads[i] ? l + 1 : last[i];
	}
	for (size_t l = 1; l <= p->line_count; l++) {
		int count = 0;

		for (size_t i = 0; i < p->dag->count; i++)
			count += first[i] && first[i] <= l && (last[i] > l || (at && first[i] < l && last[i] == l));
		most = count > most ? count : most;
	}
	free(reads);
	free(first);
	return most;
}

/* While a node is made: those before it that it or a later one reads, and itself where a later one reads it. */
static int at_node(const struct dag *d, uint32_t node)
{
	int count = 0;

	for (uint32_t i = 0; i <= node; i++) {
		int is_read = 0;

		for (uint32_t by = i == node ? node + 1 : node; by < d->count && d->nodes[i].op != OP_CONST; by++)
			for (int k = 0; k < op_arity[d->nodes[by].op]; k++)
				is_read |= d->nodes[by].arg[k].i == i;
		count += is_read;
	}
	return count;
}

START_TEST(test_alive)
{
	struct case_ *c = calloc(1, sizeof *c);

	for (unsigned long long seed = 1; seed <= PLANS && c; seed++) {
		int most = 0, lines, room = (int)(seed % 9);
		size_t beyond = 0;
		struct waits w;

		draw(c, seed);
		for (uint32_t i = 0; i < c->dag.count; i++) {
			int count = at_node(&c->dag, i);

			most = count > most ? count : most;
			beyond += count > room ? (size_t)(count - room) : 0;
		}
		w = plan_waits(&c->plan, room, &c->arena);
		ck_assert_msg(w.most == most && plan_alive(&c->plan, &c->arena) == most, "seed %llu: %d at once, not %d", seed, most, w.most);
		ck_assert_msg(w.beyond == beyond, "seed %llu: %zu have no room, not %zu", seed, beyond, w.beyond);
		ck_assert(readings_alive(&lines, &c->plan, &c->arena));
		ck_assert_msg(lines == most_at_once(&c->plan, 1), "seed %llu: %d at once by lines, not %d", seed,
			most_at_once(&c->plan, 1), lines);
		arena_free(&c->arena);
	}
	free(c);
}
END_TEST

/* ---- orders ---- */

/* Each line once, behind what it reads. */
static void expect_order(const struct case_ *c, const struct plan *p, const char *what)
{
	size_t *count = calloc(c->dag.count + c->dag.output_count, sizeof *count), early = drawn_first_too_early(p);

	ck_assert(count != NULL);
	ck_assert_msg(p->line_count == c->plan.line_count, "seed %llu: %s has %zu lines, not %zu", c->seed, what, p->line_count,
		c->plan.line_count);
	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++)
		if (count[l->kind == LINE_STORE ? c->dag.count + l->index : l->value.i]++)
			ck_abort_msg("seed %llu: %s has node %u twice", c->seed, what, l->value.i);
	ck_assert_msg(early == p->line_count, "seed %llu: in %s line %zu reads what is not there", c->seed, what, early);
	free(count);
}

static struct plan written(struct case_ *c, struct orderer *x, enum order_way way)
{
	struct plan p = c->plan;

	order_write(x, way);
	p.lines = arena_alloc(&c->arena, c->plan.line_count, sizeof *p.lines);
	p.line_count = x->count;
	for (uint32_t i = 0; i < x->count; i++)
		p.lines[i] = c->plan.lines[x->order[i]];
	return p;
}

/* The last joint whose inputs the node takes; -1: none. */
static int reach(const struct dag *d, uint32_t node)
{
	const struct node *n = &d->nodes[node];
	int last = n->op == OP_INPUT && d->arguments[n->arg[0].i].role != ROLE_GRAVITY ? (int)n->arg[1].i : -1;

	for (int k = 0; k < op_arity[n->op]; k++)
		last = reach(d, n->arg[k].i) > last ? reach(d, n->arg[k].i) : last;
	return last;
}

/* What the first joints are enough for comes before what takes others. */
static void expect_joints(const struct case_ *c, const struct plan *p, const struct orderer *x)
{
	for (size_t l = 0, joint = 0; l < p->line_count; l++) {
		int own = reach(&c->dag, p->lines[l].value.i);

		if (p->lines[l].kind == LINE_INPUT)
			continue;
		ck_assert_msg(own < 0 || own >= (int)joint, "seed %llu: line %zu takes joint %d alone, behind %zu", c->seed, l, own, joint);
		joint = own < 0 ? joint : (size_t)own;
		ck_assert_msg(x->row_at[l] == (int)joint, "seed %llu: line %zu is of joint %d, not %zu", c->seed, l, x->row_at[l], joint);
	}
}

START_TEST(test_orders)
{
	static const char *const ways[] = {[ORDER_ROWS] = "by rows", [ORDER_BIAS] = "the bias first", [ORDER_INPUTS] = "by inputs"};
	struct case_ *c = calloc(1, sizeof *c);

	for (unsigned long long seed = 1; seed <= PLANS && c; seed++) {
		struct orderer x = {.p = &c->plan, .t = &c->tree};
		struct plan p;

		draw(c, seed);
		ck_assert(order_begin(&x, &c->arena));
		for (enum order_way way = ORDER_ROWS; way <= ORDER_INPUTS; way++) {
			p = written(c, &x, way);
			expect_order(c, &p, ways[way]);
		}
		expect_joints(c, &p, &x);
		ck_assert(plan_early(&p, &c->plan, &c->arena));
		expect_order(c, &p, "early lines");
		ck_assert_msg(most_at_once(&p, 0) <= most_at_once(&c->plan, 0), "seed %llu: more wait behind early lines", seed);
		arena_free(&c->arena);
	}
	free(c);
}
END_TEST

/* ---- trees, of which a search finds the best order ---- */

/* Each value is read once. */
static struct ref draw_tree(struct case_ *c, struct rng *r, int *left, int *leaf)
{
	static const enum op ops[] = {OP_NEG, OP_ADD, OP_MUL, OP_SUB, OP_FMA, OP_FMA};
	enum op op = ops[rng_below(r, sizeof ops / sizeof *ops)];
	struct ref arg[3] = {{0}};

	if (*left < 1 + op_arity[op] || rng_chance(r, 0.2)) {
		int row = (*leaf)++;

		return dag_input(&c->dag, row / JOINTS, row % JOINTS);
	}
	*left -= op_arity[op];
	for (int k = 0; k < op_arity[op]; k++)
		arg[k] = draw_tree(c, r, left, leaf);
	return dag_node(&c->dag, op, arg[0], arg[1], arg[2], 0);
}

/* The fewest values at once behind a line, of all orders: by sets of lines that are done. */
static int fewest(const struct plan *p)
{
	unsigned needs[TREE_LINES] = {0}, sets = 1u << p->line_count;
	unsigned char *reads = calloc(p->dag->count, 1);
	int found, *best = malloc(sets * sizeof *best);

	ck_assert(reads && best);
	for (size_t l = 0; l < p->line_count; l++) {
		drawn_reads(p, &p->lines[l], reads);
		for (size_t k = 0; k < p->line_count; k++)
			needs[l] |= p->lines[k].kind != LINE_STORE && reads[p->lines[k].value.i] ? 1u << k : 0;
	}
	for (unsigned set = 0; set < sets; set++)
		best[set] = set ? INT_MAX : 0;
	for (unsigned set = 0; set < sets; set++)
		for (size_t l = 0; l < p->line_count && best[set] < INT_MAX; l++) {
			unsigned then = set | 1u << l;
			int waits = 0, most;

			if (then == set || needs[l] & ~set)
				continue;
			for (size_t k = 0; k < p->line_count; k++)
				for (size_t by = 0; by < p->line_count && then >> k & 1; by++)
					waits += needs[by] >> k & 1 && !(then >> by & 1);
			most = best[set] > waits ? best[set] : waits;
			best[then] = most < best[then] ? most : best[then];
		}
	found = best[sets - 1];
	free(best);
	free(reads);
	return found;
}

/* Operands come first that need most (Sethi and Ullman 1970): no order of a tree is better. */
START_TEST(test_trees)
{
	struct case_ *c = calloc(1, sizeof *c);
	int wide = 0;

	for (unsigned long long seed = 1; seed <= TREES && c; seed++) {
		struct rng r = rng_seed(seed);
		const struct drawn_knobs knobs = {.named = seed % 2 ? 1 : 0.6, .named_inputs = 1, .late = 0.3};
		struct orderer x = {.p = &c->plan, .t = &c->tree};
		int left = TREE_LINES - 1, leaf = 0, least;
		struct plan p;

		begin(c, seed);
		dag_output(&c->dag, dag_argument(&c->dag, "qdd", JOINTS, 1), 0, draw_tree(c, &r, &left, &leaf));
		drawn_plan(&c->plan, &c->dag, &r, &knobs, &c->arena);
		c->plan.tree = &c->tree;
		ck_assert(c->plan.line_count <= TREE_LINES && order_begin(&x, &c->arena));
		p = written(c, &x, ORDER_ROWS);
		least = fewest(&c->plan);
		ck_assert_msg(most_at_once(&p, 0) == least, "seed %llu: %d wait, where %d may", seed, most_at_once(&p, 0), least);
		wide += least > 2;
		arena_free(&c->arena);
	}
	free(c);
	ck_assert_msg(wide > TREES / 10, "in %d of %d trees more than two wait", wide, TREES);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("lines");

	suite_add(s, "alive", test_alive, 1, 20);
	suite_add(s, "orders", test_orders, 1, 20);
	suite_add(s, "trees", test_trees, 1, 20);
	return suite_run(s);
}
