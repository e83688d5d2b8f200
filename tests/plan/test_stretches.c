/* Rows that a part stages, beside the rows that small DAGs touch. A row that is missed changes numbers; this would catch rows too
   many, for which a part moves memory that it does not need, or finds no room: a shorter gap than there is, a stretch that holds
   rows of nobody, places of a vjp wider than they must be. */
#include "plan/drawn.h"
#include "plan/stretch.h"
#include "support/suite.h"

enum { Q, QD, QDD, WEIGHT, TAU, VJP, MOST_ARGUMENTS };
enum { MOST_ROWS = 40, LEAST_GAP = 4, DRAWS = 1500 };

struct case_ {
	struct dag dag;
	int nv, nq, arguments;
	unsigned char touched[MOST_ARGUMENTS][MOST_ROWS], any[MOST_ROWS]; /* by row; of all arrays */
	struct stretches s;
	unsigned long long seed;
};

static void find_touched(struct case_ *c)
{
	for (size_t i = 0; i < c->dag.count; i++)
		if (c->dag.nodes[i].op == OP_INPUT)
			c->touched[c->dag.nodes[i].arg[0].i][c->dag.nodes[i].arg[1].i] = 1;
	for (size_t i = 0; i < c->dag.output_count; i++)
		c->touched[c->dag.outputs[i].argument][c->dag.outputs[i].row % c->nv] = 1;
	for (int i = 0; i < c->arguments; i++)
		for (int row = 0; row < MOST_ROWS; row++)
			c->any[row] |= c->touched[i][row];
}

/* The first row behind the longest run that nobody touches, which somebody stands before; 0: there is none of this length. */
static int behind_gap(const struct case_ *c, int *gap)
{
	int second = 0;

	*gap = LEAST_GAP - 1;
	for (int first = 1; first < c->nv; first++)
		for (int end = first; end < c->nv && !c->any[end]; end++)
			if (c->any[first - 1] && c->any[end + 1] && end + 1 < c->nv && end + 1 - first > *gap) {
				*gap = end + 1 - first;
				second = end + 1;
			}
	return second;
}

/* From the first row that is touched to the last one, of rows `from` to `to` - 1. */
static struct stretch span(const struct case_ *c, int argument, int from, int to)
{
	struct stretch s = {0, 0};

	for (int row = from; row < to; row++)
		if (c->touched[argument][row])
			s = s.rows ? (struct stretch){s.first, row + 1 - s.first} : (struct stretch){row, 1};
	return s;
}

static int is_equal(struct stretch a, struct stretch b)
{
	return a.rows == b.rows && (!a.rows || a.first == b.first);
}

/* What an array's own stretches are: where nothing is touched, one row, that its place has anyway. */
static void expect_own(const struct case_ *c, int argument)
{
	int second = c->s.gap ? c->s.second : MOST_ROWS;
	struct stretch one = span(c, argument, 0, second), two = span(c, argument, second, MOST_ROWS);
	const struct stretch *own = c->s.own[argument];

	if (!one.rows && !two.rows)
		*(c->s.gap ? &two : &one) = (struct stretch){c->s.gap ? second : 0, 1};
	ck_assert_msg(is_equal(own[0], one) && is_equal(own[1], two), "seed %llu: rows %d, %d and %d, %d of argument %d", c->seed,
		own[0].first, own[0].rows, own[1].first, own[1].rows, argument);
}

/* Widened so that it holds these rows. */
static struct stretch both(struct stretch a, struct stretch b)
{
	int first = a.rows && a.first < b.first ? a.first : b.first, end = a.first + a.rows;

	if (!a.rows || !b.rows)
		return a.rows ? a : b;
	return (struct stretch){first, (end > b.first + b.rows ? end : b.first + b.rows) - first};
}

/* Of the array that has this place, and what stands there too: with a gap, from its end or to its begin. */
static void expect_place(const struct case_ *c, int place)
{
	struct stretch held[STRETCHES] = {{0, 0}, {0, 0}};

	for (int i = 0; i < c->arguments; i++)
		for (int k = 0; k < STRETCHES; k++)
			if (c->s.place_of[i] == place)
				held[k] = both(held[k], c->s.own[i][k]);
	if (c->s.gap) {
		held[0] = both(held[0], (struct stretch){c->s.second - c->s.gap - 1, 1});
		held[1] = both(held[1], (struct stretch){c->s.second, 1});
	}
	ck_assert_msg(is_equal(c->s.place[place][0], held[0]) && is_equal(c->s.place[place][1], held[1]),
		"seed %llu: rows %d, %d in place %d", c->seed, c->s.place[place][0].first, c->s.place[place][0].rows, place);
}

/* The places of q, qd and qdd, alike, with the vjp's rows among them. */
static void expect_periods(const struct case_ *c)
{
	struct stretch all = {c->s.own[VJP][0].first + c->s.shift, c->s.own[VJP][0].rows};

	for (int i = Q; i <= QDD; i++)
		all = both(all, c->s.own[i][0]);
	for (int i = Q; i <= QDD; i++)
		ck_assert_msg(is_equal(c->s.place[i][0], all) && !c->s.place[i][1].rows, "seed %llu: rows %d, %d in place %d", c->seed,
			c->s.place[i][0].first, c->s.place[i][0].rows, i);
}

/* Rows of which some are touched, each by some arrays. */
static void draw(struct case_ *c, struct rng *r, int has_vjp, struct arena *a)
{
	static const enum role roles[] = {ROLE_JOINT_POSITION, ROLE_JOINT_VELOCITY, ROLE_JOINT_ACCELERATION, ROLE_COTANGENT,
		ROLE_JOINT_TORQUE, ROLE_VJP};
	double rows = rng_uniform(r, 0.1, 0.9);

	*c = (struct case_){.nv = 3 + rng_below(r, 20), .arguments = has_vjp ? MOST_ARGUMENTS : VJP, .seed = c->seed};
	c->nq = c->nv + rng_below(r, 2);
	dag_init(&c->dag, a);
	for (int i = 0; i < c->arguments; i++)
		dag_argument_of(&c->dag, (struct argument){.name = "x", .rows = i == Q ? c->nq : i == VJP ? 3 * c->nv : c->nv,
			.is_output = i >= TAU, .role = roles[i]});
	for (int row = 0; row < c->nv; row++)
		for (int i = 0, is_touched = rng_chance(r, rows); i < c->arguments && is_touched; i++) {
			if (rng_chance(r, 0.6))
				continue;
			if (i < TAU)
				dag_input(&c->dag, i, row);
			else
				dag_output(&c->dag, i, row + (i == VJP ? rng_below(r, 3) * c->nv : 0), (struct ref){0});
		}
	find_touched(c);
}

START_TEST(test_drawn)
{
	static struct case_ c;
	int gaps = 0;

	for (c.seed = 1; c.seed <= DRAWS; c.seed++) {
		struct rng r = rng_seed(c.seed);
		int has_vjp = rng_chance(&r, 0.4), gap, second;
		struct arena a;

		arena_init(&a, NULL);
		draw(&c, &r, has_vjp, &a);
		stretches_make(&c.s, &c.dag, c.nv);
		second = has_vjp ? 0 : behind_gap(&c, &gap);
		ck_assert_msg(second ? c.s.gap == gap && c.s.second == second : !c.s.gap, "seed %llu: a gap of %d before %d, not of %d",
			c.seed, c.s.gap, c.s.second, second ? gap : 0);
		for (int i = 0; i < c.arguments; i++)
			expect_own(&c, i);
		for (int i = 0; i < c.arguments; i++)
			if (c.s.place_of[i] == i && !(has_vjp && i <= QDD))
				expect_place(&c, i);
		if (has_vjp)
			expect_periods(&c);
		gaps += second > 0;
		arena_free(&a);
	}
	ck_assert_msg(gaps > DRAWS / 10, "%d with a gap", gaps);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("stretches");

	suite_add(s, "drawn", test_drawn, 1, 20);
	return suite_run(s);
}
