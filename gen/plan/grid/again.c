/* Rows come in the order of their numbers, the last first: a value is made for the last row that takes it. Where a stretch's
   rows take what was made for an earlier stretch, of joints of its own chain up to its own, they take a double of it. */
#include "plan/grid/again.h"

/* Joints in a stretch that are tried, and what a value costs for which there is no room while a node is made, in operations.
   Two are tried where four and three cut alike. H100, 1 M samples of tau with vjp, ns, by length of the stretches, none, 4, 3,
   2: atlas 1.38, 0.94, 0.85, 0.85, g1_29dof 1.59, 1.25, 1.00, 0.96, jvrc1 3.66 (whole), 2.96, 2.91, 3.83 (the compiler gives
   each thread 168 registers then), romeo 0.94, 0.87, 0.90, 0.92; of a floating base, whole and in one part: hyq 0.97, -, 0.63,
   0.53, atlas 6.92, -, 3.63, 3.55. 16384 samples, us: atlas -, 28.3, 24.1, 27.2, g1_29dof 42.3, 36.8, 32.2, 30.6. In f32 values
   have room: atlas 0.40, 0.43 (4), 0.47 (2). Where more values than MOST_KEPT wait at once, it is not tried, for it takes time
   and memory: 474 wait of g1_brainco, and 287 are left. */
static const int LENGTHS[] = {0, 4, 3, 2};
enum { LENGTH_COUNT = sizeof LENGTHS / sizeof *LENGTHS, ROOM = 110, MOST_KEPT = 1000 };
static const double COST_BEYOND = 0.03;

/* What a row belongs to: joints that follow each other without a branch. Rows of `base` and before are of the chain's parents,
   or of chains beside it. */
struct stretch_of_chain {
	int base, last;
	int times; /* tells its readings of inputs from those of the chain's other stretches: 1 is the last joints' */
};

struct again {
	const struct dag *d;
	const struct tree *t;
	const int *first_row;            /* by row: of the first limb that is alike; NULL: the row itself */
	int *parent, *children;          /* by last row of a joint: the last row of what carries it, or -1; how many it carries */
	struct stretch_of_chain *stretches;
	int count;                       /* of stretches */
	int *stretch;                    /* by row */
	int *made_for;                   /* by node: the last row that takes it; -1: none does */
	int *of;                         /* by node: the last row whose inputs it takes; -1: none */
	unsigned char *taken;            /* by stretch and node: the stretch takes a double of it */
	struct ref *map, *doubles;       /* by node; by stretch and node */
	size_t *made;                    /* by stretch: doubles of the nodes before this one are made */
};

/* ---- stretches ---- */

static int last_row(const struct tree *t, int row)
{
	const struct tree_joint *j = tree_joint_of_row(t, row);

	return j->iv + j->nv - 1;
}

/* The last row of the joint that carries this one; -1: the ground does. */
static int parent_of(const struct tree *t, const struct tree_joint *j)
{
	int b = t->bodies[j->body].parent;

	while (b >= 0 && (t->bodies[b].type == JOINT_FIXED || t->bodies[b].iv == j->iv))
		b = t->bodies[b].parent;
	return b < 0 ? -1 : last_row(t, t->bodies[b].iv);
}

int again_is_ordered(const struct tree *t)
{
	for (int i = 0; i < t->joint_count; i++)
		if (parent_of(t, &t->joints[i]) >= t->joints[i].iv)
			return 0;
	return 1;
}

static void find_parents(struct again *x)
{
	for (int i = 0; i < x->t->joint_count; i++) {
		const struct tree_joint *j = &x->t->joints[i];
		int parent = parent_of(x->t, j);

		x->parent[j->iv + j->nv - 1] = parent;
		if (parent >= 0)
			x->children[parent]++;
	}
}

/* The last rows of the joints of a chain, from the row on. Returns how many there are. */
static int chain_from(const struct again *x, int row, int *last)
{
	int count = 0;

	do {
		last[count++] = last_row(x->t, row);
		row = last[count - 1] + 1;
	} while (row < x->t->nv && x->children[row - 1] == 1 && x->parent[last_row(x->t, row)] == row - 1);
	return count;
}

static void cut_chains(struct again *x, int joints, int *last)
{
	for (int row = 0, count; row < x->t->nv; row = last[count - 1] + 1) {
		int base = x->parent[last_row(x->t, row)], stretches;

		count = chain_from(x, row, last);
		stretches = (count + joints - 1) / joints;
		for (int k = 0, r = row; k < stretches; k++, x->count++) {
			x->stretches[x->count] = (struct stretch_of_chain){base, last[count * (k + 1) / stretches - 1], stretches - k};
			for (; r <= x->stretches[x->count].last; r++)
				x->stretch[r] = x->count;
		}
	}
}

/* ---- nodes ---- */

/* Then rows of outputs that are read are those of qdd and mu (found.h), else what hands have left in some row. */
static int is_forward(const struct dag *d)
{
	return dag_find_role(d, ROLE_JOINT_TORQUE, 0) >= 0;
}

/* The row of qd that an input belongs to; -1: it is no joint's. */
static int row_of_input(const struct again *x, const struct node *n)
{
	const struct argument *a = n->arg[0].i < DAG_ARGUMENTS ? &x->d->arguments[n->arg[0].i] : NULL;
	int row = (int)n->arg[1].i;

	if (!a || (a->is_output && !is_forward(x->d)))
		return -1;
	if (a->role == ROLE_JOINT_POSITION)
		return tree_joint_of_q(x->t, row)->iv;
	if (a->role == ROLE_COTANGENT || a->is_output)
		return row % x->t->nv;
	return a->rows == x->t->nv ? row : -1;
}

/* Of what a loop over limbs makes it is the first limb's. */
static int row_of_output(const struct again *x, const struct output *o)
{
	int row = o->row % x->t->nv;

	return x->first_row && x->d->nodes[o->value.i].is_wide ? x->first_row[row] : row;
}

static void find_rows(struct again *x)
{
	const struct dag *d = x->d;

	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		x->made_for[i] = -1;
		x->of[i] = n->op == OP_INPUT ? row_of_input(x, n) : -1;
		for (int k = 0; k < op_arity[n->op]; k++)
			if (x->of[n->arg[k].i] > x->of[i])
				x->of[i] = x->of[n->arg[k].i];
	}
	for (size_t i = 0; i < d->output_count; i++) {
		int row = row_of_output(x, &d->outputs[i]), *made_for = &x->made_for[d->outputs[i].value.i];

		*made_for = row > *made_for ? row : *made_for;
	}
	for (size_t i = d->count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++) {
			int *made_for = &x->made_for[d->nodes[i].arg[k].i];

			*made_for = x->made_for[i] > *made_for ? x->made_for[i] : *made_for;
		}
}

/* May a stretch take a double of it: is it no constant, no sine or cosine, and of the joints of its chain? */
static int has_double(const struct again *x, int stretch, uint32_t i)
{
	const struct stretch_of_chain *s = &x->stretches[stretch];
	enum op op = x->d->nodes[i].op;

	return op != OP_CONST && op != OP_SIN && op != OP_COS && x->of[i] > s->base && x->of[i] <= s->last;
}

static unsigned char *taken_by(const struct again *x, int stretch, uint32_t i)
{
	return &x->taken[(size_t)stretch * x->d->count + i];
}

/* Does this node's own stretch take a double of the operand? */
static int takes_double(const struct again *x, size_t i, uint32_t operand)
{
	int stretch = x->stretch[x->made_for[i]];

	return x->stretch[x->made_for[operand]] != stretch && has_double(x, stretch, operand);
}

/* What nodes take for themselves, and for their doubles. */
static void find_taken(struct again *x)
{
	for (size_t i = x->d->count; i-- > 0;) {
		const struct node *n = &x->d->nodes[i];

		for (int k = 0; k < op_arity[n->op] && x->made_for[i] >= 0; k++) {
			uint32_t of = n->arg[k].i;

			if (takes_double(x, i, of))
				*taken_by(x, x->stretch[x->made_for[i]], of) = 1;
			for (int stretch = 0; stretch < x->count; stretch++)
				*taken_by(x, stretch, of) |= *taken_by(x, stretch, (uint32_t)i) && has_double(x, stretch, of);
		}
	}
}

/* ---- the copy: the rules of constructors were followed already ---- */

static struct ref *double_of(const struct again *x, int stretch, uint32_t i)
{
	return &x->doubles[(size_t)stretch * x->d->count + i];
}

/* Of operands, one of which at least is another value: what is made of sines and cosines alone takes one that counts as such. */
static struct ref doubled(const struct again *x, struct dag *out, int stretch, const struct node *n)
{
	struct ref args[3] = {{0}};
	int differs = 0, angle = -1;

	for (int k = 0; k < op_arity[n->op]; k++) {
		uint32_t of = n->arg[k].i;

		args[k] = *taken_by(x, stretch, of) ? *double_of(x, stretch, of) : x->map[of];
		differs |= *taken_by(x, stretch, of);
		angle = x->of[of] > x->stretches[stretch].base ? k : angle;
	}
	if (!differs && angle >= 0)
		args[angle] = dag_anew(out, args[angle]);
	return dag_node(out, n->op, args[0], args[1], args[2], 0);
}

/* Those of a stretch up to node `last`. */
static void make_doubles(const struct again *x, struct dag *out, int stretch, size_t last)
{
	for (; x->made[stretch] <= last; x->made[stretch]++) {
		uint32_t i = (uint32_t)x->made[stretch];
		const struct node *n = &x->d->nodes[i];

		if (*taken_by(x, stretch, i))
			*double_of(x, stretch, i) = n->op == OP_INPUT
				? dag_input_anew(out, (int)n->arg[0].i, (int)n->arg[1].i, (int)n->arg[2].i + x->stretches[stretch].times)
				: doubled(x, out, stretch, n);
	}
}

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct again *x = context;
	const struct node *n = &x->d->nodes[i];
	struct ref args[3] = {{0}};

	if (!op_arity[n->op])
		return dag_copy_leaf(out, x->d, i);
	if (x->made_for[i] < 0)
		return args[0];
	for (int k = 0; k < op_arity[n->op]; k++) {
		uint32_t of = n->arg[k].i;
		int stretch = x->stretch[x->made_for[i]];

		args[k] = x->map[of];
		if (takes_double(x, i, of)) {
			make_doubles(x, out, stretch, of);
			args[k] = *double_of(x, stretch, of);
		}
	}
	return dag_node(out, n->op, args[0], args[1], args[2], 0);
}

static int begin(struct again *x, int joints, struct arena *a)
{
	size_t rows = (size_t)x->t->nv + 1, nodes = x->d->count;
	int *last = arena_alloc(a, rows, sizeof *last);

	x->parent = arena_alloc(a, rows, sizeof *x->parent);
	x->children = arena_alloc(a, rows, sizeof *x->children);
	x->stretches = arena_alloc(a, rows, sizeof *x->stretches);
	x->stretch = arena_alloc(a, rows, sizeof *x->stretch);
	x->made_for = arena_alloc(a, nodes, sizeof *x->made_for);
	x->of = arena_alloc(a, nodes, sizeof *x->of);
	if (a->failed)
		return 0;
	find_parents(x);
	cut_chains(x, joints, last);
	find_rows(x);
	x->map = arena_alloc(a, nodes, sizeof *x->map);
	x->doubles = arena_alloc(a, (size_t)x->count * nodes, sizeof *x->doubles);
	x->taken = arena_alloc(a, (size_t)x->count * nodes, 1);
	x->made = arena_alloc(a, (size_t)x->count, sizeof *x->made);
	return !a->failed;
}

void again_make(struct dag *out, const struct dag *d, const struct tree *t, int joints, const int *first_row, struct arena *a)
{
	struct again x = {.d = d, .t = t, .first_row = first_row};
	struct arena spare;

	dag_init(out, a);
	arena_init(&spare, &a->allocator);
	if (begin(&x, joints, &spare)) {
		find_taken(&x);
		dag_copy(out, d, x.map, copy, &x);
	}
	out->failed |= spare.failed;
	arena_free(&spare);
}

/* ---- the length of the stretches ---- */

int again_is_of(const struct parts_of *x)
{
	return x->tree->nv > 0 && !x->request->is_forward && request_wants(x->request, WANT_VJP);
}

int again_serves(const struct parts_of *x)
{
	return again_is_of(x) && x->options->precision == RNEAGEN_F64;
}

/* Of a share whose products are joined to sums. */
static int build(struct part *p, const struct dag *share, int joints, const char *name, const char *doc, const struct parts_of *x,
	struct arena *a)
{
	if (joints)
		again_make(&p->function.dag, share, x->tree, joints, NULL, a);
	else
		p->function.dag = *share;
	p->joints = joints;
	return !p->function.dag.failed && part_plan(p, name, doc, x, a) && part_order(p, ORDERED_PART, x, a);
}

/* What a length costs, and values that wait. */
struct cost {
	double operations;
	struct waits waits;
};

static int cost_of(struct cost *c, const struct dag *share, int joints, const struct parts_of *x)
{
	struct arena spare;
	struct part p = {0};
	int is_built;

	arena_init(&spare, x->options->allocator);
	is_built = build(&p, share, joints, "", "", x, &spare);
	if (is_built) {
		c->waits = plan_waits(&p.function.plan, ROOM, &spare);
		c->operations = plan_flops(plan_operations(&p.function.plan)) + COST_BEYOND * (double)c->waits.beyond;
	}
	is_built = is_built && !spare.failed;
	arena_free(&spare);
	return is_built;
}

/* The length that costs least; -1 when memory runs out. */
static int best_length(const struct dag *share, const struct parts_of *x)
{
	struct cost cost[LENGTH_COUNT];
	int best = 0;

	if (!again_is_ordered(x->tree))
		return 0;
	if (!cost_of(&cost[0], share, LENGTHS[0], x))
		return -1;
	if (cost[0].waits.beyond == 0 || cost[0].waits.most > MOST_KEPT)
		return 0;
	for (int i = 1; i < LENGTH_COUNT; i++) {
		if (i == LENGTH_COUNT - 1 && cost[i - 1].operations != cost[i - 2].operations)
			break;
		if (!cost_of(&cost[i], share, LENGTHS[i], x))
			return -1;
		best = cost[i].operations < cost[best].operations ? i : best;
	}
	return LENGTHS[best];
}

int again_build(struct part *p, struct share *share, int owner, const char *name, const char *doc, const struct parts_of *x,
	struct arena *a)
{
	struct arena spare;
	struct dag raw, fused;
	int joints;

	arena_init(&spare, x->options->allocator);
	share_copy(share, owner, owner + 1, &raw, &spare);
	dag_init(&fused, a);
	dag_fuse(&fused, &raw, x->options->strict);
	arena_free(&spare);
	joints = fused.failed ? -1 : best_length(&fused, x);
	return joints >= 0 && build(p, &fused, joints, name, doc, x, a);
}
