/* Rows come in the order of their numbers, the last first: a value is made for the last row that takes it. Where a stretch's rows take
   what was made for an earlier stretch, of joints of its own chain up to its own, they take a double of it. */
#include "plan/grid/again.h"

/* Joints in a stretch that are tried, and what a value costs for which there is no room while a node is made, in operations. Two are
   tried where neither four nor three cut a chain. H100, 1 M samples of tau with vjp, ns, by length of the stretches, none, 4, 3, 2: atlas
   1.38, 0.94, 0.85, 0.85, g1_29dof 1.59, 1.25, 1.00, 0.96, jvrc1 3.66 (whole), 2.96, 2.91, 3.83 (the compiler gives each thread 168
   registers then), romeo 0.94, 0.87, 0.90, 0.92; of a floating base, whole and in one part: hyq 0.97, -, 0.63, 0.53, atlas 6.92, -, 3.63,
   3.55. 16384 samples, us: atlas 37.0, 28.3, 24.1, 27.2, g1_29dof 42.3, 36.8, 32.2, 30.6. In f32 values have room: atlas 0.40, 0.43
   (4), 0.47 (2). */
static const int LENGTHS[] = {0, 4, 3, 2};
enum { LENGTH_COUNT = sizeof LENGTHS / sizeof *LENGTHS, ROOM = 110 };
static const double COST_BEYOND = 0.03;

/* What a row belongs to: joints that follow each other without a branch. Rows of `base` and before are of the chain's parents. */
struct stretch_of_chain {
	int base, last;
	int times; /* its inputs are read for so many stretches of the chain before it, it among them */
};

struct again {
	const struct dag *d;
	const struct tree *t;
	int *parent, *children;          /* by last row of a joint: the last row of the one that carries it, or -1; how many it carries */
	struct stretch_of_chain *stretches;
	int *stretch;                    /* by row */
	int *made_for;                   /* by node: the last row that takes it; -1: none does */
	int *of;                         /* by node: the last row whose inputs it takes; -1: none */
	struct ref *map, *doubles;       /* by node; by stretch and node */
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

/* Returns 0 where a joint's rows stand before those of what carries it. */
static int find_parents(struct again *x)
{
	for (int i = 0; i < x->t->joint_count; i++) {
		const struct tree_joint *j = &x->t->joints[i];
		int last = j->iv + j->nv - 1, parent = parent_of(x->t, j);

		if (parent >= j->iv)
			return 0;
		x->parent[last] = parent;
		if (parent >= 0)
			x->children[parent]++;
	}
	return 1;
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
	int made = 0;

	for (int row = 0, count; row < x->t->nv; row = last[count - 1] + 1) {
		int base = x->parent[last_row(x->t, row)], stretches;

		count = chain_from(x, row, last);
		stretches = (count + joints - 1) / joints;
		for (int k = 0, r = row; k < stretches; k++, made++) {
			x->stretches[made] = (struct stretch_of_chain){base, last[count * (k + 1) / stretches - 1], stretches - k};
			for (; r <= x->stretches[made].last; r++)
				x->stretch[r] = made;
		}
	}
}

/* ---- nodes ---- */

/* The row of qd that an input belongs to; what earlier kernels hand on, and what is no joint's, of the last. */
static int row_of_input(const struct again *x, const struct node *n)
{
	const struct argument *a = &x->d->arguments[n->arg[0].i];
	int row = (int)n->arg[1].i;

	if (n->arg[0].i >= DAG_ARGUMENTS || a->is_output)
		return x->t->nv;
	if (a->role == ROLE_JOINT_POSITION) {
		for (int i = 0; i < x->t->joint_count; i++)
			if (row >= x->t->joints[i].iq && row < x->t->joints[i].iq + x->t->joints[i].nq)
				return x->t->joints[i].iv;
	} else if (a->role == ROLE_COTANGENT) {
		return row % x->t->nv;
	}
	return a->rows == x->t->nv ? row : x->t->nv;
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
		int row = d->outputs[i].row % x->t->nv, *made_for = &x->made_for[d->outputs[i].value.i];

		*made_for = row > *made_for ? row : *made_for;
	}
	for (size_t i = d->count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++) {
			int *made_for = &x->made_for[d->nodes[i].arg[k].i];

			*made_for = x->made_for[i] > *made_for ? x->made_for[i] : *made_for;
		}
}

/* Is it made again in a stretch that takes it: no constant, no sine or cosine, and of joints of its chain? */
static int has_double(const struct again *x, const struct stretch_of_chain *s, uint32_t i)
{
	enum op op = x->d->nodes[i].op;

	return op != OP_CONST && op != OP_SIN && op != OP_COS && x->of[i] > s->base && x->of[i] <= s->last;
}

/* ---- the copy: the rules of constructors were followed already ---- */

static struct ref double_of(struct again *x, struct dag *out, int stretch, uint32_t i);

/* Of operands, one of which at least is another value: what is made of sines and cosines alone takes one that counts as such. */
static struct ref doubled(struct again *x, struct dag *out, int stretch, const struct node *n)
{
	struct ref args[3] = {{0}};
	int differs = 0, angle = -1;

	for (int k = 0; k < op_arity[n->op]; k++) {
		args[k] = double_of(x, out, stretch, n->arg[k].i);
		differs |= !ref_equal(args[k], x->map[n->arg[k].i]);
		angle = x->of[n->arg[k].i] > x->stretches[stretch].base ? k : angle;
	}
	if (!differs && angle >= 0)
		args[angle] = dag_anew(out, args[angle]);
	return dag_node(out, n->op, args[0], args[1], args[2], 0);
}

static struct ref double_of(struct again *x, struct dag *out, int stretch, uint32_t i)
{
	const struct stretch_of_chain *s = &x->stretches[stretch];
	const struct node *n = &x->d->nodes[i];
	struct ref *made = &x->doubles[(size_t)stretch * x->d->count + i];

	if (!has_double(x, s, i))
		return x->map[i];
	if (!made->i)
		*made = n->op == OP_INPUT ? dag_input_anew(out, (int)n->arg[0].i, (int)n->arg[1].i, s->times)
					  : doubled(x, out, stretch, n);
	return *made;
}

static struct ref copy(void *context, struct dag *out, size_t i)
{
	struct again *x = context;
	const struct node *n = &x->d->nodes[i];
	struct ref args[3] = {{0}};
	int stretch;

	if (!op_arity[n->op])
		return dag_copy_leaf(out, x->d, i);
	if (x->made_for[i] < 0)
		return args[0];
	stretch = x->stretch[x->made_for[i]];
	for (int k = 0; k < op_arity[n->op]; k++) {
		uint32_t of = n->arg[k].i;

		args[k] = x->stretch[x->made_for[of]] == stretch ? x->map[of] : double_of(x, out, stretch, of);
	}
	return dag_node(out, n->op, args[0], args[1], args[2], 0);
}

void again_make(struct dag *out, const struct dag *d, const struct tree *t, int joints, struct arena *a)
{
	struct again x = {.d = d, .t = t};
	size_t rows = (size_t)t->nv + 1;
	struct arena spare;
	int *last;

	dag_init(out, a);
	arena_init(&spare, &a->allocator);
	x.parent = arena_alloc(&spare, rows, sizeof *x.parent);
	x.children = arena_alloc(&spare, rows, sizeof *x.children);
	x.stretches = arena_alloc(&spare, rows, sizeof *x.stretches);
	x.stretch = arena_alloc(&spare, rows, sizeof *x.stretch);
	x.made_for = arena_alloc(&spare, d->count, sizeof *x.made_for);
	x.of = arena_alloc(&spare, d->count, sizeof *x.of);
	x.map = arena_alloc(&spare, d->count, sizeof *x.map);
	x.doubles = arena_alloc(&spare, rows * d->count, sizeof *x.doubles);
	last = arena_alloc(&spare, rows, sizeof *last);
	if (!spare.failed) {
		cut_chains(&x, find_parents(&x) ? joints : t->nv, last);
		find_rows(&x);
		dag_copy(out, d, x.map, copy, &x);
	}
	out->failed |= spare.failed;
	arena_free(&spare);
}

/* ---- the length of the stretches ---- */

int again_serves(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;

	return x->tree->nv > 0 && !x->request->is_forward && request_wants(x->request, WANT_VJP) && o->precision == RNEAGEN_F64 &&
		o->layout == RNEAGEN_SOA;
}

/* Of a share whose products are joined to sums. */
static int build(struct part *p, const struct dag *share, int joints, const char *name, const char *doc, const struct parts_of *x,
	struct arena *a)
{
	if (joints)
		again_make(&p->pass.dag, share, x->tree, joints, a);
	else
		p->pass.dag = *share;
	if (p->pass.dag.failed || !part_plan(p, name, doc, x, a) || !plan_order(&p->pass, x->tree, x->request, x->options, 1, a))
		return 0;
	p->joints = joints;
	p->alive = plan_alive(&p->pass.plan, a);
	return !a->failed;
}

static int cost_of(double *cost, const struct dag *share, int joints, const struct parts_of *x)
{
	struct arena spare;
	struct part p = {0};
	int is_built;

	arena_init(&spare, x->options->allocator);
	is_built = build(&p, share, joints, "", "", x, &spare);
	if (is_built)
		*cost = plan_flops(plan_operations(&p.pass.plan)) + COST_BEYOND * (double)plan_waits(&p.pass.plan, ROOM, &spare).beyond;
	arena_free(&spare);
	return is_built;
}

/* The length that costs least; -1 when memory runs out. */
static int best_length(const struct dag *share, const struct parts_of *x)
{
	double cost[LENGTH_COUNT];
	int best = 0;

	for (int i = 0; i < LENGTH_COUNT; i++) {
		if (i == LENGTH_COUNT - 1 && cost[i - 1] != cost[i - 2])
			break;
		if (!cost_of(&cost[i], share, LENGTHS[i], x))
			return -1;
		best = cost[i] < cost[best] ? i : best;
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
