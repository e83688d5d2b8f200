/* Nodes of different limbs are twins if they are the same operation of twins, of what no limb owns, or of constants. A node of
   one limb without three twins is no limb's, nor is what is made of several limbs' nodes. */
#include "plan/lanes/lanes.h"
#include <string.h>

struct twins {
	enum op op;
	uint64_t key[3];
	uint32_t member[ALIKE_LIMBS]; /* 1 + a node; 0: none yet */
	struct ref wide;	      /* what they become */
};

struct finder {
	const struct dag *d;
	const struct alike *limbs;
	const struct tree *tree;
	struct twins *twins; /* from 1 */
	size_t count;
	uint32_t *of;	       /* by node: its twins; 0: it is no limb's */
	size_t loops;	       /* nodes from this one on are of columns: lanes there are columns */
	unsigned char *limb;   /* by node, from 1 */
	uint32_t *table;
	size_t table_size;
	struct ref *map;
};

/* Keys of operands: twins, a node of no limb, a constant of a limb's own. */
enum { KEY_KINDS = 3 };

static int limb_of_number(const struct finder *f, uint32_t i)
{
	const struct node *n = &f->d->nodes[i];
	int limb = n->op == OP_CONST ? dag_number(f->d, n).limb : 0;

	return limb > 0 ? limb : 0;
}

/* Of what follows the joints, once or several times, as weights of torques do: which joints' row it is. -1: it does not. */
static int joint_row(const struct finder *f, const struct argument *a, int row)
{
	int nv = f->tree->nv, is_of_joints = role_rows(a->role) == ROWS_NV || a->role == ROLE_COTANGENT || a->role == ROLE_TANGENT;

	return is_of_joints && nv > 0 && a->rows % nv == 0 ? row % nv : -1;
}

/* The limb, from 1, that an input's row belongs to, and its place: which of the first limb's bodies, and in which
   turn; 0: none. */
static int limb_of_input(const struct finder *f, const struct node *n, uint64_t *place)
{
	const struct argument *a;
	int is_q, row, limb = 0, body = 0;

	*place = 0;
	if (n->arg[0].i >= DAG_COLUMN)
		return 0;
	a = &f->d->arguments[n->arg[0].i];
	is_q = role_rows(a->role) == ROWS_NQ;
	row = is_q ? (int)n->arg[1].i : joint_row(f, a, (int)n->arg[1].i);
	if (row >= 0)
		limb = alike_limb(f->limbs, f->tree, is_q, row, &body);
	if (limb)
		*place = (uint64_t)body + (uint64_t)f->tree->body_count * (is_q ? 0 : n->arg[1].i / (uint32_t)f->tree->nv);
	return limb;
}

static uint64_t key_of(const struct finder *f, uint32_t i)
{
	if (f->of[i])
		return (uint64_t)f->of[i] * KEY_KINDS;
	return limb_of_number(f, i) ? (uint64_t)dag_number(f->d, &f->d->nodes[i]).kind * KEY_KINDS + 2 : (uint64_t)i * KEY_KINDS + 1;
}

/* The limb of which it is made, from 1; 0: of none, or of several. */
static int limb_of(const struct finder *f, uint32_t i, uint64_t key[3])
{
	const struct node *n = &f->d->nodes[i];
	int limb = 0;

	memset(key, 0, 3 * sizeof *key);
	if (i >= f->loops || n->op == OP_CONST || n->op == OP_SQRT || n->op == OP_ABS) /* vectors have signs alone */
		return 0;
	if (n->op == OP_INPUT) {
		key[0] = n->arg[0].i;
		key[2] = n->arg[2].i;
		return limb_of_input(f, n, &key[1]);
	}
	for (int k = 0; k < op_arity[n->op]; k++) {
		uint32_t a = n->arg[k].i;
		int own = f->of[a] ? f->limb[a] : limb_of_number(f, a);

		key[k] = key_of(f, a);
		if (own && limb && own != limb)
			return 0;
		limb = own ? own : limb;
	}
	if (op_commutes[n->op] && key[0] > key[1]) {
		uint64_t first = key[0];

		key[0] = key[1];
		key[1] = first;
	}
	return limb;
}

/* Which lane a limb has. */
static int lane_of(const struct finder *f, int limb)
{
	return (limb - 1) % f->limbs->limbs;
}

/* The first twins of this key that lack one of the limb. */
static uint32_t twins_for(struct finder *f, enum op op, const uint64_t key[3], int limb)
{
	uint64_t h = ((key[0] * 0x9e3779b97f4a7c15u ^ key[1]) * 0x9e3779b97f4a7c15u ^ key[2]) * 0x9e3779b97f4a7c15u + (uint64_t)op;
	size_t slot = (size_t)(h ^ h >> 32) & (f->table_size - 1);

	for (; f->table[slot]; slot = (slot + 1) & (f->table_size - 1)) {
		const struct twins *x = &f->twins[f->table[slot]];

		if (x->op == op && !memcmp(x->key, key, sizeof x->key) && !x->member[lane_of(f, limb)])
			return f->table[slot];
	}
	f->table[slot] = (uint32_t)++f->count;
	f->twins[f->count] = (struct twins){.op = op};
	memcpy(f->twins[f->count].key, key, sizeof f->twins->key);
	return (uint32_t)f->count;
}

static int is_complete(const struct finder *f, const struct twins *x)
{
	for (int k = 0; k < f->limbs->limbs; k++)
		if (!x->member[k])
			return 0;
	return 1;
}

/* Nodes by height, which twins have in common: begin[h] to begin[h + 1] of `order`. Returns how many heights there are. */
static uint32_t sort_by_height(const struct dag *d, uint32_t *height, uint32_t *begin, uint32_t *order)
{
	uint32_t heights = 0;

	for (uint32_t i = 0; i < d->count; i++) {
		height[i] = 0;
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			if (height[d->nodes[i].arg[k].i] >= height[i])
				height[i] = height[d->nodes[i].arg[k].i] + 1;
		heights = height[i] >= heights ? height[i] + 1 : heights;
		begin[height[i] + 1]++;
	}
	for (uint32_t h = 0; h < heights; h++)
		begin[h + 1] += begin[h];
	for (uint32_t i = (uint32_t)d->count; i-- > 0;)
		order[--begin[height[i] + 1]] = i;
	memmove(begin, begin + 1, heights * sizeof *begin);
	begin[heights] = (uint32_t)d->count;
	return heights;
}

/* Those of one height: what they are made of is known by then. */
static void find_level(struct finder *f, const uint32_t *nodes, uint32_t count)
{
	uint64_t key[3];

	for (uint32_t n = 0; n < count; n++) {
		uint32_t i = nodes[n];
		int limb = limb_of(f, i, key);

		f->limb[i] = (unsigned char)limb;
		f->of[i] = limb ? twins_for(f, f->d->nodes[i].op, key, limb) : 0;
		if (limb)
			f->twins[f->of[i]].member[lane_of(f, limb)] = i + 1;
	}
	for (uint32_t n = 0; n < count; n++)
		if (f->of[nodes[n]] && !is_complete(f, &f->twins[f->of[nodes[n]]]))
			f->of[nodes[n]] = 0;
}

static void find_twins(struct finder *f, struct arena *a)
{
	size_t count = f->d->count + 2;
	uint32_t *height = arena_alloc(a, count, sizeof *height), *begin = arena_alloc(a, count, sizeof *begin);
	uint32_t *order = arena_alloc(a, count, sizeof *order), heights;

	if (a->failed)
		return;
	heights = sort_by_height(f->d, height, begin, order);
	for (uint32_t h = 0; h < heights; h++)
		find_level(f, order + begin[h], begin[h + 1] - begin[h]);
}

/* ---- the DAG of lanes ---- */

/* What a text has for each limb by itself: inputs, sines and cosines. */
static int is_apart(enum op op)
{
	return op == OP_INPUT || op == OP_SIN || op == OP_COS;
}

/* The node as it is without lanes. */
static struct ref apart(const struct finder *f, struct dag *out, uint32_t i)
{
	const struct node *n = &f->d->nodes[i];
	struct ref args[3] = {{0}};

	if (!op_arity[n->op])
		return dag_copy_leaf(out, f->d, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		args[k] = apart(f, out, n->arg[k].i);
	return dag_operation(out, n->op, args[0], args[1], args[2]);
}

/* In a loop over limbs it is the same row of each, and its sine and cosine are made like all else. */
static int is_leaf(const struct finder *f, enum op op)
{
	return f->d->is_each ? op == OP_INPUT : is_apart(op);
}

/* Which group of limbs, from 1. */
static int loop_of(const struct finder *f, const struct twins *x)
{
	return 1 + (f->limb[x->member[0] - 1] - 1) / f->limbs->limbs;
}

static struct ref packed(const struct finder *f, struct dag *out, const struct twins *x)
{
	const struct node *n = &f->d->nodes[x->member[0] - 1];
	struct ref each[ALIKE_LIMBS];

	if (f->d->is_each)
		return dag_input_each(out, (int)n->arg[0].i, (int)n->arg[1].i, loop_of(f, x));
	for (int k = 0; k < f->limbs->limbs; k++)
		each[k] = apart(f, out, x->member[k] - 1);
	return dag_pack(out, each);
}

static struct ref constant(const struct finder *f, struct dag *out, const struct twins *x, int operand)
{
	struct dag_lanes lanes = {.loop = f->d->is_each ? loop_of(f, x) : 0};

	for (int k = 0; k < f->limbs->limbs; k++)
		lanes.x[k] = f->d->nodes[f->d->nodes[x->member[k] - 1].arg[operand].i].value;
	return dag_const_lanes(out, lanes);
}

static struct ref side_by_side(struct finder *f, struct dag *out, struct twins *x)
{
	const struct node *n = &f->d->nodes[x->member[0] - 1];
	struct ref args[3] = {{0}};

	if (x->wide.i)
		return x->wide;
	if (is_leaf(f, x->op))
		return x->wide = packed(f, out, x);
	for (int k = 0; k < op_arity[x->op]; k++) {
		uint32_t a = n->arg[k].i;

		args[k] = f->of[a] ? side_by_side(f, out, &f->twins[f->of[a]]) : limb_of_number(f, a) ? constant(f, out, x, k) : f->map[a];
	}
	if (x->op == OP_ANEW) /* that is for a GPU's registers */
		return x->wide = args[0];
	x->wide = dag_node(out, x->op, args[0], args[1], args[2], 0);
	if (n->tag.quantity[0])
		dag_tag(out, x->wide, n->tag.quantity, n->tag.body, n->tag.component);
	return x->wide;
}

static struct ref copy(void *context, struct dag *out, size_t i)
{
	struct finder *f = context;
	const struct node *n = &f->d->nodes[i];
	struct ref args[3] = {{0}}, wide;

	if (f->of[i]) {
		wide = side_by_side(f, out, &f->twins[f->of[i]]);
		return is_apart(n->op) && !f->d->is_each ? apart(f, out, (uint32_t)i) : dag_lane(out, wide, lane_of(f, f->limb[i]));
	}
	if (!op_arity[n->op])
		return dag_copy_leaf(out, f->d, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		args[k] = f->map[n->arg[k].i];
	return n->op == OP_ANEW ? args[0] : dag_operation(out, n->op, args[0], args[1], args[2]);
}

/* ---- what loops store ---- */

/* Which joint's row of an output it is: twins have the same place in each limb. Returns the limb, from 1; 0: it is no limb's. */
static int limb_of_output(const struct finder *f, const struct output *o, int *place)
{
	int nv = f->tree->nv, body, limb;

	if (nv == 0 || f->d->arguments[o->argument].rows % nv)
		return 0;
	limb = alike_limb(f->limbs, f->tree, 0, o->row % nv, &body);
	*place = body + f->tree->body_count * (o->row / nv);
	return limb;
}

/* Is the row of this place, of the limb's twin, an output too? */
static int has_output(const struct finder *f, const struct twins *x, const struct output *of, int place, int lane)
{
	for (const struct output *o = f->d->outputs; o < f->d->outputs + f->d->output_count; o++) {
		int at = 0, limb = o->argument == of->argument && o->value.i == x->member[lane] - 1 ? limb_of_output(f, o, &at) : 0;

		if (limb && at == place && lane_of(f, limb) == lane)
			return 1;
	}
	return 0;
}

/* A loop stores the same row of each of its limbs in its turn. */
static void store_in_loops(const struct finder *f, struct dag *out)
{
	for (size_t i = 0; i < f->d->output_count && f->d->is_each && !out->failed; i++) {
		const struct output *o = &f->d->outputs[i];
		const struct twins *x = &f->twins[f->of[o->value.i]];
		int place, limb = f->of[o->value.i] ? limb_of_output(f, o, &place) : 0;
		int all = limb > 0 && loop_of(f, x) == 1 + (limb - 1) / f->limbs->limbs && out->nodes[x->wide.i].is_wide;

		for (int k = 0; k < f->limbs->limbs && all; k++)
			all = has_output(f, x, o, place, k);
		if (all)
			out->outputs[i].value = x->wide;
	}
}

void lanes_of_twins(struct dag *out, const struct dag *d, const struct tree *t, const struct alike *limbs)
{
	struct finder f = {.d = d, .limbs = limbs, .tree = t, .loops = dag_loops_begin(d), .table_size = 1024};
	struct arena *a = out->arena;

	while (f.table_size < 2 * d->count)
		f.table_size *= 2;
	f.twins = arena_alloc(a, d->count + 1, sizeof *f.twins);
	f.of = arena_alloc(a, d->count, sizeof *f.of);
	f.limb = arena_alloc(a, d->count, 1);
	f.table = arena_alloc(a, f.table_size, sizeof *f.table);
	f.map = arena_alloc(a, d->count, sizeof *f.map);
	if (a->failed || d->failed) {
		out->failed = 1;
		return;
	}
	find_twins(&f, a);
	if (a->failed) {
		out->failed = 1;
		return;
	}
	dag_copy(out, d, f.map, copy, &f);
	store_in_loops(&f, out);
}
