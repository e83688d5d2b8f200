/* Limbs that share nothing, beside sets of operations of each output of small DAGs that are drawn. It would catch rows that are
   put into one part though nothing joins them: the part is longer, and no number changes; and rows that are parted though they
   share an operation, which is then made twice, or read a row that another part leaves, which a GPU may write too late. */
#include "plan/drawn.h"
#include "plan/grid/joined.h"
#include "support/suite.h"

/* The arguments. A base, where there is one, has the first rows, and of q one more. */
enum { Q, QD, GRAVITY, OUT, ARGUMENTS };
enum { MOST_ROWS = 8, BASE_ROWS = 3, MOST_OUTPUTS = 3 * MOST_ROWS, DRAWS = 3000 };

struct case_ {
	struct dag dag;
	struct tree tree;
	struct tree_joint joints[MOST_ROWS];
	int rows, base_rows;
	uint64_t cones[MOST_OUTPUTS]; /* by output: operations that it takes and that join */
	uint64_t left[MOST_OUTPUTS];  /* rows of the output that one of these reads */
};

static int of_base(const struct case_ *c, const struct node *n)
{
	int row = (int)n->arg[1].i;

	return c->base_rows && (n->arg[0].i == OUT ? row % c->rows : row) < c->base_rows + (n->arg[0].i == Q);
}

/* Does the node differ from sample to sample, the base's inputs aside, and what is left in its rows? */
static int varies(const struct case_ *c, uint32_t node)
{
	const struct node *n = &c->dag.nodes[node];

	if (n->op == OP_INPUT)
		return n->arg[0].i != GRAVITY && !of_base(c, n);
	for (int k = 0; k < op_arity[n->op]; k++)
		if (varies(c, n->arg[k].i))
			return 1;
	return 0;
}

static void take(struct case_ *c, int output, uint32_t node)
{
	const struct node *n = &c->dag.nodes[node];

	if (!node_is_operation(n) || !varies(c, node))
		return;
	c->cones[output] |= (uint64_t)1 << node;
	for (int k = 0; k < op_arity[n->op]; k++) {
		const struct node *x = &c->dag.nodes[n->arg[k].i];

		if (x->op == OP_INPUT && x->arg[0].i == OUT)
			c->left[output] |= (uint64_t)1 << x->arg[1].i;
		take(c, output, n->arg[k].i);
	}
}

static int row_of(const struct case_ *c, int output)
{
	return c->dag.outputs[output].row % c->rows;
}

/* Rows `row` and the next one are of a limb: two outputs that are joined have rows on both sides of the gap between them. */
static int is_joined_there(const struct case_ *c, int row)
{
	int count = (int)c->dag.output_count;

	for (int i = 0; i < count; i++)
		for (int k = 0; k < count; k++)
			if (row_of(c, i) <= row && row_of(c, k) > row && (c->cones[i] & c->cones[k] ||
				c->left[i] >> c->dag.outputs[k].row & 1 || c->left[k] >> c->dag.outputs[i].row & 1))
				return 1;
	return 0;
}

static unsigned operations(const struct case_ *c, int first, int last)
{
	uint64_t set = 0;
	unsigned count = 0;

	for (int i = 0; i < (int)c->dag.output_count; i++)
		if (row_of(c, i) >= first && row_of(c, i) <= last)
			set |= c->cones[i];
	for (; set; set &= set - 1)
		count++;
	return count;
}

static int end_of_limb(const struct case_ *c, int first)
{
	while (first + 1 < c->rows && is_joined_there(c, first))
		first++;
	return first;
}

/* The longest limb's operations. */
static unsigned longest(const struct case_ *c)
{
	unsigned most = 0;

	for (int first = 0, last; first < c->rows; first = last + 1) {
		last = end_of_limb(c, first);
		most = operations(c, first, last) > most ? operations(c, first, last) : most;
	}
	return most;
}

/* Limbs one after the other, as long as the part is little longer than the longest limb. Returns how many parts there are. */
static int parts_of(const struct case_ *c, int *part)
{
	int parts = 0, begin = 0;

	for (int first = 0, last; first < c->rows; first = last + 1) {
		last = end_of_limb(c, first);
		if (!parts || 8 * operations(c, begin, last) > 9 * longest(c)) {
			begin = first;
			parts++;
		}
		for (int row = first; row <= last; row++)
			part[row] = parts - 1;
	}
	return parts;
}

/* ---- what is drawn ---- */

static void draw_tree(struct case_ *c)
{
	int joints = 0;

	if (c->base_rows)
		c->joints[joints++] = (struct tree_joint){.nq = BASE_ROWS + 1, .nv = BASE_ROWS};
	for (int row = c->base_rows; row < c->rows; row++)
		c->joints[joints++] = (struct tree_joint){.iq = row + (c->base_rows > 0), .nq = 1, .iv = row, .nv = 1};
	c->tree = (struct tree){.joints = c->joints, .joint_count = joints, .nv = c->rows};
}

/* A node of these rows that is there; seldom of any, or what all samples share, or the base's. */
static struct ref operand(struct case_ *c, struct rng *r, int first, int last, struct ref own, double apart)
{
	struct dag *d = &c->dag;
	int row = first + rng_below(r, last - first + 1);

	if (d->count > 1 && rng_chance(r, apart))
		return (struct ref){1 + (uint32_t)rng_below(r, (int)d->count - 1)};
	if (own.i && rng_chance(r, 0.6))
		return own;
	if (rng_chance(r, 0.3))
		return c->base_rows ? dag_input(d, rng_chance(r, 0.5) ? Q : QD, rng_below(r, BASE_ROWS)) : dag_input(d, GRAVITY, 0);
	if (rng_chance(r, 0.05))
		return dag_input(d, OUT, row + rng_below(r, 3) * c->rows);
	return rng_chance(r, 0.5) ? dag_input(d, Q, row + (c->base_rows > 0)) : dag_input(d, QD, row);
}

/* Of some rows, of which each has two outputs at most, which may share nothing. */
static void draw_limb(struct case_ *c, struct rng *r, int first, int last, double apart)
{
	struct ref own = {0}, none = {0};

	for (int k = 2 * first; k <= 2 * last + 1; k++) {
		if (rng_chance(r, 0.4))
			own = none;
		for (int more = rng_below(r, 3); more >= 0 && c->dag.count < 60; more--) {
			struct ref x = operand(c, r, first, last, own, apart), y = operand(c, r, first, last, own, apart);

			own = dag_node(&c->dag, more % 2 ? OP_MUL : OP_ADD, x, y, none, 0);
		}
		if (own.i && rng_chance(r, 0.5))
			dag_output(&c->dag, OUT, k / 2 + (k % 2 ? rng_below(r, 2) : 2) * c->rows, own);
	}
}

static void draw(struct case_ *c, struct rng *r, struct arena *a)
{
	double apart = rng_chance(r, 0.5) ? 0 : 0.05;

	*c = (struct case_){.rows = BASE_ROWS + 1 + rng_below(r, MOST_ROWS - BASE_ROWS)};
	c->base_rows = rng_chance(r, 0.5) ? BASE_ROWS : 0;
	draw_tree(c);
	dag_init(&c->dag, a);
	dag_argument_of(&c->dag, (struct argument){.name = "q", .rows = c->rows + (c->base_rows > 0), .role = ROLE_JOINT_POSITION});
	dag_argument_of(&c->dag, (struct argument){.name = "qd", .rows = c->rows, .role = ROLE_JOINT_VELOCITY});
	dag_argument_of(&c->dag, (struct argument){.name = "g", .rows = 1, .per_batch = 1, .role = ROLE_GRAVITY});
	dag_argument_of(&c->dag, (struct argument){.name = "vjp", .rows = 3 * c->rows, .is_output = 1, .role = ROLE_VJP});
	for (int first = 0, last; first < c->rows; first = last + 1) {
		last = first + rng_below(r, c->rows - first < 3 ? c->rows - first : 3);
		draw_limb(c, r, first, last, apart);
	}
	for (int i = 0; i < (int)c->dag.output_count; i++)
		take(c, i, c->dag.outputs[i].value.i);
}

START_TEST(test_drawn)
{
	int several = 0, single = 0;

	for (unsigned long long seed = 1; seed <= DRAWS; seed++) {
		struct rng r = rng_seed(seed);
		int owner[MOST_OUTPUTS], part[MOST_ROWS], parts, found;
		struct arena a;
		struct case_ c;

		arena_init(&a, NULL);
		draw(&c, &r, &a);
		parts = parts_of(&c, part);
		found = c.base_rows ? joined_own_beyond(owner, &c.dag, &c.tree, c.base_rows, &a) : joined_own(owner, &c.dag, c.rows, &a);
		ck_assert_msg(found == parts, "seed %llu: %d parts, not %d", seed, found, parts);
		for (int i = 0; i < (int)c.dag.output_count; i++)
			ck_assert_msg(owner[i] == part[row_of(&c, i)], "seed %llu: row %d is of part %d, not %d", seed, row_of(&c, i), owner[i],
				part[row_of(&c, i)]);
		several += parts > 2;
		single += parts == 1;
		arena_free(&a);
	}
	ck_assert_msg(several > DRAWS / 10 && single > DRAWS / 100, "%d of more than two parts, %d of one", several, single);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("joined");

	suite_add(s, "drawn", test_drawn, 1, 20);
	return suite_run(s);
}
